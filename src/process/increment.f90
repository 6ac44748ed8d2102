!> One increment: predict, limit, correct; if the corrector fails and cut-backs are allowed, again
!> from the committed state with a smaller r.
module dd3_process_increment
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_converged
  use dd3_model_model, only : model_t
  use dd3_model_motions, only : motion_displacement
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_attempt, only : new_attempt
  use dd3_process_corrector, only : correct
  use dd3_process_external, only : evaluate_external, set_loads
  use dd3_process_limit, only : limiter_cutback, limiter_until
  use dd3_process_limiters, only : limit_increment
  use dd3_process_phase_end, only : progress_tolerance, until_fraction
  use dd3_process_predictor, only : predict
  use dd3_process_stepper, only : stepper_t
  use dd3_process_work, only : add_work
  use dd3_system_partition, only : share_state
  use dd3_system_reduced, only : linear_problem_t
  use dd3_system_solve, only : solve_info_t
  implicit none
  private
  public :: prepare_increment, try_increment, shrink_increment, return_to_until, accept_increment

  !> Factor on r_cap after an accepted increment; value of r_cap above which the bound is removed.
  real(wp), parameter :: r_cap_factor = 1.5_wp, largest_r_cap = 1.0e3_wp
  !> Smallest factor on r after an increment that took more iterations than the target.
  real(wp), parameter :: smallest_factor = 0.5_wp
  !> Largest number of attempts up to which one beyond the early end of the phase is repeated.
  integer, parameter :: most_returns = 10

contains

  !> Predict the increment and set its factor r. The verdict of the attempt is that of the
  !> prediction.
  subroutine prepare_increment(model, committed, stepper)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(stepper_t), intent(inout) :: stepper

    call new_attempt(stepper%attempt, model%n_contact)
    call predict(stepper%prediction, model, committed, stepper%system, stepper%attempt)
    if (stepper%attempt%verdict%outcome /= verdict_converged) return
    call limit_increment(model, committed, stepper)
  end subroutine prepare_increment

  !> Make one attempt: the predicted state with the present r, corrected.
  subroutine try_increment(model, committed, trial, stepper)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    type(stepper_t), intent(inout) :: stepper

    real(wp) :: progress

    trial = committed
    associate (prediction => stepper%prediction, r => stepper%attempt%limit%r, &
        phase => model%phase(committed%phase))
      progress = committed%progress + r*prediction%progress
      if (abs(1.0_wp - progress) < progress_tolerance) progress = 1.0_wp
      trial%increment = committed%increment + 1
      trial%progress = progress
      trial%travel = committed%travel + (progress - committed%progress)*phase%length
      trial%x = committed%x + r*prediction%displacement
      trial%enhanced = r*prediction%enhanced
      trial%lambda = committed%lambda + r*prediction%lambda
      trial%tool_displacement = committed%tool_displacement + r*prediction%tool_displacement
      call set_loads(model, trial)
      call evaluate_external(model, trial)
      call set_target(model, trial, stepper%system%problem)
      trial%hint%due = .true.
    end associate
    call correct(model, committed, trial, stepper%system, stepper%attempt)
  end subroutine try_increment

  !> Set where the nodes with prescribed displacements have to be: at their predicted positions, or
  !> on the curve of their motion.
  subroutine set_target(model, trial, problem)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(linear_problem_t), intent(inout) :: problem

    integer :: i

    problem%target = trial%x
    associate (phase => model%phase(trial%phase))
      problem%missed = .false.
      if (.not. allocated(phase%motion)) return
      problem%missed = size(phase%motion) > 0
      do i = 1, size(phase%motion)
        call start_from(phase%motion(i)%node, phase%motion(i)%prescribes)
      end do
      do i = 1, size(phase%motion)
        call motion_displacement(phase%motion(i), model%x0, trial%start%x, &
            phase%factor(trial%progress), problem%target)
      end do
    end associate

  contains

    subroutine start_from(node, prescribes)
      integer, intent(in) :: node(:)
      logical, intent(in) :: prescribes(3)

      integer :: k

      do k = 1, size(node)
        where (prescribes) problem%target(:, node(k)) = trial%start%x(:, node(k))
      end do
    end subroutine start_from

  end subroutine set_target

  !> Reduce r for another attempt, if one is allowed.
  subroutine shrink_increment(phase, stepper, again)
    type(phase_t), intent(in) :: phase
    type(stepper_t), intent(inout) :: stepper
    !> Whether another attempt is allowed.
    logical, intent(out) :: again

    again = .false.
    if (.not. phase%newton%cutback) return
    associate (attempt => stepper%attempt)
      if (attempt%limit%r*phase%newton%cutback_factor < phase%newton%cutback_min) return
      again = .true.
      attempt%limit%r = attempt%limit%r*phase%newton%cutback_factor
      attempt%limit%limiter = limiter_cutback
      attempt%solver = solve_info_t()
      attempt%number = attempt%number + 1
    end associate
  end subroutine shrink_increment

  !> Reduce r for another attempt if a converged one has gone beyond the early end of the phase: the
  !> prediction extrapolates linearly, and knows nothing of nodes that meet a tool.
  subroutine return_to_until(phase, committed, trial, stepper, again)
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: committed
    !> Converged.
    type(state_t), intent(in) :: trial
    type(stepper_t), intent(inout) :: stepper
    !> Whether another attempt is due.
    logical, intent(out) :: again

    real(wp) :: fraction

    fraction = until_fraction(phase, committed, trial)
    associate (attempt => stepper%attempt)
      again = fraction < 1.0_wp .and. fraction > 0.0_wp .and. attempt%number < most_returns
      if (.not. again) return
      attempt%limit%r = fraction*attempt%limit%r
      attempt%limit%limiter = limiter_until
      attempt%solver = solve_info_t()
      attempt%number = attempt%number + 1
    end associate
  end subroutine return_to_until

  !> Commit the trial state. A cut-back, or more iterations than the target, set a bound of r, which
  !> every other accepted increment raises; a failed increment leaves none, so that a restart
  !> repeats its attempts.
  subroutine accept_increment(model, trial, stepper, committed)
    type(model_t), intent(in) :: model
    !> Gets work and slip of the increment.
    type(state_t), intent(inout) :: trial
    type(stepper_t), intent(in) :: stepper
    type(state_t), intent(inout) :: committed

    real(wp) :: factor

    call share_state(stepper%system%partition, trial)
    call add_work(model, stepper%system%contact, committed, trial)
    committed = trial
    committed%enhanced = 0.0_wp
    factor = r_cap_factor
    associate (attempt => stepper%attempt, newton => model%phase(trial%phase)%newton)
      if (newton%target_iterations > 0 .and. &
          attempt%verdict%iterations > newton%target_iterations) then
        factor = max(smallest_factor, &
            sqrt(real(newton%target_iterations, wp)/real(attempt%verdict%iterations, wp)))
        committed%r_cap = attempt%limit%r
        committed%r_cap_by_iterations = .true.
      else if (attempt%number > 1 .and. attempt%limit%limiter /= limiter_until) then
        committed%r_cap = attempt%limit%r
        committed%r_cap_by_iterations = .false.
      end if
    end associate
    if (committed%r_cap < huge(1.0_wp)/r_cap_factor) committed%r_cap = committed%r_cap*factor
    if (committed%r_cap > largest_r_cap) committed%r_cap = huge(1.0_wp)
    committed%solver_memory = stepper%system%solver%memory
  end subroutine accept_increment

end module dd3_process_increment
