! SPDX-License-Identifier: GPL-3.0-or-later
!> Kernels of the numeric ILU factorisation, one block row at a time; see `ilu_t` for the arrays.
module dd3_linalg_ilu_factor
  use dd3_base_kinds, only : wp
  use dd3_linalg_elimination, only : subtract
  use dd3_linalg_tensor, only : inverse
  implicit none
  private
  public :: load_row, eliminate_row, finish_row

  !> Largest size of a multiplier or of a diagonal block; beyond it the factors are useless.
  real(wp), parameter :: growth_limit = 1.0e30_wp
  !> Reciprocal of the largest inverse of a diagonal block that is not shifted (the rows of the
  !> matrix add up to one).
  real(wp), parameter :: pivot_limit = 1.0e-12_wp
  !> First shift of a diagonal block.
  real(wp), parameter :: pivot_shift = 1.0e-3_wp

contains

  !> Kernel: copy a block row of the matrix into the pattern of the factors, as scalar rows.
  pure subroutine load_row(first, last, n_block, target, value, row)
    !> First and last block of the row in the factors, and number of blocks in the matrix.
    integer, intent(in) :: first, last, n_block
    !> Position of each block in the factors.
    integer, intent(in) :: target(n_block)
    real(wp), intent(in) :: value(3, 3, n_block)
    real(wp), intent(out) :: row(3*(last - first + 1), 3)

    integer :: k, c

    row = 0.0_wp
    do k = 1, n_block
      c = 3*(target(k) - first)
      row(c + 1:c + 3, 1) = value(1, :, k)
      row(c + 1:c + 3, 2) = value(2, :, k)
      row(c + 1:c + 3, 3) = value(3, :, k)
    end do
  end subroutine load_row

  !> Kernel: subtract multiples of all earlier rows from row i and store the multipliers as blocks
  !> of L.
  pure subroutine eliminate_row(n, i, row_start, column, diagonal, n_stretch, stretch_start, &
      stretch, row, block, good)
    integer, intent(in) :: n, i, row_start(n + 1), column(*), diagonal(n)
    integer, intent(in) :: n_stretch, stretch_start(*), stretch(3, n_stretch)
    real(wp), intent(inout) :: row(*), block(3, 3, *)
    !> Whether the multipliers stay below `growth_limit`.
    logical, intent(out) :: good

    real(wp) :: l(3, 3), w(3, 3), size_of_row(3)
    integer :: position, k, s, at_i, at_k, width_i, width_k, c, from, to

    good = .true.
    at_i = 9*(row_start(i) - 1)
    width_i = 3*(row_start(i + 1) - row_start(i))
    do position = row_start(i), diagonal(i) - 1
      k = column(position)
      c = at_i + 3*(position - row_start(i))
      w(1, :) = row(c + 1:c + 3)
      w(2, :) = row(c + width_i + 1:c + width_i + 3)
      w(3, :) = row(c + 2*width_i + 1:c + 2*width_i + 3)
      l = product_of(w, block(:, :, diagonal(k)))
      block(:, :, position) = l
      w = abs(l)
      size_of_row = w(:, 1) + w(:, 2) + w(:, 3)
      if (.not. size_of_row(1) + size_of_row(2) + size_of_row(3) <= growth_limit) then
        good = .false.
        return
      end if
      at_k = 9*(row_start(k) - 1)
      width_k = 3*(row_start(k + 1) - row_start(k))
      do s = stretch_start(position), stretch_start(position + 1) - 1
        from = at_k + 3*stretch(1, s) + 1
        to = at_i + 3*stretch(2, s) + 1
        call subtract(3*stretch(3, s), l, row(from), row(from + width_k), row(from + 2*width_k), &
            row(to), row(to + width_i), row(to + 2*width_i))
      end do
    end do
  end subroutine eliminate_row

  !> Return the product of two 3x3 matrices.
  pure function product_of(a, b) result(c)
    real(wp), intent(in) :: a(3, 3), b(3, 3)
    real(wp) :: c(3, 3)

    integer :: j

    do j = 1, 3
      c(:, j) = a(:, 1)*b(1, j) + a(:, 2)*b(2, j) + a(:, 3)*b(3, j)
    end do
  end function product_of

  !> Kernel: copy the scalar rows of a finished block row into blocks and invert the diagonal one.
  pure subroutine finish_row(n_block, diagonal, row, block, shifted, good)
    !> Number of blocks in the row, and which of them is the diagonal.
    integer, intent(in) :: n_block, diagonal
    real(wp), intent(in) :: row(3*n_block, 3)
    !> Blocks of the row; those of L are not changed.
    real(wp), intent(inout) :: block(3, 3, n_block)
    !> Number of diagonal blocks shifted so far.
    integer, intent(inout) :: shifted
    !> Whether the diagonal block could be inverted.
    logical, intent(out) :: good

    integer :: k, c

    do k = diagonal, n_block
      c = 3*(k - 1)
      block(1, :, k) = row(c + 1:c + 3, 1)
      block(2, :, k) = row(c + 1:c + 3, 2)
      block(3, :, k) = row(c + 1:c + 3, 3)
    end do
    call invert_diagonal(block(:, :, diagonal), shifted, good)
  end subroutine finish_row

  !> Invert a diagonal block in place; a nearly singular one is shifted until it is regular.
  pure subroutine invert_diagonal(d, shifted, good)
    real(wp), intent(inout) :: d(3, 3)
    !> Number of diagonal blocks shifted so far.
    integer, intent(inout) :: shifted
    !> Whether there is an inverse.
    logical, intent(out) :: good

    real(wp) :: inverted(3, 3), shift
    integer :: attempt, i

    good = .false.
    if (.not. sum(abs(d)) <= growth_limit) return
    shift = pivot_shift
    do attempt = 0, 5
      call inverse(d, inverted, good)
      if (good) good = sum(abs(inverted)) <= 1.0_wp/pivot_limit
      if (good) exit
      if (attempt == 0) shifted = shifted + 1
      do i = 1, 3
        d(i, i) = d(i, i) + sign(shift, d(i, i))
      end do
      shift = 10*shift
    end do
    d = inverted
  end subroutine invert_diagonal

end module dd3_linalg_ilu_factor
