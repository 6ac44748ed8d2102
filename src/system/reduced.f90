! SPDX-License-Identifier: GPL-3.0-or-later
!> Reduced system: the matrix with the contact, supports, and a row of force balance for every
!> pressed tool.
module dd3_system_reduced
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : this_rank
  use dd3_linalg_matrix, only : set_unit_row
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_pressed_tools, only : motion_of
  use dd3_model_state, only : state_t
  use dd3_system_bound_rows, only : set_bound_displacements
  use dd3_system_enhanced, only : enhanced_response
  use dd3_system_linear_problem, only : linear_problem_t, unknowns_t
  use dd3_system_system, only : system_t
  use dd3_system_tool_rows, only : finish_tool_rows, share_tool_rows, start_tool_rows
  implicit none
  private
  public :: reduce, read_step

contains

  !> Make the assembled stiffness the reduced matrix, of several ranks each its rows, and build the
  !> right-hand side.
  subroutine reduce(system, model, state)
    !> With stiffness, newly assembled, contact, residuals and prescribed values at the state.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    associate (phase => model%phase(state%phase), problem => system%problem)
      call start_rhs(problem, model)
      call start_tool_rows(system, model, phase)
      call system%formulation%reduce(system%matrix, problem, system%contact, system%partition, &
          system%position, model, state)
      if (model%part%divided) call share_tool_rows(system, model, phase)
      call finish_tool_rows(system, model, phase)
      call prescribe(system, phase)
    end associate
  end subroutine reduce

  !> Set the right-hand side of the nodes of this rank to their residuals, and that of others to
  !> zero.
  subroutine start_rhs(problem, model)
    type(linear_problem_t), intent(inout) :: problem
    type(model_t), intent(in) :: model

    integer :: node, rank

    problem%rhs(:3*model%n_node) = -reshape(problem%residual, [3*model%n_node])
    if (.not. model%part%divided) return
    rank = this_rank()
    do node = 1, model%n_node
      if (model%part%node_owner(node) /= rank) problem%rhs(3*node - 2:3*node) = 0.0_wp
    end do
  end subroutine start_rhs

  !> Make the rows of prescribed displacements unit rows.
  subroutine prescribe(system, phase)
    type(system_t), intent(inout) :: system
    type(phase_t), intent(in) :: phase

    integer :: node, i

    associate (reduced => system%matrix)
      do node = 1, size(phase%prescribed, 2)
        system%problem%rhs(3*node - 2:3*node) = merge(system%problem%prescribed(:, node), &
            system%problem%rhs(3*node - 2:3*node), phase%prescribed(:, node))
        ! Of several ranks some have no blocks in this row.
        if (reduced%diagonal(node) == 0) cycle
        do i = 1, 3
          if (phase%prescribed(i, node)) call set_unit_row(reduced, node, i)
        end do
      end do
    end associate
  end subroutine prescribe

  !> Set a step of the unknowns from the solution, but for the offset of the enhanced strains. A
  !> candidate in gap status loses its force.
  subroutine read_step(system, model, state, step)
    !> Solved; the solution gets the displacements of the bound nodes.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    !> State of the linearisation.
    type(state_t), intent(in) :: state
    type(unknowns_t), intent(inout) :: step

    integer :: tool, row

    call set_bound_displacements(model, state%x, system%problem%solution)
    associate (phase => model%phase(state%phase), solution => system%problem%solution)
      step%x = reshape(solution(:3*model%n_node), [3, model%n_node])
      step%enhanced = enhanced_response(system%enhanced, model, solution)
      step%tool = system%problem%tool_prescribed
      step%tilt = 0.0_wp*step%tool
      do tool = 1, model%n_tool
        row = 3*model%tool_row(tool)
        if (phase%pressed(tool)) call motion_of(phase, tool, solution(row - 2:row), &
            step%tool(:, tool), step%tilt(:, tool))
      end do
      call system%formulation%read_forces(system%contact, system%problem, model, state, step)
    end associate
  end subroutine read_step

end module dd3_system_reduced
