! SPDX-License-Identifier: GPL-3.0-or-later
!> Gauss-Legendre quadrature on -1 ... 1. Abscissae are the zeros of the Legendre polynomial, found
!> by Newton's method (Abramowitz & Stegun 1964, 25.4.29).
module dd3_element_gauss
  use dd3_base_kinds, only : pi, wp
  implicit none
  private
  public :: gauss_legendre

contains

  !> Evaluate abscissae, ascending, and weights of the rule with n points.
  pure subroutine gauss_legendre(n, abscissa, weight)
    integer, intent(in) :: n
    real(wp), intent(out) :: abscissa(n), weight(n)

    integer, parameter :: iterations = 8
    real(wp) :: z, value, slope
    integer :: i, k

    do i = 1, n
      z = 0.0_wp
      if (2*i /= n + 1) then
        z = -cos(pi*(real(i, wp) - 0.25_wp)/(real(n, wp) + 0.5_wp))
        do k = 1, iterations
          call legendre(n, z, value, slope)
          z = z - value/slope
        end do
      end if
      call legendre(n, z, value, slope)
      abscissa(i) = z
      weight(i) = 2.0_wp/((1.0_wp - z*z)*slope*slope)
    end do
  end subroutine gauss_legendre

  !> Evaluate the Legendre polynomial of degree n and its derivative, |z| < 1.
  pure subroutine legendre(n, z, value, slope)
    integer, intent(in) :: n
    real(wp), intent(in) :: z
    real(wp), intent(out) :: value, slope

    real(wp) :: before, next
    integer :: k

    before = 0.0_wp
    value = 1.0_wp
    do k = 1, n
      next = (real(2*k - 1, wp)*z*value - real(k - 1, wp)*before)/real(k, wp)
      before = value
      value = next
    end do
    slope = real(n, wp)*(before - z*value)/(1.0_wp - z*z)
  end subroutine legendre

end module dd3_element_gauss
