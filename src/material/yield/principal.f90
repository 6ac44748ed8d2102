! SPDX-License-Identifier: GPL-3.0-or-later
!> Criteria that are symmetric functions q of the principal values of one or two linearly
!> transformed stresses S = L T. With eigenvectors v_i, N_ij = sym(v_i x v_j) and M_ij = L^T N_ij,
!>
!>     V = sum q_i M_ii,   H = sum q_ij M_ii M_jj + sum_{i/=j} t_ij M_ij M_ij,
!>     t_ij = (q_i - q_j)/(e_i - e_j), and its limit q_ii - q_ij at equal principal values
!>
!> (R. W. Ogden, Non-linear Elastic Deformations, 1984, section 6.1.4, for derivatives of isotropic
!> functions). The second sum runs over the pairs of the same transformed stress.
module dd3_material_yield_principal
  use dd3_base_kinds, only : inverse_sqrt2, sqrt2, wp
  use dd3_linalg_tensor, only : symmetric_eigen, tensor_from_kelvin
  use dd3_material_flow, only : flow_direction_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  use dd3_material_yield_power, only : exponent_t, function_t, powers
  use dd3_material_yield_transformation, only : transformation_t, deviator_of, transform, pull_back
  implicit none
  private
  public :: principal_criterion_t, add_differences

  !> A criterion by principal values.
  type, abstract, extends(yield_criterion_t) :: principal_criterion_t
    !> Number of transformed stresses, and their transformations.
    integer :: count = 1
    type(transformation_t) :: transformation(2)
  contains
    procedure(principal_function_interface), deferred :: principal_function
    procedure :: value
    procedure :: gradient
    procedure :: second_derivative
  end type principal_criterion_t

  abstract interface
    !> Evaluate the function q of principal values that are not all zero.
    pure subroutine principal_function_interface(self, e, q)
      import :: principal_criterion_t, function_t, wp
      class(principal_criterion_t), intent(in) :: self
      !> Principal values, three of each transformed stress, MPa.
      real(wp), intent(in) :: e(6)
      !> Only the derivatives in the values of the transformed stresses in use are defined.
      type(function_t), intent(out) :: q
    end subroutine principal_function_interface
  end interface

  !> Principal values of the transformed stresses and their derivatives in the stress.
  type :: spectrum_t
    real(wp) :: e(6)
    !> M_ii.
    real(wp) :: own(6, 6)
    !> M_23, M_31, M_12 of each transformed stress.
    real(wp) :: mixed(6, 6)
  end type spectrum_t

  !> First and second index of the pairs.
  integer, parameter :: one(3) = [2, 3, 1], other(3) = [3, 1, 2]
  !> Difference of principal values, relative to the largest, below which they count as equal.
  real(wp), parameter :: closeness = 1.0e-6_wp

contains

  !> Add weight (|e1-e2|^m + |e2-e3|^m + |e3-e1|^m) to a function of scaled principal values.
  pure subroutine add_differences(exponent, weight, e, f)
    !> m.
    type(exponent_t), intent(in) :: exponent
    real(wp), intent(in) :: weight
    !> Principal values, scaled.
    real(wp), intent(in) :: e(3)
    type(function_t), intent(inout) :: f

    real(wp) :: power(3), d(3), dd(3)
    integer :: i

    call powers(3, exponent, e(one) - e(other), power, d, dd)
    f%value = f%value + weight*sum(power)
    do i = 1, 3
      associate (j => one(i), k => other(i))
        f%first(j) = f%first(j) + weight*d(i)
        f%first(k) = f%first(k) - weight*d(i)
        f%second(j, j) = f%second(j, j) + weight*dd(i)
        f%second(k, k) = f%second(k, k) + weight*dd(i)
        f%second(j, k) = f%second(j, k) - weight*dd(i)
        f%second(k, j) = f%second(k, j) - weight*dd(i)
      end associate
    end do
  end subroutine add_differences

  !> Return the equivalent stress.
  pure real(wp) function value(self, stress)
    class(principal_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)

    type(function_t) :: q
    real(wp) :: s(6), e(6), vectors(3, 3)
    integer :: n

    s = deviator_of(stress)
    value = 0.0_wp
    if (.not. any(abs(s) > 0.0_wp)) return
    e = 0.0_wp
    do n = 1, self%count
      call symmetric_eigen(tensor_from_kelvin(transform(self%transformation(n), s)), &
          e(3*n - 2:3*n), vectors)
    end do
    if (.not. any(abs(e) > 0.0_wp)) return
    call self%principal_function(e, q)
    value = q%value
  end function value

  !> Evaluate the equivalent stress and its gradient.
  pure subroutine gradient(self, stress, value, normal)
    class(principal_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    real(wp), intent(out) :: value
    real(wp), intent(out) :: normal(6)

    type(spectrum_t) :: at
    type(function_t) :: q
    integer :: i

    value = 0.0_wp
    normal = 0.0_wp
    call decompose(self, stress, at)
    if (.not. any(abs(at%e) > 0.0_wp)) return
    call self%principal_function(at%e, q)
    value = q%value
    do i = 1, 3*self%count
      normal = normal + q%first(i)*at%own(:, i)
    end do
  end subroutine gradient

  !> Evaluate the equivalent stress and both derivatives.
  pure subroutine second_derivative(self, stress, direction)
    class(principal_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    type(flow_direction_t), intent(out) :: direction

    type(spectrum_t) :: at
    type(function_t) :: q
    real(wp) :: w(6)
    integer :: i, j

    direction%stress = stress
    direction%equivalent = 0.0_wp
    direction%gradient = 0.0_wp
    direction%second = 0.0_wp
    call decompose(self, stress, at)
    if (.not. any(abs(at%e) > 0.0_wp)) return
    call self%principal_function(at%e, q)
    direction%equivalent = q%value
    do j = 1, 3*self%count
      direction%gradient = direction%gradient + q%first(j)*at%own(:, j)
      w = 0.0_wp
      do i = 1, 3*self%count
        w = w + q%second(i, j)*at%own(:, i)
      end do
      call add_product(w, at%own(:, j), direction%second)
    end do
    do j = 1, 3*self%count
      call add_product(2*quotient(at%e, q, j)*at%mixed(:, j), at%mixed(:, j), direction%second)
    end do
    direction%second = 0.5_wp*(direction%second + transpose(direction%second))
  end subroutine second_derivative

  !> Decompose the transformed stresses; the principal values are zero at zero deviator.
  pure subroutine decompose(self, stress, at)
    class(principal_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    type(spectrum_t), intent(out) :: at

    real(wp) :: s(6), v(3, 3)
    integer :: n, i, m

    at%e = 0.0_wp
    s = deviator_of(stress)
    if (.not. any(abs(s) > 0.0_wp)) return
    do n = 1, self%count
      call symmetric_eigen(tensor_from_kelvin(transform(self%transformation(n), s)), &
          at%e(3*n - 2:3*n), v)
      do i = 1, 3
        m = 3*n - 3 + i
        at%own(:, m) = pull_back(self%transformation(n), square_of(v(:, i)))
        at%mixed(:, m) = pull_back(self%transformation(n), product_of(v(:, one(i)), v(:, other(i))))
      end do
    end do
  end subroutine decompose

  !> Return the Kelvin vector of v x v.
  pure function square_of(v) result(n)
    real(wp), intent(in) :: v(3)
    real(wp) :: n(6)

    n(1:3) = v*v
    n(4) = sqrt2*v(2)*v(3)
    n(5) = sqrt2*v(3)*v(1)
    n(6) = sqrt2*v(1)*v(2)
  end function square_of

  !> Return the Kelvin vector of sym(v x w).
  pure function product_of(v, w) result(n)
    real(wp), intent(in) :: v(3), w(3)
    real(wp) :: n(6)

    n(1:3) = v*w
    n(4) = inverse_sqrt2*(v(2)*w(3) + v(3)*w(2))
    n(5) = inverse_sqrt2*(v(3)*w(1) + v(1)*w(3))
    n(6) = inverse_sqrt2*(v(1)*w(2) + v(2)*w(1))
  end function product_of

  !> Return t_ij of a pair.
  pure real(wp) function quotient(e, q, pair)
    real(wp), intent(in) :: e(6)
    type(function_t), intent(in) :: q
    !> Number of the pair: that of the value not in it.
    integer, intent(in) :: pair

    integer :: start, i, j

    start = 3*((pair - 1)/3)
    i = start + one(pair - start)
    j = start + other(pair - start)
    if (abs(e(i) - e(j)) > closeness*maxval(abs(e))) then
      quotient = (q%first(i) - q%first(j))/(e(i) - e(j))
    else
      quotient = 0.5_wp*(q%second(i, i) + q%second(j, j)) - q%second(i, j)
    end if
  end function quotient

  !> Add a b^T to a matrix.
  pure subroutine add_product(a, b, matrix)
    real(wp), intent(in) :: a(6), b(6)
    real(wp), intent(inout) :: matrix(6, 6)

    integer :: j

    do j = 1, 6
      matrix(:, j) = matrix(:, j) + b(j)*a
    end do
  end subroutine add_product

end module dd3_material_yield_principal
