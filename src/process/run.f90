!> The run of a job: phase by phase, increment by increment, with its records.
module dd3_process_run
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : wall_time, profile_t, section_output
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_log, only : log_t
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_contact_operator, only : status_gap, status_slip, status_stick
  use dd3_input_case, only : solver_spec_t
  use dd3_linalg_solver, only : solver_options_t
  use dd3_model_initial, only : new_initial_state
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_output_fields, only : field_record_t
  use dd3_output_history, only : history_record_t
  use dd3_output_interrupt, only : interrupted
  use dd3_output_progress, only : progress_t, progress_view_t
  use dd3_output_status, only : status_record_t, status_row_t
  use dd3_process_increment, only : accept_increment, new_stepper, prepare_increment, &
      shrink_increment, stepper_t, try_increment
  use dd3_process_stage, only : begin_phase, next_output_progress, phase_is_over, progress_tolerance
  use dd3_process_stage_warnings, only : press_warning, release_warning, support_warning
  use dd3_system_system, only : new_system
  implicit none
  private
  public :: run_model, run_summary_t

  !> What a run came to.
  type :: run_summary_t
    !> Accepted increments, iterations of the corrector and of the linear solver, failed attempts.
    integer :: increments = 0, iterations = 0, solver_iterations = 0, retries = 0
    !> Wall-clock time, s.
    real(wp) :: seconds = 0.0_wp
    !> Where the time went.
    type(profile_t) :: profile
  end type run_summary_t

  !> Everything a run holds.
  type :: run_t
    !> The committed and the trial state.
    type(state_t) :: committed, trial
    !> The maker of increments.
    type(stepper_t) :: stepper
    !> Records.
    type(history_record_t) :: history
    !> See above.
    type(status_record_t) :: status
    !> See above.
    type(field_record_t) :: fields
    !> The live display.
    type(progress_t) :: progress
    !> The sums.
    type(run_summary_t) :: summary
  end type run_t

contains

  !> Runs a model to the end of its last phase, or says why it stopped; the records are whole either
  !> way.
  subroutine run_model(model, solver, threads, directory, log, summary, error)
    !> The model.
    type(model_t), intent(in) :: model
    !> The linear solver, as the case wants it.
    type(solver_spec_t), intent(in) :: solver
    !> Number of threads.
    integer, intent(in) :: threads
    !> The directory of the results; it exists.
    character(len=*), intent(in) :: directory
    !> Where the run speaks.
    type(log_t), intent(inout) :: log
    !> What it came to.
    type(run_summary_t), intent(out) :: summary
    !> Set where the run stopped before the end.
    type(error_t), allocatable, intent(out) :: error

    type(run_t) :: run
    real(wp) :: began
    integer :: number

    began = wall_time()
    call new_initial_state(run%committed, model)
    call new_initial_state(run%trial, model)
    call new_system(run%stepper%system, model, solver_options(solver), threads, error)
    if (allocated(error)) return
    call log%note("linear solver: "//trim(run%stepper%system%solver%description))
    call new_stepper(run%stepper, model)
    call open_records(run, model, directory, error)
    if (.not. allocated(error)) then
      call run%progress%start(model)
      do number = 1, size(model%phase)
        call run_phase(run, model, number, log, error)
        if (allocated(error)) exit
      end do
      call run%progress%finish(log)
      call close_records(run, model, error)
    end if
    call run%stepper%system%solver%release()
    summary = run%summary
    summary%profile = run%stepper%system%profile
    summary%seconds = wall_time() - began
  end subroutine run_model

  !> The linear solver's options from the case's.
  pure type(solver_options_t) function solver_options(solver)
    !> As the case wants it.
    type(solver_spec_t), intent(in) :: solver

    solver_options%method = solver%method
    solver_options%ilu_level = solver%ilu_level
    solver_options%tolerance = solver%tolerance
    solver_options%iterations = solver%iterations
    solver_options%ordering = solver%ordering
  end function solver_options

  !> Opens the records and writes the initial state.
  subroutine open_records(run, model, directory, error)
    !> The run.
    type(run_t), intent(inout) :: run
    !> The model.
    type(model_t), intent(in) :: model
    !> The directory.
    character(len=*), intent(in) :: directory
    !> Why a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call run%history%open(model, directory, error)
    if (.not. allocated(error)) call run%status%open(directory, error)
    if (.not. allocated(error)) call run%fields%open(model, directory, error)
    if (.not. allocated(error)) call run%history%write(model, run%committed, error)
    if (.not. allocated(error)) call run%fields%write(model, run%committed, error)
  end subroutine open_records

  !> Writes the last state and closes the records; the first error of all is kept.
  subroutine close_records(run, model, error)
    !> The run.
    type(run_t), intent(inout) :: run
    !> The model.
    type(model_t), intent(in) :: model
    !> Why the run stopped, or why a record cannot be closed.
    type(error_t), allocatable, intent(inout) :: error

    type(error_t), allocatable :: late

    call run%fields%write(model, run%committed, late)
    call keep_first(error, late)
    call run%history%close(late)
    call keep_first(error, late)
    call run%status%close(late)
    call keep_first(error, late)
    call run%fields%close(late)
    call keep_first(error, late)
  end subroutine close_records

  !> Keeps the first error of two.
  subroutine keep_first(error, late)
    !> The first, where there is one.
    type(error_t), allocatable, intent(inout) :: error
    !> The other.
    type(error_t), allocatable, intent(inout) :: late

    if (.not. allocated(error)) call move_alloc(late, error)
  end subroutine keep_first

  !> Runs one phase to its end.
  subroutine run_phase(run, model, number, log, error)
    !> The run.
    type(run_t), intent(inout) :: run
    !> The model.
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> Where the run speaks.
    type(log_t), intent(inout) :: log
    !> Why it stopped.
    type(error_t), allocatable, intent(out) :: error

    type(phase_t) :: phase
    real(wp), allocatable :: strain_before(:, :)
    type(error_t), allocatable :: late
    real(wp) :: next_output
    integer :: done

    strain_before = run%committed%internal(1, :, :)
    call begin_phase(model, number, phase, run%committed)
    call say_if_any(log, press_warning(model, phase, run%committed))
    call say_if_any(log, support_warning(model, phase, run%committed))
    if (phase_is_over(phase, run%committed)) call log%say("phase '"//phase%name &
        //"' has no increment: its early end is there from the start")
    do while (.not. phase_is_over(phase, run%committed))
      next_output = next_output_progress(model, phase, run%committed)
      done = run%committed%increment
      call run_increment(run, model, phase, next_output, error)
      if (run%committed%increment > done) then
        call write_increment(run, model, phase, next_output, log, late)
        call keep_first(error, late)
      end if
      if (allocated(error)) return
      if (interrupted()) then
        call fatal_error(error, "interrupted by the user after increment " &
            //to_text(run%committed%increment))
        return
      end if
    end do
    call say_if_any(log, release_warning(phase, strain_before, run%committed))
    call run%fields%write(model, run%committed, error)
  end subroutine run_phase

  !> Says a text that is not empty.
  subroutine say_if_any(log, text)
    !> Where it is said.
    type(log_t), intent(inout) :: log
    !> The text.
    character(len=*), intent(in) :: text

    if (len(text) > 0) call log%say(text)
  end subroutine say_if_any

  !> One increment with as many attempts as it takes. One that converged is done, even where its row
  !> of status.csv cannot be written any more.
  subroutine run_increment(run, model, phase, next_output, error)
    !> The run.
    type(run_t), intent(inout) :: run
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> Progress of the phase at the next output.
    real(wp), intent(in) :: next_output
    !> Why the increment failed.
    type(error_t), allocatable, intent(out) :: error

    type(verdict_t) :: verdict
    type(status_row_t) :: row
    real(wp) :: began
    logical :: predicted, again

    began = wall_time()
    call prepare_increment(run%stepper, model, phase, run%committed, next_output, verdict)
    predicted = verdict%outcome == verdict_converged
    do
      if (predicted) &
        call try_increment(run%stepper, model, phase, run%committed, run%trial, verdict)
      row = status_row(run, phase, verdict)
      row%seconds = wall_time() - began
      began = wall_time()
      again = .false.
      if (predicted .and. verdict%outcome == verdict_retry) &
        call shrink_increment(run%stepper, phase, again)
      if (verdict%outcome == verdict_converged) then
        row%outcome = "accepted"
        row%reason = run%stepper%info%reason
      else
        row%outcome = trim(merge("retry ", "failed", again))
        row%reason = verdict%reason
      end if
      call run%status%add(row, error)
      run%summary%iterations = run%summary%iterations + row%iterations
      run%summary%solver_iterations = run%summary%solver_iterations + row%solver_iterations
      if (allocated(error) .or. .not. again) exit
      run%summary%retries = run%summary%retries + 1
    end do
    if (verdict%outcome == verdict_converged) then
      call accept_increment(run%stepper, run%trial, run%committed)
      run%summary%increments = run%committed%increment
    else if (.not. allocated(error)) then
      call fatal_error(error, failure_message(run, model, phase, verdict))
    end if
  end subroutine run_increment

  !> The row of status.csv for an attempt, but for its outcome.
  function status_row(run, phase, verdict) result(row)
    !> The run.
    type(run_t), intent(in) :: run
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> How the attempt ended.
    type(verdict_t), intent(in) :: verdict
    type(status_row_t) :: row

    associate (stepper => run%stepper)
      row%increment = run%committed%increment + 1
      row%attempt = stepper%attempt
      row%phase = phase%name
      row%travel = run%committed%travel + stepper%limit%r*stepper%prediction%progress*phase%length
      row%r = stepper%limit%r
      row%limiter = stepper%limit%name
      row%limiter_at = stepper%limit%at
      row%r_force = stepper%limit%r_force
      row%force_at = stepper%limit%force_at
      row%iterations = verdict%iterations
      associate (criterion => stepper%correction%criterion)
        if (size(criterion) > 0) row%criterion = criterion(size(criterion))
      end associate
      row%solver_iterations = stepper%info%iterations
      row%solver = stepper%info%solver(:len(row%solver))
      row%gap = count(stepper%system%contact%status == status_gap)
      row%stick = count(stepper%system%contact%status == status_stick)
      row%slip = count(stepper%system%contact%status == status_slip)
      if (stepper%correction%worst_node > 0) then
        row%worst = "node "//to_text(stepper%correction%worst_node)//" residual " &
          //to_text(stepper%correction%worst_residual, 3)//" N"
      end if
      if (verdict%element > 0) &
        row%worst = "element "//to_text(verdict%element)//" point "//to_text(verdict%point)
    end associate
  end function status_row

  !> What the user is told when an increment fails: where, and why.
  function failure_message(run, model, phase, verdict) result(message)
    !> The run.
    type(run_t), intent(in) :: run
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> How the last attempt ended.
    type(verdict_t), intent(in) :: verdict
    character(len=:), allocatable :: message

    message = "increment "//to_text(run%committed%increment + 1)//" of phase '"//phase%name &
      //"' (travel "//to_text(run%committed%travel)//" mm) did not converge"
    if (run%stepper%attempt > 1) &
      message = message//" in "//to_text(run%stepper%attempt)//" attempts"
    message = message//": "//trim(verdict%reason)
    if (verdict%element > 0) message = message//", element "//to_text(verdict%element) &
      //" point "//to_text(verdict%point)
    if (verdict%node == 0) return
    associate (x => run%committed%x(:, verdict%node))
      message = message//", node "//to_text(verdict%node)//" at "//to_text(x(1), 5)//" " &
        //to_text(x(2), 5)//" "//to_text(x(3), 5)//tool_text(run, model, verdict%node)
    end associate
  end function failure_message

  !> The tool a node touches, as a piece of a message.
  function tool_text(run, model, node) result(text)
    !> The run.
    type(run_t), intent(in) :: run
    !> The model.
    type(model_t), intent(in) :: model
    !> The node.
    integer, intent(in) :: node
    character(len=:), allocatable :: text

    integer :: c

    text = ""
    c = model%candidate_of(node)
    if (c == 0) return
    if (run%stepper%system%contact%tool(c) == 0) return
    text = ", tool "//model%tool(run%stepper%system%contact%tool(c))%name
  end function tool_text

  !> Writes an accepted increment into the records and shows it.
  subroutine write_increment(run, model, phase, next_output, log, error)
    !> The run.
    type(run_t), intent(inout) :: run
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> Progress of the phase at which fields were due.
    real(wp), intent(in) :: next_output
    !> Where the run speaks.
    type(log_t), intent(inout) :: log
    !> Why a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(progress_view_t) :: view
    logical :: due

    call run%stepper%system%profile%start()
    associate (state => run%committed)
      call run%history%write(model, state, error)
      if (allocated(error)) return
      due = state%progress >= next_output - progress_tolerance
      if (model%output%fields_increments > 0) &
        due = due .or. mod(state%increment, model%output%fields_increments) == 0
      if (due) call run%fields%write(model, state, error)
      if (allocated(error)) return
      view%phase = state%phase
      view%progress = state%progress
      view%travel = state%travel
      view%increment = state%increment
      view%r = run%stepper%limit%r
      view%limiter = run%stepper%limit%name
      view%iterations = size(run%stepper%correction%criterion)
      if (phase%control > 0) view%force = &
        dot_product(-phase%direction(:, phase%control), state%tool_force(:, phase%control))
      call run%progress%update(log, view)
    end associate
    call run%stepper%system%profile%add(section_output)
  end subroutine write_increment

end module dd3_process_run
