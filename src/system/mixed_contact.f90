! SPDX-License-Identifier: GPL-3.0-or-later
!> Mixed formulation of the contact, an augmented Lagrangian: the contact forces are unknowns. They
!> follow from the rows of their nodes and are eliminated node by node.
!>
!> A node A with residual r_A = F_int - F_ext + lambda and contact operator F_equ(u, lambda),
!> linearised as dF_equ = D (du - dw) + E dlambda (dw: the tool's motion), gives
!>     dlambda_A = -r_A - K_A du,
!>     [(I - E) K_A + D] du - D dw = -[(I - E) r_A + F_equ - lambda].
!> Source: Menezes and Teodosiu, J. Mater. Process. Technol. 97 (2000) 100-106; Oliveira and
!> Menezes, Finite Elem. Anal. Des. 40 (2004) 1995-2010, eq. (6).
module dd3_system_mixed_contact
  use dd3_base_kinds, only : wp
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_contact_friction, only : coulomb, friction_t
  use dd3_contact_operator, only : contact_operator_of_status, contact_status, status_gap, &
      status_slip, status_stick
  use dd3_linalg_matrix, only : block_matrix_t, copy_blocks
  use dd3_linalg_partition, only : column_squares
  use dd3_linalg_tensor, only : identity
  use dd3_model_contact_data, only : side_faces
  use dd3_model_contact_layer, only : contact_penalty
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : is_normal_held, is_slip_prescribed, phase_t
  use dd3_model_state, only : state_t
  use dd3_system_contact_search, only : find_candidate, find_committed_candidate
  use dd3_system_contact_work, only : contact_work_t, open_candidate
  use dd3_system_formulation, only : formulation_t
  use dd3_system_linear_problem, only : linear_problem_t, unknowns_t
  use dd3_system_partition, only : partition_t
  use dd3_system_tool_rows, only : add_block
  use dd3_tools_closest, only : hit_t
  implicit none
  private
  public :: mixed_contact_t

  !> The formulation.
  type, extends(formulation_t) :: mixed_contact_t
    !> Stiffness of the sheet and the terms, from which the contact forces follow.
    type(block_matrix_t), private :: stiffness
  contains
    procedure :: evaluate
    procedure :: predict
    procedure :: reduce
    procedure :: read_forces
    procedure :: squares
  end type mixed_contact_t

  !> Factor on the penalty of a candidate whose supports hold it along the normal: its force does
  !> not follow from equilibrium, but grows or falls by the penalty times the gap in every
  !> iteration. Without the factor a ram that is lifted keeps its force there, 1993 of 2000 N in
  !> tests/cases/held_under_tool/held_in_mixed_contact.dat.
  real(wp), parameter :: held_factor = 1.0e4_wp
  !> Points that a thread takes at a time.
  integer, parameter :: chunk = 64

contains

  !> Evaluate the points in a trial state.
  subroutine evaluate(self, contact, model, committed, trial, points)
    class(mixed_contact_t), intent(in) :: self
    type(contact_work_t), intent(inout) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: points(:)

    integer :: k

    !$omp parallel do num_threads(threads_for(size(points), least_nodes)) private(k) &
    !$omp& schedule(dynamic, chunk)
    do k = 1, size(points)
      call evaluate_point(contact, model, committed, trial, points(k))
    end do
    !$omp end parallel do
  end subroutine evaluate

  !> Evaluate the contact at a point. Points that move on edges of the mesh have none.
  subroutine evaluate_point(contact, model, committed, trial, c)
    type(contact_work_t), intent(inout) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: c

    type(hit_t) :: hit
    real(wp) :: slip(3), penalty(2)

    if (model%contact_point(c)%moves) then
      call leave_out(contact, c)
      trial%contact%tool(c) = 0
      trial%contact%status(c) = status_gap
      return
    end if
    call find_candidate(contact, model, committed, trial, c, hit, slip)
    associate (tool => contact%tool(c))
      if (tool > 0) then
        penalty = candidate_penalty(model, model%phase(trial%phase), c, hit%normal, slip)
        contact%onset(c) = 0.0_wp
        contact%distance(c) = hit%distance + trial%tools%layer_offset(tool)
        contact%status(c) = contact_status(hit%normal, contact%distance(c), &
            trial%contact%lambda(:, c), slip, penalty, model%tool(tool)%friction, &
            contact%sliding(c))
        call contact_operator_of_status(contact%status(c), hit%normal, contact%distance(c), &
            hit%dnormal, trial%contact%lambda(:, c), slip, penalty, model%tool(tool)%friction, &
            contact%sliding(c), contact%force(:, c), contact%d(:, :, c), contact%e(:, :, c))
      end if
    end associate
    trial%contact%status(c) = contact%status(c)
  end subroutine evaluate_point

  !> Leave out a point.
  subroutine leave_out(contact, c)
    type(contact_work_t), intent(inout) :: contact
    integer, intent(in) :: c

    contact%tool(c) = 0
    call open_candidate(contact, c)
  end subroutine leave_out

  !> Return the penalties of a candidate on gap and slip at a point of a tool, N/mm. The tangential
  !> force of a candidate whose supports prescribe a slip does not follow from equilibrium, but from
  !> sigma_t: in every iteration it takes the direction of its last value and the penalty times the
  !> slip. With the stiffness of the sheet under the candidate the slip outweighs a friction force,
  !> and the force has the direction of the slip at once.
  pure function candidate_penalty(model, phase, c, normal, slip) result(penalty)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c
    !> Of the tool, and relative to it, mm.
    real(wp), intent(in) :: normal(3), slip(3)
    real(wp) :: penalty(2)

    penalty = contact_penalty(model, phase, c)
    associate (node => model%contact_node(c))
      if (is_normal_held(phase, node, normal)) penalty = held_factor*penalty
      if (is_slip_prescribed(phase, node, normal, slip)) penalty(2) = &
          max(penalty(2), model%contact_stiffness(c, side_faces))
    end associate
  end function candidate_penalty

  !> Evaluate the points at the committed state: a slipping node lies on the cone, where round-off
  !> would make it stick. If a tool has no contact, the nodes within `touch` of it stick without
  !> being pulled, unless it moves away from them. A gap that has closed resists without friction.
  subroutine predict(self, contact, model, committed, touching)
    class(mixed_contact_t), intent(in) :: self
    type(contact_work_t), intent(inout) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    logical, intent(in) :: touching(:)

    integer :: c

    !$omp parallel do num_threads(threads_for(model%n_contact, least_nodes)) private(c) &
    !$omp& schedule(dynamic, chunk)
    do c = 1, model%n_contact
      call predict_point(contact, model, committed, touching, c)
    end do
    !$omp end parallel do
  end subroutine predict

  !> Evaluate the contact at a point at the committed state.
  subroutine predict_point(contact, model, committed, touching, c)
    type(contact_work_t), intent(inout) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    logical, intent(in) :: touching(:)
    integer, intent(in) :: c

    real(wp), parameter :: no_slip(3) = 0.0_wp
    type(hit_t) :: hit
    type(friction_t) :: friction
    logical :: leaving

    if (model%contact_point(c)%moves) then
      contact%near(c) = .false.
      contact%committed_tool(c) = 0
      call leave_out(contact, c)
      return
    end if
    call find_committed_candidate(contact, model, committed, c, hit)
    if (contact%tool(c) == 0) return
    associate (phase => model%phase(committed%phase), tool => contact%tool(c))
      contact%onset(c) = 0.0_wp
      contact%distance(c) = hit%distance + committed%tools%layer_offset(tool)
      friction = model%tool(tool)%friction
      leaving = dot_product(phase%tool_rate(tool, committed%progress, &
          committed%start%tool_displacement) + contact%turning(:, c), hit%normal) < 0.0_wp
      if (.not. touching(tool)) then
        contact%status(c) = status_gap
        if (contact%distance(c) <= model%tolerance%touch .and. .not. leaving) then
          contact%status(c) = status_stick
        end if
      else if (contact%status(c) == status_gap .and. .not. leaving .and. &
          contact%distance(c) < 0.0_wp) then
        contact%status(c) = status_slip
        friction = coulomb(0.0_wp)
      end if
      call contact_operator_of_status(contact%status(c), hit%normal, 0.0_wp, hit%dnormal, &
          committed%contact%lambda(:, c), no_slip, &
          candidate_penalty(model, phase, c, hit%normal, no_slip), friction, &
          contact%sliding(c), contact%force(:, c), contact%d(:, :, c), contact%e(:, :, c))
    end associate
  end subroutine predict_point

  !> Keep the stiffness, and reduce the rows of the nodes in contact.
  subroutine reduce(self, matrix, problem, contact, partition, position, model, state)
    class(mixed_contact_t), intent(inout) :: self
    type(block_matrix_t), intent(inout) :: matrix
    type(linear_problem_t), intent(inout) :: problem
    type(contact_work_t), intent(in) :: contact
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: position(:, :, :)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    integer :: c

    call partition%complete_rows(matrix)
    if (allocated(self%stiffness%value)) then
      call copy_blocks(matrix, self%stiffness)
    else
      self%stiffness = matrix
    end if
    do c = 1, model%n_contact
      associate (rhs => problem%rhs, node => model%contact_node(c))
        if (contact%status(c) == status_gap) then
          rhs(3*node - 2:3*node) = rhs(3*node - 2:3*node) - problem%contact_residual(:, c)
        else
          call reduce_node(matrix, problem, contact, model, model%phase(state%phase), c)
        end if
      end associate
    end do
  end subroutine reduce

  !> Replace the row of a candidate in contact by its reduced row, and add its contribution to the
  !> row of a pressed tool.
  subroutine reduce_node(reduced, problem, contact, model, phase, c)
    type(block_matrix_t), intent(inout) :: reduced
    type(linear_problem_t), intent(inout) :: problem
    type(contact_work_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c

    real(wp) :: remaining(3, 3), residual(3), weight(3), along(3, 3)
    integer :: node, tool, block, k, at
    logical :: pressed

    node = model%contact_node(c)
    tool = contact%tool(c)
    block = model%tool_row(tool)
    pressed = phase%pressed(tool)
    associate (line => phase%direction(:, tool), d => contact%d(:, :, c), e => contact%e(:, :, c))
      remaining = identity - e
      residual = node_residual(phase, problem, node, c)
      problem%rhs(3*node - 2:3*node) = -matmul(remaining, residual) - problem%contact_residual(:, c)
      if (.not. pressed) then
        problem%rhs(3*node - 2:3*node) = problem%rhs(3*node - 2:3*node) &
            + matmul(d, problem%tool_prescribed(:, tool))
      else
        problem%rhs(3*block - 2) = problem%rhs(3*block - 2) + dot_product(line, matmul(e, residual))
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
          reduced%value(1, :, at) = reduced%value(1, :, at) &
              + matmul(weight, reduced%value(:, :, k))
        end if
        reduced%value(:, :, k) = matmul(remaining, reduced%value(:, :, k))
      end do
      k = reduced%diagonal(node)
      reduced%value(:, :, k) = reduced%value(:, :, k) + d
      if (.not. pressed) return
      along = 0.0_wp
      along(:, 1) = line
      call add_block(reduced, node, block, -matmul(d, along))
      call add_block(reduced, block, node, matmul(transpose(along), d))
      call add_block(reduced, block, block, -matmul(transpose(along), matmul(d, along)))
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

  !> Set the increments of the contact forces of the nodes: dlambda_A = -r_A - K_A du.
  subroutine read_forces(self, contact, problem, model, state, step)
    class(mixed_contact_t), intent(in) :: self
    type(contact_work_t), intent(in) :: contact
    type(linear_problem_t), intent(in) :: problem
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(unknowns_t), intent(inout) :: step

    real(wp) :: change(3)
    integer :: c, node, k

    step%lambda = -state%contact%lambda
    associate (stiffness => self%stiffness, phase => model%phase(state%phase))
      do c = 1, model%n_contact
        node = model%contact_node(c)
        if (contact%status(c) == status_gap) cycle
        change = 0.0_wp
        do k = stiffness%row_start(node), stiffness%row_start(node + 1) - 1
          if (stiffness%column(k) > model%n_node) exit
          change = change + matmul(stiffness%value(:, :, k), step%x(:, stiffness%column(k)))
        end do
        where (phase%prescribed(:, node)) change = 0.0_wp
        step%lambda(:, c) = -node_residual(phase, problem, node, c) - change
      end do
    end associate
  end subroutine read_forces

  !> Return the sums of the squares in the columns of the stiffness of the sheet.
  function squares(self, matrix, n_node) result(square)
    class(mixed_contact_t), intent(in) :: self
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: n_node
    real(wp), allocatable :: square(:, :)

    square = column_squares(self%stiffness, n_node)
  end function squares

end module dd3_system_mixed_contact
