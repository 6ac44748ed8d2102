!> Sums of powers and their roots, as criteria of high exponents need them. All of them are
!> homogeneous of degree one, so that stresses are first divided by a scale that brings the largest
!> base to one: no exponent then overflows.
module dd3_material_yield_power
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: exponent_t, new_exponent, powers, take_root

  !> An exponent of at least two.
  type :: exponent_t
    !> Its value.
    real(wp) :: value = 2.0_wp
    !> Two less, where it is a whole number; negative where it is none.
    integer :: whole = 0
  end type exponent_t

  !> Whole exponents above it are treated as real ones.
  real(wp), parameter :: whole_limit = 64.0_wp

contains

  !> Makes an exponent.
  pure subroutine new_exponent(self, value)
    !> The exponent.
    type(exponent_t), intent(out) :: self
    !> Its value, at least two.
    real(wp), intent(in) :: value

    self%value = value
    self%whole = -1
    if (value > whole_limit) return
    if (abs(value - anint(value)) > epsilon(value)*value) return
    self%whole = nint(value) - 2
  end subroutine new_exponent

  !> |x|^m of several numbers not above one, with the first and the second derivatives.
  pure subroutine powers(n, exponent, x, power, first, second)
    !> How many.
    integer, intent(in) :: n
    !> m.
    type(exponent_t), intent(in) :: exponent
    !> The numbers.
    real(wp), intent(in) :: x(n)
    !> The powers, their first and second derivatives.
    real(wp), intent(out) :: power(n), first(n), second(n)
    real(wp) :: base, m
    integer :: i

    m = exponent%value
    do i = 1, n
      if (exponent%whole >= 0) then
        base = abs(x(i))**exponent%whole
      else
        base = abs(x(i))**(m - 2)
      end if
      power(i) = base*x(i)*x(i)
      first(i) = m*base*x(i)
      second(i) = m*(m - 1)*base
    end do
  end subroutine powers

  !> Root of degree m of a function f of the scaled variables x/scale that is homogeneous of degree
  !> m: q = scale (factor f)^(1/m), with its derivatives in x,
  !>
  !>     q_i = c f_i,   q_ij = [c f_ij - (m-1) q_i q_j / (q/scale)] / scale,   c = q / (scale m f)
  pure subroutine take_root(n, m, scale, factor, f, f_first, f_second, q, first, second)
    !> Number of variables.
    integer, intent(in) :: n
    !> The degree, the scale and the factor.
    real(wp), intent(in) :: m, scale, factor
    !> The function, positive, and its derivatives in the scaled variables.
    real(wp), intent(in) :: f, f_first(6), f_second(6, 6)
    !> The root and its derivatives.
    real(wp), intent(out) :: q, first(6), second(6, 6)
    real(wp) :: root, c, weight
    integer :: j

    root = (factor*f)**(1/m)
    c = root/(m*f)
    q = scale*root
    weight = (m - 1)/root
    first(1:n) = c*f_first(1:n)
    do j = 1, n
      second(1:n, j) = (c*f_second(1:n, j) - (weight*first(j))*first(1:n))/scale
    end do
  end subroutine take_root

end module dd3_material_yield_power
