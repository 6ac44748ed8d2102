/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The constitutive laws of dd3imp for C, and as Abaqus' user subroutine UMAT (umat.c).
 *
 * A material is made from the lines of a block *MATERIAL of dd3imp's input, so that each yield criterion, hardening
 * law and back-stress law of the program is at hand, with the same parameters, checks and return mapping.
 *
 * Conventions
 *   axes           those of the material: 1 rolling, 2 transverse, 3 normal direction. The laws do not rotate: at
 *                  large strains the caller passes components in axes that rotate with the material.
 *   vectors        11 22 33 12 13 23. Shear strains are engineering strains, twice the tensor component.
 *   strain         increment of the logarithmic strain, or of the small strain
 *   stress         Cauchy stress, MPa, or the unit of Young's modulus and the flow stress
 *   tangent        consistent tangent d stress_i/d strain_j = tangent[i + 6*j]; not symmetric with back-stresses
 *   state          internal variables, initially zero: equivalent plastic strain first; the 6 of a tensor are 11 22 33
 *                  sqrt(2) 23, sqrt(2) 13, sqrt(2) 12; temperature is its rise above the initial one
 *   elasticity     isotropic, hypoelastic: stress rate and elastic strain rate in the rotating axes
 *
 * Errors are returned with their text in message, cut to length bytes with the null character; message may be NULL.
 *
 * A material does not change after it was made: any number of threads may use it, and make others.
 */
#ifndef DD3LAWS_H
#define DD3LAWS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dd3laws_material dd3laws_material;

/* Results of dd3laws_update. */
enum {
  DD3LAWS_CONVERGED = 0,
  DD3LAWS_RETRY = 1,     /* a smaller increment may succeed */
  DD3LAWS_IMPOSSIBLE = 2 /* the input is not finite */
};

/* Copy the version of the library, such as 1.0.0. */
void dd3laws_version(char *text, size_t length);

/* Make a material from a text with a block *MATERIAL, or from a file, which may be a whole input file. name is that of
 * the block; NULL or "" if there is only one. NULL is returned if there are errors; message then has a text for each,
 * with line and column. Files that the laws name are relative to the folder of the file, or to the working directory.
 */
dd3laws_material *dd3laws_new(const char *text, const char *name, char *message, size_t length);
dd3laws_material *dd3laws_read(const char *file, const char *name, char *message, size_t length);

/* Release a material; NULL is allowed. */
void dd3laws_free(dd3laws_material *material);

/* Return the number of internal variables. */
int dd3laws_state_size(const dd3laws_material *material);

/* Copy the name of internal variable i, from 0; empty if there is none. */
void dd3laws_state_name(const dd3laws_material *material, int i, char *name, size_t length);

/* Copy rolling, transverse and normal direction in the initial sheet, one after the other. */
void dd3laws_axes(const dd3laws_material *material, double axes[9]);

/* Integrate stress and internal variables over a strain increment; return one of the results above. If it is not
 * DD3LAWS_CONVERGED, stress and state are unchanged and the tangent is elastic.
 */
int dd3laws_update(const dd3laws_material *material, const double strain[6], double stress[6], double *state,
                   double tangent[36], char *message, size_t length);

/* The same with strain, stress and tangent in the axes in which rolling and normal direction are given, those of the
 * initial sheet, which rotate with the material. The state stays in the axes of the material.
 */
int dd3laws_update_in_sheet(const dd3laws_material *material, const double strain[6], double stress[6], double *state,
                            double tangent[36], char *message, size_t length);

/* The two over a time, s, which a law of the strain rate needs. Without a time, by the functions above or by 0, the
 * rate is that of the state: 0 at the start, so that the flow stress is that at rest.
 */
int dd3laws_update_timed(const dd3laws_material *material, const double strain[6], double time, double stress[6],
                         double *state, double tangent[36], char *message, size_t length);
int dd3laws_update_in_sheet_timed(const dd3laws_material *material, const double strain[6], double time,
                                  double stress[6], double *state, double tangent[36], char *message, size_t length);

/* Return equivalent stress and flow stress of a state; they are equal in plastic flow. */
double dd3laws_equivalent_stress(const dd3laws_material *material, const double stress[6], const double *state);
double dd3laws_flow_stress(const dd3laws_material *material, const double *state);

#ifdef __cplusplus
}
#endif

#endif
