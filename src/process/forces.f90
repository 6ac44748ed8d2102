! SPDX-License-Identifier: GPL-3.0-or-later
!> Forces of a trial state: external ones, those of the contact, and the residuals of the nodes and
!> of the pressed tools. External are loads, pressures, draw-beads, the forces of lost constraints,
!> which turn with the sheet and fall linearly over the phase, and those that lay a free sheet down,
!> with their springs.
module dd3_process_forces
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank, largest_over_ranks, sum_over_ranks, this_rank
  use dd3_model_carried_forces, only : carried_forces
  use dd3_model_contact_layer, only : offset_factor
  use dd3_model_loads, only : add_pressure_forces, laying_factor, laying_rate, nodal_forces, &
      spring_stiffness
  use dd3_model_model, only : model_t
  use dd3_model_support_springs, only : add_support_springs
  use dd3_model_state, only : state_t
  use dd3_system_contact, only : evaluate_contact
  use dd3_system_drawbead, only : evaluate_beads
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: set_loads, applied_forces, evaluate_external, released_rate
  public :: evaluate_forces, lost_tool

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

  !> Return the forces of loads, pressures and lost constraints on the nodes, `(3, n_node)`, N.
  pure function applied_forces(model, load, pressure, x, fading) result(force)
    type(model_t), intent(in) :: model
    !> Total force on each set with loads, `(3, n_load)`, N, and pressures, `(n_pressure)`, MPa.
    real(wp), intent(in) :: load(:, :), pressure(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Forces of the nodes on lost constraints that are left, `(3, n_node)`, N.
    real(wp), intent(in) :: fading(:, :)
    real(wp) :: force(3, model%n_node)

    call nodal_forces(model%load_set, load, fading, force)
    if (size(pressure) > 0) &
        call add_pressure_forces(model%element, model%pressure_set, pressure, x, force)
  end function applied_forces

  !> Set the external forces of a state, and the fading ones among them; those of pressures and of
  !> springs depend on the positions of the nodes.
  subroutine evaluate_external(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state

    state%fading = model%phase(state%phase)%fading(state%progress)*carried(model, state)
    if (any(abs(state%start%laying) > 0.0_wp)) state%fading = state%fading &
        + laying_factor(state%progress)*laying_forces(model, state)
    state%external_force = applied_forces(model, state%load, state%pressure, state%x, state%fading)
    if (size(state%bead_load) > 0) state%external_force = state%external_force + state%bead_load
    call add_support_springs(model, state, state%external_force)
  end subroutine evaluate_external

  !> Return the forces on lost constraints at their full size, turned with the sheet, N.
  pure function carried(model, state) result(force)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    force = state%start%fading
    if (state%start%fading_turns) &
        force = carried_forces(model%fibre_end, state%start%x, state%x, state%start%fading)
  end function carried

  !> Return the negative derivative of the fading forces in the progress, behind it, N.
  pure function released_rate(model, state) result(rate)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: rate(3, model%n_node)

    rate = model%phase(state%phase)%fading_rate(state%progress)*carried(model, state)
    if (any(abs(state%start%laying) > 0.0_wp)) rate = rate &
        + laying_rate(state%progress)*laying_forces(model, state)
  end function released_rate

  !> Return the forces that lay a free sheet down, with those of their springs, at their full size,
  !> N.
  pure function laying_forces(model, state) result(force)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    integer :: node

    force = state%start%laying
    do node = 1, model%n_node
      if (all(abs(force(:, node)) <= 0.0_wp)) cycle
      force(:, node) = force(:, node) + spring_stiffness(force(:, node), &
          model%thickness_at(node))*(state%x(:, node) - state%start%x(:, node))
    end do
  end function laying_forces

  !> Evaluate the contact of a trial state, and the residuals from it and the internal forces.
  subroutine evaluate_forces(model, committed, trial, system)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Gets contact and residuals.
    type(system_t), intent(inout) :: system

    real(wp) :: nearest(1), contact_forces(3, model%n_node)
    integer :: b, c, node, tool

    call evaluate_contact(system%contact, model, committed, trial)
    if (size(trial%bead_load) > 0) call evaluate_beads(system%bead, model, committed, trial)
    if (size(trial%bead_load) > 0 .or. any(abs(trial%pressure) > 0.0_wp) &
        .or. any(abs(trial%start%fading) + abs(trial%start%laying) > 0.0_wp) &
        .or. model%phase(trial%phase)%floats) &
        call evaluate_external(model, trial)
    associate (problem => system%problem, contact => system%contact, &
        phase => model%phase(trial%phase), force => trial%tool_force)
      contact_forces = model%own_contact_forces(trial%x, trial%lambda, trial%place)
      call system%partition%complete_forces(model%n_node, contact_forces)
      problem%residual = trial%internal_force - trial%external_force
      problem%residual = problem%residual + contact_forces
      if (any(problem%damping > 0.0_wp)) problem%residual = problem%residual &
          + spread(problem%damping, 1, 3)*(trial%x - committed%x)
      problem%contact_residual = contact%force - trial%lambda
      contact_forces = model%own_contact_forces(trial%x, problem%contact_residual, trial%place)
      call system%partition%complete_forces(model%n_node, contact_forces)
      problem%law_residual = problem%residual + contact_forces
      force = 0.0_wp
      do node = 1, merge(model%n_node, 0, this_rank() == 0)
        tool = trial%fading_tool(node)
        if (tool > 0) force(:, tool) = force(:, tool) + trial%fading(:, node)
      end do
      do c = 1, model%n_contact
        tool = contact%tool(c)
        if (tool > 0) force(:, tool) = force(:, tool) + contact%force(:, c)
      end do
      call sum_over_ranks(size(force), force)
      do b = 1, size(trial%bead_total, 2)
        tool = model%drawbead(b)%tool
        if (tool > 0) force(:, tool) = force(:, tool) - trial%bead_total(:, b)
      end do
      do tool = 1, model%n_tool
        problem%tool_residual(tool) = dot_product(phase%direction(:, tool), &
            trial%tool_load(:, tool) + force(:, tool))
        ! A pressed tool that has lost the sheet moves back to contact.
        problem%tool_prescribed(:, tool) = 0.0_wp
        if (.not. is_lost(model, trial, tool)) cycle
        if (.not. any_rank(any(contact%tool == tool))) cycle
        nearest = -minval(contact%distance, mask=contact%tool == tool)
        call largest_over_ranks(1, nearest)
        problem%tool_prescribed(:, tool) = phase%direction(:, tool) &
            *(-nearest(1) + model%tolerance%touch)
      end do
    end associate
  end subroutine evaluate_forces

  !> Return a tool that is pressed and has no contact; 0 if there is none.
  integer function lost_tool(model, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial

    do lost_tool = model%n_tool, 1, -1
      if (is_lost(model, trial, lost_tool)) return
    end do
  end function lost_tool

  !> Whether a tool is pressed and has no contact.
  logical function is_lost(model, trial, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    integer, intent(in) :: tool

    is_lost = model%phase(trial%phase)%pressed(tool) .and. &
        norm2(trial%tool_load(:, tool)) > 0.0_wp
    if (is_lost) is_lost = .not. trial%touches(tool)
  end function is_lost

end module dd3_process_forces
