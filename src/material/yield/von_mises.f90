! SPDX-License-Identifier: GPL-3.0-or-later
!> The isotropic criterion of R. von Mises (1913): sb = sqrt(3/2 s:s), s the deviator of the stress.
module dd3_material_yield_von_mises
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_linalg_tensor, only : kelvin_deviator_projector
  use dd3_material_description, only : description_t
  use dd3_material_flow, only : flow_direction_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  use dd3_material_yield_transformation, only : deviator_of
  implicit none
  private
  public :: von_mises_t

  type, extends(yield_criterion_t) :: von_mises_t
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: value
    procedure :: gradient
    procedure :: second_derivative
  end type von_mises_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "von_mises"
    description%title = "isotropic, quadratic"
    description%source = "R. von Mises, Nachr. Ges. Wiss. Goettingen (1913) 582-592"
    allocate (description%rows(0), description%example(0))
  end subroutine describe

  subroutine set(self, values)
    class(von_mises_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    associate (unused => values)
    end associate
    self%always_convex = .true.
  end subroutine set

  !> Return the equivalent stress.
  pure real(wp) function value(self, stress)
    class(von_mises_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)

    real(wp) :: s(6)

    associate (unused => self)
    end associate
    s = deviator_of(stress)
    value = sqrt(1.5_wp*dot_product(s, s))
  end function value

  !> Evaluate the equivalent stress and its gradient.
  pure subroutine gradient(self, stress, value, normal)
    class(von_mises_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    real(wp), intent(out) :: value
    real(wp), intent(out) :: normal(6)

    associate (unused => self)
    end associate
    normal = deviator_of(stress)
    value = sqrt(1.5_wp*dot_product(normal, normal))
    if (value > 0.0_wp) normal = (1.5_wp/value)*normal
  end subroutine gradient

  !> Evaluate the equivalent stress and both derivatives.
  pure subroutine second_derivative(self, stress, direction)
    class(von_mises_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    type(flow_direction_t), intent(out) :: direction

    real(wp) :: factor
    integer :: j

    direction%stress = stress
    call self%gradient(stress, direction%equivalent, direction%gradient)
    factor = 0.0_wp
    if (direction%equivalent > 0.0_wp) factor = 1/direction%equivalent
    do j = 1, 6
      direction%second(:, j) = factor*(1.5_wp*kelvin_deviator_projector(:, j) &
          - direction%gradient(j)*direction%gradient)
    end do
  end subroutine second_derivative

end module dd3_material_yield_von_mises
