! SPDX-License-Identifier: GPL-3.0-or-later
!> Bernstein polynomials, by the triangular recurrence
!> B_i^k = (1-t) B_i^(k-1) + t B_(i-1)^(k-1), which adds only positive numbers for t from 0 to 1 and
!> is stable for any degree. Derivatives are differences of the polynomials of the next lower
!> degrees.
!> Source: Farin, Curves and Surfaces for CAGD, 5th ed. (2002), chapter 5; Piegl and Tiller, The
!> NURBS Book, 2nd ed. (1997), algorithm A1.3.
module dd3_tools_bernstein
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: bernstein, bernstein_values, largest_degree

  !> Largest degree of a patch in u or v.
  integer, parameter :: largest_degree = 25

contains

  !> Evaluate the Bernstein polynomials of a degree and their first two derivatives.
  pure subroutine bernstein(degree, t, b)
    !> At least 1.
    integer, intent(in) :: degree
    real(wp), intent(in) :: t
    !> Values, first and second derivatives in `b(0:degree, 0:2)`.
    real(wp), intent(out) :: b(0:largest_degree, 0:2)

    real(wp) :: s, factor
    integer :: k, i

    s = 1.0_wp - t
    if (degree == 1) then
      b(0, :) = [s, -1.0_wp, 0.0_wp]
      b(1, :) = [t, 1.0_wp, 0.0_wp]
      return
    end if
    b(0, 0) = 1.0_wp
    do k = 1, degree
      if (k == degree - 1) b(0:k - 1, 2) = b(0:k - 1, 0)
      if (k == degree) b(0:k - 1, 1) = b(0:k - 1, 0)
      b(k, 0) = t*b(k - 1, 0)
      do i = k - 1, 1, -1
        b(i, 0) = s*b(i, 0) + t*b(i - 1, 0)
      end do
      b(0, 0) = s*b(0, 0)
    end do
    factor = real(degree, wp)
    b(degree, 1) = factor*b(degree - 1, 1)
    do i = degree - 1, 1, -1
      b(i, 1) = factor*(b(i - 1, 1) - b(i, 1))
    end do
    b(0, 1) = -factor*b(0, 1)
    factor = real(degree*(degree - 1), wp)
    b(degree - 1:degree, 2) = 0.0_wp
    do i = degree, 2, -1
      b(i, 2) = factor*(b(i, 2) - 2.0_wp*b(i - 1, 2) + b(i - 2, 2))
    end do
    b(1, 2) = factor*(b(1, 2) - 2.0_wp*b(0, 2))
    b(0, 2) = factor*b(0, 2)
  end subroutine bernstein

  !> Evaluate the Bernstein polynomials of a degree.
  pure subroutine bernstein_values(degree, t, b)
    !> At least 1.
    integer, intent(in) :: degree
    real(wp), intent(in) :: t
    !> `b(0:degree)`.
    real(wp), intent(out) :: b(0:largest_degree)

    integer :: k, i

    b(0) = 1.0_wp
    do k = 1, degree
      b(k) = t*b(k - 1)
      do i = k - 1, 1, -1
        b(i) = (1.0_wp - t)*b(i) + t*b(i - 1)
      end do
      b(0) = (1.0_wp - t)*b(0)
    end do
  end subroutine bernstein_values

end module dd3_tools_bernstein
