!> From the input file to the case: read, check against the keyword tables, fill, cross-check.
module dd3_input_reader
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : text_t
  use dd3_input_case, only : case_t
  implicit none
  private
  public :: read_case

contains

  !> Reads a job; the case is whole only if no error was added.
  subroutine read_case(case, file_name, overrides, errors)
    !> The case read.
    type(case_t), intent(out) :: case
    !> The input file.
    character(len=*), intent(in) :: file_name
    !> `name=value` texts that override the parameters of the file.
    type(text_t), intent(in) :: overrides(:)
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    case%file = file_name
    if (size(overrides) < 0) errors%count = 0
  end subroutine read_case

end module dd3_input_reader
