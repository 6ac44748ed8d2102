/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Print the stress after tension of 1 % with lateral strains of -0.5 %. */
#include <dd3laws.h>
#include <stdio.h>

int main(void) {
  const char *text = "*MATERIAL steel\n"
                     "young = 2.1e5\n"
                     "poisson = 0.3\n"
                     "yield = von_mises\n"
                     "hardening = swift K=565 e0=0.007117 n=0.259\n";
  const double strain[6] = {0.01, -0.005, -0.005};
  double stress[6] = {0}, state[1] = {0}, tangent[36];
  char message[400];
  dd3laws_material *steel = dd3laws_new(text, NULL, message, sizeof message);
  if (steel == NULL || dd3laws_state_size(steel) != 1 ||
      dd3laws_update(steel, strain, stress, state, tangent, message, sizeof message) != DD3LAWS_CONVERGED) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  printf("%.9f\n", stress[0]);
  dd3laws_free(steel);
  return 0;
}
