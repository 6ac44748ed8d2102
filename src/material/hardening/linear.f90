! SPDX-License-Identifier: GPL-3.0-or-later
!> Linear isotropic hardening: Y = Y0 + H p.
module dd3_material_hardening_linear
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t
  implicit none
  private
  public :: linear_t

  type, extends(isotropic_hardening_t) :: linear_t
    private
    !> Initial flow stress and slope H, MPa.
    real(wp) :: y0 = 0.0_wp, slope = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: hardening_curve
  end type linear_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "linear"
    description%title = "Y = Y0 + H p"
    description%source = "W. Prager, J. Appl. Mech. 16 (1949) 215-218"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("H", kind_real, "MPa", "", "slope dY/dp", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 200.0_wp), law_value_t("H", 500.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(linear_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
    self%slope = value_of(values, "H")
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(linear_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    stress = self%y0 + self%slope*strain
    slope = self%slope
  end subroutine hardening_curve

end module dd3_material_hardening_linear
