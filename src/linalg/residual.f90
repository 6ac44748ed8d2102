! SPDX-License-Identifier: GPL-3.0-or-later
!> Dot product and residual of a linear system, and the residual that round-off allows.
module dd3_linalg_residual
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t, multiply
  implicit none
  private
  public :: round_off_residual, dot, true_residual

  !> Largest round-off of the product of matrix and solution, over the right-hand side, that is
  !> taken for that of a slender sheet and not of a singular matrix.
  real(wp), parameter :: largest_round_off = 1.0e-3_wp

contains

  !> Evaluate the residual r = b - A x and its length.
  subroutine true_residual(matrix, b, x, r, length)
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:), x(:)
    real(wp), intent(out) :: r(:), length

    call multiply(matrix, x, r)
    r = b - r
    length = sqrt(dot(r, r))
  end subroutine true_residual

  !> Return the round-off of the product of matrix and solution, over the right-hand side: no solver
  !> can bring the relative residual below it for certain. Where the sheet is slender and hardly
  !> supported the solution is large, and this is far above the tolerance. It is zero where the
  !> matrix counts as singular.
  real(wp) function round_off_residual(matrix, b, x) result(round_off)
    type(block_matrix_t), intent(in) :: matrix
    !> Right-hand side and solution, `(3n)`.
    real(wp), intent(in) :: b(:), x(:)

    round_off = epsilon(1.0_wp)*maxval(abs(matrix%value)) &
        *sqrt(dot(x, x))/max(sqrt(dot(b, b)), tiny(1.0_wp))
    if (.not. round_off <= largest_round_off) round_off = 0.0_wp
  end function round_off_residual

  !> Return the dot product of two vectors of one size, as four partial sums in a fixed order.
  pure real(wp) function dot(a, b)
    real(wp), intent(in) :: a(:), b(:)

    real(wp) :: s(4)
    integer :: i, n_grouped

    s = 0.0_wp
    n_grouped = size(a) - modulo(size(a), 4)
    do i = 1, n_grouped, 4
      s = s + a(i:i + 3)*b(i:i + 3)
    end do
    dot = (s(1) + s(2)) + (s(3) + s(4))
    do i = n_grouped + 1, size(a)
      dot = dot + a(i)*b(i)
    end do
  end function dot

end module dd3_linalg_residual
