! SPDX-License-Identifier: GPL-3.0-or-later
!> Perfect plasticity: the flow stress is a constant, Y = Y0.
module dd3_material_hardening_perfect
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t
  implicit none
  private
  public :: perfect_t

  type, extends(isotropic_hardening_t) :: perfect_t
    private
    !> Flow stress, MPa.
    real(wp) :: y0 = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: hardening_curve
  end type perfect_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "perfect"
    description%title = "constant flow stress"
    description%source = "L. Prandtl, Proc. 1st Int. Congr. Appl. Mech., Delft "// &
        "(1924) 43-54; A. Reuss, Z. angew. Math. Mech. 10 (1930) 266-274"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "flow stress", 0.0_wp, lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 200.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(perfect_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(perfect_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    associate (unused => strain)
    end associate
    stress = self%y0
    slope = 0.0_wp
  end subroutine hardening_curve

end module dd3_material_hardening_perfect
