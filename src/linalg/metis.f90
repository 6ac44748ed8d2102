! SPDX-License-Identifier: GPL-3.0-or-later
!> Ordering by nested dissection (Karypis and Kumar, SIAM J. Sci. Comput. 20, 1998; METIS 5), and
!> partition of the graph of a matrix. The library is part of the program where SuiteSparse's
!> CHOLMOD, which UMFPACK uses, was built with it: its procedures are looked up by name in the
!> running program.
module dd3_linalg_metis
  use, intrinsic :: iso_c_binding, only : c_int, c_ptr, c_funptr, c_null_ptr, c_associated, &
      c_f_procpointer
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_program_symbol, only : program_symbol
  implicit none
  private
  public :: nested_dissection, partition_graph

  !> METIS_NOPTIONS, and METIS_OK.
  integer, parameter :: n_options = 40
  integer(c_int), parameter :: status_ok = 1
  !> Smallest number of rows for which the search for a better ordering is worth while.
  integer, parameter :: least_rows = 200

  abstract interface
    !> METIS_SetDefaultOptions.
    integer(c_int) function defaults_interface(options) bind(c)
      import :: c_int
      integer(c_int), intent(inout) :: options(*)
    end function defaults_interface

    !> METIS_NodeND: number the nodes of a graph.
    integer(c_int) function order_interface(n, start, neighbour, weight, options, order, &
        new_number) bind(c)
      import :: c_int, c_ptr
      integer(c_int), intent(in) :: n
      !> Where the neighbours of each node begin, and the neighbours; both 0-based.
      integer(c_int), intent(in) :: start(*), neighbour(*)
      !> Weights of the nodes; null for none.
      type(c_ptr), value :: weight
      integer(c_int), intent(in) :: options(*)
      !> Original number of each row, and new number of each node.
      integer(c_int), intent(out) :: order(*), new_number(*)
    end function order_interface

    !> METIS_PartGraphKway: divide a graph into parts of nearly equal weight.
    integer(c_int) function partition_interface(n, n_balance, start, neighbour, weight, size, &
        edge_weight, n_part, fraction, tolerance, options, cut, part) bind(c)
      import :: c_int, c_ptr
      !> Number of nodes, and of balancing constraints.
      integer(c_int), intent(in) :: n, n_balance
      !> See `order_interface`.
      integer(c_int), intent(in) :: start(*), neighbour(*)
      !> Weights, and fractions and tolerances of the parts; null for the defaults.
      type(c_ptr), value :: weight, size, edge_weight
      integer(c_int), intent(in) :: n_part
      type(c_ptr), value :: fraction, tolerance
      integer(c_int), intent(in) :: options(*)
      !> Number of edges between parts, and the part of each node, from 0.
      integer(c_int), intent(out) :: cut, part(*)
    end function partition_interface
  end interface

contains

  !> Find the ordering of a matrix with a symmetric pattern.
  subroutine nested_dissection(matrix, order, found)
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row.
    integer, allocatable, intent(out) :: order(:)
    !> False if the program has no METIS for integers of this size, or METIS fails.
    logical, intent(out) :: found

    procedure(order_interface), pointer :: find_order
    type(c_funptr) :: address
    integer(c_int), allocatable :: start(:), neighbour(:), original(:), new_number(:)
    integer(c_int) :: options(2*n_options)

    found = .false.
    if (matrix%n < least_rows) return
    call find_options(options, found)
    address = program_symbol("METIS_NodeND")
    found = found .and. c_associated(address)
    if (.not. found) return
    call c_f_procpointer(address, find_order)
    call list_neighbours(matrix, start, neighbour)
    allocate (original(matrix%n), new_number(matrix%n))
    found = status_ok == find_order(int(matrix%n, c_int), start, neighbour, c_null_ptr, options, &
        original, new_number)
    if (found) order = int(original) + 1
  end subroutine nested_dissection

  !> Divide the block rows of a matrix with a symmetric pattern into parts of nearly equal size.
  subroutine partition_graph(matrix, n_part, part, found)
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: n_part
    !> Part of each block row, from 0.
    integer, allocatable, intent(out) :: part(:)
    !> False if the program has no METIS for integers of this size, or METIS fails.
    logical, intent(out) :: found

    procedure(partition_interface), pointer :: divide
    type(c_funptr) :: address
    integer(c_int), allocatable :: start(:), neighbour(:), part_of(:)
    integer(c_int) :: options(2*n_options), cut

    call find_options(options, found)
    address = program_symbol("METIS_PartGraphKway")
    found = found .and. c_associated(address)
    if (.not. found) return
    call c_f_procpointer(address, divide)
    call list_neighbours(matrix, start, neighbour)
    allocate (part_of(matrix%n))
    found = status_ok == divide(int(matrix%n, c_int), 1_c_int, start, neighbour, c_null_ptr, &
        c_null_ptr, c_null_ptr, int(n_part, c_int), c_null_ptr, c_null_ptr, options, cut, part_of)
    part = int(part_of)
  end subroutine partition_graph

  !> Find the default options. A METIS built for integers of 8 bytes, which does not suit, is
  !> recognised by the number of bytes that it sets.
  subroutine find_options(options, found)
    integer(c_int), intent(out) :: options(2*n_options)
    logical, intent(out) :: found

    procedure(defaults_interface), pointer :: set_defaults
    type(c_funptr) :: address

    options = 0
    found = .false.
    address = program_symbol("METIS_SetDefaultOptions")
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, set_defaults)
    if (set_defaults(options) /= status_ok) return
    found = all(options(n_options + 1:) == 0)
  end subroutine find_options

  !> List the neighbours of each row.
  subroutine list_neighbours(matrix, start, neighbour)
    type(block_matrix_t), intent(in) :: matrix
    !> 0-based, see `order_interface`.
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
