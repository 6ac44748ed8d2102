! SPDX-License-Identifier: GPL-3.0-or-later
!> Contributions of the contact points to the reduced system in the compliant formulation.
!>
!> The law of contact has one force at a gap, so that the force lambda of a point follows from its
!> own equation: with the law linearised as dF = D (dx - dw) + E dlambda (dx: the point's
!> displacement B du, dw: the tool's),
!>     dlambda = (I - E)^-1 [F - lambda + D (B du - dw)],
!>     [K + B^T (I - E)^-1 D B + G] du = -r - B^T (I - E)^-1 (F - lambda - D dw),
!> r with B^T lambda in it. G is the derivative of B^T F at a constant F. The motion of a pressed
!> tool is dw = A dq, with the unknowns q, A and the derivatives S and P of `pressed_tools`: its
!> columns of the rows of the nodes are B^T (S - (I - E)^-1 D A), its rows [A^T (I - E)^-1 D + P^T]
!> B. The slip does not turn with the tool: a point that has moved by h along the normal n in the
!> increment has, as the tool tilts by t, the further slip -h t x n.
module dd3_system_point_rows
  use dd3_base_kinds, only : wp
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_tensor, only : cross, identity, inverse
  use dd3_sheet_surface_point, only : surface_point_t, most_point_nodes
  use dd3_model_model, only : model_t
  use dd3_model_pressed_tools, only : arm_change, force_turn, motion_at, &
      point_motion
  use dd3_model_state, only : state_t
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_linear_problem, only : linear_problem_t, unknowns_t
  use dd3_system_tool_rows, only : add_block
  implicit none
  private
  public :: add_points, add_point, set_point_forces, force_change

contains

  !> Add the contributions of the points of this rank to matrix and right-hand side.
  subroutine add_points(matrix, problem, contact, position, model, state)
    type(block_matrix_t), intent(inout) :: matrix
    type(linear_problem_t), intent(inout) :: problem
    type(contact_work_t), intent(in) :: contact
    !> Of the blocks of the elements in the matrix.
    integer, intent(in) :: position(:, :, :)
    type(model_t), intent(in) :: model
    !> Of the linearisation.
    type(state_t), intent(in) :: state

    real(wp) :: motion(3)
    integer :: c, e, k

    associate (point => model%contact_point, phase => model%phase(state%phase))
      do k = 1, size(problem%point)
        c = problem%point(k)
        motion = 0.0_wp
        if (contact%status(c) == status_gap) then
          if (all(abs(problem%contact_residual(:, c)) <= 0.0_wp)) cycle
        else if (.not. phase%pressed(contact%tool(c))) then
          motion = problem%tool_prescribed(:, contact%tool(c))
        end if
        e = 0
        if (point(c)%n_node > 1) e = model%part%place(point(c)%element)
        call add_point(point(c)%at_place(contact%place(c)), contact, c, &
            problem%contact_residual(:, c), motion, state%x, position, e, matrix, problem%rhs)
        if (contact%status(c) == status_gap) cycle
        if (phase%pressed(contact%tool(c))) call couple_tool(matrix, problem, contact, model, &
            state, c)
      end do
    end associate
  end subroutine add_points

  !> Add the contributions of a point to the rows of its nodes.
  pure subroutine add_point(point, contact, c, residual, motion, x, position, e, matrix, rhs)
    type(surface_point_t), intent(in) :: point
    type(contact_work_t), intent(in) :: contact
    !> Number of the point.
    integer, intent(in) :: c
    !> F - lambda, N.
    real(wp), intent(in) :: residual(3)
    !> Of the tool, known in advance, mm.
    real(wp), intent(in) :: motion(3)
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Positions of the blocks of elements, and its element among them. A point at a node needs
    !> none: its element may belong to another rank.
    integer, intent(in) :: position(:, :, :), e
    type(block_matrix_t), intent(inout) :: matrix
    real(wp), intent(inout) :: rhs(:)

    real(wp) :: b(3, 3, most_point_nodes), weight(3, 3), stiffness(3, 3)

    call point%gradient(x, b)
    if (contact%status(c) == status_gap) then
      call add_force(point, b, -residual, rhs)
      return
    end if
    call eliminate(contact, c, weight, stiffness)
    call add_force(point, b, matmul(stiffness, motion) - matmul(weight, residual), rhs)
    if (point%n_node > 1) then
      call add_stiffness(matrix, point, position(:, :, e), x, b, stiffness, contact%force(:, c))
      if (point%moves) call add_crossing_stiffness(matrix, point, position(:, :, e), contact, c, &
          matmul(weight, contact%by_edge(:, :, c)))
    else
      associate (block => matrix%value(:, :, matrix%diagonal(point%node(1))))
        block = block + stiffness
      end associate
    end if
  end subroutine add_point

  !> Couple a point with its pressed tool: the tool's unknowns in the rows of the nodes; the motion
  !> of the nodes and of the tool itself in its balance.
  subroutine couple_tool(matrix, problem, contact, model, state, c)
    type(block_matrix_t), intent(inout) :: matrix
    type(linear_problem_t), intent(inout) :: problem
    type(contact_work_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Number of the point.
    integer, intent(in) :: c

    type(surface_point_t) :: point
    real(wp) :: b(3, 3, most_point_nodes), weight(3, 3), stiffness(3, 3)
    real(wp), dimension(3, 3) :: a, s, arm, by_node, line
    integer :: i

    point = model%contact_point(c)%at_place(contact%place(c))
    call point%gradient(state%x, b)
    call eliminate(contact, c, weight, stiffness)
    associate (phase => model%phase(state%phase), tool => contact%tool(c), &
        row => model%tool_row(contact%tool(c)))
      a = point_motion(phase, state%tools, tool, point%position(state%x))
      s = force_turn(phase, tool, contact%normal(:, c), contact%force(:, c)) - contact%rise(c) &
          *matmul(stiffness, force_turn(phase, tool, contact%normal(:, c), contact%normal(:, c)))
      arm = transpose(arm_change(phase, tool, contact%force(:, c)))
      by_node = matmul(transpose(a), stiffness) + arm
      do i = 1, point%n_node
        call add_block(matrix, point%node(i), row, &
            matmul(transpose(b(:, :, i)), s - matmul(stiffness, a)))
        call add_block(matrix, row, point%node(i), matmul(by_node, b(:, :, i)))
      end do
      line = 0.0_wp
      line(:, 1) = phase%direction(:, tool)
      call add_block(matrix, row, row, matmul(transpose(a), s - matmul(stiffness, a)) &
          - matmul(arm, line))
      associate (balance => problem%rhs(3*row - 2:3*row))
        balance = balance - matmul(matmul(weight - identity, problem%contact_residual(:, c)), a)
      end associate
    end associate
  end subroutine couple_tool

  !> Add nodal forces B^T f to a right-hand side.
  pure subroutine add_force(point, b, force, rhs)
    type(surface_point_t), intent(in) :: point
    real(wp), intent(in) :: b(:, :, :)
    !> N.
    real(wp), intent(in) :: force(3)
    real(wp), intent(inout) :: rhs(:)

    integer :: i

    do i = 1, point%n_node
      associate (n => 3*point%node(i))
        rhs(n - 2:n) = rhs(n - 2:n) + matmul(force, b(:, :, i))
      end associate
    end do
  end subroutine add_force

  !> Add B^T C B + G of a point between nodes to the matrix.
  pure subroutine add_stiffness(matrix, point, position, x, b, stiffness, force)
    type(block_matrix_t), intent(inout) :: matrix
    type(surface_point_t), intent(in) :: point
    !> Of the blocks of its element.
    integer, intent(in) :: position(:, :)
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), intent(in) :: b(3, 3, most_point_nodes)
    !> C, N/mm, and the force of the point, N.
    real(wp), intent(in) :: stiffness(3, 3), force(3)

    real(wp) :: block(3, 3, most_point_nodes, most_point_nodes), right(3, 3)
    integer :: i, j, k

    associate (local => point%local, value => matrix%value)
      call point%bending_stiffness(x, force, block)
      do j = 1, point%n_node
        right = matmul(stiffness, b(:, :, j))
        do i = 1, point%n_node
          k = position(local(i), local(j))
          value(:, :, k) = value(:, :, k) &
              + (block(:, :, i, j) + matmul(transpose(b(:, :, i)), right))
        end do
      end do
    end associate
  end subroutine add_stiffness

  !> Add what a point that moves on its edge has besides: the change of its force as the edge turns,
  !> and that of its place.
  pure subroutine add_crossing_stiffness(matrix, point, position, contact, c, by_edge)
    type(block_matrix_t), intent(inout) :: matrix
    type(surface_point_t), intent(in) :: point
    !> Of the blocks of its element.
    integer, intent(in) :: position(:, :)
    type(contact_work_t), intent(in) :: contact
    integer, intent(in) :: c
    !> Derivative of the force in the displacement of the second end less the first, N/mm.
    real(wp), intent(in) :: by_edge(3, 3)

    real(wp), parameter :: sides(2) = [-1.0_wp, 1.0_wp]
    real(wp) :: by_place(3)
    integer :: i, j, k, m

    associate (force => contact%force(:, c), w => point%weight)
      do j = 1, 2
        by_place = w(j)*contact%by_place(:, 1, c) + sides(j)*contact%by_place(:, 2, c)
        do i = 1, 2
          k = position(point%local(i), point%local(j))
          do m = 1, 3
            matrix%value(:, m, k) = matrix%value(:, m, k) + w(i)*sides(j)*by_edge(:, m) &
                + sides(i)*force*by_place(m)
          end do
        end do
      end do
    end associate
  end subroutine add_crossing_stiffness

  !> Evaluate (I - E)^-1 and (I - E)^-1 D of a point in contact.
  pure subroutine eliminate(contact, c, weight, stiffness)
    type(contact_work_t), intent(in) :: contact
    integer, intent(in) :: c
    real(wp), intent(out) :: weight(3, 3), stiffness(3, 3)

    logical :: regular

    call inverse(identity - contact%e(:, :, c), weight, regular)
    stiffness = matmul(weight, contact%d(:, :, c))
  end subroutine eliminate

  !> Set the increments of the forces of the points.
  pure subroutine set_point_forces(contact, problem, model, state, step)
    type(contact_work_t), intent(in) :: contact
    type(linear_problem_t), intent(in) :: problem
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Has the displacements.
    type(unknowns_t), intent(inout) :: step

    type(surface_point_t) :: point
    real(wp) :: motion(3)
    integer :: c, k

    step%lambda = 0.0_wp*state%contact%lambda
    do k = 1, size(problem%point)
      c = problem%point(k)
      step%lambda(:, c) = -state%contact%lambda(:, c)
      if (contact%status(c) == status_gap) cycle
      associate (tilt => step%tilt(:, contact%tool(c)), normal => contact%normal(:, c))
        point = model%contact_point(c)%at_place(contact%place(c))
        motion = -motion_at(state%tools, contact%tool(c), point%position(state%x), &
            step%tool(:, contact%tool(c)), tilt) - contact%rise(c)*cross(tilt, normal)
        step%lambda(:, c) = force_change(contact, c, problem%contact_residual(:, c), &
            model%contact_point(c), state%x, step%x, motion) &
            + cross(tilt - dot_product(normal, tilt)*normal, contact%force(:, c))
      end associate
    end do
  end subroutine set_point_forces

  !> Return the increment of the force of a point in contact, N.
  pure function force_change(contact, c, residual, contact_point, x, displacement, motion) &
      result(change)
    type(contact_work_t), intent(in) :: contact
    integer, intent(in) :: c
    !> F - lambda, N.
    real(wp), intent(in) :: residual(3)
    type(surface_point_t), intent(in) :: contact_point
    !> Positions and displacements of the nodes of the sheet, `(3, n_node)`, and the displacement
    !> of the tool, the other way, mm.
    real(wp), intent(in) :: x(:, :), displacement(:, :), motion(3)
    real(wp) :: change(3)

    type(surface_point_t) :: point
    real(wp) :: weight(3, 3), stiffness(3, 3), turn(3)

    call eliminate(contact, c, weight, stiffness)
    point = contact_point%at_place(contact%place(c))
    change = matmul(weight, residual) &
        + matmul(stiffness, point%change(x, displacement) + motion)
    if (.not. point%moves) return
    turn = displacement(:, point%node(2)) - displacement(:, point%node(1))
    change = change + matmul(weight, matmul(contact%by_edge(:, :, c), turn))
  end function force_change

end module dd3_system_point_rows
