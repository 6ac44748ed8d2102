! SPDX-License-Identifier: GPL-3.0-or-later
!> Contributions of the contact points to the reduced system in the compliant formulation.
!>
!> The law of contact has one force at a gap, so that the force lambda of a point follows from its
!> own equation: with the law linearised as dF = D (dx - dw) + E dlambda (dx: the point's
!> displacement B du, dw: the tool's),
!>     dlambda = (I - E)^-1 [F - lambda + D (B du - dw)],
!>     [K + B^T (I - E)^-1 D B + G] du = -r - B^T (I - E)^-1 (F - lambda - D dw),
!> r with B^T lambda in it. G is the derivative of B^T F at a constant F.
module dd3_system_point_rows
  use dd3_base_kinds, only : wp
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_tensor, only : identity, inverse
  use dd3_model_contact_point, only : contact_point_t, most_point_nodes
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_linear_problem, only : linear_problem_t, unknowns_t
  use dd3_system_tool_rows, only : add_to_tool_row, force_row
  implicit none
  private
  public :: add_points, add_point, set_point_forces, force_change

contains

  !> Add the contributions of the points of this rank to matrix and right-hand side.
  subroutine add_points(matrix, problem, contact, position, model, phase, x)
    type(block_matrix_t), intent(inout) :: matrix
    type(linear_problem_t), intent(inout) :: problem
    type(contact_work_t), intent(in) :: contact
    !> Of the blocks of the elements in the matrix.
    integer, intent(in) :: position(:, :, :)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    real(wp) :: motion(3)
    integer :: c, e

    associate (point => model%contact_point)
      do c = 1, model%n_contact
        motion = 0.0_wp
        if (contact%status(c) == status_gap) then
          if (all(abs(problem%contact_residual(:, c)) <= 0.0_wp)) cycle
        else if (.not. phase%pressed(contact%tool(c))) then
          motion = problem%tool_prescribed(:, contact%tool(c))
        end if
        e = 0
        if (point(c)%n_node > 1) e = model%part%place(point(c)%element)
        call add_point(point(c)%at_place(contact%place(c)), contact, c, &
            problem%contact_residual(:, c), motion, x, point(c)%node, position, e, matrix, &
            problem%rhs)
        if (contact%status(c) == status_gap) cycle
        if (phase%pressed(contact%tool(c))) call add_to_tool(matrix, problem, &
            contact, model, phase, c, x)
      end do
    end associate
  end subroutine add_points

  !> Add the contributions of a point to the rows of its nodes.
  pure subroutine add_point(point, contact, c, residual, motion, x, row, position, e, matrix, rhs)
    type(contact_point_t), intent(in) :: point
    type(contact_work_t), intent(in) :: contact
    !> Number of the point.
    integer, intent(in) :: c
    !> F - lambda, N.
    real(wp), intent(in) :: residual(3)
    !> Of the tool, known in advance, mm.
    real(wp), intent(in) :: motion(3)
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Block rows of its nodes; positions of the blocks of elements, and its element among them. A
    !> point at a node needs none: its element may belong to another rank.
    integer, intent(in) :: row(:), position(:, :, :), e
    type(block_matrix_t), intent(inout) :: matrix
    real(wp), intent(inout) :: rhs(:)

    real(wp) :: b(3, 3, most_point_nodes), weight(3, 3), stiffness(3, 3)

    call point%gradient(x, b)
    if (contact%status(c) == status_gap) then
      call add_force(point, b, -residual, row, rhs)
      return
    end if
    call eliminate(contact, c, weight, stiffness)
    call add_force(point, b, matmul(stiffness, motion) - matmul(weight, residual), row, rhs)
    if (point%n_node > 1) then
      call add_stiffness(matrix, point, position(:, :, e), x, b, stiffness, contact%force(:, c))
      if (point%moves) call add_crossing_stiffness(matrix, point, position(:, :, e), contact, c, &
          matmul(weight, contact%by_edge(:, :, c)))
    else
      associate (block => matrix%value(:, :, matrix%diagonal(row(1))))
        block = block + stiffness
      end associate
    end if
  end subroutine add_point

  !> Couple a point with its pressed tool.
  subroutine add_to_tool(matrix, problem, contact, model, phase, c, x)
    type(block_matrix_t), intent(inout) :: matrix
    type(linear_problem_t), intent(inout) :: problem
    type(contact_work_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Number of the point.
    integer, intent(in) :: c
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    type(contact_point_t) :: point
    real(wp) :: b(3, 3, most_point_nodes), weight(3, 3), stiffness(3, 3)

    point = model%contact_point(c)%at_place(contact%place(c))
    associate (tool => contact%tool(c))
      call eliminate(contact, c, weight, stiffness)
      call add_to_balance(problem%rhs, model%tool_row(tool), phase%direction(:, tool), &
          matmul(weight - identity, problem%contact_residual(:, c)))
      call point%gradient(x, b)
      call couple_tool(matrix, point, model%tool_row(tool), phase%direction(:, tool), b, stiffness)
    end associate
  end subroutine add_to_tool

  !> Add nodal forces B^T f to a right-hand side.
  pure subroutine add_force(point, b, force, row, rhs)
    type(contact_point_t), intent(in) :: point
    real(wp), intent(in) :: b(:, :, :)
    !> N.
    real(wp), intent(in) :: force(3)
    !> Block rows of the nodes of the point.
    integer, intent(in) :: row(:)
    real(wp), intent(inout) :: rhs(:)

    integer :: i

    do i = 1, point%n_node
      associate (n => 3*row(i))
        rhs(n - 2:n) = rhs(n - 2:n) + matmul(force, b(:, :, i))
      end associate
    end do
  end subroutine add_force

  !> Add B^T C B + G of a point between nodes to the matrix.
  pure subroutine add_stiffness(matrix, point, position, x, b, stiffness, force)
    type(block_matrix_t), intent(inout) :: matrix
    type(contact_point_t), intent(in) :: point
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
    type(contact_point_t), intent(in) :: point
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

  !> Add the force of a point to the right-hand side of the force balance of its pressed tool.
  pure subroutine add_to_balance(rhs, block, line, force)
    real(wp), intent(inout) :: rhs(:)
    !> Block row of the tool.
    integer, intent(in) :: block
    !> Unit vector along the line of its motion, and the force of the point, N.
    real(wp), intent(in) :: line(3), force(3)

    associate (balance => rhs(3*(block - 1) + force_row(line)))
      balance = balance - dot_product(line, force)
    end associate
  end subroutine add_to_balance

  !> Couple a point with its pressed tool: the tool's displacement in the rows of the nodes; theirs
  !> and its own in its force balance.
  subroutine couple_tool(reduced, point, block, line, b, stiffness)
    type(block_matrix_t), intent(inout) :: reduced
    type(contact_point_t), intent(in) :: point
    !> Block row of the tool.
    integer, intent(in) :: block
    !> Unit vector along the line of its motion.
    real(wp), intent(in) :: line(3)
    real(wp), intent(in) :: b(3, 3, most_point_nodes)
    !> C, N/mm.
    real(wp), intent(in) :: stiffness(3, 3)

    integer :: i, k, row

    row = force_row(line)
    do i = 1, point%n_node
      k = position_of(reduced, point%node(i), block)
      reduced%value(:, :, k) = reduced%value(:, :, k) - matmul(transpose(b(:, :, i)), stiffness)
      call add_to_tool_row(reduced, block, row, point%node(i), &
          matmul(matmul(line, stiffness), b(:, :, i)))
    end do
    call add_to_tool_row(reduced, block, row, block, -matmul(line, stiffness))
  end subroutine couple_tool

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

    real(wp) :: motion(3)
    integer :: c

    step%lambda = -state%contact%lambda
    do c = 1, model%n_contact
      if (contact%status(c) == status_gap) cycle
      motion = -step%tool(:, contact%tool(c))
      step%lambda(:, c) = force_change(contact, c, problem%contact_residual(:, c), &
          model%contact_point(c), state%x, step%x, motion)
    end do
  end subroutine set_point_forces

  !> Return the increment of the force of a point in contact, N.
  pure function force_change(contact, c, residual, contact_point, x, displacement, motion) &
      result(change)
    type(contact_work_t), intent(in) :: contact
    integer, intent(in) :: c
    !> F - lambda, N.
    real(wp), intent(in) :: residual(3)
    type(contact_point_t), intent(in) :: contact_point
    !> Positions and displacements of the nodes of the sheet, `(3, n_node)`, and the displacement
    !> of the tool, the other way, mm.
    real(wp), intent(in) :: x(:, :), displacement(:, :), motion(3)
    real(wp) :: change(3)

    type(contact_point_t) :: point
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
