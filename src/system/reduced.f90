! SPDX-License-Identifier: GPL-3.0-or-later
!> Reduced system: contact forces eliminated node by node from the mixed equations, supports, and a
!> row of force balance for every pressed tool.
!>
!> A candidate node A with residual r_A = F_int - F_ext + lambda and contact operator F_equ(u,
!> lambda), linearised as dF_equ = D (du - dw) + E dlambda (dw: the tool's motion), gives
!>     dlambda_A = -r_A - K_A du,
!>     [(I - E) K_A + D] du - D dw = -[(I - E) r_A + F_equ - lambda].
!> Source: Menezes and Teodosiu, J. Mater. Process. Technol. 97 (2000) 100-106; Oliveira and
!> Menezes, Finite Elem. Anal. Des. 40 (2004) 1995-2010, eq. (6).
module dd3_system_reduced
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : this_rank
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_matrix, only : copy_blocks, position_of, set_unit_row
  use dd3_linalg_partition, only : holds_row
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_system_enhanced, only : enhanced_response
  use dd3_system_linear_problem, only : linear_problem_t, unknowns_t
  use dd3_system_point_rows, only : add_points, set_point_forces
  use dd3_system_system, only : system_t
  use dd3_system_tool_rows, only : add_to_tool_row, finish_tool_rows, force_row, share_tool_rows, &
      start_tool_rows
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
      if (phase%mixed) call keep_stiffness(system)
      call start_rhs(problem, model)
      call start_tool_rows(system, model, phase)
      if (phase%mixed) then
        call reduce_nodes(system, model, phase)
      else
        call add_points(system, model, phase, state%x)
        call system%partition%complete_rows(system%matrix)
        call system%partition%complete_forces(model%n_node, problem%rhs)
      end if
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

  !> Complete the stiffness of the sheet and keep a copy.
  subroutine keep_stiffness(system)
    type(system_t), intent(inout) :: system

    call system%partition%complete_rows(system%matrix)
    if (allocated(system%stiffness%value)) then
      call copy_blocks(system%matrix, system%stiffness)
    else
      system%stiffness = system%matrix
    end if
  end subroutine keep_stiffness

  !> Reduce the rows of all candidates in the mixed formulation.
  subroutine reduce_nodes(system, model, phase)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    integer :: c, node

    associate (problem => system%problem, contact => system%contact)
      do c = 1, model%n_contact
        node = model%contact_node(c)
        if (contact%status(c) == status_gap) then
          problem%rhs(3*node - 2:3*node) = problem%rhs(3*node - 2:3*node) - &
              problem%contact_residual(:, c)
          cycle
        end if
        call reduce_node(system, model, phase, c)
      end do
    end associate
  end subroutine reduce_nodes

  !> Replace the row of a candidate in contact by its reduced row, and add its contribution to the
  !> row of a pressed tool.
  subroutine reduce_node(system, model, phase, c)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c

    real(wp) :: remaining(3, 3), residual(3), weight(3)
    integer :: node, tool, block, k, at, row
    logical :: pressed

    node = model%contact_node(c)
    tool = system%contact%tool(c)
    block = model%tool_row(tool)
    pressed = phase%pressed(tool)
    associate (problem => system%problem, reduced => system%matrix, &
        line => phase%direction(:, tool), d => system%contact%d(:, :, c), &
        e => system%contact%e(:, :, c))
      remaining = identity - e
      residual = node_residual(phase, problem, node, c)
      problem%rhs(3*node - 2:3*node) = -matmul(remaining, residual) - problem%contact_residual(:, c)
      if (.not. pressed) then
        problem%rhs(3*node - 2:3*node) = problem%rhs(3*node - 2:3*node) &
            + matmul(d, problem%tool_prescribed(:, tool))
      else
        row = force_row(line)
        problem%rhs(3*(block - 1) + row) = problem%rhs(3*(block - 1) + row) &
            + dot_product(line, matmul(e, residual))
      end if
      weight = -matmul(line, e)
      do k = 1, 3
        if (.not. phase%prescribed(k, node)) cycle
        remaining(:, k) = 0.0_wp
        weight(k) = 0.0_wp
      end do
      ! The columns of both rows ascend, and all of the node's are among the tool's.
      if (pressed) at = reduced%row_start(block)
      do k = reduced%row_start(node), reduced%row_start(node + 1) - 1
        if (reduced%column(k) > model%n_node) exit
        if (pressed) then
          do while (reduced%column(at) < reduced%column(k))
            at = at + 1
          end do
          reduced%value(row, :, at) = reduced%value(row, :, at) &
              + matmul(weight, reduced%value(:, :, k))
        end if
        reduced%value(:, :, k) = matmul(remaining, reduced%value(:, :, k))
      end do
      k = reduced%diagonal(node)
      reduced%value(:, :, k) = reduced%value(:, :, k) + d
      if (.not. pressed) return
      reduced%value(:, :, position_of(reduced, node, block)) = -d
      weight = matmul(line, d)
      call add_to_tool_row(reduced, block, row, node, weight)
      call add_to_tool_row(reduced, block, row, block, -weight)
    end associate
  end subroutine reduce_node

  !> Return the residual of a candidate in contact. At supported degrees of freedom, where the
  !> equilibrium holds the unknown reaction, the contact force follows the contact law instead.
  pure function node_residual(phase, problem, node, c) result(residual)
    type(phase_t), intent(in) :: phase
    type(linear_problem_t), intent(in) :: problem
    !> The node and its number among the candidates.
    integer, intent(in) :: node, c
    real(wp) :: residual(3)

    residual = merge(-problem%contact_residual(:, c), problem%residual(:, node), &
        phase%prescribed(:, node))
  end function node_residual

  !> Make the rows of prescribed displacements unit rows.
  subroutine prescribe(system, phase)
    type(system_t), intent(inout) :: system
    type(phase_t), intent(in) :: phase

    integer :: node, i

    associate (reduced => system%matrix)
      do node = 1, size(phase%prescribed, 2)
        system%problem%rhs(3*node - 2:3*node) = merge(system%problem%prescribed(:, node), &
            system%problem%rhs(3*node - 2:3*node), phase%prescribed(:, node))
        if (.not. holds_row(reduced, node)) cycle
        do i = 1, 3
          if (phase%prescribed(i, node)) call set_unit_row(reduced, node, i)
        end do
      end do
    end associate
  end subroutine prescribe

  !> Set a step of the unknowns from the solution, but for the offset of the enhanced strains. A
  !> candidate in gap status loses its force.
  subroutine read_step(system, model, state, step)
    !> Solved.
    type(system_t), intent(in) :: system
    type(model_t), intent(in) :: model
    !> State of the linearisation.
    type(state_t), intent(in) :: state
    type(unknowns_t), intent(inout) :: step

    integer :: tool, row

    associate (phase => model%phase(state%phase), solution => system%problem%solution)
      step%x = reshape(solution(:3*model%n_node), [3, model%n_node])
      step%enhanced = enhanced_response(system%enhanced, model, solution)
      step%tool = system%problem%tool_prescribed
      do tool = 1, model%n_tool
        row = 3*model%tool_row(tool)
        if (phase%pressed(tool)) step%tool(:, tool) = solution(row - 2:row)
      end do
      if (phase%mixed) then
        call set_node_forces(system, model, state, step)
      else
        call set_point_forces(system, model, state, step)
      end if
    end associate
  end subroutine read_step

  !> Set the increments of the contact forces of the nodes: dlambda_A = -r_A - K_A du.
  subroutine set_node_forces(system, model, state, step)
    type(system_t), intent(in) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Has the displacements.
    type(unknowns_t), intent(inout) :: step

    real(wp) :: change(3)
    integer :: c, node, k

    step%lambda = -state%lambda
    associate (stiffness => system%stiffness, phase => model%phase(state%phase))
      do c = 1, model%n_contact
        node = model%contact_node(c)
        if (system%contact%status(c) == status_gap) cycle
        change = 0.0_wp
        do k = stiffness%row_start(node), stiffness%row_start(node + 1) - 1
          if (stiffness%column(k) > model%n_node) exit
          change = change + matmul(stiffness%value(:, :, k), step%x(:, stiffness%column(k)))
        end do
        where (phase%prescribed(:, node)) change = 0.0_wp
        step%lambda(:, c) = -node_residual(phase, system%problem, node, c) - change
      end do
    end associate
  end subroutine set_node_forces

end module dd3_system_reduced
