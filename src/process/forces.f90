! SPDX-License-Identifier: GPL-3.0-or-later
!> Forces of a trial state: those of the terms, those of the contact, and the residuals of the nodes
!> and of the pressed tools.
module dd3_process_forces
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank, largest_over_ranks, sum_over_ranks
  use dd3_model_bound_nodes, only : forces_on_bound, give_to_parents, share_bound
  use dd3_model_contact_layer, only : layer_offset
  use dd3_model_model, only : model_t
  use dd3_model_pressed_tools, only : tool_balance
  use dd3_model_tool_supports, only : on_spacer, support_balance, support_matrix
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : evaluate_terms, external_forces
  use dd3_system_contact, only : evaluate_contact
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: set_tools, evaluate_forces, evaluate_residuals, lost_tool

contains

  !> Set the forces on the tools of a trial state and the places of its contact layers, from its
  !> progress.
  subroutine set_tools(model, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: trial

    integer :: tool

    associate (start => trial%start)
      do tool = 1, model%n_tool
        trial%tools%layer_offset(tool) = layer_offset(model, trial, tool)
        trial%tools%load(:, tool) = model%phase(trial%phase)%tool_load(tool, trial%progress, &
            start%tool_load(:, tool), start%tool_load_end(:, tool))
      end do
    end associate
  end subroutine set_tools

  !> Evaluate the contact of a trial state, and the residuals from it and the internal forces.
  subroutine evaluate_forces(model, committed, trial, system)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Gets contact and residuals.
    type(system_t), intent(inout) :: system

    call evaluate_contact(system, model, committed, trial)
    call evaluate_residuals(model, committed, trial, system)
  end subroutine evaluate_forces

  !> Evaluate the residuals of a trial state from its internal forces and its contact.
  subroutine evaluate_residuals(model, committed, trial, system)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Has the contact, and gets the residuals.
    type(system_t), intent(inout) :: system

    real(wp) :: nearest(1), contact_forces(3, model%n_node)
    integer :: c, k, tool

    call trial%find_touching()
    call evaluate_terms(trial%term, model, committed%configuration_t, trial%configuration_t)
    trial%external_force = external_forces(trial%term, model, trial%configuration_t)
    associate (problem => system%problem, contact => system%contact, &
        phase => model%phase(trial%phase), force => trial%tools%force)
      contact_forces = model%own_contact_forces(trial%x, trial%contact%lambda, trial%contact%place)
      call system%partition%complete_forces(model%n_node, contact_forces)
      call share_bound(model, contact_forces)
      problem%residual = trial%sheet%internal_force - trial%external_force
      problem%residual = problem%residual + contact_forces
      problem%contact_residual = contact%force - trial%contact%lambda
      contact_forces = model%own_contact_forces(trial%x, problem%contact_residual, &
          trial%contact%place)
      call system%partition%complete_forces(model%n_node, contact_forces)
      call share_bound(model, contact_forces)
      problem%law_residual = problem%residual + contact_forces
      problem%bound_force = forces_on_bound(model, problem%law_residual)
      call give_to_parents(model, trial%x, problem%residual)
      call give_to_parents(model, trial%x, problem%law_residual)
      force = 0.0_wp
      do c = 1, model%n_contact
        tool = contact%tool(c)
        if (tool > 0) force(:, tool) = force(:, tool) + contact%force(:, c)
      end do
      call sum_over_ranks(size(force), force)
      do k = 1, size(trial%term)
        call trial%term(k)%of%add_tool_force(model, force)
      end do
      do tool = 1, model%n_tool
        problem%supported(tool) = on_spacer(phase, trial%tools, tool)
        if (problem%supported(tool)) trial%tools%touches(tool) = .true.
        if (phase%pressed(tool)) then
          problem%tool_residual(:, tool) = tool_balance(model, trial, tool, contact%force) &
              + support_balance(phase, trial%tools, tool)
          problem%tool_stiffness(:, :, tool) = support_matrix(phase, trial%tools, tool)
        end if
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
  end subroutine evaluate_residuals

  !> Return a tool that is pressed and has no contact; 0 if there is none.
  pure integer function lost_tool(model, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial

    do lost_tool = model%n_tool, 1, -1
      if (is_lost(model, trial, lost_tool)) return
    end do
  end function lost_tool

  !> Whether a tool is pressed and has no contact.
  pure logical function is_lost(model, trial, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    integer, intent(in) :: tool

    is_lost = model%phase(trial%phase)%pressed(tool) .and. &
        norm2(trial%tools%load(:, tool)) > 0.0_wp
    if (is_lost) is_lost = .not. trial%tools%touches(tool)
  end function is_lost

end module dd3_process_forces
