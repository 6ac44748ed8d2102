! SPDX-License-Identifier: GPL-3.0-or-later
!> Criteria by generalised second and third invariants of the deviator s, an orthotropic quadratic
!> and an orthotropic cubic form (O. Cazacu and F. Barlat, 2001, 2003):
!>
!>     sb = factor (J2^3 - c J3^2)^(1/6),   J2 = Q_ij s_i s_j / 2,   J3 = A_ijk s_i s_j s_k / 6
!>
!> with Kelvin components s_i and symmetric Q and A. Their contraction with the unit tensor is zero:
!> derivatives need no projection.
module dd3_material_yield_invariant
  use dd3_base_kinds, only : wp
  use dd3_material_flow, only : flow_direction_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  use dd3_material_yield_power, only : function_t, root_of
  use dd3_material_yield_transformation, only : transformation_t, deviator_of, pull_back
  implicit none
  private
  public :: invariant_criterion_t, add_cubic, transform_forms

  !> A criterion by two invariants.
  type, abstract, extends(yield_criterion_t) :: invariant_criterion_t
    !> Q.
    real(wp) :: quadratic(6, 6) = 0.0_wp
    !> A.
    real(wp) :: cubic(6, 6, 6) = 0.0_wp
    real(wp) :: c = 0.0_wp
    !> Sixth power of the factor.
    real(wp) :: factor = 1.0_wp
  contains
    procedure :: value
    procedure :: second_derivative
  end type invariant_criterion_t

contains

  !> Add a term factor s_i s_j s_k to a cubic form.
  pure subroutine add_cubic(cubic, i, j, k, factor)
    real(wp), intent(inout) :: cubic(6, 6, 6)
    integer, intent(in) :: i, j, k
    real(wp), intent(in) :: factor

    cubic(i, j, k) = cubic(i, j, k) + factor
    cubic(j, k, i) = cubic(j, k, i) + factor
    cubic(k, i, j) = cubic(k, i, j) + factor
    cubic(i, k, j) = cubic(i, k, j) + factor
    cubic(k, j, i) = cubic(k, j, i) + factor
    cubic(j, i, k) = cubic(j, i, k) + factor
  end subroutine add_cubic

  !> Convert forms of a transformed stress to forms of the stress.
  pure subroutine transform_forms(transformation, quadratic, cubic)
    type(transformation_t), intent(in) :: transformation
    !> Q and A.
    real(wp), intent(inout) :: quadratic(6, 6), cubic(6, 6, 6)

    integer :: i, j

    do j = 1, 6
      quadratic(:, j) = pull_back(transformation, quadratic(:, j))
      do i = 1, 6
        cubic(:, i, j) = pull_back(transformation, cubic(:, i, j))
      end do
    end do
    do j = 1, 6
      quadratic(j, :) = pull_back(transformation, quadratic(j, :))
      do i = 1, 6
        cubic(i, :, j) = pull_back(transformation, cubic(i, :, j))
      end do
    end do
    do j = 1, 6
      do i = 1, 6
        cubic(i, j, :) = pull_back(transformation, cubic(i, j, :))
      end do
    end do
  end subroutine transform_forms

  !> Return the equivalent stress.
  pure real(wp) function value(self, stress)
    class(invariant_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)

    real(wp) :: s(6), second(6, 6), first(6), scale, f
    integer :: k

    value = 0.0_wp
    s = deviator_of(stress)
    scale = maxval(abs(s))
    if (.not. scale > 0.0_wp) return
    s = s/scale
    second = 0.0_wp
    do k = 1, 6
      second = second + s(k)*self%cubic(:, :, k)
    end do
    first = matmul(second, s)
    f = (0.5_wp*dot_product(s, matmul(self%quadratic, s)))**3 - self%c*(dot_product(first, s)/6)**2
    value = scale*(self%factor*max(f, 0.0_wp))**(1/6.0_wp)
  end function value

  !> Evaluate the equivalent stress and both derivatives by the chain rule; all are zero if the base
  !> of the root is not positive.
  pure subroutine second_derivative(self, stress, direction)
    class(invariant_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    type(flow_direction_t), intent(out) :: direction

    type(function_t) :: f, q
    real(wp) :: s(6), j2, j3, d2(6), d3(6), dd3(6, 6), scale
    integer :: k

    direction = flow_direction_t(stress, 0.0_wp, 0.0_wp, 0.0_wp)
    s = deviator_of(stress)
    scale = maxval(abs(s))
    if (.not. scale > 0.0_wp) return
    s = s/scale
    dd3 = 0.0_wp
    d2 = 0.0_wp
    d3 = 0.0_wp
    do k = 1, 6
      dd3 = dd3 + s(k)*self%cubic(:, :, k)
      d2 = d2 + s(k)*self%quadratic(:, k)
    end do
    do k = 1, 6
      d3 = d3 + 0.5_wp*s(k)*dd3(:, k)
    end do
    j2 = dot_product(d2, s)/2
    j3 = dot_product(d3, s)/3
    f%value = j2**3 - self%c*j3**2
    if (.not. f%value > 0.0_wp) return
    f%first = (3*j2**2)*d2 - (2*self%c*j3)*d3
    do k = 1, 6
      f%second(:, k) = (6*j2*d2(k))*d2 + (3*j2**2)*self%quadratic(:, k) &
          - (2*self%c)*(d3(k)*d3 + j3*dd3(:, k))
    end do
    call root_of(6, 6.0_wp, scale, self%factor, f, q)
    direction%equivalent = q%value
    direction%gradient = q%first
    direction%second = q%second
  end subroutine second_derivative

end module dd3_material_yield_invariant
