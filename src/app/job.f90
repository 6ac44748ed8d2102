!> One job from the options to the exit code.
module dd3_app_job
  use, intrinsic :: iso_fortran_env, only : output_unit, error_unit
  use dd3_app_command_line, only : options_t
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : to_text
  use dd3_input_case, only : case_t
  use dd3_input_echo, only : echo_case
  use dd3_input_reader, only : read_case
  implicit none
  private
  public :: run_job, results_directory
  public :: exit_end, exit_usage, exit_input, exit_stopped

  !> Exit codes: reached the end, usage, errors in the input, stopped before the end.
  integer, parameter :: exit_end = 0, exit_usage = 1, exit_input = 2, exit_stopped = 3
  !> Most errors shown.
  integer, parameter :: most_errors = 100

contains

  !> Reads, checks and runs a job.
  subroutine run_job(options, exit_code)
    !> What the user asks for.
    type(options_t), intent(in) :: options
    !> One of the `exit_*` values.
    integer, intent(out) :: exit_code

    type(case_t) :: case
    type(error_list_t) :: errors

    call read_case(case, options%file, options%overrides, errors)
    if (errors%count > 0) then
      call report_errors(errors, options%file)
      exit_code = exit_input
      return
    end if
    if (options%check .and. .not. options%quiet) then
      write (output_unit, '(a)', advance="no") echo_case(case)
      write (output_unit, '(a)') "checked: "//options%file
    end if
    exit_code = exit_end
  end subroutine run_job

  !> Shows all errors of the input in the order of its lines.
  subroutine report_errors(errors, file)
    !> The errors.
    type(error_list_t), intent(inout) :: errors
    !> The input file.
    character(len=*), intent(in) :: file

    integer :: i

    call errors%sort()
    do i = 1, min(errors%count, most_errors)
      write (error_unit, '(a)') errors%item(i)%message
    end do
    if (errors%count > most_errors) then
      write (error_unit, '(a)') "and "//to_text(errors%count - most_errors)//" more errors"
    end if
    write (error_unit, '(a)') to_text(errors%count)//trim(merge(" error ", " errors", &
        errors%count == 1))// &
      " in "//file//"; nothing was computed"
  end subroutine report_errors

  !> Folder of the results: as the command line says, else as the input says, else beside the input
  !> file.
  function results_directory(options, case) result(directory)
    !> What the user asks for.
    type(options_t), intent(in) :: options
    !> The case.
    type(case_t), intent(in) :: case
    character(len=:), allocatable :: directory

    integer :: dot, slash

    directory = options%output
    if (directory == "") directory = case%output%directory
    if (directory /= "") return
    dot = index(case%file, ".", back=.true.)
    slash = index(case%file, "/", back=.true.)
    if (dot <= slash + 1) dot = len(case%file) + 1
    directory = case%file(:dot - 1)//".out"
  end function results_directory

end module dd3_app_job
