! SPDX-License-Identifier: GPL-3.0-or-later
!> Criteria of plane stress, extended to all components of the stress. Those of Barlat and of
!> Banabic are sums over pairs of norms U and V of the stress,
!>
!>     sb^m = sum of w (|U+V|^m + |U-V|^m)
!>     U^2 = (a1 T11 + a2 T22)^2 + b12 T12^2, V likewise
!>
!> Extension (M. Dunand, A. P. Maertens, M. Luo, D. Mohr, Int. J. Plasticity 36 (2012) 34-49, for
!> Yld2000-2d): T11-T33 and T22-T33 take the place of T11 and T22, which makes the criterion
!> independent of pressure, and b23 T23^2 + b31 T31^2 is added to the squares. The function is even
!> in U and in V, convex, and increases with both: sb is convex.
module dd3_material_yield_planar
  use dd3_base_kinds, only : wp
  use dd3_material_flow, only : flow_direction_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  use dd3_material_yield_power, only : exponent_t, function_t, powers, root_of
  implicit none
  private
  public :: planar_criterion_t, norm_t, pair_t

  !> A norm U of the stress.
  type :: norm_t
    !> a1, a2.
    real(wp) :: normal(2) = 0.0_wp
    !> b23, b31, b12, of the squares of the tensor components.
    real(wp) :: shear(3) = 0.0_wp
  end type norm_t

  !> One term of the sum.
  type :: pair_t
    real(wp) :: weight = 1.0_wp
    type(norm_t) :: u, v
  end type pair_t

  !> A criterion of plane stress with its extension.
  type, abstract, extends(yield_criterion_t) :: planar_criterion_t
    type(pair_t), allocatable :: pairs(:)
    !> m.
    type(exponent_t) :: exponent
  contains
    procedure :: value
    procedure :: second_derivative
  end type planar_criterion_t

  !> Value of a norm and its derivatives in z: U, dU/dz, and half the second derivative of U^2.
  type :: norm_value_t
    real(wp) :: value, first(5), square(5, 5)
  end type norm_value_t

  !> Value of a norm, relative to the largest, below which quotients are replaced by their limits.
  real(wp), parameter :: closeness = 1.0e-6_wp

contains

  !> Return z = (T11-T33, T22-T33, T23, T31, T12), shears as Kelvin components.
  pure function reduced(stress) result(z)
    real(wp), intent(in) :: stress(6)
    real(wp) :: z(5)

    z = [stress(1) - stress(3), stress(2) - stress(3), stress(4), stress(5), stress(6)]
  end function reduced

  !> Return a norm of z.
  pure real(wp) function norm_of(norm, z)
    type(norm_t), intent(in) :: norm
    real(wp), intent(in) :: z(5)

    norm_of = sqrt((norm%normal(1)*z(1) + norm%normal(2)*z(2))**2 &
        + 0.5_wp*(norm%shear(1)*z(3)**2 + norm%shear(2)*z(4)**2 + norm%shear(3)*z(5)**2))
  end function norm_of

  !> Return the equivalent stress.
  pure real(wp) function value(self, stress)
    class(planar_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)

    real(wp) :: z(5), x(2*size(self%pairs)), scale, weight
    real(wp), dimension(2*size(self%pairs)) :: power, d, dd
    integer :: n

    z = reduced(stress)
    do n = 1, size(self%pairs)
      x(2*n - 1) = norm_of(self%pairs(n)%u, z)
      x(2*n) = norm_of(self%pairs(n)%v, z)
      x(2*n - 1:2*n) = [x(2*n - 1) + x(2*n), x(2*n - 1) - x(2*n)]
    end do
    scale = maxval(x)
    value = 0.0_wp
    if (.not. scale > 0.0_wp) return
    call powers(size(x), self%exponent, x/scale, power, d, dd)
    do n = 1, size(self%pairs)
      weight = self%pairs(n)%weight
      value = value + weight*(power(2*n - 1) + power(2*n))
    end do
    value = scale*value**(1/self%exponent%value)
  end function value

  !> Evaluate the equivalent stress and both derivatives.
  pure subroutine second_derivative(self, stress, direction)
    class(planar_criterion_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    type(flow_direction_t), intent(out) :: direction

    type(norm_value_t) :: u(size(self%pairs)), v(size(self%pairs))
    type(function_t) :: f, q
    real(wp) :: z(5), scale
    integer :: n

    direction = flow_direction_t(stress, 0.0_wp, 0.0_wp, 0.0_wp)
    z = reduced(stress)
    scale = maxval(abs(z))
    if (.not. scale > 0.0_wp) return
    z = z/scale
    do n = 1, size(self%pairs)
      call differentiate(self%pairs(n)%u, z, u(n))
      call differentiate(self%pairs(n)%v, z, v(n))
    end do
    f = function_t(0.0_wp, 0.0_wp, 0.0_wp)
    associate (largest => maxval(u%value + v%value))
      if (.not. largest > 0.0_wp) return
      do n = 1, size(self%pairs)
        call add_pair(self%exponent, self%pairs(n)%weight, u(n), v(n), largest, f)
      end do
      call root_of(5, self%exponent%value, scale*largest, 1.0_wp, f, q)
    end associate
    direction%equivalent = q%value
    direction%gradient = expand(q%first(1:5))
    call expand_matrix(q%second(1:5, 1:5), direction%second)
  end subroutine second_derivative

  !> Evaluate a norm with its derivatives; the first one is zero if the norm is.
  pure subroutine differentiate(norm, z, at)
    type(norm_t), intent(in) :: norm
    real(wp), intent(in) :: z(5)
    type(norm_value_t), intent(out) :: at

    integer :: k

    at%value = norm_of(norm, z)
    at%square = 0.0_wp
    at%square(1:2, 1) = norm%normal(1)*norm%normal
    at%square(1:2, 2) = norm%normal(2)*norm%normal
    do k = 1, 3
      at%square(2 + k, 2 + k) = 0.5_wp*norm%shear(k)
    end do
    at%first = 0.0_wp
    if (.not. at%value > 0.0_wp) return
    at%first(1:2) = (norm%normal(1)*z(1) + norm%normal(2)*z(2))/at%value*norm%normal
    at%first(3:5) = 0.5_wp*norm%shear*z(3:5)/at%value
  end subroutine differentiate

  !> Add w (|U+V|^m + |U-V|^m), of norms divided by a scale, with derivatives in z/scale:
  !>
  !>     f_U U_i + f_V V_i,   f_UU U_i U_j + f_UV (U_i V_j + V_i U_j) + f_VV V_i V_j
  !>                          + (f_U/U) (P_ij - U_i U_j) + (f_V/V) (Q_ij - V_i V_j)
  !>
  !> with half the second derivatives P and Q of U^2 and V^2. f_U/U tends to f_UU for U -> 0.
  pure subroutine add_pair(exponent, weight, u, v, scale, f)
    !> m.
    type(exponent_t), intent(in) :: exponent
    real(wp), intent(in) :: weight
    type(norm_value_t), intent(in) :: u, v
    !> At least U + V, positive.
    real(wp), intent(in) :: scale
    type(function_t), intent(inout) :: f

    real(wp), dimension(2) :: power, d, dd
    real(wp) :: f_u, f_v, same, mixed, over_u, over_v
    integer :: j

    call powers(2, exponent, [u%value + v%value, u%value - v%value]/scale, power, d, dd)
    f_u = weight*(d(1) + d(2))
    f_v = weight*(d(1) - d(2))
    same = weight*(dd(1) + dd(2))
    mixed = weight*(dd(1) - dd(2))
    over_u = quotient(f_u, u%value/scale, same)
    over_v = quotient(f_v, v%value/scale, same)
    f%value = f%value + weight*(power(1) + power(2))
    f%first(1:5) = f%first(1:5) + f_u*u%first + f_v*v%first
    do j = 1, 5
      f%second(1:5, j) = f%second(1:5, j) &
          + ((same - over_u)*u%first(j) + mixed*v%first(j))*u%first &
          + ((same - over_v)*v%first(j) + mixed*u%first(j))*v%first &
          + over_u*u%square(:, j) + over_v*v%square(:, j)
    end do
  end subroutine add_pair

  !> Return f_U/U, and its limit for small U.
  pure real(wp) function quotient(first, norm, limit)
    real(wp), intent(in) :: first, norm, limit

    quotient = limit
    if (norm > closeness) quotient = first/norm
  end function quotient

  !> Return the gradient in the stress of one in z.
  pure function expand(g) result(normal)
    real(wp), intent(in) :: g(5)
    real(wp) :: normal(6)

    normal = [g(1), g(2), -(g(1) + g(2)), g(3), g(4), g(5)]
  end function expand

  !> Convert a second derivative in z to one in the stress.
  pure subroutine expand_matrix(second, matrix)
    real(wp), intent(in) :: second(5, 5)
    real(wp), intent(out) :: matrix(6, 6)

    real(wp) :: rows(6, 5)
    integer :: j

    do j = 1, 5
      rows(:, j) = expand(second(:, j))
    end do
    do j = 1, 6
      matrix(j, :) = expand(rows(j, :))
    end do
  end subroutine expand_matrix

end module dd3_material_yield_planar
