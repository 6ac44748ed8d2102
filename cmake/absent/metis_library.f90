! SPDX-License-Identifier: GPL-3.0-or-later
!> In place of `src/external/metis_library.f90` where METIS is not installed: every call fails.
module dd3_external_metis_library
  use, intrinsic :: iso_c_binding, only : c_int, c_ptr
  implicit none
  private
  public :: metis_nodend, metis_partgraphkway, library_present, status_ok

  !> Whether the program contains the library.
  logical, parameter :: library_present = .false.
  !> Status of success, and the one returned.
  integer(c_int), parameter :: status_ok = 1, status_absent = 0

contains

  !> Fail.
  integer(c_int) function metis_nodend(n, start, neighbour, weight, options, order, new_number)
    integer(c_int), intent(in) :: n, start(:), neighbour(:)
    type(c_ptr), intent(in) :: weight, options
    integer(c_int), intent(out) :: order(n), new_number(n)

    metis_nodend = status_absent
    order = 0
    new_number = 0
  end function metis_nodend

  !> Fail.
  integer(c_int) function metis_partgraphkway(n, n_balance, start, neighbour, weight, size, &
      edge_weight, n_part, fraction, tolerance, options, cut, part)
    integer(c_int), intent(in) :: n, n_balance, start(:), neighbour(:), n_part
    type(c_ptr), intent(in) :: weight, size, edge_weight, fraction, tolerance, options
    integer(c_int), intent(out) :: cut, part(n)

    metis_partgraphkway = status_absent
    cut = 0
    part = 0
  end function metis_partgraphkway

end module dd3_external_metis_library
