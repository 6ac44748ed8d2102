! SPDX-License-Identifier: GPL-3.0-or-later
!> Cost of a complete factorisation of a matrix with a symmetric pattern for an ordering of its
!> rows, without the pattern of the factors: the rows of L are the paths in the elimination tree
!> from the entries of a row to it (Liu, SIAM J. Matrix Anal. Appl. 11, 1990).
module dd3_linalg_ordering_cost
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: factor_cost

contains

  !> Find the number of block products of a complete factorisation, and the number of blocks of its
  !> factors. Beyond a given number of blocks the cost is huge.
  pure subroutine factor_cost(matrix, order, most, cost, n_block)
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row.
    integer, intent(in) :: order(:)
    !> Number of blocks at which the count ends.
    integer, intent(in) :: most
    real(wp), intent(out) :: cost
    integer, intent(out) :: n_block

    integer :: parent(matrix%n), mark(matrix%n), below(matrix%n), new_number(matrix%n)
    integer :: i, k, at

    new_number(order) = [(i, i=1, matrix%n)]
    parent = 0
    mark = 0
    below = 0
    n_block = matrix%n
    cost = huge(1.0_wp)
    do i = 1, matrix%n
      mark(i) = i
      do at = matrix%row_start(order(i)), matrix%row_start(order(i) + 1) - 1
        k = new_number(matrix%column(at))
        if (k >= i) cycle
        ! Entry (i, k) of L, and those on the path from k to i in the tree.
        do while (mark(k) /= i)
          if (parent(k) == 0) parent(k) = i
          below(k) = below(k) + 1
          mark(k) = i
          n_block = n_block + 2
          k = parent(k)
        end do
      end do
      if (n_block > most) return
    end do
    cost = sum(real(below, wp)*real(below + 1, wp))
  end subroutine factor_cost

end module dd3_linalg_ordering_cost
