!> What a yield criterion is: an equivalent stress, homogeneous of degree one, insensitive to
!> pressure, with its first and second derivative. Stresses are Kelvin vectors in the orthotropy
!> axes; V(-T) may differ from -V(T).
module dd3_material_yield_criterion
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_material_description, only : description_t, problem_t
  use dd3_material_flow, only : flow_direction_t
  implicit none
  private
  public :: yield_criterion_t, yield_slot_t

  !> A yield criterion.
  type, abstract :: yield_criterion_t
    !> Whether any parameters within their bounds give a convex surface; known once they are set.
    logical :: always_convex = .false.
    !> Whether the user takes a surface that is not convex.
    logical :: convexity_waived = .false.
  contains
    !> Says its name, source and parameters.
    procedure(describe_i), deferred, nopass :: describe
    !> Takes its parameters, which have been checked.
    procedure(set_i), deferred :: set
    !> The equivalent stress alone.
    procedure(value_i), deferred :: value
    !> The equivalent stress and its gradient.
    procedure(gradient_i), deferred :: gradient
    !> The equivalent stress, its gradient and its second derivative.
    procedure(second_i), deferred :: second_derivative
    !> Finds what the parameters' own bounds cannot say. Problems that are there already: a value is
    !> missing or out of bounds, and only the names can be relied upon.
    procedure, nopass :: check => check_nothing
  end type yield_criterion_t

  !> Holds a criterion of any kind.
  type :: yield_slot_t
    !> The criterion.
    class(yield_criterion_t), allocatable :: law
  end type yield_slot_t

  abstract interface
    !> Says its name, source and parameters.
    subroutine describe_i(description)
      import :: description_t
      !> What the law says of itself.
      type(description_t), intent(out) :: description
    end subroutine describe_i

    !> Takes its parameters, which have been checked.
    subroutine set_i(self, values)
      import :: yield_criterion_t, law_value_t
      !> The criterion.
      class(yield_criterion_t), intent(inout) :: self
      !> Its parameters.
      type(law_value_t), intent(in) :: values(:)
    end subroutine set_i

    !> The equivalent stress alone.
    pure real(wp) function value_i(self, stress)
      import :: yield_criterion_t, wp
      !> The criterion.
      class(yield_criterion_t), intent(in) :: self
      !> Stress, MPa.
      real(wp), intent(in) :: stress(6)
    end function value_i

    !> The equivalent stress and its gradient; both zero at zero deviator.
    pure subroutine gradient_i(self, stress, value, normal)
      import :: yield_criterion_t, wp
      !> The criterion.
      class(yield_criterion_t), intent(in) :: self
      !> Stress, MPa.
      real(wp), intent(in) :: stress(6)
      !> Equivalent stress, MPa.
      real(wp), intent(out) :: value
      !> Its gradient.
      real(wp), intent(out) :: normal(6)
    end subroutine gradient_i

    !> The equivalent stress with both derivatives; all zero at zero deviator.
    pure subroutine second_i(self, stress, direction)
      import :: yield_criterion_t, flow_direction_t, wp
      !> The criterion.
      class(yield_criterion_t), intent(in) :: self
      !> Stress, MPa.
      real(wp), intent(in) :: stress(6)
      !> The stress, its equivalent stress and the derivatives.
      type(flow_direction_t), intent(out) :: direction
    end subroutine second_i
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

end module dd3_material_yield_criterion
