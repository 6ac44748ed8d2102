! SPDX-License-Identifier: GPL-3.0-or-later
!> The saturating law of E. Voce (1948): Y = Y0 + Rsat (1 - exp(-CR p)).
module dd3_material_hardening_voce
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_relaxation, only : longest_decay
  use dd3_material_description, only : description_t, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t
  implicit none
  private
  public :: voce_t

  type, extends(isotropic_hardening_t) :: voce_t
    private
    !> Initial flow stress and Rsat, MPa.
    real(wp) :: y0 = 0.0_wp, gain = 0.0_wp
    !> CR.
    real(wp) :: rate = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: hardening_curve
  end type voce_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "voce"
    description%title = "Y = Y0 + Rsat (1 - exp(-CR p))"
    description%source = "E. Voce, J. Inst. Metals 74 (1948) 537-562"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("Rsat", kind_real, "MPa", "", "gain of flow stress at saturation", 0.0_wp), &
      row("CR", kind_real, "", "", "rate of saturation", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 200.0_wp), law_value_t("Rsat", 150.0_wp), law_value_t("CR", 10.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(voce_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
    self%gain = value_of(values, "Rsat")
    self%rate = value_of(values, "CR")
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(voce_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    real(wp) :: missing

    missing = self%gain*exp(-min(self%rate*strain, longest_decay))
    stress = self%y0 + self%gain - missing
    slope = self%rate*missing
  end subroutine hardening_curve

end module dd3_material_hardening_voce
