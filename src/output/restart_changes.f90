! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of the list of refinements in restart.h5.
module dd3_output_restart_changes
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_kinds, only : wp
  use dd3_model_mesh_change, only : mesh_change_t, n_integer, n_real, unpacked
  use dd3_output_hdf5_read, only : close_hdf5, dataset_size, read_integers, read_reals
  use dd3_output_restart_format, only : open_restart
  use hdf5, only : hid_t
  implicit none
  private
  public :: read_changes

contains

  !> Read the refinements of a run up to its restart file.
  subroutine read_changes(path, change, error)
    character(len=*), intent(in) :: path
    !> Empty if no element was divided.
    type(mesh_change_t), allocatable, intent(out) :: change(:)
    !> Set if the file cannot be read.
    type(error_t), allocatable, intent(out) :: error

    integer(hid_t) :: file
    integer, allocatable :: number(:)
    real(wp), allocatable :: value(:)
    integer :: n
    logical :: ok

    allocate (change(0))
    call open_restart(path, file, error)
    if (allocated(error)) return
    call dataset_size(file, "mesh/change_number", n)
    n = max(n, 0)/n_integer
    allocate (number(n_integer*n), value(n_real*n))
    ok = .true.
    if (n > 0) call read_integers(file, "mesh/change_number", number, ok)
    if (n > 0) call read_reals(file, "mesh/change_value", value, ok)
    call close_hdf5(file)
    if (ok) then
      change = unpacked(reshape(number, [n_integer, n]), reshape(value, [n_real, n]))
    else
      call fatal_error(error, "'"//path//"' has no whole list of refinements", "E204")
    end if
  end subroutine read_changes

end module dd3_output_restart_changes
