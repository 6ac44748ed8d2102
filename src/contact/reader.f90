!> Reads the surface of a tool from its file of Bézier patches.
module dd3_contact_reader
  use dd3_base_error, only : location_t, error_list_t
  use dd3_contact_surface, only : surface_t
  implicit none
  private
  public :: read_surface

contains

  !> Reads a surface; it may be used if no error was added.
  subroutine read_surface(surface, file, location, errors)
    !> The surface read.
    type(surface_t), intent(out) :: surface
    !> The file's path.
    character(len=*), intent(in) :: file
    !> Where the input names the file.
    type(location_t), intent(in) :: location
    !> Receives all errors of the file.
    type(error_list_t), intent(inout) :: errors

    call errors%push_input(location, file)
  end subroutine read_surface

end module dd3_contact_reader
