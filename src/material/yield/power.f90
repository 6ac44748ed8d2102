! SPDX-License-Identifier: GPL-3.0-or-later
!> Sums of powers and their roots, for criteria of high exponents. All are homogeneous of degree
!> one: stresses are divided by a scale that brings the largest base to one to avoid overflow.
module dd3_material_yield_power
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : parameter_t, row, kind_real
  implicit none
  private
  public :: exponent_t, new_exponent, exponent_row, function_t, powers, root_of

  !> An exponent of at least two.
  type :: exponent_t
    !> m.
    real(wp) :: value = 2.0_wp
    !> m - 2 if m is an integer, otherwise negative.
    integer :: reduced = 0
  end type exponent_t

  !> Value of a function of up to six variables with its first and second derivatives.
  type :: function_t
    real(wp) :: value, first(6), second(6, 6)
  end type function_t

  !> Integer exponents above this are treated as real.
  real(wp), parameter :: integer_limit = 64.0_wp

contains

  !> Initialise an exponent with a value of at least two.
  pure subroutine new_exponent(self, value)
    type(exponent_t), intent(out) :: self
    real(wp), intent(in) :: value

    self%value = value
    self%reduced = -1
    if (value > integer_limit) return
    if (abs(value - anint(value)) > epsilon(value)*value) return
    self%reduced = nint(value) - 2
  end subroutine new_exponent

  !> Return the parameter m of criteria of a high exponent.
  type(parameter_t) function exponent_row()
    exponent_row = row("m", kind_real, "", "", &
        "exponent: 6 for body-centred, 8 for face-centred cubic metals", 2.0_wp, 100.0_wp)
  end function exponent_row

  !> Evaluate |x|^m with first and second derivatives.
  pure subroutine powers(n, exponent, x, power, first, second)
    integer, intent(in) :: n
    !> m.
    type(exponent_t), intent(in) :: exponent
    !> Numbers of magnitude one at most.
    real(wp), intent(in) :: x(n)
    real(wp), intent(out) :: power(n), first(n), second(n)

    real(wp) :: base, m
    integer :: i

    m = exponent%value
    do i = 1, n
      if (exponent%reduced >= 0) then
        base = abs(x(i))**exponent%reduced
      else
        base = abs(x(i))**(m - 2)
      end if
      power(i) = base*x(i)*x(i)
      first(i) = m*base*x(i)
      second(i) = m*(m - 1)*base
    end do
  end subroutine powers

  !> Evaluate the root of degree m of a function f of x/scale, homogeneous of degree m, and its
  !> derivatives in x: q = scale (factor f)^(1/m),
  !>
  !>     q_i = c f_i,   q_ij = [c f_ij - (m-1) q_i q_j / (q/scale)] / scale,   c = q / (scale m f)
  pure subroutine root_of(n, m, scale, factor, f, q)
    !> Number of variables.
    integer, intent(in) :: n
    real(wp), intent(in) :: m, scale, factor
    !> The function, positive, with derivatives in x/scale.
    type(function_t), intent(in) :: f
    !> The root; only derivatives in the first n variables are defined.
    type(function_t), intent(out) :: q

    real(wp) :: root, c, weight
    integer :: j

    root = (factor*f%value)**(1/m)
    c = root/(m*f%value)
    q%value = scale*root
    weight = (m - 1)/root
    q%first(1:n) = c*f%first(1:n)
    do j = 1, n
      q%second(1:n, j) = (c*f%second(1:n, j) - (weight*q%first(j))*q%first(1:n))/scale
    end do
  end subroutine root_of

end module dd3_material_yield_power
