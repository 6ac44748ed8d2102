! SPDX-License-Identifier: GPL-3.0-or-later
!> Print the stress after tension of 1 % with lateral strains of -0.5 %.
program tension
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_base_verdict, only : verdict_converged, verdict_t
  use dd3_material_description, only : law_choice_t
  use dd3_material_material, only : material_t, new_material
  implicit none

  type(law_choice_t) :: criterion, hardening, no_backstress(0)
  type(material_t) :: steel
  type(verdict_t) :: verdict
  real(wp) :: strain(6), stress(6), internal_variables(1), tangent(6, 6)
  logical :: plastic

  criterion%name = "von_mises"
  allocate (criterion%values(0))
  hardening%name = "swift"
  hardening%values = [law_value_t("K", 565.0_wp), law_value_t("e0", 0.007117_wp), &
      law_value_t("n", 0.259_wp)]
  call new_material(steel, 2.1e5_wp, 0.3_wp, criterion, hardening, no_backstress)
  strain = [0.01_wp, -0.005_wp, -0.005_wp, 0.0_wp, 0.0_wp, 0.0_wp]
  call steel%update([real(wp) :: 0, 0, 0, 0, 0, 0], [0.0_wp], strain, stress, internal_variables, &
      tangent, plastic, verdict)
  if (verdict%outcome /= verdict_converged) error stop "no convergence"
  print '(f0.9)', stress(1)
end program tension
