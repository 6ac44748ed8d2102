! SPDX-License-Identifier: GPL-3.0-or-later
!> Back-stress laws: the back-stress at the end of a plastic increment, with its derivatives in the
!> increment and in the effective stress. Several back-stresses add up.
module dd3_material_backstress_law
  use dd3_base_kinds, only : wp
  use dd3_material_description, only : internal_variable_t
  use dd3_material_flow, only : flow_direction_t, back_response_t
  use dd3_material_law, only : law_t
  implicit none
  private
  public :: backstress_t, backstress_slot_t

  !> A back-stress law; its only internal variable is the back-stress.
  type, abstract, extends(law_t) :: backstress_t
  contains
    procedure, nopass :: describe_internal_variables
    procedure(back_stress_interface), deferred :: back_stress
  end type backstress_t

  !> Container of a back-stress law of any type.
  type :: backstress_slot_t
    class(backstress_t), allocatable :: law
  end type backstress_slot_t

  abstract interface
    !> Evaluate the back-stress at the end of a plastic increment; for an increment of zero, the
    !> start value and its rate as slope.
    pure subroutine back_stress_interface(self, start, increment, direction, back)
      import :: backstress_t, flow_direction_t, back_response_t, wp
      class(backstress_t), intent(in) :: self
      !> Back-stress at the start, MPa.
      real(wp), intent(in) :: start(6)
      !> Plastic increment, not negative.
      real(wp), intent(in) :: increment
      !> The criterion at the effective stress of the end.
      type(flow_direction_t), intent(in) :: direction
      type(back_response_t), intent(out) :: back
    end subroutine back_stress_interface
  end interface

contains

  pure subroutine describe_internal_variables(rows)
    type(internal_variable_t), allocatable, intent(out) :: rows(:)

    allocate (rows(1))
    rows(1) = internal_variable_t("back_stress", "MPa", "back-stress X, Kelvin vector", 6)
  end subroutine describe_internal_variables

end module dd3_material_backstress_law
