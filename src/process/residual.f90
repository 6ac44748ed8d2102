!> What a trial state leaves open: the residuals of the nodes and of the pressed tools, from its
!> internal forces and its contact.
module dd3_process_residual
  use dd3_base_kinds, only : wp
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_system_contact, only : contact_work_t, evaluate_contact, touch
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: evaluate_forces, pressed_force, lost_tool, tool_force_tolerance

  !> A pressed tool's force is met within this share of it.
  real(wp), parameter :: tool_force_tolerance = 1.0e-6_wp
  !> The force of a tool that presses less than this share of others is measured by theirs.
  real(wp), parameter :: small = 1.0e-3_wp

contains

  !> Contact of the trial state, and the residuals from it and the internal forces.
  subroutine evaluate_forces(system, model, phase, old, new)
    !> The system.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state.
    type(state_t), intent(inout) :: new

    integer :: c, node, tool

    call evaluate_contact(system%contact, model, phase, old, new)
    associate (problem => system%problem, contact => system%contact)
      problem%residual = new%internal_force - new%external_force
      do c = 1, model%n_contact
        node = model%contact_node(c)
        problem%residual(:, node) = problem%residual(:, node) + new%lambda(:, c)
      end do
      problem%excess = contact%force - new%lambda
      new%tool_force = 0.0_wp
      do c = 1, model%n_contact
        tool = contact%tool(c)
        if (tool > 0) new%tool_force(:, tool) = new%tool_force(:, tool) + contact%force(:, c)
        tool = new%fading_tool(c)
        if (tool > 0) new%tool_force(:, tool) = new%tool_force(:, tool) + new%fading(:, c)
      end do
      do tool = 1, model%n_tool
        problem%tool_residual(tool) = dot_product(phase%direction(:, tool), &
                                                  new%tool_load(:, tool) + new%tool_force(:, tool))
        problem%tool_motion(:, tool) = motion_to_touch(contact, phase, new, tool)
      end do
    end associate
  end subroutine evaluate_forces

  !> The way of a pressed tool that has lost the sheet back to touch; zero for the others.
  pure function motion_to_touch(contact, phase, new, tool) result(motion)
    !> Contact of the candidates.
    type(contact_work_t), intent(in) :: contact
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial state.
    type(state_t), intent(in) :: new
    !> The tool.
    integer, intent(in) :: tool
    real(wp) :: motion(3)

    motion = 0.0_wp
    if (.not. phase%pressed(tool) .or. norm2(new%tool_load(:, tool)) <= 0.0_wp) return
    if (.not. any(contact%tool == tool)) return
    if (any(contact%tool == tool .and. contact%status /= status_gap)) return
    motion = phase%direction(:, tool)*(minval(contact%distance, mask=contact%tool == tool) + touch)
  end function motion_to_touch

  !> What a pressed tool's force is measured by, N. One that is eased to nothing is measured by what
  !> bore it, and by what goes on in the sheet.
  pure real(wp) function pressed_force(phase, new, tool)
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial state.
    type(state_t), intent(in) :: new
    !> The tool.
    integer, intent(in) :: tool

    pressed_force = max(norm2(new%tool_load(:, tool)), &
        small*norm2(phase%press_start(:, tool)), small*norm2(phase%press_end(:, tool)), &
        small*norm2(new%internal_force))
  end function pressed_force

  !> A tool that is pressed and touches nothing; 0 where there is none.
  pure integer function lost_tool(system, model, phase, new)
    !> The evaluated system.
    type(system_t), intent(in) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial state.
    type(state_t), intent(in) :: new

    do lost_tool = model%n_tool, 1, -1
      if (.not. phase%pressed(lost_tool)) cycle
      if (norm2(new%tool_load(:, lost_tool)) <= 0.0_wp) cycle
      if (.not. any(system%contact%tool == lost_tool &
                    .and. system%contact%status /= status_gap)) return
    end do
  end function lost_tool

end module dd3_process_residual
