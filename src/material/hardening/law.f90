! SPDX-License-Identifier: GPL-3.0-or-later
!> Hardening laws: the flow stress at the end of a plastic increment, with its derivatives in the
!> increment and in the stress. A law that depends on the strain path has internal variables of its
!> own, and possibly a back-stress.
module dd3_material_hardening_law
  use dd3_base_kinds, only : wp
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_law, only : law_t
  implicit none
  private
  public :: hardening_t, hardening_slot_t

  !> Base of the hardening laws.
  type, abstract, extends(law_t) :: hardening_t
    !> Number of internal variables besides the equivalent plastic strain.
    integer :: n_internal = 0
    !> Whether the law has a back-stress of its own.
    logical :: owns_back_stress = .false.
    !> Whether the flow stress depends on the direction of flow.
    logical :: path_dependent = .false.
  contains
    procedure(flow_stress_interface), deferred :: flow_stress
    procedure :: back_stress => no_back_stress
    procedure :: evolve => keep_internal_variables
  end type hardening_t

  !> Container of a hardening law of any type.
  type :: hardening_slot_t
    class(hardening_t), allocatable :: law
  end type hardening_slot_t

  abstract interface
    !> Evaluate the flow stress at the end of a plastic increment; for an increment of zero, at the
    !> start.
    pure subroutine flow_stress_interface(self, plastic_strain, start, increment, direction, flow)
      import :: hardening_t, flow_direction_t, flow_response_t, wp
      class(hardening_t), intent(in) :: self
      !> Equivalent plastic strain at the start.
      real(wp), intent(in) :: plastic_strain
      !> Own internal variables at the start.
      real(wp), intent(in) :: start(self%n_internal)
      !> Plastic increment, not negative.
      real(wp), intent(in) :: increment
      !> The criterion at the effective stress of the end.
      type(flow_direction_t), intent(in) :: direction
      type(flow_response_t), intent(out) :: flow
    end subroutine flow_stress_interface
  end interface

contains

  !> Return the law's own back-stress at the end of an increment: none.
  pure subroutine no_back_stress(self, start, increment, direction, back)
    class(hardening_t), intent(in) :: self
    !> Own internal variables at the start.
    real(wp), intent(in) :: start(self%n_internal)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: back

    back%value = 0.0_wp
    back%slope = 0.0_wp
    back%gradient = 0.0_wp
    associate (unused => start, no_increment => increment, no_direction => direction)
    end associate
  end subroutine no_back_stress

  !> Evolve the law's own internal variables over an increment: unchanged.
  pure subroutine keep_internal_variables(self, start, increment, direction, evolved)
    class(hardening_t), intent(in) :: self
    !> Own internal variables at the start.
    real(wp), intent(in) :: start(self%n_internal)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> Own internal variables at the end.
    real(wp), intent(out) :: evolved(self%n_internal)

    evolved = start
    associate (no_increment => increment, no_direction => direction)
    end associate
  end subroutine keep_internal_variables

end module dd3_material_hardening_law
