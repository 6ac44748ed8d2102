!> One job from the options to the exit code.
module dd3_app_job
  use, intrinsic :: iso_c_binding, only : c_int
  use, intrinsic :: iso_fortran_env, only : output_unit, error_unit
  use dd3_app_command_line, only : options_t
  use dd3_app_memory, only : watch_log
  use dd3_app_overwrite, only : check_overwrite, result_file
  use dd3_app_warnings, only : unit_warnings
  use dd3_base_clock, only : section_names
  use dd3_base_error, only : error_list_t, error_t, fatal_error, share_error
  use dd3_base_file, only : folder_of, make_directory, remove_file
  use dd3_base_file_system, only : part_of, read_file
  use dd3_base_interrupt, only : watch_interrupts
  use dd3_base_kinds, only : wp
  use dd3_base_log, only : log_t
  use dd3_base_ranks, only : largest_over_ranks, n_ranks, rank_of_smallest, this_rank
  use dd3_base_text, only : text_t, to_text, slice
  use dd3_base_threads, only : most_threads
  use dd3_base_version, only : version => program_version
  use dd3_input_case, only : case_t
  use dd3_input_echo, only : echo_case
  use dd3_input_reader, only : read_case
  use dd3_linalg_solver, only : linear_solver_t
  use dd3_model_build, only : new_model
  use dd3_model_settings_report, only : contact_report, drawbead_report, limits_report
  use dd3_model_materials, only : law_sources
  use dd3_model_model, only : model_t
  use dd3_model_state, only : new_state
  use dd3_model_tool_report, only : tool_report
  use dd3_output_fields, only : field_record_t
  use dd3_output_restart, only : read_restart
  use dd3_point_run, only : run_points
  use dd3_process_job_size, only : find_job_size, job_size_t, memory_warning, size_report
  use dd3_process_run, only : run_model, run_start_t, run_summary_t, solver_options
  implicit none
  private
  public :: run_job
  public :: exit_end, exit_usage

  !> Exit codes: reached the end, usage, errors in the input, stopped before the end.
  integer, parameter :: exit_end = 0, exit_usage = 1, exit_input = 2, exit_stopped = 3
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
    logical :: wrong

    call read_case(case, options%file, options%overrides, errors)
    call new_model(model, case, errors)
    if (errors%count == 0) call check_overwrite(case, results_directory(options, case), &
        options%restart, errors)
    call share_errors(errors, options%file, wrong)
    if (wrong) then
      exit_code = exit_input
      ! The picture shows what is wrong about the place of a tool.
      if (options%initial == "" .or. .not. allocated(model%history)) return
      call set_start(start, options, case, model, error)
      if (.not. allocated(error)) call write_initial(options%initial, case, model, start, error)
      if (allocated(error)) call write_line("dd3imp: "//error%message)
      return
    end if
    call set_start(start, options, case, model, error)
    if (allocated(error)) then
      call write_line("dd3imp: "//error%message)
      exit_code = exit_input
    else if (options%check) then
      if (.not. options%quiet) call show_checked(case, model, start)
      if (options%initial /= "") call write_initial(options%initial, case, model, start, error)
      exit_code = merge(exit_stopped, exit_end, allocated(error))
      if (allocated(error)) call write_line("dd3imp: "//error%message)
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
  subroutine set_start(start, options, case, model, error)
    type(run_start_t), intent(out) :: start
    type(options_t), intent(in) :: options
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Set if the restart file cannot be used.
    type(error_t), allocatable, intent(out) :: error

    start%solver = case%solver
    start%threads = options%threads
    if (start%threads == 0) start%threads = most_threads()
    start%reproducible = options%reproducible
    start%directory = results_directory(options, case)
    if (size(case%point) > 0) then
      if (options%restart /= "") call fatal_error(error, "a run of material points (*POINT) "// &
          "has no restart")
    else if (options%restart == "") then
      call new_state(start%state, model)
    else
      start%source = folder_of(options%restart)
      call read_restart(options%restart, model, start%state, error)
    end if
    if (.not. allocated(error)) call check_ranks(case, error)
    call share_error(error)
  end subroutine set_start

  !> Check that several ranks can run the job.
  subroutine check_ranks(case, error)
    type(case_t), intent(in) :: case
    type(error_t), allocatable, intent(out) :: error

    if (n_ranks() == 1) return
    if (size(case%point) > 0) then
      call fatal_error(error, "a run of material points (*POINT) needs one process, got "// &
          to_text(n_ranks()))
    else if (case%solver%method /= "auto" .and. index(case%solver%method, "petsc") /= 1) then
      call fatal_error(error, "method = "//case%solver%method//" of *SOLVER needs one process, "// &
          "got "//to_text(n_ranks())//"; expected auto, petsc_mumps or petsc_bicgstab")
    end if
  end subroutine check_ranks

  !> Print all values and warnings.
  subroutine show_checked(case, model, start)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start

    type(job_size_t) :: job
    class(linear_solver_t), allocatable :: solver
    type(error_t), allocatable :: ignored
    type(text_t), allocatable :: warnings(:)
    integer :: i

    if (this_rank() > 0) return
    write (output_unit, '(a)', advance="no") echo_case(case)//tool_report(model)// &
        contact_report(model)//limits_report(model)//drawbead_report(model)
    if (size(case%point) == 0) then
      call find_job_size(job, model, start%state, solver_options(start), solver, ignored)
      if (allocated(solver)) call solver%release()
      write (output_unit, '(a)', advance="no") size_report(job)
      if (len(memory_warning(job)) > 0) write (output_unit, '(a)') memory_warning(job)
    end if
    call unit_warnings(case, model, warnings)
    do i = 1, size(warnings)
      write (output_unit, '(a)') warnings(i)%s
    end do
    write (output_unit, '(a)') "checked: "//case%file
  end subroutine show_checked

  !> Write the state from which a run would start, for a picture of the sheet and the tools.
  subroutine write_initial(directory, case, model, start, error)
    !> Made if it does not exist; it must hold no results.
    character(len=*), intent(in) :: directory
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(field_record_t) :: fields
    logical :: there
    integer :: i

    if (size(case%point) > 0) then
      call fatal_error(error, "material points (*POINT) have no fields")
      return
    end if
    if (this_rank() > 0) return
    call make_directory(directory, error)
    do i = 1, size(result_file)
      if (allocated(error)) return
      inquire (file=directory//"/"//trim(result_file(i)), exist=there)
      if (there) call fatal_error(error, "'"//directory//"' holds results of a run; --initial "// &
          "needs a folder without")
    end do
    if (.not. allocated(error)) call fields%open(model, directory, error)
    if (.not. allocated(error)) call fields%write(model, start%state, error)
    if (.not. allocated(error)) call fields%close(error)
  end subroutine write_initial

  !> Run a job whose input has no errors.
  subroutine run_checked(options, start, case, model, exit_code)
    type(options_t), intent(in) :: options
    type(run_start_t), intent(in) :: start
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> One of the `exit_*` values.
    integer, intent(out) :: exit_code

    type(log_t) :: log
    class(linear_solver_t), allocatable :: solver
    type(run_summary_t) :: summary
    type(error_t), allocatable :: error

    call watch_interrupts()
    call log%start(options%quiet)
    call log%say("dd3imp "//version//": "//case%file)
    if (this_rank() == 0) call make_directory(start%directory, error)
    if (.not. allocated(error)) call open_log(log, options%quiet, start, error)
    call share_error(error)
    if (.not. allocated(error)) then
      call watch_log(log%descriptor())
      call introduce(log, case, model)
      if (.not. allocated(start%source)) call clear_directory(log, start%directory)
      if (size(case%point) > 0) then
        call run_points(case, model, start%directory, log, summary%increments, error)
      else
        call log_size(log, model, start, solver)
        call run_model(model, start, solver, log, summary, error)
        call conclude(log, summary)
      end if
      ! A run whose folder has vanished has no results.
      if (.not. allocated(error)) call log%check(error)
      call share_error(error)
    end if
    exit_code = merge(exit_stopped, exit_end, allocated(error))
    if (allocated(error)) then
      call log%note("stopped: "//error%message)
      call write_line("dd3imp: stopped: "//error%message)
    else
      call log%say("reached the end; results in "//start%directory)
    end if
    call watch_log(-1_c_int)
    call log%close(error)
    if (.not. allocated(error)) return
    if (exit_code == exit_end) call write_line("dd3imp: "//error%message)
    exit_code = exit_stopped
  end subroutine run_checked

  !> Write a line that all ranks know on the error stream.
  subroutine write_line(text)
    character(len=*), intent(in) :: text

    if (this_rank() == 0) call put_line(text)
  end subroutine write_line

  !> Write a line on the error stream, which may be closed.
  subroutine put_line(text)
    character(len=*), intent(in) :: text

    integer :: ignored

    write (error_unit, '(a)', iostat=ignored) text
  end subroutine put_line

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
  subroutine clear_directory(log, directory)
    type(log_t), intent(inout) :: log
    character(len=*), intent(in) :: directory

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
    if (names /= "") call log%note("removed from an earlier run:"//names)
  end subroutine clear_directory

  !> Log title, sizes and laws; the echo of all values goes into the file only.
  subroutine introduce(log, case, model)
    type(log_t), intent(inout) :: log
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model

    type(text_t), allocatable :: warnings(:)
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
        to_text(model%n_contact)//" candidates for contact with "//to_text(model%n_tool)//" tools")
    end if
    do i = 1, size(case%mesh)
      call log%say("mesh of "//case%mesh(i)%file//": thickness from z_min to z_max "// &
          thickness_range(model)//" mm")
    end do
    call unit_warnings(case, model, warnings)
    do i = 1, size(warnings)
      call log%say(warnings(i)%s)
    end do
    call log%note(echo_case(case)//tool_report(model)//contact_report(model)// &
        limits_report(model)//drawbead_report(model))
    do i = 1, size(model%material)
      call log%note(law_sources(model%material_name(i), model%material(i)))
      if (.not. model%material(i)%laws%criterion%convexity_waived) cycle
      call log%say("warning: material "//trim(model%material_name(i))// &
          ": its yield surface is taken though it may not be convex")
    end do
  end subroutine introduce

  !> Log the size of the job, and a warning if it needs too much memory.
  subroutine log_size(log, model, start, solver)
    type(log_t), intent(inout) :: log
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start
    !> See `find_job_size`.
    class(linear_solver_t), allocatable, intent(out) :: solver

    type(job_size_t) :: job
    type(error_t), allocatable :: error

    call find_job_size(job, model, start%state, solver_options(start), solver, error)
    if (allocated(error)) return
    call log%note(size_report(job))
    if (len(memory_warning(job)) > 0) call log%say(memory_warning(job))
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

    character(len=:), allocatable :: linear
    integer :: i

    ! A direct solver has no iterations.
    linear = ""
    if (summary%solver_iterations > 0) linear = "; "//to_text(summary%solver_iterations)// &
        " iterations of the linear solver"
    call log%say(to_text(summary%increments)//" increments, "//to_text(summary%retries)// &
        " cut back; "//to_text(summary%iterations)//" iterations"//linear//"; "// &
        to_text(summary%seconds, 3)//" s")
    call log%note("time by section, s:")
    do i = 1, size(section_names)
      call log%note("  "//section_names(i)//" "//to_text(summary%profile%seconds(i), 4))
    end do
  end subroutine conclude

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
