! SPDX-License-Identifier: GPL-3.0-or-later
!> Run of a job whose input has no errors, with its log and run.json.
module dd3_app_run
  use, intrinsic :: iso_c_binding, only : c_int
  use dd3_app_command_line, only : options_t
  use dd3_app_error_stream, only : message_of, write_line
  use dd3_app_exit_codes, only : exit_end, exit_stopped
  use dd3_app_memory, only : ended_message, watch_log, watch_run_file
  use dd3_app_overwrite, only : result_file
  use dd3_app_warnings, only : unit_warnings
  use dd3_base_clock, only : section_names
  use dd3_base_error, only : error_list_t, error_t, fatal_error, keep_first, share_error
  use dd3_base_file, only : make_directory, remove_file
  use dd3_base_file_system, only : part_of, read_file
  use dd3_base_interrupt, only : watch_interrupts
  use dd3_base_log, only : log_t
  use dd3_base_message, only : message_list_t
  use dd3_base_ranks, only : this_rank
  use dd3_base_text, only : newline, to_text
  use dd3_base_version, only : version => program_version
  use dd3_input_case, only : case_t
  use dd3_input_echo, only : echo_case
  use dd3_linalg_solver, only : linear_solver_t
  use dd3_model_model, only : model_t
  use dd3_output_restart_format, only : restart_name
  use dd3_output_run_summary, only : phase_summary_t, run_summary_t
  use dd3_point_run, only : run_points
  use dd3_report_settings_report, only : contact_report, drawbead_report, limits_report
  use dd3_report_job_size, only : find_job_size, job_size_t, memory_warning, size_report
  use dd3_run_model, only : run_model, run_start_t, solver_options
  use dd3_run_file_head, only : command_t
  use dd3_run_file_writer, only : run_file_name, run_file_t
  use dd3_setup_axes, only : normal_report
  use dd3_setup_element, only : default_report
  use dd3_setup_materials, only : law_sources
  use dd3_setup_tool_report, only : tool_report
  implicit none
  private
  public :: command_of, run_checked

contains

  !> Run a job whose input has no errors.
  subroutine run_checked(options, start, case, model, exit_code)
    type(options_t), intent(in) :: options
    type(run_start_t), intent(inout) :: start
    type(case_t), intent(in) :: case
    type(model_t), intent(inout) :: model
    !> One of the `exit_*` values.
    integer, intent(out) :: exit_code

    type(log_t) :: log
    type(run_file_t) :: file
    type(run_summary_t) :: summary
    type(error_t), allocatable :: error, late

    call watch_interrupts()
    call log%start(options%quiet)
    call log%say("dd3imp "//version//": "//case%file)
    if (this_rank() == 0) call make_directory(start%directory, error)
    if (.not. allocated(error)) call open_log(log, options%quiet, start, error)
    call share_error(error)
    if (.not. allocated(error)) then
      call watch_log(log%descriptor())
      call file%start(command_of(options, start), case, model, start%directory)
      call run_logged(start, case, model, log, file, summary, error)
      if (allocated(error)) then
        call log%note(message_of(error, "stopped"))
      else
        call log%say("reached the end; results in "//start%directory)
      end if
      call watch_log(-1_c_int)
      call log%close(late)
      call keep_first(error, late)
      call end_file(file, case, model, summary, log, error)
    end if
    exit_code = merge(exit_stopped, exit_end, allocated(error))
    if (allocated(error)) call write_line("dd3imp: "//message_of(error, "stopped"))
  end subroutine run_checked

  !> Run a job whose log is open.
  subroutine run_logged(start, case, model, log, file, summary, error)
    type(run_start_t), intent(inout) :: start
    type(case_t), intent(in) :: case
    type(model_t), intent(inout) :: model
    type(log_t), intent(inout) :: log
    type(run_file_t), intent(inout) :: file
    type(run_summary_t), intent(out) :: summary
    !> Set if the run stopped.
    type(error_t), allocatable, intent(out) :: error

    class(linear_solver_t), allocatable :: solver
    type(job_size_t) :: job
    character(len=:), allocatable :: earlier
    type(error_t), allocatable :: ignored

    earlier = ""
    if (allocated(start%source)) call read_file(start%source//"/"//run_file_name, earlier, ignored)
    call introduce(log, case, model)
    if (allocated(start%sheet_report)) call say_lines(log, start%sheet_report)
    if (.not. allocated(start%source)) call clear_directory(log, start%directory, case)
    if (size(case%point) == 0) then
      call log_size(log, model, start, solver, job)
      call summary%start(size(model%phase), start%state)
    end if
    call begin_file(file, start, case, model, job, solver, earlier)
    deallocate (earlier)
    call file%write(case, model, summary, log, ignored, error_list_t(), error)
    call share_error(error)
    if (allocated(error)) return
    call watch_end(file, case, model, summary, log)
    if (size(case%point) > 0) then
      call run_points(case, model, start%directory, log, summary%increments, error)
    else
      call run_model(model, case, start, solver, log, summary, error)
      call conclude(log, summary)
    end if
    ! A run whose folder has vanished has no results.
    if (.not. allocated(error)) call log%check(error)
    call share_error(error)
  end subroutine run_logged

  !> Return the call of the program.
  function command_of(options, start) result(command)
    type(options_t), intent(in) :: options
    type(run_start_t), intent(in) :: start
    type(command_t) :: command

    command%file = options%file
    command%directory = start%directory
    command%restart = options%restart
    command%settings = options%overrides
    command%threads = start%threads
    command%check = options%check
  end function command_of

  !> Add to run.json what the run starts from.
  subroutine begin_file(file, start, case, model, job, solver, earlier)
    type(run_file_t), intent(inout) :: file
    type(run_start_t), intent(in) :: start
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(job_size_t), intent(in) :: job
    !> Not allocated for material points, and without memory for it.
    class(linear_solver_t), allocatable, intent(in) :: solver
    !> run.json of the run that is continued.
    character(len=*), intent(in) :: earlier

    if (allocated(solver)) then
      call file%add_solver(case%solver, trim(solver%description))
    else
      call file%add_solver(case%solver, "")
    end if
    call file%add_size(job)
    if (allocated(start%source)) then
      call file%add_continued(start%restart, model%phase(start%state%phase)%name, start%state, &
          earlier)
    else
      call file%add_new()
    end if
  end subroutine begin_file

  !> Compose the run.json of a run that the program cannot end itself.
  subroutine watch_end(file, case, model, summary, log)
    type(run_file_t), intent(in) :: file
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_summary_t), intent(in) :: summary
    type(log_t), intent(in) :: log

    type(run_file_t) :: ended
    type(error_t), allocatable :: error

    if (this_rank() > 0) return
    call fatal_error(error, ended_message, "E202")
    ended = file
    ended%exit_code = exit_stopped
    call watch_run_file(file%path, part_of(file%path), &
        ended%compose(case, model, summary, log, error, error_list_t()))
  end subroutine watch_end

  !> Write run.json at the end of the run.
  subroutine end_file(file, case, model, summary, log, error)
    type(run_file_t), intent(inout) :: file
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_summary_t), intent(in) :: summary
    type(log_t), intent(in) :: log
    !> What stopped the run; set if the file cannot be written.
    type(error_t), allocatable, intent(inout) :: error

    type(error_t), allocatable :: late

    call watch_run_file("", "", "")
    file%state = "reached"
    file%exit_code = merge(exit_stopped, exit_end, allocated(error))
    call file%write(case, model, summary, log, error, error_list_t(), late)
    call share_error(late)
    call keep_first(error, late)
  end subroutine end_file

  !> Open job.log; after a restart it continues the log of the earlier run.
  subroutine open_log(log, quiet, start, error)
    type(log_t), intent(inout) :: log
    logical, intent(in) :: quiet
    type(run_start_t), intent(in) :: start
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    character(len=*), parameter :: name = "/job.log"
    character(len=:), allocatable :: earlier
    type(error_t), allocatable :: ignored

    earlier = ""
    if (allocated(start%source)) call read_file(start%source//name, earlier, ignored)
    call log%open(start%directory//name, quiet, error, earlier)
  end subroutine open_log

  !> Remove the results of an earlier run.
  subroutine clear_directory(log, directory, case)
    type(log_t), intent(inout) :: log
    character(len=*), intent(in) :: directory
    !> Each of its phases may have left a state at its end.
    type(case_t), intent(in) :: case

    character(len=:), allocatable :: names
    logical :: removed
    integer :: i

    if (this_rank() > 0) return
    names = ""
    do i = 1, size(result_file)
      call remove_file(part_of(directory//"/"//trim(result_file(i))), removed)
      call remove_file(directory//"/"//trim(result_file(i)), removed)
      if (removed) names = names//" "//trim(result_file(i))
    end do
    do i = 1, size(case%phase)
      associate (name => case%phase(i)%name//"/"//restart_name)
        call remove_file(directory//"/"//name, removed)
        if (removed) names = names//" "//name
      end associate
    end do
    if (names /= "") call log%note("removed from an earlier run:"//names)
  end subroutine clear_directory

  !> Log title, sizes and laws; the echo of all values goes into the file only.
  subroutine introduce(log, case, model)
    type(log_t), intent(inout) :: log
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model

    type(message_list_t) :: warnings
    character(len=12) :: date, time
    integer :: i

    call date_and_time(date=date, time=time)
    if (len(model%title) > 0) call log%say(model%title)
    call log%note("started "//date(1:4)//"-"//date(5:6)//"-"//date(7:8)//" "//time(1:2)//":"// &
        time(3:4))
    if (size(case%point) > 0) then
      call log%say("material points, without a mesh")
    else
      call log%say(to_text(model%n_element)//" elements "//trim(model%element%name)//" ("// &
        trim(model%element%title)//"), "//to_text(model%n_node)//" nodes, "// &
        to_text(model%part%n_point)//" candidates for contact with "//to_text(model%n_tool)// &
        " tools")
    end if
    call say_lines(log, default_report(case, model)//normal_report(case, model))
    do i = 1, size(case%mesh)
      call log%say("mesh of "//case%mesh(i)%file//": thickness from z_min to z_max "// &
          thickness_range(model)//" mm")
    end do
    call unit_warnings(case, model, warnings)
    do i = 1, warnings%count
      call log%tell(warnings%item(i))
    end do
    call log%note(echo_case(case)//tool_report(model)//contact_report(model)// &
        limits_report(model)//drawbead_report(model))
    do i = 1, size(model%material)
      call log%note(law_sources(model%material_name(i), model%material(i)))
      if (.not. model%material(i)%laws%criterion%convexity_waived) cycle
      call log%report("W013", "material "//trim(model%material_name(i))// &
          ": its yield surface is taken though it may not be convex")
    end do
  end subroutine introduce

  !> Log the lines of a text.
  subroutine say_lines(log, text)
    type(log_t), intent(inout) :: log
    !> Each line with its end.
    character(len=*), intent(in) :: text

    integer :: first, length

    first = 1
    do while (first <= len(text))
      length = index(text(first:), newline)
      call log%say(text(first:first + length - 2))
      first = first + length
    end do
  end subroutine say_lines

  !> Log the size of the job, and a warning if it needs too much memory.
  subroutine log_size(log, model, start, solver, job)
    type(log_t), intent(inout) :: log
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start
    !> See `find_job_size`.
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(job_size_t), intent(out) :: job

    type(error_t), allocatable :: error

    call find_job_size(job, model, start%state, solver_options(start), solver, error)
    if (allocated(error)) return
    call log%note(size_report(job))
    call log%report("W014", memory_warning(job))
  end subroutine log_size

  !> Return the thickness of the sheet, or its range, as text.
  pure function thickness_range(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    text = to_text(model%thickness, 4)
    if (allocated(model%node_thickness)) text = text//" to "//to_text(model%largest_thickness(), 4)
  end function thickness_range

  !> Log the totals of the run.
  subroutine conclude(log, summary)
    type(log_t), intent(inout) :: log
    type(run_summary_t), intent(in) :: summary

    type(phase_summary_t) :: total
    character(len=:), allocatable :: linear
    integer :: i

    ! A direct solver has no iterations.
    total = summary%total()
    linear = ""
    if (total%solver_iterations > 0) linear = "; "//to_text(total%solver_iterations)// &
        " iterations of the linear solver"
    call log%say(to_text(summary%increments)//" increments, "//to_text(total%retries)// &
        " cut back; "//to_text(total%iterations)//" iterations"//linear//"; "// &
        to_text(summary%seconds, 3)//" s")
    call log%note("time by section, s:")
    do i = 1, size(section_names)
      call log%note("  "//section_names(i)//" "//to_text(summary%profile%seconds(i), 4))
    end do
  end subroutine conclude

end module dd3_app_run
