! SPDX-License-Identifier: GPL-3.0-or-later
!> Partition of a matrix among the ranks: each holds some block rows. The rows of a rank are
!> connected, with few couplings to those of the others (multilevel k-way partitioning, Karypis and
!> Kumar, J. Parallel Distrib. Comput. 48, 1998; METIS 5).
module dd3_linalg_partition
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_integers, n_ranks, this_rank
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_metis, only : partition_graph
  implicit none
  private
  public :: divide_rows, holds_row, order_by_owner, own_rows, column_squares

contains

  !> Divide the block rows among the ranks.
  subroutine divide_rows(matrix, owner)
    !> Its values are not used.
    type(block_matrix_t), intent(in) :: matrix
    !> Rank of each block row, `(n)`.
    integer, intent(out) :: owner(:)

    integer, allocatable :: part(:)
    logical :: found
    integer :: i

    call partition_graph(matrix, n_ranks(), part, found)
    ! Without METIS: strips of the numbering, which follows the sheet.
    if (.not. found) part = [(int(real(i - 1)/real(matrix%n)*real(n_ranks())), i=1, matrix%n)]
    call broadcast_integers(0, size(part), part)
    owner = part
  end subroutine divide_rows

  !> Whether a block row is one of this rank.
  logical function holds_row(matrix, row)
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: row

    holds_row = .true.
    if (allocated(matrix%owner)) holds_row = matrix%owner(row) == this_rank()
  end function holds_row

  !> Return the sums of the squares in the first columns over the first rows, those of this rank.
  function column_squares(matrix, n) result(square)
    type(block_matrix_t), intent(in) :: matrix
    !> Number of block rows and columns.
    integer, intent(in) :: n
    !> `(3, n)`.
    real(wp), allocatable :: square(:, :)

    integer :: i, j, k

    allocate (square(3, n), source=0.0_wp)
    do i = 1, n
      if (.not. holds_row(matrix, i)) cycle
      do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
        j = matrix%column(k)
        if (j <= n) square(:, j) = square(:, j) + sum(matrix%value(:, :, k)**2, dim=1)
      end do
    end do
  end function column_squares

  !> Return the order in which the rows of each rank are consecutive.
  function order_by_owner(matrix) result(order)
    !> Distributed.
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row, `(n)`.
    integer, allocatable :: order(:)

    integer :: i, rank

    order = [integer ::]
    do rank = 0, maxval(matrix%owner)
      order = [order, pack([(i, i=1, matrix%n)], matrix%owner == rank)]
    end do
  end function order_by_owner

  !> Find the block rows that this rank holds, in a matrix ordered by owner.
  subroutine own_rows(matrix, first, last)
    type(block_matrix_t), intent(in) :: matrix
    !> The first and the last; `last < first` if there are none.
    integer, intent(out) :: first, last

    first = 1
    last = matrix%n
    if (.not. allocated(matrix%owner)) return
    first = count(matrix%owner < this_rank()) + 1
    last = count(matrix%owner <= this_rank())
  end subroutine own_rows

end module dd3_linalg_partition
