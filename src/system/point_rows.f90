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
  use dd3_linalg_partition, only : holds_row
  use dd3_linalg_tensor, only : identity, inverse
  use dd3_model_contact_point, only : contact_point_t, most_point_nodes
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_linear_problem, only : linear_problem_t
  use dd3_system_tool_rows, only : add_to_tool_row, force_row
  implicit none
  private
  public :: add_points, point_force_increment

contains

  !> Add the contributions of all points.
  subroutine add_points(model, phase, contact, x, position, problem, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Evaluated at the positions.
    type(contact_work_t), intent(in) :: contact
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Positions of the blocks of each element in the matrix, see `find_positions`.
    integer, intent(in) :: position(:, :, :)
    !> Residuals; gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    type(block_matrix_t), intent(inout) :: reduced

    real(wp) :: b(3, 3, most_point_nodes), weight(3, 3), stiffness(3, 3), force(3)
    !> Coupling of the nodes with a pressed tool: its displacement in their rows, theirs in its row.
    real(wp) :: column(3, 3, model%n_node), row(3, model%n_node), own(3)
    integer :: c, i, tool

    do c = 1, model%n_contact
      if (contact%status(c) == status_gap) then
        if (all(abs(problem%contact_residual(:, c)) <= 0.0_wp)) cycle
        call model%contact_point(c)%gradient(x, b)
        call add_force(model%contact_point(c), b, -problem%contact_residual(:, c), problem%rhs)
        cycle
      end if
      tool = contact%tool(c)
      call eliminate(contact, c, weight, stiffness)
      force = matmul(weight, problem%contact_residual(:, c))
      if (.not. phase%pressed(tool)) &
          force = force - matmul(stiffness, problem%tool_prescribed(:, tool))
      call model%contact_point(c)%gradient(x, b)
      call add_force(model%contact_point(c), b, -force, problem%rhs)
      call add_point_stiffness(model%contact_point(c), x, b, stiffness, contact%force(:, c), &
          position, reduced)
    end do
    do tool = 1, model%n_tool
      if (.not. phase%pressed(tool)) cycle
      column = 0.0_wp
      row = 0.0_wp
      own = 0.0_wp
      associate (line => phase%direction(:, tool), block => model%tool_row(tool))
        associate (balance => problem%rhs(3*(block - 1) + force_row(line)))
          do c = 1, model%n_contact
            if (contact%tool(c) /= tool .or. contact%status(c) == status_gap) cycle
            call eliminate(contact, c, weight, stiffness)
            balance = balance - dot_product(line, &
                matmul(weight - identity, problem%contact_residual(:, c)))
            call model%contact_point(c)%gradient(x, b)
            own = own + matmul(line, stiffness)
            do i = 1, model%contact_point(c)%n_node
              associate (node => model%contact_point(c)%node(i))
                column(:, :, node) = column(:, :, node) &
                    + matmul(transpose(b(:, :, i)), stiffness)
                row(:, node) = row(:, node) + matmul(matmul(line, stiffness), b(:, :, i))
              end associate
            end do
          end do
        end associate
        call couple_tool(block, force_row(line), column, row, own, reduced)
      end associate
    end do
  end subroutine add_points

  !> Add a multiple of nodal forces B^T f to a right-hand side.
  pure subroutine add_force(point, b, force, rhs)
    type(contact_point_t), intent(in) :: point
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

  !> Add B^T C B + G of a point to the matrix.
  pure subroutine add_point_stiffness(point, x, b, stiffness, force, position, reduced)
    type(contact_point_t), intent(in) :: point
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), intent(in) :: b(3, 3, most_point_nodes)
    !> C, N/mm, and the force of the point, N.
    real(wp), intent(in) :: stiffness(3, 3), force(3)
    integer, intent(in) :: position(:, :, :)
    type(block_matrix_t), intent(inout) :: reduced

    real(wp) :: block(3, 3, most_point_nodes, most_point_nodes), right(3, 3)
    integer :: i, j, k

    associate (e => point%element, local => point%local)
      if (point%n_node == 1) then
        k = position(local(1), local(1), e)
        reduced%value(:, :, k) = reduced%value(:, :, k) + stiffness
        return
      end if
      call point%bending_stiffness(x, force, block)
      do j = 1, point%n_node
        right = matmul(stiffness, b(:, :, j))
        do i = 1, point%n_node
          k = position(local(i), local(j), e)
          reduced%value(:, :, k) = reduced%value(:, :, k) &
              + (block(:, :, i, j) + matmul(transpose(b(:, :, i)), right))
        end do
      end do
    end associate
  end subroutine add_point_stiffness

  !> Add the coupling of nodes and a pressed tool.
  subroutine couple_tool(block, force_row, column, row, own, reduced)
    !> Block row of the tool, and the row in it of the force balance.
    integer, intent(in) :: block, force_row
    !> Coupling, `(3, 3, n_node)` and `(3, n_node)`, and that of the tool with itself, N/mm.
    real(wp), intent(in) :: column(:, :, :), row(:, :), own(3)
    type(block_matrix_t), intent(inout) :: reduced

    integer :: node, k

    do node = 1, size(row, 2)
      if (all(abs(column(:, :, node)) <= 0.0_wp)) cycle
      if (.not. holds_row(reduced, node)) cycle
      k = position_of(reduced, node, block)
      reduced%value(:, :, k) = reduced%value(:, :, k) - column(:, :, node)
      call add_to_tool_row(reduced, block, force_row, node, row(:, node))
    end do
    if (holds_row(reduced, block)) call add_to_tool_row(reduced, block, force_row, block, -own)
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

  !> Return the increments of the forces of the points from the solution.
  pure subroutine point_force_increment(model, phase, contact, x, problem, increment)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    type(linear_problem_t), intent(in) :: problem
    !> `(3, n_contact)`, N.
    real(wp), intent(out) :: increment(:, :)

    real(wp) :: displacement(3, model%n_node), weight(3, 3), stiffness(3, 3), moved(3)
    integer :: c, row

    displacement = reshape(problem%solution(:3*model%n_node), [3, model%n_node])
    do c = 1, model%n_contact
      if (contact%status(c) == status_gap) then
        increment(:, c) = -contact%lambda(:, c)
        cycle
      end if
      call eliminate(contact, c, weight, stiffness)
      moved = problem%tool_prescribed(:, contact%tool(c))
      if (phase%pressed(contact%tool(c))) then
        row = model%tool_row(contact%tool(c))
        moved = problem%solution(3*row - 2:3*row)
      end if
      increment(:, c) = matmul(weight, problem%contact_residual(:, c)) &
          + matmul(stiffness, model%contact_point(c)%change(x, displacement) - moved)
    end do
  end subroutine point_force_increment

end module dd3_system_point_rows
