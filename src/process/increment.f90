!> One increment: predict, limit, correct; on failure, where allowed, once more from the committed
!> state with a smaller r.
module dd3_process_increment
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_model_loads, only : nodal_forces
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t, state_copy
  use dd3_process_corrector, only : clear_correction, correct, correction_t
  use dd3_process_limiters, only : limit_increment, limit_t
  use dd3_process_predictor, only : new_prediction, predict, prediction_t
  use dd3_process_stage, only : progress_tolerance
  use dd3_system_solve, only : solve_info_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: stepper_t, new_stepper, prepare_increment, try_increment, shrink_increment, &
      accept_increment

  !> Growth of the bound on r after a cut-back, at every success.
  real(wp), parameter :: growth_factor = 1.5_wp

  !> What an increment works on, and what the records want to know of it.
  type :: stepper_t
    !> Matrices and solver.
    type(system_t) :: system
    !> The trial increment.
    type(prediction_t) :: prediction
    !> The factor of this increment and the limiter it comes from.
    type(limit_t) :: limit
    !> Bound on r that a cut-back sets and successes lift.
    real(wp) :: growth = huge(1.0_wp)
    !> Attempt at this increment, from 1.
    integer :: attempt = 1
    !> What the linear solver did.
    type(solve_info_t) :: info
    !> The course of the corrector.
    type(correction_t) :: correction
  end type stepper_t

contains

  !> Makes a stepper around a system.
  subroutine new_stepper(self, model)
    !> The stepper; its system is made apart.
    type(stepper_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model

    call new_prediction(self%prediction, model)
  end subroutine new_stepper

  !> Predicts the increment and fixes its factor r.
  subroutine prepare_increment(self, model, phase, committed, next_output, verdict)
    !> The stepper.
    type(stepper_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: committed
    !> Progress of the phase at the next output of fields.
    real(wp), intent(in) :: next_output
    !> Whether there is a prediction.
    type(verdict_t), intent(out) :: verdict

    self%attempt = 1
    self%info = solve_info_t()
    self%limit = limit_t()
    call clear_correction(self%correction, model)
    call predict(self%prediction, self%system, model, phase, committed, self%info, verdict)
    if (verdict%outcome /= verdict_converged) return
    self%limit = limit_increment(model, phase, committed, self%system, self%prediction, &
        self%growth, next_output)
  end subroutine prepare_increment

  !> One attempt: the predicted state with the present r, corrected.
  subroutine try_increment(self, model, phase, committed, trial, verdict)
    !> The stepper.
    type(stepper_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: committed
    !> The trial state.
    type(state_t), intent(inout) :: trial
    !> Converged, or retry with the reason.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: progress

    call state_copy(committed, trial)
    associate (prediction => self%prediction, r => self%limit%r)
      progress = committed%progress + r*prediction%progress
      if (abs(1.0_wp - progress) < progress_tolerance) progress = 1.0_wp
      trial%increment = committed%increment + 1
      trial%progress = progress
      trial%travel = committed%travel + (progress - committed%progress)*phase%length
      trial%x = committed%x + r*prediction%displacement
      trial%lambda = committed%lambda + r*prediction%lambda
      trial%tool_displacement = committed%tool_displacement + r*prediction%tool_displacement
      trial%load = phase%load_start + progress*(phase%load_end - phase%load_start)
      trial%fading = (1.0_wp - progress)*phase%fading
      call nodal_forces(model%load_set, trial%load, model%contact_node, trial%fading, &
          trial%external_force)
      trial%tool_load = phase%press_start + progress*(phase%press_end - phase%press_start)
      trial%hint%due = .true.
    end associate
    call correct(self%system, model, phase, committed, trial, self%info, self%correction, verdict)
  end subroutine try_increment

  !> Makes r smaller for another attempt; says whether there may be one.
  subroutine shrink_increment(self, phase, again)
    !> The stepper.
    type(stepper_t), intent(inout) :: self
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> Whether another attempt is allowed.
    logical, intent(out) :: again

    again = .false.
    if (.not. phase%newton%cutback) return
    if (self%limit%r*phase%newton%cutback_factor < phase%newton%cutback_min) return
    again = .true.
    self%limit%r = self%limit%r*phase%newton%cutback_factor
    self%limit%name = "cutback"
    self%growth = self%limit%r
    self%attempt = self%attempt + 1
    self%info = solve_info_t()
  end subroutine shrink_increment

  !> Makes the trial state the committed one and lifts the bound that a cut-back set.
  subroutine accept_increment(self, trial, committed)
    !> The stepper.
    type(stepper_t), intent(inout) :: self
    !> The trial state.
    type(state_t), intent(in) :: trial
    !> The committed state.
    type(state_t), intent(inout) :: committed

    call state_copy(trial, committed)
    if (self%growth < huge(1.0_wp)/growth_factor) self%growth = self%growth*growth_factor
    if (self%growth > 1.0e3_wp) self%growth = huge(1.0_wp)
  end subroutine accept_increment

end module dd3_process_increment
