!> Corrector: one Newton-Raphson loop for all non-linearities (plasticity, large rotations, contact,
!> friction).
!> Source: Menezes and Teodosiu 2000; criterion of convergence: Oliveira and Menezes 2004, eq. (19),
!> scaled by the norm of the internal forces where it exceeds that of the contact forces, and such
!> that a residual that is round-off has converged.
module dd3_process_corrector
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : section_assembly, section_contact, section_material
  use dd3_base_interrupt, only : interrupted
  use dd3_base_verdict, only : verdict_converged, verdict_impossible, verdict_retry, &
      cause_interrupted, cause_led_inside, cause_lost_tool, cause_none, cause_residual, &
      cause_tool_force, cause_unsettled
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_attempt, only : attempt_t, clear_correction
  use dd3_process_balance, only : balance_tools, tool_tolerance
  use dd3_process_newton_step, only : advance, retreat
  use dd3_process_overshoot, only : check_overshoot
  use dd3_process_residual, only : evaluate_forces, evaluate_norm, lost_tool, pressed_force
  use dd3_process_status_memory, only : record_status, unsettled
  use dd3_system_enhanced, only : subtract_condensed
  use dd3_system_internal, only : assemble_stiffness, update_material
  use dd3_system_contact, only : is_normal_held
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_load_stiffness, only : add_load_stiffness
  use dd3_system_reduced, only : linear_problem_t
  use dd3_system_round_off, only : attainable_residual
  use dd3_system_solve, only : solve_reduced
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: correct, is_lost

  !> Fraction of the tolerance of the criterion below which all but the tool forces has converged.
  real(wp), parameter :: settled = 0.1_wp
  !> Strain whose force on the square of the thickness is the smallest scale of the criterion: in a
  !> free sheet at rest all forces are round-off.
  real(wp), parameter :: negligible_strain = 1.0e-6_wp
  !> Iterations with the criterion above a value after which an attempt is given up, unless it has
  !> fallen to a new minimum in the last ones.
  integer, parameter :: lost_iterations = 10, without_progress = 5
  real(wp), parameter :: lost_criterion = 0.5_wp

contains

  !> Correct a trial state until it is in equilibrium and every contact condition holds.
  subroutine correct(model, committed, trial, system, attempt)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Predicted on entry, corrected on return.
    type(state_t), intent(inout) :: trial
    type(system_t), intent(inout) :: system
    !> Gets the course of the iterations and the verdict: converged, or retry with the reason.
    type(attempt_t), intent(inout) :: attempt

    call clear_correction(attempt%correction, model%n_contact)
    call iterate(model, committed, trial, system, attempt)
    associate (verdict => attempt%verdict)
      if (verdict%outcome == verdict_converged) return
      if (verdict%cause == cause_none) call explain(model, trial, system, attempt)
      verdict%changing = count(unsettled(attempt%correction%status))
    end associate
  end subroutine correct

  !> Iterate. The verdict has no cause if the iterations are used up.
  subroutine iterate(model, committed, trial, system, attempt)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    type(system_t), intent(inout) :: system
    type(attempt_t), intent(inout) :: attempt

    integer :: j
    logical :: moved

    system%problem%prescribed = 0.0_wp
    system%problem%tool_prescribed = 0.0_wp
    associate (phase => model%phase(trial%phase), verdict => attempt%verdict, &
        correction => attempt%correction)
      do j = 1, phase%newton%iterations
        if (interrupted()) then
          verdict%outcome = verdict_retry
          verdict%cause = cause_interrupted
          return
        end if
        verdict%iterations = j
        if (j == 1) call system%threads%begin_iteration()
        if (j == 2) call system%threads%end_iteration()
        call evaluate(model, committed, trial, system, attempt)
        if (verdict%outcome /= verdict_converged) return
        call record_status(correction%status, system%contact%status)
        call check_convergence(model, trial, system, attempt)
        call system%partition%check_agreement(verdict%norm, verdict)
        if (verdict%outcome == verdict_impossible) return
        if (verdict%outcome == verdict_converged &
            .or. (j > 1 .and. verdict%norm < settled*phase%newton%tolerance)) then
          call balance_tools(model, committed, trial, system, moved)
          if (moved) call check_convergence(model, trial, system, attempt)
        end if
        if (verdict%outcome == verdict_converged) then
          trial%lambda = system%contact%force
          return
        end if
        if (phase%newton%damping .and. is_lost(correction%criterion)) exit
        call system%profile%start()
        if (j > 1) call assemble_stiffness(system, model, committed, trial)
        call subtract_condensed(system%enhanced, system%problem%residual)
        call add_load_stiffness(system, model, trial)
        call prescribe_missed(phase%prescribed, trial, system%problem)
        call system%profile%add(section_assembly)
        call solve_reduced(system, model, phase, attempt%solver, verdict)
        verdict%iterations = j
        verdict%norm = correction%criterion(j)
        if (verdict%outcome /= verdict_converged) return
        call advance(model, trial, system, attempt)
        if (verdict%outcome /= verdict_converged) return
      end do
      verdict%outcome = verdict_retry
      verdict%norm = correction%criterion(size(correction%criterion))
    end associate
  end subroutine iterate

  !> Prescribe the displacements that are left to the positions aimed at.
  pure subroutine prescribe_missed(prescribed, trial, problem)
    !> `(3, n_node)`.
    logical, intent(in) :: prescribed(:, :)
    type(state_t), intent(in) :: trial
    type(linear_problem_t), intent(inout) :: problem

    if (.not. problem%missed) return
    where (prescribed) problem%prescribed = problem%target - trial%x
  end subroutine prescribe_missed

  !> Whether the iterations do not approach a solution: residuals as large as the forces for long,
  !> and not decreasing.
  pure logical function is_lost(criterion)
    real(wp), intent(in) :: criterion(:)

    integer :: j

    j = size(criterion)
    is_lost = .false.
    if (j >= lost_iterations) is_lost = all(criterion(j - lost_iterations + 1:) > lost_criterion) &
        .and. minloc(criterion, dim=1) <= j - without_progress
  end function is_lost

  !> Set the cause why the last iteration did not converge: a pressed tool without contact, a node
  !> led into a tool, a contact status that has not settled, the force on a tool, or the residual of
  !> a node.
  subroutine explain(model, trial, system, attempt)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(system_t), intent(in) :: system
    type(attempt_t), intent(inout) :: attempt

    associate (phase => model%phase(trial%phase), verdict => attempt%verdict, &
        correction => attempt%correction)
      verdict%tool = lost_tool(model, trial, system%contact)
      if (verdict%tool > 0) then
        verdict%cause = cause_lost_tool
        return
      end if
      verdict%node = correction%worst_node
      if (is_led_inside(model, phase, system%contact, model%candidate_of(max(1, verdict%node)))) then
        verdict%cause = cause_led_inside
        return
      end if
      verdict%cause = cause_unsettled
      if (any(unsettled(correction%status))) return
      verdict%cause = cause_residual
      verdict%value(1) = correction%worst_residual
      if (verdict%norm >= phase%newton%tolerance) return
      verdict%tool = maxloc(abs(system%problem%tool_residual), dim=1, mask=phase%pressed)
      if (verdict%tool == 0) return
      verdict%cause = cause_tool_force
      verdict%node = 0
      verdict%value(1) = abs(system%problem%tool_residual(verdict%tool))
    end associate
  end subroutine explain

  !> Whether a candidate lies in a tool out of which its supports do not let it.
  pure logical function is_led_inside(model, phase, contact, c)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    !> Number of the candidate; 0 for none.
    integer, intent(in) :: c

    is_led_inside = .false.
    if (c == 0) return
    if (contact%tool(c) == 0 .or. contact%distance(c) >= -model%tolerance%closed) return
    is_led_inside = is_normal_held(phase, model%contact_node(c), contact%normal(:, c))
  end function is_led_inside

  !> Evaluate stresses, internal forces, contact and residuals of the trial state; in the first
  !> iteration, which is never the last, the stiffness too. A step that inverts an element or
  !> overshoots is shortened if the iterations are damped.
  subroutine evaluate(model, committed, trial, system, attempt)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    type(system_t), intent(inout) :: system
    !> Holds the number of the iteration; gets a verdict on the material.
    type(attempt_t), intent(inout) :: attempt

    integer :: j
    logical :: again

    j = attempt%verdict%iterations
    again = .true.
    do while (again)
      call system%profile%start()
      call update_material(system, model, committed, trial, j == 1, attempt%verdict)
      attempt%verdict%iterations = j
      call system%profile%add(section_material)
      again = attempt%verdict%outcome /= verdict_converged
      if (.not. again) then
        call evaluate_forces(model, committed, trial, system)
        call system%profile%add(section_contact)
        if (model%phase(trial%phase)%newton%damping) &
            call check_overshoot(model, trial, system, attempt, again)
      end if
      again = again .and. model%phase(trial%phase)%newton%damping
      if (again) call retreat(model, committed, trial, system, attempt, again)
      if (again) system%problem%missed = .true.
    end do
  end subroutine evaluate

  !> Evaluate the criterion of convergence, eq. (19).
  subroutine check_convergence(model, trial, system, attempt)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    !> Evaluated at the trial state.
    type(system_t), intent(in) :: system
    !> Gets criterion, contact status and verdict: converged, or retry.
    type(attempt_t), intent(inout) :: attempt

    real(wp) :: scale
    integer :: j, tool
    logical :: forces_met, outside

    associate (phase => model%phase(trial%phase), verdict => attempt%verdict, &
        correction => attempt%correction, contact => system%contact, &
        tool_residual => system%problem%tool_residual)
      call evaluate_norm(model, trial, system, correction%residual, correction%worst_node, &
          correction%worst_residual)
      forces_met = .true.
      do tool = 1, model%n_tool
        if (.not. phase%pressed(tool)) cycle
        if (any(contact%tool == tool .and. contact%status /= status_gap)) then
          forces_met = forces_met &
              .and. abs(tool_residual(tool)) <= tool_tolerance*pressed_force(trial, tool)
        else
          forces_met = forces_met .and. norm2(trial%tool_load(:, tool)) <= 0.0_wp
        end if
      end do
      scale = max(norm2(trial%lambda), norm2(trial%internal_force), &
          negligible_strain*model%least_shear()*model%thickness**2, &
          attainable_residual(system%stiffness, trial%x, system%partition)/phase%newton%tolerance)
      j = verdict%iterations
      correction%criterion = [correction%criterion(:j - 1), &
          (norm2(correction%lambda_increment) + correction%residual)/scale]
      verdict%norm = correction%criterion(j)
      verdict%outcome = verdict_retry
      outside = all(contact%distance + contact%onset >= -model%tolerance%depth &
          .or. contact%tool == 0)
      if (system%problem%missed) outside = outside .and. all(abs(system%problem%target - trial%x) &
          <= model%tolerance%closed .or. .not. phase%prescribed)
      if (j > 1 .and. forces_met .and. outside .and. verdict%norm < phase%newton%tolerance) &
          verdict%outcome = verdict_converged
    end associate
  end subroutine check_convergence

end module dd3_process_corrector
