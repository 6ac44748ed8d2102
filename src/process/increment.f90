! SPDX-License-Identifier: GPL-3.0-or-later
!> One increment: predict, limit, correct.
module dd3_process_increment
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank
  use dd3_base_verdict, only : verdict_converged, verdict_retry, cause_interrupted
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_motions, only : motion_displacement
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : begin_increment
  use dd3_model_terms_released, only : has_released
  use dd3_model_terms_viscous, only : set_viscous, viscous_range, viscous_strength, &
      weaken_viscous
  use dd3_model_turning, only : set_rotations
  use dd3_process_elimination, only : sheet_equilibrium_t
  use dd3_process_equilibrium, only : equilibrium_t
  use dd3_process_forces, only : set_tools
  use dd3_process_limiters, only : limit_increment
  use dd3_process_newton, only : newton_converged, newton_diverging, newton_interrupted, &
      newton_slow, solve
  use dd3_process_norm, only : convergence_tolerance
  use dd3_process_open_edges, only : find_passage, observe_passages
  use dd3_process_phase_end, only : progress_tolerance
  use dd3_process_predictor, only : predict
  use dd3_process_step_control, only : attempt_t, set_next_r_cap, stepper_t
  use dd3_process_work, only : add_work
  use dd3_system_internal, only : evaluate_fading
  use dd3_system_linear_problem, only : linear_problem_t
  implicit none
  private
  public :: prepare_increment, try_increment, accept_increment

  !> Iterations without contraction after which an attempt at an increment of a release is ended,
  !> near the solution too: contact of nodes that buckle opens and closes for ever.
  integer, parameter :: release_patience = 15

contains

  !> Predict the increment and set its factor r. The verdict of the attempt is that of the
  !> prediction.
  subroutine prepare_increment(model, committed, stepper)
    type(model_t), intent(in) :: model
    !> Its terms get what is fixed in the increment.
    type(state_t), intent(inout) :: committed
    type(stepper_t), intent(inout) :: stepper

    stepper%attempt = attempt_t(releases=has_released(committed%term) &
        .or. committed%sheet%fades &
        .or. any(model%phase(committed%phase)%withdrawn))
    call begin_increment(committed%term, model, committed%configuration_t)
    stepper%attempt%viscosity = viscous_strength(committed%term)
    if (stepper%attempt%releases) stepper%attempt%viscous_range = viscous_range(model, &
        committed%configuration_t)
    stepper%system%contact%turn_limited = .false.
    call predict(stepper%prediction, model, committed, stepper%system, stepper%attempt%solver, &
        stepper%attempt%verdict)
    if (stepper%attempt%verdict%outcome /= verdict_converged) return
    call limit_increment(model, committed, stepper)
  end subroutine prepare_increment

  !> Make one attempt: the predicted state with the present r, corrected until it is in equilibrium
  !> and every contact condition holds.
  subroutine try_increment(model, committed, trial, stepper)
    type(model_t), target, intent(in) :: model
    type(state_t), target, intent(in) :: committed
    type(state_t), target, intent(inout) :: trial
    type(stepper_t), target, intent(inout) :: stepper

    type(sheet_equilibrium_t) :: equilibrium

    trial = committed
    call equilibrium%attach(model, committed, trial, stepper%system)
    associate (prediction => stepper%prediction, attempt => stepper%attempt, &
        r => stepper%attempt%limit%r, phase => model%phase(committed%phase))
      equilibrium%solver = attempt%solver
      equilibrium%releases = attempt%releases
      if (attempt%releases) then
        equilibrium%far = 0.0_wp
        equilibrium%patience = release_patience
        if (attempt%number > 1) call set_viscous(trial%term, model, attempt%viscosity)
      end if
      equilibrium%system%contact%turn_limited = attempt%number > 1 .and. attempt%after_failure
      trial%increment = committed%increment + 1
      trial%progress = committed%progress + r*prediction%progress
      if (abs(1.0_wp - trial%progress) < progress_tolerance) trial%progress = 1.0_wp
      attempt%ends_phase = trial%progress >= 1.0_wp
      trial%travel = committed%travel + phase%path(committed%progress, trial%progress)
      trial%time = committed%time + (trial%progress - committed%progress)*phase%duration
      trial%contact%hint%due = .true.
      call set_rotations(phase, trial)
      call equilibrium%begin(prediction%step%scaled(r))
      call set_tools(model, trial)
      call set_target(model, trial, stepper%system%problem)
      call solve(equilibrium, convergence_tolerance(phase, trial), phase%newton%iterations, &
          phase%newton%line_search, attempt%course)
      call conclude(equilibrium, attempt)
      if (attempt%verdict%outcome /= verdict_converged) attempt%passage = &
          find_passage(model, committed, prediction%step%x, prediction%step%tool)
    end associate
  end subroutine try_increment

  !> Conclude from the course of the corrector: the contact forces of a converged state, or the
  !> cause of a failure.
  subroutine conclude(equilibrium, attempt)
    class(equilibrium_t), intent(inout) :: equilibrium
    type(attempt_t), intent(inout) :: attempt

    integer :: c

    attempt%solver = equilibrium%solver
    attempt%residual = equilibrium%residual
    associate (course => attempt%course, verdict => attempt%verdict)
      verdict = course%verdict
      verdict%iterations = course%iterations
      verdict%changing = equilibrium%changing()
      verdict%norm = equilibrium%scaled_norm
      select case (course%outcome)
      case (newton_converged)
        equilibrium%trial%contact%lambda = equilibrium%system%contact%force
      case (newton_interrupted)
        verdict%outcome = verdict_retry
        verdict%cause = cause_interrupted
      case (newton_diverging, newton_slow)
        verdict%outcome = verdict_retry
        call equilibrium%explain(verdict)
      case default
        ! The verdict of the corrector stands.
      end select
      c = 0
      if (verdict%node > 0) c = equilibrium%model%candidate_of(verdict%node)
      attempt%touched = .false.
      if (c > 0) attempt%touched = any(equilibrium%status(c, :) > status_gap)
      attempt%touched = any_rank(attempt%touched)
    end associate
  end subroutine conclude

  !> Set where the nodes with prescribed displacements have to be: at their predicted positions, or
  !> on the curve of their motion.
  subroutine set_target(model, trial, problem)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(linear_problem_t), intent(inout) :: problem

    real(wp) :: undeformed(3, model%n_node)
    integer :: i

    problem%target = trial%x
    problem%missed = .false.
    associate (phase => model%phase(trial%phase))
      if (size(phase%motion) == 0) return
      problem%missed = .true.
      undeformed = model%undeformed_positions()
      do i = 1, size(phase%motion)
        associate (node => phase%motion(i)%node)
          where (spread(phase%motion(i)%prescribes, 2, size(node))) &
              problem%target(:, node) = trial%start%x(:, node)
        end associate
      end do
      do i = 1, size(phase%motion)
        call motion_displacement(phase%motion(i), undeformed, trial%start%x, &
            phase%factor(trial%progress), problem%target)
      end do
    end associate
  end subroutine set_target

  !> Whether the tools that the running phase withdraws have all left the sheet.
  logical function has_opened(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    integer :: tool

    associate (phase => model%phase(state%phase))
      has_opened = phase%opening > 0.0_wp .and. state%progress > phase%opening
      do tool = 1, model%n_tool
        if (has_opened) has_opened = .not. state%tools%touches(tool)
      end do
    end associate
  end function has_opened

  !> Commit the trial state.
  subroutine accept_increment(model, trial, stepper, committed)
    type(model_t), intent(in) :: model
    !> Gets work, slip and passages over open edges of the increment.
    type(state_t), intent(inout) :: trial
    type(stepper_t), intent(inout) :: stepper
    type(state_t), intent(inout) :: committed

    call evaluate_fading(stepper%system, model, trial)
    call add_work(model, stepper%system%contact, committed, trial)
    call observe_passages(model, committed, trial)
    trial%open = has_opened(model, trial)
    committed = trial
    committed%sheet%enhanced = 0.0_wp
    call set_next_r_cap(committed, stepper%attempt)
    call weaken_viscous(committed%term, stepper%attempt%course%iterations, &
        stepper%attempt%viscous_range)
  end subroutine accept_increment

end module dd3_process_increment
