! SPDX-License-Identifier: GPL-3.0-or-later
!> Innermost kernel of the incomplete factorisation, in a file of its own so that it is not inlined:
!> as dummy arguments its arrays cannot overlap, so the loop vectorises without run-time tests.
module dd3_linalg_elimination
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: subtract

contains

  !> Kernel: subtract l times three scalar rows u of U from the three scalar rows w.
  pure subroutine subtract(n, l, u1, u2, u3, w1, w2, w3)
    integer, intent(in) :: n
    real(wp), intent(in) :: l(3, 3), u1(n), u2(n), u3(n)
    real(wp), intent(inout) :: w1(n), w2(n), w3(n)

    integer :: c

    do c = 1, n
      w1(c) = w1(c) - (l(1, 1)*u1(c) + l(1, 2)*u2(c) + l(1, 3)*u3(c))
      w2(c) = w2(c) - (l(2, 1)*u1(c) + l(2, 2)*u2(c) + l(2, 3)*u3(c))
      w3(c) = w3(c) - (l(3, 1)*u1(c) + l(3, 2)*u2(c) + l(3, 3)*u3(c))
    end do
  end subroutine subtract

end module dd3_linalg_elimination
