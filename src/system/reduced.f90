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
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_linalg_tensor, only : identity
  use dd3_linalg_matrix, only : block_matrix_t, copy_blocks, position_of
  use dd3_linalg_partition, only : holds_row
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_contact_operator, only : status_gap
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_linear_problem, only : linear_problem_t
  use dd3_system_point_rows, only : add_points, point_force_increment
  use dd3_system_tool_rows, only : add_to_tool_row, finish_tool_rows, force_row, share_tool_rows, &
      start_tool_rows
  implicit none
  private
  public :: reduce, contact_force_increment

contains

  !> Build the reduced matrix, of several ranks each its rows, and the right-hand side.
  subroutine reduce(model, phase, contact, x, position, stiffness, problem, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Positions of the blocks of each element in the matrix, see `find_positions`.
    integer, intent(in) :: position(:, :, :)
    !> Stiffness of the sheet, zero in the rows and columns of the tools.
    type(block_matrix_t), intent(in) :: stiffness
    !> Residuals and prescribed values; gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    !> Has the pattern of the stiffness.
    type(block_matrix_t), intent(inout) :: reduced

    integer :: node

    call copy_blocks(stiffness, reduced)
    do node = 1, model%n_node
      problem%rhs(3*node - 2:3*node) = -problem%residual(:, node)
    end do
    call start_tool_rows(model, phase, problem, reduced)
    if (phase%mixed) then
      call reduce_nodes(model, phase, contact, problem, reduced)
    else
      call add_points(model, phase, contact, x, position, problem, reduced)
    end if
    if (allocated(reduced%owner)) call share_tool_rows(model, phase, reduced)
    call finish_tool_rows(model, phase, contact, problem, reduced)
    call prescribe(phase, problem, reduced)
  end subroutine reduce

  !> Reduce the rows of all candidates in the mixed formulation.
  subroutine reduce_nodes(model, phase, contact, problem, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    !> Residuals; gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    type(block_matrix_t), intent(inout) :: reduced

    integer :: c, node

    do c = 1, model%n_contact
      node = model%contact_node(c)
      if (contact%status(c) == status_gap) then
        problem%rhs(3*node - 2:3*node) = problem%rhs(3*node - 2:3*node) - &
            problem%contact_residual(:, c)
        cycle
      end if
      call reduce_node(model, phase, contact, c, problem, reduced)
    end do
  end subroutine reduce_nodes

  !> Replace the row of a candidate in contact by its reduced row, and add its contribution to the
  !> row of a pressed tool.
  subroutine reduce_node(model, phase, contact, c, problem, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    integer, intent(in) :: c
    !> Residuals; gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    type(block_matrix_t), intent(inout) :: reduced

    real(wp) :: remaining(3, 3), d(3, 3), residual(3), weight(3)
    integer :: node, tool, block, k, at, row
    logical :: pressed

    node = model%contact_node(c)
    tool = contact%tool(c)
    block = model%tool_row(tool)
    pressed = phase%pressed(tool)
    d = contact%d(:, :, c)
    remaining = identity - contact%e(:, :, c)
    residual = node_residual(phase, problem, node, c)
    problem%rhs(3*node - 2:3*node) = -matmul(remaining, residual) - problem%contact_residual(:, c)
    if (.not. pressed) then
      problem%rhs(3*node - 2:3*node) = problem%rhs(3*node - 2:3*node) &
          + matmul(d, problem%tool_prescribed(:, tool))
    else
      row = force_row(phase%direction(:, tool))
      problem%rhs(3*(block - 1) + row) = problem%rhs(3*(block - 1) + row) &
          + dot_product(phase%direction(:, tool), matmul(contact%e(:, :, c), residual))
    end if
    weight = -matmul(phase%direction(:, tool), contact%e(:, :, c))
    do k = 1, 3
      if (.not. phase%prescribed(k, node)) cycle
      remaining(:, k) = 0.0_wp
      weight(k) = 0.0_wp
    end do
    if (.not. holds_row(reduced, node)) return
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
    if (pressed) then
      k = position_of(reduced, node, block)
      reduced%value(:, :, k) = -d
      weight = matmul(phase%direction(:, tool), d)
      call add_to_tool_row(reduced, block, row, node, weight)
      call add_to_tool_row(reduced, block, row, block, -weight)
    end if
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
  subroutine prescribe(phase, problem, reduced)
    type(phase_t), intent(in) :: phase
    !> Prescribed increments; gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    type(block_matrix_t), intent(inout) :: reduced

    integer :: node, i, k

    do node = 1, size(phase%prescribed, 2)
      do i = 1, 3
        if (.not. phase%prescribed(i, node)) cycle
        do k = reduced%row_start(node), reduced%row_start(node + 1) - 1
          reduced%value(i, :, k) = 0.0_wp
        end do
        reduced%value(i, i, reduced%diagonal(node)) = 1.0_wp
        problem%rhs(3*(node - 1) + i) = problem%prescribed(i, node)
      end do
    end do
  end subroutine prescribe

  !> Return the increments of the contact forces from the solution: dlambda_A = -r_A - K_A du.
  subroutine contact_force_increment(model, phase, contact, x, stiffness, problem, increment)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    type(block_matrix_t), intent(in) :: stiffness
    !> Residuals and solution.
    type(linear_problem_t), intent(in) :: problem
    !> Increments, `(3, n_contact)`, N; a candidate in gap status loses its force.
    real(wp), intent(out) :: increment(:, :)

    real(wp) :: change(3)
    integer :: c, node, k, first

    if (.not. phase%mixed) then
      call point_force_increment(model, phase, contact, x, problem, increment)
      return
    end if
    increment = 0.0_wp
    do c = 1, model%n_contact
      node = model%contact_node(c)
      if (.not. holds_row(stiffness, node)) cycle
      if (contact%status(c) == status_gap) then
        increment(:, c) = -contact%lambda(:, c)
        cycle
      end if
      change = 0.0_wp
      do k = stiffness%row_start(node), stiffness%row_start(node + 1) - 1
        if (stiffness%column(k) > model%n_node) exit
        first = 3*stiffness%column(k) - 2
        change = change + matmul(stiffness%value(:, :, k), problem%solution(first:first + 2))
      end do
      where (phase%prescribed(:, node)) change = 0.0_wp
      increment(:, c) = -node_residual(phase, problem, node, c) - change
    end do
    if (allocated(stiffness%owner)) call sum_over_ranks(size(increment), increment)
  end subroutine contact_force_increment

end module dd3_system_reduced
