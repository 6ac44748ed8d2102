! SPDX-License-Identifier: GPL-3.0-or-later
!> Linear kinematic hardening, W. Prager (1955): dX = k N' dp, N' = dev(T - X)/sb. In uniaxial
!> tension of a von Mises material the stress rises by k per unit of plastic strain.
module dd3_material_backstress_prager
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_law, only : backstress_t
  use dd3_material_backstress_relaxation, only : relax_back_stress
  use dd3_material_description, only : description_t, value_of
  use dd3_material_flow, only : flow_direction_t, back_response_t
  implicit none
  private
  public :: prager_t

  type, extends(backstress_t) :: prager_t
    private
    !> Modulus k, MPa.
    real(wp) :: modulus = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: back_stress
  end type prager_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "prager"
    description%title = "dX = k dev(T - X)/sb dp"
    description%source = "W. Prager, Proc. Inst. Mech. Eng. 169 (1955) 41-57"
    allocate (description%rows, source=[ &
      row("k", kind_real, "MPa", "", "kinematic modulus", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("k", 800.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(prager_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%modulus = value_of(values, "k")
  end subroutine set

  !> Evaluate the back-stress at the end of a plastic increment.
  pure subroutine back_stress(self, start, increment, direction, back)
    class(prager_t), intent(in) :: self
    real(wp), intent(in) :: start(6), increment
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: back

    call relax_back_stress(self%modulus, 0.0_wp, start, increment, direction, back)
  end subroutine back_stress

end module dd3_material_backstress_prager
