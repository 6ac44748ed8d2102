!> Residuals of a trial state: of the nodes and of the pressed tools, from its internal forces and
!> its contact.
module dd3_process_residual
  use dd3_base_kinds, only : wp
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_process_external, only : evaluate_external
  use dd3_system_contact, only : evaluate_contact
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_drawbead, only : evaluate_beads
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: evaluate_forces, evaluate_norm, pressed_force, lost_tool, residual_t

  !> Norm of the residuals.
  type :: residual_t
    !> N.
    real(wp) :: norm = 0.0_wp
    !> Node with the largest residual, and that residual, N.
    integer :: worst_node = 0
    real(wp) :: worst = 0.0_wp
  end type residual_t

  !> Fraction of other forces that scales the force of a tool if its own force is smaller.
  real(wp), parameter :: small = 1.0e-3_wp

contains

  !> Evaluate the contact of a trial state, and the residuals from it and the internal forces.
  subroutine evaluate_forces(model, committed, trial, system)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Gets contact and residuals.
    type(system_t), intent(inout) :: system

    integer :: b, c, node, tool

    call evaluate_contact(system%contact, model, committed, trial)
    if (size(trial%bead_load) > 0) call evaluate_beads(system%bead, model, committed, trial)
    if (size(trial%bead_load) > 0 .or. any(abs(trial%pressure) > 0.0_wp) &
        .or. any(abs(trial%start%fading) > 0.0_wp)) &
        call evaluate_external(model, trial)
    associate (problem => system%problem, contact => system%contact, &
        phase => model%phase(trial%phase))
      problem%residual = trial%internal_force - trial%external_force
      problem%residual = problem%residual + model%nodal_contact_forces(trial%x, trial%lambda)
      problem%contact_residual = contact%force - trial%lambda
      trial%tool_force = 0.0_wp
      do node = 1, model%n_node
        tool = trial%fading_tool(node)
        if (tool > 0) trial%tool_force(:, tool) = trial%tool_force(:, tool) + trial%fading(:, node)
      end do
      do c = 1, model%n_contact
        tool = contact%tool(c)
        if (tool > 0) trial%tool_force(:, tool) = trial%tool_force(:, tool) + contact%force(:, c)
      end do
      do b = 1, size(trial%bead_total, 2)
        tool = model%drawbead(b)%tool
        if (tool > 0) trial%tool_force(:, tool) = trial%tool_force(:, tool) - trial%bead_total(:, b)
      end do
      do tool = 1, model%n_tool
        problem%tool_residual(tool) = dot_product(phase%direction(:, tool), &
            trial%tool_load(:, tool) + trial%tool_force(:, tool))
        problem%tool_prescribed(:, tool) = motion_to_contact(contact, model, trial, tool)
      end do
    end associate
  end subroutine evaluate_forces

  !> Evaluate the norm of the residuals of equilibrium and contact at the free degrees of freedom,
  !> of the enhanced strains and of the pressed tools in contact.
  subroutine evaluate_norm(model, trial, system, found)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    !> Evaluated at the trial state.
    type(system_t), intent(in) :: system
    type(residual_t), intent(out) :: found

    real(wp) :: equilibrium(3, model%n_node), contribution(model%n_node), sum_of_squares
    integer :: node, c, tool

    associate (phase => model%phase(trial%phase), problem => system%problem, &
        contact => system%contact)
      equilibrium = problem%residual + model%nodal_contact_forces(trial%x, problem%contact_residual)
      contribution = sum(equilibrium**2, mask=.not. phase%prescribed, dim=1)
      do c = 1, model%n_contact
        node = model%contact_node(c)
        contribution(node) = contribution(node) + sum(problem%contact_residual(:, c)**2)
      end do
      found%worst_node = maxloc(contribution, dim=1)
      found%worst = contribution(found%worst_node)
      sum_of_squares = sum(contribution) &
          + sum((system%enhanced%residual*(0.5_wp*model%thickness))**2)
      do tool = 1, model%n_tool
        if (.not. phase%pressed(tool)) cycle
        if (any(contact%tool == tool .and. contact%status /= status_gap)) &
            sum_of_squares = sum_of_squares + problem%tool_residual(tool)**2
      end do
    end associate
    found%norm = sqrt(sum_of_squares)
    found%worst = sqrt(max(found%worst, 0.0_wp))
  end subroutine evaluate_norm

  !> Return the displacement of a pressed tool that has lost the sheet back to contact, mm; zero for
  !> the others.
  pure function motion_to_contact(contact, model, trial, tool) result(motion)
    type(contact_work_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    integer, intent(in) :: tool
    real(wp) :: motion(3)

    motion = 0.0_wp
    associate (phase => model%phase(trial%phase))
      if (.not. phase%pressed(tool) .or. norm2(trial%tool_load(:, tool)) <= 0.0_wp) return
      if (.not. any(contact%tool == tool)) return
      if (any(contact%tool == tool .and. contact%status /= status_gap)) return
      motion = phase%direction(:, tool) &
          *(minval(contact%distance, mask=contact%tool == tool) + model%tolerance%touch)
    end associate
  end function motion_to_contact

  !> Return the scale of the force on a pressed tool, N. The scale of one that is eased to zero is a
  !> fraction of its force at the start of the phase and of the internal forces.
  pure real(wp) function pressed_force(trial, tool)
    type(state_t), intent(in) :: trial
    integer, intent(in) :: tool

    pressed_force = max(norm2(trial%tool_load(:, tool)), &
        small*norm2(trial%start%tool_load(:, tool)), &
        small*norm2(trial%start%tool_load_end(:, tool)), small*norm2(trial%internal_force), &
        tiny(1.0_wp))
  end function pressed_force

  !> Return a tool that is pressed and has no contact; 0 if there is none.
  pure integer function lost_tool(model, trial, contact)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(contact_work_t), intent(in) :: contact

    do lost_tool = model%n_tool, 1, -1
      if (.not. model%phase(trial%phase)%pressed(lost_tool)) cycle
      if (norm2(trial%tool_load(:, lost_tool)) <= 0.0_wp) cycle
      if (.not. any(contact%tool == lost_tool .and. contact%status /= status_gap)) return
    end do
  end function lost_tool

end module dd3_process_residual
