! SPDX-License-Identifier: GPL-3.0-or-later
!> Triangular solves with block factors.
module dd3_linalg_triangular_solve
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: solve_triangles

contains

  !> Kernel: solve L U z = r; L has unit diagonal, the diagonal blocks of U are inverted. See
  !> `ilu_t` and `fill_pattern_t` for the arrays.
  pure subroutine solve_triangles(n, n_block, row_start, column, diagonal, block, r, z)
    integer, intent(in) :: n, n_block, row_start(n + 1), column(n_block), diagonal(n)
    real(wp), intent(in) :: block(3, 3, n_block), r(3, n)
    real(wp), intent(out) :: z(3, n)

    real(wp) :: a(3), b(3), c(3)
    integer :: i, j, k

    do i = 1, n
      a = r(:, i)
      b = 0.0_wp
      c = 0.0_wp
      do k = row_start(i), diagonal(i) - 1
        j = column(k)
        a = a - block(:, 1, k)*z(1, j)
        b = b - block(:, 2, k)*z(2, j)
        c = c - block(:, 3, k)*z(3, j)
      end do
      z(:, i) = a + b + c
    end do
    do i = n, 1, -1
      a = z(:, i)
      b = 0.0_wp
      c = 0.0_wp
      do k = diagonal(i) + 1, row_start(i + 1) - 1
        j = column(k)
        a = a - block(:, 1, k)*z(1, j)
        b = b - block(:, 2, k)*z(2, j)
        c = c - block(:, 3, k)*z(3, j)
      end do
      a = a + b + c
      k = diagonal(i)
      z(:, i) = block(:, 1, k)*a(1) + block(:, 2, k)*a(2) + block(:, 3, k)*a(3)
    end do
  end subroutine solve_triangles

end module dd3_linalg_triangular_solve
