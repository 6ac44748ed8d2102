! SPDX-License-Identifier: GPL-3.0-or-later
!> One job from the options to the exit code.
module dd3_app_job
  use, intrinsic :: iso_fortran_env, only : output_unit
  use dd3_app_command_line, only : options_t
  use dd3_app_error_stream, only : message_of, put_line, write_line
  use dd3_app_exit_codes, only : exit_end, exit_input, exit_stopped
  use dd3_app_overwrite, only : check_overwrite, result_file
  use dd3_app_run, only : command_of, run_checked
  use dd3_app_warnings, only : unit_warnings
  use dd3_base_error, only : error_list_t, error_t, fatal_error, share_error
  use dd3_base_file, only : folder_of, make_directory
  use dd3_base_kinds, only : wp
  use dd3_base_log, only : log_t
  use dd3_base_ranks, only : largest_over_ranks, n_ranks, rank_of_smallest, this_rank
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : join, slice, to_text
  use dd3_base_threads, only : most_threads, set_threads
  use dd3_input_case, only : case_t
  use dd3_input_echo, only : echo_case
  use dd3_input_reader, only : read_case
  use dd3_linalg_solver, only : linear_solver_t
  use dd3_linalg_solver_registry, only : solver_names
  use dd3_model_model, only : model_t
  use dd3_model_state, only : new_state
  use dd3_output_fields, only : field_record_t
  use dd3_output_restart_read, only : read_restart
  use dd3_output_run_summary, only : run_summary_t
  use dd3_report_expected_time, only : time_report
  use dd3_report_settings_report, only : contact_report, drawbead_report, limits_report
  use dd3_report_job_size, only : find_job_size, job_size_t, memory_warning, size_report
  use dd3_run_expected_mesh, only : expected_mesh_t, new_expected_mesh
  use dd3_run_model, only : run_start_t, solver_options
  use dd3_run_file_writer, only : run_file_t
  use dd3_setup_axes, only : normal_report
  use dd3_setup_element, only : default_report
  use dd3_setup_model, only : new_model
  use dd3_setup_restart_sheet, only : take_restart_sheet
  use dd3_setup_sheet_file, only : read_sheet
  use dd3_setup_tool_report, only : tool_report
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: run_job

  !> Most errors shown.
  integer, parameter :: most_errors = 100

contains

  !> Read, check and run a job.
  subroutine run_job(options, exit_code)
    type(options_t), intent(in) :: options
    !> One of the `exit_*` values.
    integer, intent(out) :: exit_code

    type(case_t) :: case
    type(model_t) :: model
    type(run_start_t) :: start
    type(error_list_t) :: errors
    type(error_t), allocatable :: error
    type(sheet_t) :: sheet
    logical :: wrong
    integer :: i

    call read_case(case, options%file, options%overrides, errors)
    do i = 1, size(case%start)
      if (case%start(i)%source%valid) call read_sheet(sheet, case%start(i), errors)
    end do
    call new_model(model, case, errors, sheet)
    if (errors%count == 0) call check_overwrite(case, results_directory(options, case), &
        options%restart, errors)
    call share_errors(errors, options%file, wrong)
    if (wrong) then
      exit_code = exit_input
      ! The picture shows what is wrong about the place of a tool.
      if (options%initial == "" .or. .not. allocated(model%history)) return
      call set_start(start, options, case, model, sheet, error)
      if (.not. allocated(error)) call write_initial(options, case, model, start, errors, error)
      if (allocated(error)) call write_line("dd3imp: "//message_of(error, "error"))
      return
    end if
    call set_start(start, options, case, model, sheet, error)
    sheet = sheet_t()
    if (allocated(error)) then
      call write_line("dd3imp: "//message_of(error, "error"))
      exit_code = exit_input
    else if (options%check) then
      if (.not. options%quiet) call show_checked(case, model, start)
      if (options%initial /= "") call write_initial(options, case, model, start, errors, error)
      exit_code = merge(exit_stopped, exit_end, allocated(error))
      if (allocated(error)) call write_line("dd3imp: "//message_of(error, "error"))
    else
      call run_checked(options, start, case, model, exit_code)
    end if
  end subroutine run_job

  !> Report the errors of the input, those of the lowest rank that has some.
  subroutine share_errors(errors, file, wrong)
    type(error_list_t), intent(inout) :: errors
    character(len=*), intent(in) :: file
    !> Whether any rank has errors.
    logical, intent(out) :: wrong

    integer :: rank, number(1)

    rank = rank_of_smallest(merge(0.0_wp, 1.0_wp, errors%count > 0), 0)
    number = errors%count
    call largest_over_ranks(1, number)
    wrong = number(1) > 0
    if (this_rank() == rank .and. wrong) call report_errors(errors, file)
  end subroutine share_errors

  !> Set what a run starts from: the initial state, or that of a restart file.
  subroutine set_start(start, options, case, model, sheet, error)
    type(run_start_t), intent(out) :: start
    type(options_t), intent(in) :: options
    type(case_t), intent(in) :: case
    !> Built anew if the sheet of the restart file has been refined.
    type(model_t), intent(inout) :: model
    type(sheet_t), intent(in) :: sheet
    !> Set if the restart file cannot be used.
    type(error_t), allocatable, intent(out) :: error

    start%solver = case%solver
    start%threads = options%threads
    if (start%threads == 0) start%threads = most_threads()
    call set_threads(start%threads)
    start%directory = results_directory(options, case)
    if (size(case%point) > 0) then
      if (options%restart /= "") call fatal_error(error, "a run of material points (*POINT) "// &
          "has no restart", "E205")
    else if (options%restart == "") then
      call new_state(start%state, model, sheet)
      start%sheet_report = sheet%report
    else
      start%restart = options%restart
      start%source = folder_of(options%restart)
      call take_restart_sheet(options%restart, case, model, error)
      if (.not. allocated(error)) call read_restart(options%restart, model, start%state, error)
    end if
    if (.not. allocated(error)) call check_ranks(case, error)
    call share_error(error)
  end subroutine set_start

  !> Check that several ranks can run the job.
  subroutine check_ranks(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(out) :: error

    character(len=16), allocatable :: expected(:)

    if (n_ranks() == 1) return
    expected = [character(len=16) :: "auto", solver_names(distributed=.true.)]
    if (size(case%point) > 0) then
      call fatal_error(error, "a run of material points (*POINT) needs one process, got "// &
          to_text(n_ranks()), "E205")
    else if (all(expected /= case%solver%method)) then
      call fatal_error(error, "method = "//case%solver%method//" of *SOLVER needs one process, "// &
          "got "//to_text(n_ranks())//"; expected one of: "//join(expected, " "), "E205")
    end if
  end subroutine check_ranks

  !> Print all values and warnings.
  subroutine show_checked(case, model, start)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start

    type(job_size_t) :: job
    type(expected_mesh_t) :: mesh
    class(linear_solver_t), allocatable :: solver
    type(error_t), allocatable :: ignored
    type(message_list_t) :: messages, warnings
    character(len=:), allocatable :: settings
    integer :: i

    settings = contact_report(model)
    if (size(case%point) == 0) then
      if (this_rank() == 0) then
        call find_job_size(job, model, start%state, solver_options(start), solver, ignored)
      end if
      if (allocated(solver)) call solver%release()
      call new_expected_mesh(mesh, case, model, start%state)
    end if
    if (this_rank() > 0) return
    write (output_unit, '(a)', advance="no") echo_case(case)//default_report(case, model)// &
        normal_report(case, model)// &
        tool_report(model)//settings//limits_report(model)//drawbead_report(model)
    if (allocated(start%sheet_report)) then
      write (output_unit, '(a)', advance="no") start%sheet_report
    end if
    if (size(case%point) == 0) then
      write (output_unit, '(a)', advance="no") size_report(job, mesh%at_end)//mesh%report()// &
          time_report(model, start%state, mesh%mean_number())
      call messages%add_new("W014", memory_warning(job, mesh%at_end))
    end if
    call unit_warnings(case, model, warnings)
    do i = 1, warnings%count
      call messages%add(warnings%item(i))
    end do
    do i = 1, messages%count
      write (output_unit, '(a)') messages%line(i)
    end do
    write (output_unit, '(a)') "checked: "//case%file
  end subroutine show_checked

  !> Write the state from which a run would start and run.json, for a picture of the sheet and the
  !> tools.
  subroutine write_initial(options, case, model, start, errors, error)
    !> The folder is made if it does not exist; it must hold no results.
    type(options_t), intent(in) :: options
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start
    !> Errors of the input.
    type(error_list_t), intent(in) :: errors
    !> Set if a file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(field_record_t) :: fields
    logical :: there
    integer :: i

    if (size(case%point) > 0) then
      call fatal_error(error, "material points (*POINT) have no fields", "E205")
      return
    end if
    associate (directory => options%initial)
      if (this_rank() == 0) call make_directory(directory, error)
      do i = 1, size(result_file)
        if (this_rank() > 0 .or. allocated(error)) exit
        inquire (file=directory//"/"//trim(result_file(i)), exist=there)
        if (there) call fatal_error(error, "'"//directory//"' holds results of a run; "// &
            "--initial needs a folder without", "E205")
      end do
      if (this_rank() == 0 .and. .not. allocated(error)) then
        call fields%open(model, directory, error)
      end if
      call share_error(error)
      if (allocated(error)) return
      call fields%write(model, start%state, error)
      if (this_rank() > 0) return
      if (.not. allocated(error)) call fields%close(error)
    end associate
    if (.not. allocated(error)) call describe_initial(options, case, model, start, errors, error)
  end subroutine write_initial

  !> Write run.json beside the initial state.
  subroutine describe_initial(options, case, model, start, errors, error)
    type(options_t), intent(in) :: options
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start
    !> Errors of the input.
    type(error_list_t), intent(in) :: errors
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(run_file_t) :: file
    type(run_summary_t) :: summary
    type(log_t) :: log
    type(error_t), allocatable :: none

    call file%start(command_of(options, start), case, model, options%initial)
    call file%add_solver(case%solver, "")
    call file%add_size(job_size_t())
    call file%add_new()
    call summary%start(size(model%phase), start%state)
    if (errors%count == 0) call unit_warnings(case, model, log%told)
    file%state = trim(merge("input_error", "checked    ", errors%count > 0))
    file%exit_code = merge(exit_input, exit_end, errors%count > 0)
    call file%write(case, model, summary, log, none, errors, error)
  end subroutine describe_initial

  !> Print all errors of the input in the order of its lines.
  subroutine report_errors(errors, file)
    type(error_list_t), intent(inout) :: errors
    character(len=*), intent(in) :: file

    integer :: i

    call errors%sort()
    do i = 1, min(errors%count, most_errors)
      call put_line(errors%item(i)%message)
    end do
    if (errors%count > most_errors) call put_line("and "// &
        to_text(errors%count - most_errors)//" more errors")
    call put_line(to_text(errors%count)//trim(merge(" error ", " errors", errors%count == 1))// &
        " in "//file//"; nothing was computed")
  end subroutine report_errors

  !> Return the folder of the results: that of the command line, else that of the input, else one
  !> beside the input file.
  function results_directory(options, case) result(directory)
    type(options_t), intent(in) :: options
    type(case_t), intent(in) :: case
    character(len=:), allocatable :: directory

    integer :: dot, slash

    directory = options%output
    if (directory == "") directory = case%output%directory
    if (directory /= "") return
    dot = index(case%file, ".", back=.true.)
    slash = index(case%file, "/", back=.true.)
    if (dot <= slash + 1) dot = len(case%file) + 1
    directory = slice(case%file, 1, dot - 1)//".out"
  end function results_directory

end module dd3_app_job
