!> What a hardening law is: the flow stress at the end of a plastic increment, with its derivatives
!> in the increment and in the stress. A law may own internal variables, and one back-stress that
!> follows them, as a law that depends on the strain path does.
module dd3_material_hardening_law
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_material_description, only : description_t, problem_t
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  implicit none
  private
  public :: hardening_t, hardening_slot_t

  !> A hardening law.
  type, abstract :: hardening_t
    !> Number of internal variables besides the equivalent plastic strain.
    integer :: n_internal = 0
    !> Whether the law has a back-stress of its own.
    logical :: owns_back_stress = .false.
    !> Whether the flow stress depends on the direction of flow.
    logical :: follows_path = .false.
  contains
    !> Says its name, source and parameters.
    procedure(describe_i), deferred, nopass :: describe
    !> Takes its parameters, which have been checked.
    procedure(set_i), deferred :: set
    !> The flow stress at the end of an increment.
    procedure(flow_stress_i), deferred :: flow_stress
    !> Its own back-stress at the end of an increment.
    procedure :: back_stress => no_back_stress
    !> Its own internal variables at the end of an increment.
    procedure :: advance => advance_nothing
    !> Finds what the parameters' own bounds cannot say. Problems that are there already: a value is
    !> missing or out of bounds, and only the names can be relied upon.
    procedure, nopass :: check => check_nothing
  end type hardening_t

  !> Holds a hardening law of any kind.
  type :: hardening_slot_t
    !> The law.
    class(hardening_t), allocatable :: law
  end type hardening_slot_t

  abstract interface
    !> Says its name, source and parameters.
    subroutine describe_i(description)
      import :: description_t
      !> What the law says of itself.
      type(description_t), intent(out) :: description
    end subroutine describe_i

    !> Takes its parameters, which have been checked.
    subroutine set_i(self, values)
      import :: hardening_t, law_value_t
      !> The law.
      class(hardening_t), intent(inout) :: self
      !> Its parameters.
      type(law_value_t), intent(in) :: values(:)
    end subroutine set_i

    !> The flow stress after a plastic increment; an increment of zero gives that of the old state.
    pure subroutine flow_stress_i(self, plastic, old, increment, direction, flow)
      import :: hardening_t, flow_direction_t, flow_response_t, wp
      !> The law.
      class(hardening_t), intent(in) :: self
      !> Equivalent plastic strain at the start.
      real(wp), intent(in) :: plastic
      !> Own internal variables at the start.
      real(wp), intent(in) :: old(self%n_internal)
      !> Plastic increment, not negative.
      real(wp), intent(in) :: increment
      !> The criterion at the effective stress of the end.
      type(flow_direction_t), intent(in) :: direction
      !> Flow stress and its derivatives.
      type(flow_response_t), intent(out) :: flow
    end subroutine flow_stress_i
  end interface

contains

  !> No back-stress.
  pure subroutine no_back_stress(self, old, increment, direction, back)
    !> The law.
    class(hardening_t), intent(in) :: self
    !> Own internal variables at the start.
    real(wp), intent(in) :: old(self%n_internal)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> The back-stress and its derivatives.
    type(back_response_t), intent(out) :: back

    back%value = 0.0_wp
    back%slope = 0.0_wp
    back%gradient = 0.0_wp
    associate (unused => old, no_increment => increment, no_direction => direction)
    end associate
  end subroutine no_back_stress

  !> Nothing changes.
  pure subroutine advance_nothing(self, old, increment, direction, new)
    !> The law.
    class(hardening_t), intent(in) :: self
    !> Own internal variables at the start.
    real(wp), intent(in) :: old(self%n_internal)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> Own internal variables at the end.
    real(wp), intent(out) :: new(self%n_internal)

    new = old
    associate (no_increment => increment, no_direction => direction)
    end associate
  end subroutine advance_nothing

  !> Finds nothing.
  subroutine check_nothing(values, problems)
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> Receives what is wrong.
    type(problem_t), allocatable, intent(inout) :: problems(:)

    associate (unused => values, unchanged => problems)
    end associate
  end subroutine check_nothing

end module dd3_material_hardening_law
