! SPDX-License-Identifier: GPL-3.0-or-later
!> Sheet metal forming with rigid tools: read a keyword file, run the process that it describes and
!> write the results.
program dd3imp
  use, intrinsic :: iso_fortran_env, only : error_unit
  use dd3_app_command_line, only : options_t, read_command_line, usage_text
  use dd3_app_help, only : show_help, show_version
  use dd3_app_exit_codes, only : exit_end, exit_usage
  use dd3_app_job, only : run_job
  use dd3_app_memory, only : end_program, watch_memory
  use dd3_base_error, only : error_t
  use dd3_external_blas, only : use_kernels_of_processor
  use dd3_base_ranks, only : end_ranks, start_ranks, this_rank
  implicit none

  type(options_t) :: options
  type(error_t), allocatable :: error
  integer :: exit_code, ignored

  call use_kernels_of_processor()
  call watch_memory()
  call start_ranks()
  call read_command_line(options, error)
  if (this_rank() > 0 .and. (allocated(error) .or. options%version .or. options%help)) then
    exit_code = merge(exit_usage, exit_end, allocated(error))
  else if (allocated(error)) then
    ! allow(C181)
    write (error_unit, '(a)', iostat=ignored) "dd3imp: "//error%message
    ! allow(C181)
    write (error_unit, '(a)', advance="no", iostat=ignored) usage_text()
    exit_code = exit_usage
  else if (options%version) then
    call show_version()
    exit_code = exit_end
  else if (options%help) then
    call show_help(options%topic, exit_code)
  else
    call run_job(options, exit_code)
  end if
  ! allow(C181)
  flush (error_unit, iostat=ignored)
  call end_ranks()
  call end_program(exit_code)

end program dd3imp
