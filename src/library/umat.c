/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Abaqus' user subroutine UMAT by the constitutive laws, for Abaqus/Standard, CalculiX and codes that call it.
 *
 * The material is read from the file that the environment variable DD3_MATERIALS names, dd3_materials.dat by default.
 * Its name there is CMNAME in lower case without what CalculiX leaves of its own part: `@...@` and underscores before it.
 * Laws of the strain rate take DTIME, s. PROPS is not used; NSTATV is at least the number of internal variables.
 *
 * Stress and strain are components in axes that rotate with the material: in CalculiX always, in Abaqus with
 * *ORIENTATION. DROT is therefore not used. Rolling and normal direction of the material are in these axes as well.
 * A step that fails asks for half of the increment by PNEWDT.
 */
#include <ctype.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dd3laws.h"

enum { NAME_LENGTH = 80, MOST_MATERIALS = 100, EXIT_CODE = 201 };

static struct {
  char name[NAME_LENGTH + 1];
  dd3laws_material *material;
} known[MOST_MATERIALS];
static int n_known = 0;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static void stop(const char *text) {
  fflush(stdout);
  fprintf(stderr, " *ERROR in umat: %s\n", text);
  exit(EXIT_CODE);
}

/* Copy the material's name from CMNAME, which ends with blanks. */
static void copy_name(const char *cmname, char name[NAME_LENGTH + 1]) {
  int first = 0, last = 0, i;
  for (i = 0; i < NAME_LENGTH && cmname[i] != '\0'; i++) {
    if (!isspace((unsigned char)cmname[i])) last = i + 1;
    if (cmname[i] == '@') first = i + 1;
  }
  while (first < last && cmname[first] == '_') first++;
  for (i = first; i < last; i++) name[i - first] = (char)tolower((unsigned char)cmname[i]);
  name[last - first] = '\0';
}

static dd3laws_material *read_known(const char *name) {
  static char message[4000];
  const char *file = getenv("DD3_MATERIALS");
  if (file == NULL || *file == '\0') file = "dd3_materials.dat";
  if (n_known == MOST_MATERIALS) stop("too many materials");
  known[n_known].material = dd3laws_read(file, name, message, sizeof message);
  if (known[n_known].material == NULL) stop(message);
  strcpy(known[n_known].name, name);
  return known[n_known++].material;
}

/* Return a material by its name; the file is read at the first call. */
static const dd3laws_material *find_material(const char *cmname) {
  char name[NAME_LENGTH + 1];
  dd3laws_material *found = NULL;
  int i;
  copy_name(cmname, name);
  pthread_mutex_lock(&lock);
  for (i = 0; i < n_known && found == NULL; i++)
    if (strcmp(known[i].name, name) == 0) found = known[i].material;
  if (found == NULL) found = read_known(name);
  pthread_mutex_unlock(&lock);
  return found;
}

static void check_sizes(const dd3laws_material *material, int ndi, int nshr, int nstatv) {
  char text[200];
  if (ndi != 3 || nshr < 1 || nshr > 3)
    stop("expected 3 normal stresses and 1 to 3 shear stresses: solid elements, not plane stress");
  if (nstatv >= dd3laws_state_size(material)) return;
  snprintf(text, sizeof text, "expected %d state variables (*DEPVAR), got %d", dd3laws_state_size(material),
           nstatv);
  stop(text);
}

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
           double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
           const double *time, const double *dtime, const double *temp, const double *dtemp, const double *predef,
           const double *dpred, const char *cmname, const int *ndi, const int *nshr, const int *ntens,
           const int *nstatv, const double *props, const int *nprops, const double *coords, const double *drot,
           double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1, const int *noel,
           const int *npt, const int *layer, const int *kspt, const int *kstep, const int *kinc, int cmname_length) {
  const dd3laws_material *material = find_material(cmname);
  const int n = *ntens;
  double all_stress[6] = {0}, all_strain[6] = {0}, tangent[36];
  int i, j;

  (void)sse, (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)stran, (void)time;
  (void)temp, (void)dtemp, (void)predef, (void)dpred, (void)props, (void)nprops, (void)coords, (void)drot;
  (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel, (void)npt, (void)layer, (void)kspt, (void)kstep, (void)kinc;
  (void)cmname_length;
  check_sizes(material, *ndi, *nshr, *nstatv);
  for (i = 0; i < n; i++) {
    all_stress[i] = stress[i];
    all_strain[i] = dstran[i];
  }
  if (dd3laws_update_in_sheet_timed(material, all_strain, *dtime, all_stress, statev, tangent, NULL, 0) !=
      DD3LAWS_CONVERGED)
    *pnewdt = 0.5;
  for (j = 0; j < n; j++) {
    stress[j] = all_stress[j];
    for (i = 0; i < n; i++) ddsdde[i + n * j] = tangent[i + 6 * j];
  }
}
