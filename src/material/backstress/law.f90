!> What a back-stress law is: the back-stress at the end of a plastic increment, with its
!> derivatives in the increment and in the effective stress. Several back-stresses add up.
module dd3_material_backstress_law
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_material_description, only : description_t, problem_t
  use dd3_material_flow, only : flow_direction_t, back_response_t
  implicit none
  private
  public :: backstress_t, backstress_slot_t

  !> A back-stress law.
  type, abstract :: backstress_t
  contains
    !> Says its name, source and parameters.
    procedure(describe_i), deferred, nopass :: describe
    !> Takes its parameters, which have been checked.
    procedure(set_i), deferred :: set
    !> The back-stress at the end of an increment.
    procedure(back_stress_i), deferred :: back_stress
    !> Finds what the parameters' own bounds cannot say. Problems that are there already: a value is
    !> missing or out of bounds, and only the names can be relied upon.
    procedure, nopass :: check => check_nothing
  end type backstress_t

  !> Holds a back-stress law of any kind.
  type :: backstress_slot_t
    !> The law.
    class(backstress_t), allocatable :: law
  end type backstress_slot_t

  abstract interface
    !> Says its name, source and parameters.
    subroutine describe_i(description)
      import :: description_t
      !> What the law says of itself.
      type(description_t), intent(out) :: description
    end subroutine describe_i

    !> Takes its parameters, which have been checked.
    subroutine set_i(self, values)
      import :: backstress_t, law_value_t
      !> The law.
      class(backstress_t), intent(inout) :: self
      !> Its parameters.
      type(law_value_t), intent(in) :: values(:)
    end subroutine set_i

    !> The back-stress after a plastic increment; an increment of zero gives the old one, and as
    !> slope its rate.
    pure subroutine back_stress_i(self, old, increment, direction, back)
      import :: backstress_t, flow_direction_t, back_response_t, wp
      !> The law.
      class(backstress_t), intent(in) :: self
      !> Back-stress at the start, MPa.
      real(wp), intent(in) :: old(6)
      !> Plastic increment, not negative.
      real(wp), intent(in) :: increment
      !> The criterion at the effective stress of the end.
      type(flow_direction_t), intent(in) :: direction
      !> The back-stress and its derivatives.
      type(back_response_t), intent(out) :: back
    end subroutine back_stress_i
  end interface

contains

  !> Finds nothing.
  subroutine check_nothing(values, problems)
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> Receives what is wrong.
    type(problem_t), allocatable, intent(inout) :: problems(:)

    associate (unused => values, unchanged => problems)
    end associate
  end subroutine check_nothing

end module dd3_material_backstress_law
