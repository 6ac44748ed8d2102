! SPDX-License-Identifier: GPL-3.0-or-later
!> Entries of the library METIS (Karypis and Kumar, SIAM J. Sci. Comput. 20, 1998), with integers of
!> 4 bytes. Where it is not installed, the build takes `cmake/absent/metis_library.f90` instead.
module dd3_external_metis_library
  use, intrinsic :: iso_c_binding, only : c_int, c_ptr
  implicit none
  private
  public :: metis_nodend, metis_partgraphkway, library_present, status_ok

  !> Whether the program contains the library.
  logical, parameter :: library_present = .true.
  !> Status of success.
  integer(c_int), parameter :: status_ok = 1

  interface
    !> Number the nodes of a graph by nested dissection.
    integer(c_int) function metis_nodend(n, start, neighbour, weight, options, order, new_number) &
        bind(c, name="METIS_NodeND")
      import :: c_int, c_ptr
      integer(c_int), intent(in) :: n
      !> Where the neighbours of each node begin, and the neighbours; both 0-based.
      integer(c_int), intent(in) :: start(*), neighbour(*)
      !> Weights of the nodes; null for none.
      type(c_ptr), value :: weight
      !> Null for the defaults.
      type(c_ptr), value :: options
      !> Original number of each row, and new number of each node; 0-based.
      integer(c_int), intent(out) :: order(*), new_number(*)
    end function metis_nodend

    !> Divide a graph into parts of nearly equal weight.
    integer(c_int) function metis_partgraphkway(n, n_balance, start, neighbour, weight, size, &
        edge_weight, n_part, fraction, tolerance, options, cut, part) &
        bind(c, name="METIS_PartGraphKway")
      import :: c_int, c_ptr
      !> Number of nodes, and of balancing constraints.
      integer(c_int), intent(in) :: n, n_balance
      !> See `metis_nodend`.
      integer(c_int), intent(in) :: start(*), neighbour(*)
      !> Weights, and fractions and tolerances of the parts; null for the defaults.
      type(c_ptr), value :: weight, size, edge_weight
      integer(c_int), intent(in) :: n_part
      type(c_ptr), value :: fraction, tolerance
      !> Null for the defaults.
      type(c_ptr), value :: options
      !> Number of edges between parts, and the part of each node, from 0.
      integer(c_int), intent(out) :: cut, part(*)
    end function metis_partgraphkway
  end interface

end module dd3_external_metis_library
