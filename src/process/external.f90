!> External forces of a trial state: loads, pressures, and the forces of lost constraints, which
!> fade over the phase with springs that hold the sheet where the constraints left it.
module dd3_process_external
  use dd3_base_kinds, only : wp
  use dd3_model_contact_layer, only : offset_factor
  use dd3_model_loads, only : fading_factor, nodal_forces, spring_stiffness
  use dd3_model_model, only : model_t
  use dd3_model_pressures, only : add_pressure_forces
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: set_loads, evaluate_external, unfaded_forces

contains

  !> Set the loads and pressures of a trial state, and the places of its contact layers, from its
  !> progress.
  subroutine set_loads(model, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: trial

    real(wp) :: factor
    integer :: tool

    factor = model%phase(trial%phase)%factor(trial%progress)
    associate (start => trial%start)
      trial%layer_offset = offset_factor(trial%progress)*start%layer_offset
      trial%load = start%load + factor*(start%load_end - start%load)
      trial%pressure = start%pressure + factor*(start%pressure_end - start%pressure)
      do tool = 1, model%n_tool
        trial%tool_load(:, tool) = model%phase(trial%phase)%tool_load(tool, trial%progress, &
            start%tool_load(:, tool), start%tool_load_end(:, tool))
      end do
    end associate
  end subroutine set_loads

  !> Set the external forces of a state, and the fading ones among them; those of pressures and of
  !> springs depend on the positions of the nodes.
  subroutine evaluate_external(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state

    associate (force => state%external_force)
      state%fading = fading_factor(state%progress)*unfaded_forces(model, state)
      call nodal_forces(model%load_set, state%load, state%fading, force)
      if (size(state%bead_load) > 0) force = force + state%bead_load
      if (size(state%pressure) > 0) call add_pressure_forces(model%element, model%pressure_set, &
          state%pressure, state%x, force)
    end associate
  end subroutine evaluate_external

  !> Return the forces of the nodes on lost constraints and on their springs before they fade, N.
  pure function unfaded_forces(model, state) result(force)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    integer :: node

    force = state%start%fading
    do node = 1, model%n_node
      if (all(abs(force(:, node)) <= 0.0_wp)) cycle
      force(:, node) = force(:, node) + spring_stiffness(force(:, node), &
          model%thickness_at(node))*(state%x(:, node) - state%start%x(:, node))
    end do
  end function unfaded_forces

end module dd3_process_external
