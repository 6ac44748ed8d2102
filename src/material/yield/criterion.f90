! SPDX-License-Identifier: GPL-3.0-or-later
!> Yield criteria: an equivalent stress, homogeneous of degree one and independent of pressure, with
!> its first and second derivatives. Stresses are Kelvin vectors in the orthotropy axes; V(-T) may
!> differ from -V(T).
module dd3_material_yield_criterion
  use dd3_base_kinds, only : wp
  use dd3_material_flow, only : flow_direction_t
  use dd3_material_law, only : law_t
  implicit none
  private
  public :: yield_criterion_t, yield_slot_t

  !> Base of the yield criteria.
  type, abstract, extends(law_t) :: yield_criterion_t
    !> Whether all parameters within their bounds give a convex surface; assigned by `set`.
    logical :: always_convex = .false.
    !> Whether the user accepts a surface that is not convex.
    logical :: convexity_waived = .false.
  contains
    procedure(value_interface), deferred :: value
    procedure(second_derivative_interface), deferred :: second_derivative
    procedure :: gradient
  end type yield_criterion_t

  !> Container of a criterion of any type.
  type :: yield_slot_t
    class(yield_criterion_t), allocatable :: law
  end type yield_slot_t

  abstract interface
    !> Return the equivalent stress, MPa.
    pure real(wp) function value_interface(self, stress)
      import :: yield_criterion_t, wp
      class(yield_criterion_t), intent(in) :: self
      !> Stress, MPa.
      real(wp), intent(in) :: stress(6)
    end function value_interface

    !> Evaluate the equivalent stress and both derivatives; all zero at zero deviator.
    pure subroutine second_derivative_interface(self, stress, direction)
      import :: yield_criterion_t, flow_direction_t, wp
      class(yield_criterion_t), intent(in) :: self
      !> Stress, MPa.
      real(wp), intent(in) :: stress(6)
      type(flow_direction_t), intent(out) :: direction
    end subroutine second_derivative_interface
  end interface

contains

  !> Evaluate the equivalent stress and its gradient; both zero at zero deviator.
  pure subroutine gradient(self, stress, value, normal)
    class(yield_criterion_t), intent(in) :: self
    !> Stress, MPa.
    real(wp), intent(in) :: stress(6)
    !> Equivalent stress, MPa.
    real(wp), intent(out) :: value
    !> Its gradient.
    real(wp), intent(out) :: normal(6)

    type(flow_direction_t) :: direction

    call self%second_derivative(stress, direction)
    value = direction%equivalent
    normal = direction%gradient
  end subroutine gradient

end module dd3_material_yield_criterion
