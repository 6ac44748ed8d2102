! SPDX-License-Identifier: GPL-3.0-or-later
!> Orderings of the block rows for the incomplete factorisation: none, approximate minimum degree
!> (Amestoy, Davis and Duff 1996; SuiteSparse), reverse Cuthill-McKee (Cuthill and McKee 1969; start
!> node after George and Liu 1979), or the one of these that suits the matrix.
module dd3_linalg_ordering
  use, intrinsic :: iso_c_binding, only : c_int, c_ptr, c_null_ptr
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : join
  use dd3_linalg_fill_pattern, only : fill_limit
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_ordering_cost, only : factor_cost
  implicit none
  private
  public :: find_ordering, ordering_names

  !> Names of the orderings, as written in the input.
  character(len=4), parameter :: ordering_names(4) = [character(len=4) :: "auto", "none", "amd", &
      "rcm"]
  !> The given numbering is kept unless another one costs less than this fraction.
  real(wp), parameter :: worth_while = 0.8_wp
  !> Most blocks of the factors in the comparison of band-like numberings, in blocks of the matrix.
  integer, parameter :: most_fill = 100
  !> Rows with more than this many times the average number of blocks, such as those of pressed
  !> tools, are numbered last by reverse Cuthill-McKee.
  integer, parameter :: dense_factor = 3

  interface
    !> Approximate minimum degree ordering of SuiteSparse; all indices are 0-based.
    integer(c_int) function amd_order(n, start, row, permutation, control, info) &
        bind(c, name="amd_order")
      import :: c_int, c_ptr
      integer(c_int), value :: n
      !> Where the columns begin, and their rows.
      integer(c_int), intent(in) :: start(*), row(*)
      !> Original number of each row.
      integer(c_int), intent(out) :: permutation(*)
      !> Control parameters, null for the defaults, and statistics, null for none.
      type(c_ptr), value :: control, info
    end function amd_order
  end interface

contains

  !> Find an ordering of the block rows.
  subroutine find_ordering(name, matrix, order, error)
    !> One of `ordering_names`.
    character(len=*), intent(in) :: name
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row.
    integer, allocatable, intent(out) :: order(:)
    !> Set for an unknown name or if AMD fails.
    type(error_t), allocatable, intent(out) :: error

    integer :: i

    select case (name)
    case ("auto")
      call best_ordering(matrix, order, error)
    case ("none")
      order = [(i, i=1, matrix%n)]
    case ("amd")
      call minimum_degree(matrix, order, error)
    case ("rcm")
      call reverse_cuthill_mckee(matrix, order)
    case default
      call fatal_error(error, "unknown ordering "//trim(name)//"; known: " &
          //join(ordering_names, ", "))
    end select
  end subroutine find_ordering

  !> Find the ordering with the least cost. If none of them allows a complete factorisation, an
  !> incomplete one is likely, for which minimum degree is not suitable.
  subroutine best_ordering(matrix, order, error)
    type(block_matrix_t), intent(in) :: matrix
    integer, allocatable, intent(out) :: order(:)
    type(error_t), allocatable, intent(out) :: error

    integer, allocatable :: other(:)
    real(wp) :: least, cost
    integer :: i, most, n_block

    order = [(i, i=1, matrix%n)]
    most = most_fill*min(size(matrix%column), huge(1)/(2*most_fill))
    call factor_cost(matrix, order, most, least, n_block)
    call minimum_degree(matrix, other, error)
    if (allocated(error)) return
    call factor_cost(matrix, other, most, cost, n_block)
    if (n_block > fill_limit*size(matrix%column)) then
      call reverse_cuthill_mckee(matrix, other)
      call factor_cost(matrix, other, most, cost, n_block)
    end if
    if (cost < worth_while*least) order = other
  end subroutine best_ordering

  !> Find the approximate minimum degree ordering.
  subroutine minimum_degree(matrix, order, error)
    type(block_matrix_t), intent(in) :: matrix
    integer, allocatable, intent(out) :: order(:)
    type(error_t), allocatable, intent(out) :: error

    integer(c_int), allocatable :: permutation(:)
    integer(c_int) :: status

    allocate (permutation(matrix%n))
    status = amd_order(int(matrix%n, c_int), int(matrix%row_start - 1, c_int), &
        int(matrix%column - 1, c_int), permutation, c_null_ptr, c_null_ptr)
    if (status < 0) then
      call fatal_error(error, "AMD could not order the matrix")
      return
    end if
    order = int(permutation) + 1
  end subroutine minimum_degree

  !> Find the reverse Cuthill-McKee ordering; each connected component starts from a peripheral
  !> node, and dense rows come last.
  subroutine reverse_cuthill_mckee(matrix, order)
    !> Matrix with a symmetric or nearly symmetric pattern.
    type(block_matrix_t), intent(in) :: matrix
    integer, allocatable, intent(out) :: order(:)

    logical, allocatable :: numbered(:)
    integer, allocatable :: degree(:)
    integer :: i, n, first, last, start

    n = matrix%n
    degree = matrix%row_start(2:) - matrix%row_start(:n)
    numbered = degree > dense_factor*(size(matrix%column)/n + 1)
    allocate (order(n))
    last = count(.not. numbered)
    order(last + 1:) = pack([(i, i=1, n)], numbered)
    first = 1
    do i = 1, n
      if (numbered(i)) cycle
      start = peripheral_node(matrix, degree, numbered, i)
      call breadth_first(matrix, degree, numbered, start, order(first:last), first)
    end do
    order(:last) = order(last:1:-1)
  end subroutine reverse_cuthill_mckee

  !> Return a pseudo-peripheral node of the connected component of a given node: the last node of a
  !> breadth-first search, repeated while its depth grows.
  integer function peripheral_node(matrix, degree, numbered, given) result(node)
    type(block_matrix_t), intent(in) :: matrix
    !> Number of blocks in each row.
    integer, intent(in) :: degree(:)
    !> Whether each row is numbered already.
    logical, intent(in) :: numbered(:)
    integer, intent(in) :: given

    logical, allocatable :: seen(:)
    integer, allocatable :: queue(:)
    integer :: next, depth, deepest, round

    allocate (queue(matrix%n))
    node = given
    deepest = -1
    do round = 1, 8
      seen = numbered
      next = 1
      call breadth_first(matrix, degree, seen, node, queue, next, depth)
      if (depth <= deepest) exit
      deepest = depth
      node = queue(next - 1)
    end do
  end function peripheral_node

  !> Number a connected component by breadth-first search, neighbours in order of their degree.
  subroutine breadth_first(matrix, degree, numbered, start, queue, next, depth)
    type(block_matrix_t), intent(in) :: matrix
    !> Number of blocks in each row.
    integer, intent(in) :: degree(:)
    !> Whether each row is numbered already.
    logical, intent(inout) :: numbered(:)
    !> First node.
    integer, intent(in) :: start
    !> Nodes of the component in the order found.
    integer, intent(inout) :: queue(:)
    !> Next free number; advanced by the number of nodes found.
    integer, intent(inout) :: next
    !> Number of levels.
    integer, intent(out), optional :: depth

    integer :: k, j, read_at, write_at, level_end, at, levels

    queue(1) = start
    numbered(start) = .true.
    write_at = 1
    read_at = 1
    level_end = 1
    levels = 0
    do while (read_at <= write_at)
      k = write_at
      do at = matrix%row_start(queue(read_at)), matrix%row_start(queue(read_at) + 1) - 1
        j = matrix%column(at)
        if (numbered(j)) cycle
        numbered(j) = .true.
        write_at = write_at + 1
        queue(write_at) = j
      end do
      call sort_by_degree(degree, queue(k + 1:write_at))
      if (read_at == level_end) then
        levels = levels + 1
        level_end = write_at
      end if
      read_at = read_at + 1
    end do
    next = next + write_at
    if (present(depth)) depth = levels
  end subroutine breadth_first

  !> Sort rows in ascending order of their degree (insertion sort).
  pure subroutine sort_by_degree(degree, rows)
    integer, intent(in) :: degree(:)
    integer, intent(inout) :: rows(:)

    integer :: i, j, moved

    do i = 2, size(rows)
      moved = rows(i)
      j = i - 1
      do while (j >= 1)
        if (degree(rows(j)) <= degree(moved)) exit
        rows(j + 1) = rows(j)
        j = j - 1
      end do
      rows(j + 1) = moved
    end do
  end subroutine sort_by_degree

end module dd3_linalg_ordering
