! SPDX-License-Identifier: GPL-3.0-or-later
!> Format of restart.h5: its name, mark and version, its sizes of the mesh, and its opening.
module dd3_output_restart_format
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : to_text
  use dd3_base_version, only : program_version
  use dd3_output_hdf5_read, only : close_hdf5, open_hdf5, read_integer_attribute, &
      read_text_attribute
  use hdf5, only : hid_t
  implicit none
  private
  public :: restart_name, mark, format_version, check_origin, open_restart
  public :: at_node, at_element, at_element_node, at_point, at_internal, at_thickness_point, &
      at_ended, n_sizes

  !> Name of the file in the folder of the results.
  character(len=*), parameter :: restart_name = "restart.h5"
  !> Mark of the file, and the version of its format. Version 1 holds the components of `state_t` by
  !> name; a change of their meaning makes a new version. `mesh/number`, `mesh/level` and
  !> `mesh/bound` are there only where elements have been divided, `mesh/change_*`, `mesh/input_*`
  !> and `mesh/x_start` (of a job that starts from another) only where they were divided in the run
  !> itself.
  character(len=*), parameter :: mark = "dd3imp restart"
  integer, parameter :: format_version = 9
  !> Entries of `mesh/sizes`: numbers of nodes, of elements, of nodes and points of an element, of
  !> internal variables, of points through the thickness (0: fixed); 1 if the run has ended.
  integer, parameter :: at_node = 1, at_element = 2, at_element_node = 3, at_point = 4, &
      at_internal = 5, at_thickness_point = 6, at_ended = 7, n_sizes = 7

contains

  !> Open a restart file of this version.
  subroutine open_restart(path, file, error)
    character(len=*), intent(in) :: path
    integer(hid_t), intent(out) :: file
    !> Set if it cannot be read; then it is not open.
    type(error_t), allocatable, intent(out) :: error

    logical :: there, ok

    inquire (file=path, exist=there)
    call open_hdf5(path, file, ok)
    if (.not. there) then
      call fatal_error(error, "cannot read the restart file '"//path//"': no such file", "E204")
    else if (ok) then
      call check_origin(path, file, error)
    else
      call fatal_error(error, "cannot read the restart file '"//path// &
          "': truncated or not an HDF5 file", "E204")
    end if
    if (allocated(error)) call close_hdf5(file)
  end subroutine open_restart

  !> Check that a file is a restart file of this version.
  subroutine check_origin(path, file, error)
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: file
    type(error_t), allocatable, intent(out) :: error

    character(len=:), allocatable :: program_mark, version
    integer :: found

    call read_text_attribute(file, "program", program_mark)
    call read_text_attribute(file, "version", version)
    found = read_integer_attribute(file, "format")
    if (program_mark /= mark) then
      call fatal_error(error, "'"//path//"' is not a restart file of dd3imp", "E204")
    else if (found /= format_version) then
      call fatal_error(error, "'"//path//"' has restart format "//to_text(found)// &
          ", written by dd3imp "//version//"; this version reads format "// &
          to_text(format_version), "E204")
    else if (version /= program_version) then
      call fatal_error(error, "'"//path//"' was written by dd3imp "//version//"; this is "// &
          program_version//", and a restart file belongs to one version: continue with that "// &
          "version, or start the run again", "E204")
    end if
  end subroutine check_origin

end module dd3_output_restart_format
