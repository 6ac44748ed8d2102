! SPDX-License-Identifier: GPL-3.0-or-later
!> An increment of a run: its attempts, with their rows of status.csv, and the records of the state
!> that is accepted.
module dd3_run_increment
  use dd3_base_kinds, only : wp
  use dd3_base_cause_text, only : cause_code, cause_text
  use dd3_base_clock, only : processor_time, section_output, wall_time
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_interrupt, only : interrupted, interruption, interruption_code
  use dd3_base_log, only : log_t
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_converged, verdict_retry, verdict_t, &
      cause_beyond_until, cause_no_progress
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_progress, only : progress_view_t
  use dd3_output_status, only : status_row_t
  use dd3_process_increment, only : accept_increment, prepare_increment, try_increment
  use dd3_process_phase_end, only : progress_tolerance, until_fraction
  use dd3_process_step_control, only : cut_back, makes_progress, return_to_until
  use dd3_report_attempt_report, only : failure_message, status_row
  use dd3_report_tool_depth, only : observe_tools
  use dd3_run_data, only : run_t
  implicit none
  private
  public :: run_increment, set_interruption, write_increment

contains

  !> Make one increment in as many attempts as allowed. A converged one is accepted even if its row
  !> of status.csv cannot be written.
  subroutine run_increment(run, model, error)
    type(run_t), intent(inout) :: run
    type(model_t), intent(in) :: model
    !> Set if the increment failed.
    type(error_t), allocatable, intent(out) :: error

    type(status_row_t) :: row
    real(wp) :: began, processor
    logical :: predicted, again, too_late

    too_late = .false.
    associate (stepper => run%stepper, attempt => run%stepper%attempt, &
        phase => model%phase(run%committed%phase), totals => run%summary%phase(run%committed%phase))
      began = wall_time()
      processor = processor_time()
      call prepare_increment(model, run%committed, stepper)
      predicted = attempt%verdict%outcome == verdict_converged
      if (predicted .and. .not. makes_progress(attempt, stepper%prediction%progress)) then
        attempt%verdict%cause = cause_no_progress
        call fatal_error(error, failure_message(model, run%committed, stepper), &
            cause_code(attempt%verdict))
        return
      end if
      do
        if (predicted) call try_increment(model, run%committed, run%trial, stepper)
        if (interrupted() .and. attempt%verdict%outcome /= verdict_converged) then
          call set_interruption(run%committed, error)
          return
        end if
        row = status_row(model, run%committed, stepper)
        row%seconds = wall_time() - began
        call run%threads%record(row%seconds, processor_time() - processor, row%iterations)
        began = wall_time()
        processor = processor_time()
        again = .false.
        if (predicted .and. phase%newton%cutback &
            .and. attempt%verdict%outcome == verdict_retry) then
          call cut_back(attempt, again)
        end if
        if (attempt%verdict%outcome == verdict_converged) then
          call return_to_until(attempt, until_fraction(phase, run%committed, run%trial), again)
          if (again) row%reason = cause_text(verdict_t(cause=cause_beyond_until), "")
        end if
        if (again) again = makes_progress(attempt, stepper%prediction%progress)
        if (attempt%verdict%outcome == verdict_converged .and. .not. again) then
          call run%adaptivity%judge(model, run%trial, too_late)
        end if
        if (too_late) row%outcome = "refined"
        if (again) row%outcome = "retry"
        call run%records%add_attempt(row, error)
        call totals%add(row)
        if (allocated(error) .or. .not. again) exit
        if (attempt%verdict%outcome /= verdict_converged) totals%retries = totals%retries + 1
      end do
      if (too_late) return
      if (attempt%verdict%outcome == verdict_converged .and. .not. again) then
        call accept_increment(model, run%trial, stepper, run%committed)
        run%summary%increments = run%committed%increment
      else if (.not. allocated(error)) then
        call fatal_error(error, failure_message(model, run%committed, stepper), &
            cause_code(attempt%verdict))
      end if
    end associate
  end subroutine run_increment

  !> Set the error of a run that was interrupted.
  subroutine set_interruption(committed, error)
    type(state_t), intent(in) :: committed
    type(error_t), allocatable, intent(out) :: error

    call fatal_error(error, interruption()//" after increment "//to_text(committed%increment), &
        interruption_code)
  end subroutine set_interruption

  !> Write an accepted increment to the records and show it.
  subroutine write_increment(run, model, next_output, log, error)
    type(run_t), intent(inout) :: run
    type(model_t), intent(in) :: model
    !> Progress of the phase at which fields were due.
    real(wp), intent(in) :: next_output
    type(log_t), intent(inout) :: log
    !> Set if a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(progress_view_t) :: view

    call run%stepper%system%profile%start()
    call observe_tools(model, run%committed)
    log%increment = run%committed%increment
    associate (state => run%committed, phase => model%phase(run%committed%phase), &
        attempt => run%stepper%attempt)
      call run%records%write_increment(model, state, &
          state%progress >= next_output - progress_tolerance, error)
      if (allocated(error)) return
      view%phase = state%phase
      view%progress = state%progress
      view%travel = state%travel
      view%increment = state%increment
      if (run%adaptivity%spec%levels > 0) view%elements = model%n_element
      view%r = attempt%limit%r
      view%limiter = trim(attempt%limit%limiter)
      view%iterations = size(attempt%course%norm)
      if (phase%control > 0) view%force = &
          dot_product(-phase%direction(:, phase%control), state%tools%force(:, phase%control))
      call run%progress%update(log, view)
    end associate
    call run%stepper%system%profile%add(section_output)
  end subroutine write_increment

end module dd3_run_increment
