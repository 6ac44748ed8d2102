! SPDX-License-Identifier: GPL-3.0-or-later
!> Orderings and partitions of a matrix by METIS, where the program was built with it.
module dd3_linalg_metis
  use, intrinsic :: iso_c_binding, only : c_int, c_null_ptr
  use dd3_external_metis_library, only : metis_nodend, metis_partgraphkway, status_ok
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: nested_dissection, partition_graph

  !> Block rows from which METIS is tried.
  integer, parameter :: least_rows = 200

contains

  !> Find the ordering of a matrix with a symmetric pattern by nested dissection.
  subroutine nested_dissection(matrix, order, found)
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row.
    integer, allocatable, intent(out) :: order(:)
    !> False if the program has no METIS, or METIS fails; not tried for a small matrix.
    logical, intent(out) :: found

    integer(c_int), allocatable :: start(:), neighbour(:), original(:), new_number(:)

    found = .false.
    if (matrix%n < least_rows) return
    call list_neighbours(matrix, start, neighbour)
    allocate (original(matrix%n), new_number(matrix%n))
    found = status_ok == metis_nodend(int(matrix%n, c_int), start, neighbour, c_null_ptr, &
        c_null_ptr, original, new_number)
    if (found) order = int(original) + 1
  end subroutine nested_dissection

  !> Divide the block rows of a matrix with a symmetric pattern into parts of nearly equal size.
  subroutine partition_graph(matrix, n_part, part, found)
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: n_part
    !> Part of each block row, from 0.
    integer, allocatable, intent(out) :: part(:)
    !> False if the program has no METIS, or METIS fails.
    logical, intent(out) :: found

    integer(c_int), allocatable :: start(:), neighbour(:), part_of(:)
    integer(c_int) :: cut

    call list_neighbours(matrix, start, neighbour)
    allocate (part_of(matrix%n))
    found = status_ok == metis_partgraphkway(int(matrix%n, c_int), 1_c_int, start, neighbour, &
        c_null_ptr, c_null_ptr, c_null_ptr, int(n_part, c_int), c_null_ptr, c_null_ptr, &
        c_null_ptr, cut, part_of)
    part = int(part_of)
  end subroutine partition_graph

  !> List the neighbours of each row.
  subroutine list_neighbours(matrix, start, neighbour)
    type(block_matrix_t), intent(in) :: matrix
    !> 0-based, see `metis_nodend`.
    integer(c_int), allocatable, intent(out) :: start(:), neighbour(:)

    integer :: i, k, n

    allocate (start(matrix%n + 1), neighbour(size(matrix%column)))
    n = 0
    do i = 1, matrix%n
      start(i) = int(n, c_int)
      do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
        if (matrix%column(k) == i) cycle
        n = n + 1
        neighbour(n) = int(matrix%column(k) - 1, c_int)
      end do
    end do
    start(matrix%n + 1) = int(n, c_int)
  end subroutine list_neighbours

end module dd3_linalg_metis
