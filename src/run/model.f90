! SPDX-License-Identifier: GPL-3.0-or-later
!> Run of a job, phase by phase, with its records.
module dd3_run_model
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : profile_t, wall_time
  use dd3_base_error, only : error_t, keep_first
  use dd3_base_interrupt, only : interrupted
  use dd3_base_log, only : log_t
  use dd3_base_message, only : message_list_t
  use dd3_base_ranks, only : largest_over_ranks, n_ranks
  use dd3_base_text, only : axis_name, to_text
  use dd3_input_case, only : case_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  use dd3_linalg_solver_registry, only : solver_names
  use dd3_model_mesh_change, only : count_levels, mesh_change_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_run_summary, only : run_summary_t
  use dd3_process_phase_end, only : next_output_progress, phase_is_over
  use dd3_process_phase_start, only : begin_phase, check_returns, place_supports, &
      return_tools
  use dd3_process_predictor, only : new_prediction
  use dd3_process_taken_over, only : balance_sheet, take_up
  use dd3_report_refinement_warnings, only : late_warning
  use dd3_report_limits_reached, only : has_limits, largest_limits, limit_warnings, limits_t
  use dd3_report_phase_warnings, only : end_notes, start_notes
  use dd3_run_adaptivity, only : most_returns, new_adaptivity
  use dd3_run_data, only : run_t
  use dd3_run_increment, only : run_increment, set_interruption, write_increment
  use dd3_run_phase_closing, only : close_phase
  use dd3_run_pin_load, only : observe_pins
  use dd3_run_thread_choice, only : new_thread_choice
  use dd3_settings_solver, only : solver_spec_t
  use dd3_system_system, only : new_system
  implicit none
  private
  public :: run_model, run_start_t, solver_options

  !> Initial data of a run.
  type :: run_start_t
    !> Initial state, or that of a restart.
    type(state_t) :: state
    !> Restart file, and folder of the records to be continued; not allocated if a new run starts.
    character(len=:), allocatable :: restart, source
    !> Settings of the linear solver.
    type(solver_spec_t) :: solver
    integer :: threads = 1
    !> What has been done to the sheet before, a line each.
    character(len=:), allocatable :: sheet_report
    !> Folder of the results; it exists.
    character(len=:), allocatable :: directory
  end type run_start_t

contains

  !> Run a model from a state to the end of its last phase. The records are complete also if the run
  !> stops before.
  subroutine run_model(model, case, start, solver, log, summary, error)
    !> Its mesh may be refined.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Its state is released.
    type(run_start_t), intent(inout) :: start
    !> Linear solver, as `find_job_size` returns it; moved into the run.
    class(linear_solver_t), allocatable, intent(inout) :: solver
    type(log_t), intent(inout) :: log
    type(run_summary_t), intent(out) :: summary
    !> Set if the run stopped before the end.
    type(error_t), allocatable, intent(out) :: error

    type(run_t) :: run
    character(len=:), allocatable :: note
    real(wp) :: began
    integer :: number, stressed(1)

    began = wall_time()
    call new_thread_choice(run%threads, start%threads)
    run%committed = start%state
    start%state = state_t()
    if (run%committed%begun) call place_supports(model, run%committed%phase, run%committed%start%x)
    call summary%start(size(model%phase), run%committed)
    run%summary = summary
    run%options = solver_options(start)
    call new_system(run%stepper%system, model, run%options, error, solver)
    if (allocated(error)) return
    call log%note("linear solver: "//trim(run%stepper%system%solver%description))
    if (model%part%divided) call log%note(model%part%report())
    call new_prediction(run%stepper%prediction, model)
    call new_adaptivity(run%adaptivity, model, case%adaptive)
    stressed = merge(1, 0, any(abs(run%committed%sheet%stress) > 0.0_wp))
    call largest_over_ranks(1, stressed)
    if (.not. run%committed%begun .and. stressed(1) > 0) then
      call balance_sheet(model, run%stepper%system, run%committed, note, error)
      if (allocated(error)) return
      call log%report("N106", note)
    end if
    call open_records(run, model, start, log, error)
    if (.not. allocated(error)) then
      call run%progress%start(model)
      do number = run%committed%phase, size(model%phase)
        log%phase = model%phase(number)%name
        run%summary%phase(number)%state = "running"
        call run_phase(run, model, case, number, log, error)
        call run%summary%phase(number)%finish(run%committed, error)
        if (allocated(error)) exit
      end do
      call run%progress%finish(log)
      call run%records%close(model, run%committed, error)
    end if
    call run%stepper%system%solver%release()
    summary = run%summary
    summary%profile = run%stepper%system%profile
    summary%seconds = wall_time() - began
  end subroutine run_model

  !> Return the options of the linear solver. Several ranks need one that works on distributed
  !> matrices.
  type(solver_options_t) function solver_options(start)
    type(run_start_t), intent(in) :: start

    character(len=16), allocatable :: distributed(:)

    solver_options%method = start%solver%method
    distributed = solver_names(distributed=.true.)
    if (n_ranks() > 1 .and. solver_options%method == "auto") solver_options%method = distributed(1)
    solver_options%ilu_level = start%solver%ilu_level
    solver_options%tolerance = start%solver%tolerance
    solver_options%iterations = start%solver%iterations
    solver_options%ordering = start%solver%ordering
    solver_options%threads = start%threads
    solver_options%keeps_matrix = n_ranks() == 1
    if (start%solver%factors == "disk") solver_options%factor_folder = start%directory
  end function solver_options

  !> Open the records, or continue those of a restart.
  subroutine open_records(run, model, start, log, error)
    type(run_t), intent(inout) :: run
    type(model_t), intent(in) :: model
    type(run_start_t), intent(in) :: start
    type(log_t), intent(inout) :: log
    !> Set if a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    character(len=:), allocatable :: lost

    if (allocated(start%source)) then
      call run%records%resume(model, start%source, start%directory, run%committed, lost, error)
      log%increment = run%committed%increment
      call log%say("restart after increment "//to_text(run%committed%increment)//" of phase '"// &
          model%phase(run%committed%phase)%name//"'")
      if (len(lost) > 0) call log%report("W101", "these records begin at the restart, as those "// &
          "of the earlier run are missing or have other columns:"//lost// &
          "; earlier files in the folder are kept as *.until_<increment>")
    else
      call run%records%open(model, start%directory, run%committed, error)
    end if
    run%trial = run%committed
    run%limits = largest_limits(model, run%committed)
  end subroutine open_records

  !> Run one phase to its end.
  subroutine run_phase(run, model, case, number, log, error)
    type(run_t), intent(inout) :: run
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Number of the phase; a restart continues in the middle of it.
    integer, intent(in) :: number
    type(log_t), intent(inout) :: log
    !> Set if the run stopped.
    type(error_t), allocatable, intent(out) :: error

    type(error_t), allocatable :: late
    type(message_list_t) :: notes
    real(wp) :: next_output
    logical :: ended
    integer :: done

    associate (committed => run%committed)
      if (.not. committed%begun .or. committed%phase /= number) then
        call return_tools(model, number, committed)
        call check_returns(model, number, committed, error)
        if (allocated(error)) return
        call place_supports(model, number, committed%x)
        call begin_phase(model, number, committed)
        call start_notes(model, committed, notes)
        call tell_all(log, notes)
      end if
      do while (.not. phase_is_over(model, committed))
        call adapt(run, model, case, log, error)
        if (allocated(error)) exit
        next_output = next_output_progress(model%output, model%phase(number), committed)
        done = committed%increment
        call run_increment(run, model, error)
        call note_solution(run, model, log)
        if (committed%increment > done) then
          call observe_pins(case, model, committed)
          call write_increment(run, model, next_output, log, late)
          call tell_limits(run, model, log)
          call keep_first(error, late)
        end if
        if (allocated(error)) exit
        if (.not. interrupted()) cycle
        call set_interruption(committed, error)
        exit
      end do
      ended = .not. allocated(error)
      call end_notes(model, committed, ended, case%adaptive, notes)
      if (ended) call close_phase(model, case, committed, run%summary, notes)
      call tell_all(log, notes)
      if (ended) call run%records%write_phase_end(model, committed, error)
    end associate
  end subroutine run_phase

  !> Divide the elements that need it before the next increment, and take up the computation on the
  !> finer sheet. The forces that are out of balance then are brought into balance by the increment.
  subroutine adapt(run, model, case, log, error)
    type(run_t), intent(inout) :: run
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(log_t), intent(inout) :: log
    !> Set if the sheet cannot be refined.
    type(error_t), allocatable, intent(out) :: error

    type(profile_t) :: profile
    logical, allocatable :: marked(:)
    integer :: level, before
    logical :: again
    real(wp) :: imbalance

    again = run%adaptivity%returns > 0
    do level = 1, max(1, run%adaptivity%spec%levels)
      call run%adaptivity%find_marks(model, run%committed, marked)
      if (.not. any(marked)) return
      before = model%n_element
      call run%records%keep_state(model, run%committed, error)
      if (allocated(error)) return
      call run%adaptivity%refine(case, marked, model, run%committed, error)
      if (allocated(error)) return
      if (model%n_element == before) return
      call place_supports(model, run%committed%phase, run%committed%start%x)
      profile = run%stepper%system%profile
      call run%stepper%system%solver%release()
      call new_system(run%stepper%system, model, run%options, error)
      if (allocated(error)) return
      run%stepper%system%profile = profile
      call new_prediction(run%stepper%prediction, model)
      call take_up(model, run%stepper%system, run%committed, imbalance, error)
      if (allocated(error)) return
      run%trial = run%committed
      call add_change(model, run%committed, before, imbalance, again)
      call log%say(model%change(size(model%change))%report(log%phase, &
          model%phase(run%committed%phase)%control > 0))
      if (model%part%divided) call log%note(model%part%report())
    end do
  end subroutine adapt

  !> Add a refinement to the list of the model.
  subroutine add_change(model, state, before, imbalance, repeats)
    type(model_t), intent(inout) :: model
    !> State on the refined sheet.
    type(state_t), intent(in) :: state
    !> Number of elements before.
    integer, intent(in) :: before
    !> Norm of the forces out of balance over that of the internal forces.
    real(wp), intent(in) :: imbalance
    !> Whether the next increment is made again.
    logical, intent(in) :: repeats

    type(mesh_change_t), allocatable :: change(:)

    if (allocated(model%change)) then
      change = model%change
    else
      allocate (change(0))
    end if
    model%change = [change, mesh_change_t(state%phase, state%increment, state%progress, &
        state%travel, before, model%n_element, count_levels(model%level), imbalance, repeats)]
  end subroutine add_change

  !> Log a change of the number of threads, elements that are divided too late, and the first pivot
  !> that was perturbed.
  subroutine note_solution(run, model, log)
    type(run_t), intent(inout) :: run
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log

    if (run%threads%news /= "") call log%note(trim(run%threads%news))
    run%threads%news = ""
    call log%report("W117", late_warning(run%adaptivity%n_late, run%adaptivity%late_turn, &
        most_returns))
    associate (perturbed => run%stepper%attempt%solver%perturbed)
      if (run%told_perturbed .or. perturbed%blocks == 0) return
      run%told_perturbed = .true.
      if (perturbed%row == 0) then
        call log%report("W114", &
            "linear system: "//to_text(perturbed%blocks)//" pivots vanished "// &
            "and were perturbed; the solver does not tell which")
      else
        call log%report("W114", "linear system: the pivot of "//row_name(model, perturbed%row)// &
            " along "//axis_name(perturbed%component)//" vanished and was perturbed")
      end if
    end associate
  end subroutine note_solution

  !> Return the name of a block row of the reduced system.
  function row_name(model, row) result(name)
    type(model_t), intent(in) :: model
    integer, intent(in) :: row
    character(len=:), allocatable :: name

    if (row <= model%n_node) then
      name = "node "//to_text(row)
    else
      name = "tool '"//trim(model%tool(findloc(model%tool_row, row, 1))%name)//"'"
    end if
  end function row_name

  !> Warn of a limit of the sheet that is reached for the first time.
  subroutine tell_limits(run, model, log)
    type(run_t), intent(inout) :: run
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log

    type(message_list_t) :: notes
    type(limits_t) :: now

    if (.not. has_limits(model)) return
    now = largest_limits(model, run%committed)
    call limit_warnings(model, run%committed, run%limits, now, notes)
    call tell_all(log, notes)
    run%limits = now
  end subroutine tell_limits

  !> Log notes and warnings.
  subroutine tell_all(log, notes)
    type(log_t), intent(inout) :: log
    type(message_list_t), intent(in) :: notes

    integer :: i

    do i = 1, notes%count
      call log%tell(notes%item(i))
    end do
  end subroutine tell_all

end module dd3_run_model
