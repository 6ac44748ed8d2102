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
  implicit none
  private
  public :: linear_problem_t, new_linear_problem, reduce, reduce_equilibrium, &
      contact_force_increment

  !> Right-hand sides and prescribed values of one linear problem.
  type :: linear_problem_t
    !> Residual r_A of the equilibrium of the nodes, contact forces included, `(3, n_node)`, N.
    real(wp), allocatable :: residual(:, :)
    !> Residual F_equ - lambda of the contact law at the candidates, `(3, n_contact)`, N.
    real(wp), allocatable :: contact_residual(:, :)
    !> Prescribed displacement increments of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: prescribed(:, :)
    !> Positions that the nodes with prescribed displacements have to reach, `(3, n_node)`, mm, and
    !> whether the prediction may not reach them.
    real(wp), allocatable :: target(:, :)
    logical :: missed = .false.
    !> Prescribed displacement increments of the tools that are not pressed or have no contact,
    !> `(3, n_tool)`, mm.
    real(wp), allocatable :: tool_prescribed(:, :)
    !> Residual of the force balance of the pressed tools along their lines, `(n_tool)`, N.
    real(wp), allocatable :: tool_residual(:)
    !> I - E of the candidates in the reduced matrix, `(3, 3, n_contact)`, and their tools, 0 in a
    !> gap, `(n_contact)`.
    real(wp), allocatable :: remaining(:, :, :)
    integer, allocatable :: contact_tool(:)
    !> Right-hand side of the reduced system, `(3*n_row)`.
    real(wp), allocatable :: rhs(:)
    !> Solution: displacements of the nodes, then of the tools that can be pressed, `(3*n_row)`.
    real(wp), allocatable :: solution(:)
  end type linear_problem_t

contains

  !> Allocate a linear problem and set it to zero.
  subroutine new_linear_problem(self, model, n_row)
    type(linear_problem_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> Number of block rows of the reduced system.
    integer, intent(in) :: n_row

    allocate (self%residual(3, model%n_node), self%prescribed(3, model%n_node), source=0.0_wp)
    allocate (self%target(3, model%n_node), source=0.0_wp)
    allocate (self%contact_residual(3, model%n_contact), source=0.0_wp)
    allocate (self%remaining(3, 3, model%n_contact), source=0.0_wp)
    allocate (self%contact_tool(model%n_contact), source=0)
    allocate (self%tool_prescribed(3, model%n_tool), self%tool_residual(model%n_tool), &
        source=0.0_wp)
    allocate (self%rhs(3*n_row), self%solution(3*n_row), source=0.0_wp)
  end subroutine new_linear_problem

  !> Build the reduced matrix, of several ranks each its rows, and the right-hand side.
  subroutine reduce(model, phase, contact, stiffness, problem, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    !> Stiffness of the sheet, zero in the rows and columns of the tools.
    type(block_matrix_t), intent(in) :: stiffness
    !> Residuals and prescribed values; gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    !> Has the pattern of the stiffness.
    type(block_matrix_t), intent(inout) :: reduced

    integer :: c, node

    call copy_blocks(stiffness, reduced)
    do node = 1, model%n_node
      problem%rhs(3*node - 2:3*node) = -problem%residual(:, node)
    end do
    call start_tool_rows(model, phase, problem, reduced)
    do c = 1, model%n_contact
      node = model%contact_node(c)
      problem%remaining(:, :, c) = identity - contact%e(:, :, c)
      problem%contact_tool(c) = 0
      if (contact%status(c) == status_gap) then
        problem%rhs(3*node - 2:3*node) = problem%rhs(3*node - 2:3*node) - &
            problem%contact_residual(:, c)
        cycle
      end if
      call reduce_node(model, phase, contact, c, problem, reduced)
    end do
    if (allocated(reduced%owner)) call share_tool_rows(model, phase, reduced)
    call finish_tool_rows(model, phase, contact, problem, reduced)
    call prescribe(phase, problem, reduced)
  end subroutine reduce

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
    problem%contact_tool(c) = tool
    block = model%tool_row(tool)
    pressed = phase%pressed(tool)
    d = contact%d(:, :, c)
    remaining = problem%remaining(:, :, c)
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
        call add_weighted_rows(weight, reduced%value(:, :, k), row, reduced%value(:, :, at))
      end if
      call multiply_left(remaining, reduced%value(:, :, k))
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

  !> Set the right-hand side to that of the residual of equilibrium alone, in the reduced system
  !> built last.
  subroutine reduce_equilibrium(model, phase, problem)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem

    real(wp) :: residual(3), remaining(3)
    integer :: node, c, tool, row

    problem%rhs = 0.0_wp
    do node = 1, model%n_node
      residual = merge(0.0_wp, problem%residual(:, node), phase%prescribed(:, node))
      problem%rhs(3*node - 2:3*node) = -residual
      c = model%candidate_of(node)
      if (c == 0) cycle
      tool = problem%contact_tool(c)
      if (tool == 0) cycle
      remaining = matmul(problem%remaining(:, :, c), residual)
      problem%rhs(3*node - 2:3*node) = -merge(0.0_wp, remaining, phase%prescribed(:, node))
      if (.not. phase%pressed(tool)) cycle
      row = 3*(model%tool_row(tool) - 1) + force_row(phase%direction(:, tool))
      problem%rhs(row) = problem%rhs(row) &
          + dot_product(phase%direction(:, tool), residual - remaining)
    end do
  end subroutine reduce_equilibrium

  !> Sum up the rows of the pressed tools, to which each rank has added those of its nodes.
  subroutine share_tool_rows(model, phase, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(block_matrix_t), intent(inout) :: reduced

    integer :: tool, block, first, last

    do tool = 1, model%n_tool
      block = model%tool_row(tool)
      if (block == 0) cycle
      if (.not. phase%pressed(tool)) cycle
      first = reduced%row_start(block)
      last = reduced%row_start(block + 1) - 1
      call sum_over_ranks(9*(last - first + 1), reduced%value(:, :, first:last))
    end do
  end subroutine share_tool_rows

  !> Multiply a block by a factor from the left.
  pure subroutine multiply_left(factor, block)
    real(wp), intent(in) :: factor(3, 3)
    real(wp), intent(inout) :: block(3, 3)

    real(wp) :: a, b, c
    integer :: j

    do j = 1, 3
      a = block(1, j)
      b = block(2, j)
      c = block(3, j)
      block(:, j) = factor(:, 1)*a + factor(:, 2)*b + factor(:, 3)*c
    end do
  end subroutine multiply_left

  !> Add a weighted sum of the rows of a node's block to a row of a tool's block.
  pure subroutine add_weighted_rows(weight, block, row, sum)
    real(wp), intent(in) :: weight(3)
    !> Block of the node.
    real(wp), intent(in) :: block(3, 3)
    integer, intent(in) :: row
    !> Block of the tool.
    real(wp), intent(inout) :: sum(3, 3)

    integer :: j

    do j = 1, 3
      sum(row, j) = sum(row, j) &
          + (weight(1)*block(1, j) + weight(2)*block(2, j) + weight(3)*block(3, j))
    end do
  end subroutine add_weighted_rows

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

  !> Add a row vector to the force row of a pressed tool.
  subroutine add_to_tool_row(reduced, block, row, column, values)
    type(block_matrix_t), intent(inout) :: reduced
    !> Block row of the tool, the row in it, and the block column.
    integer, intent(in) :: block, row, column
    real(wp), intent(in) :: values(3)

    integer :: k

    k = position_of(reduced, block, column)
    reduced%value(row, :, k) = reduced%value(row, :, k) + values
  end subroutine add_to_tool_row

  !> Initialise the rows of the tools; those not pressed in this phase have a prescribed motion.
  subroutine start_tool_rows(model, phase, problem, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Prescribed motion and residuals; gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    type(block_matrix_t), intent(inout) :: reduced

    integer :: tool, block, row, k

    do tool = 1, model%n_tool
      block = model%tool_row(tool)
      if (block == 0) cycle
      do k = reduced%row_start(block), reduced%row_start(block + 1) - 1
        reduced%value(:, :, k) = 0.0_wp
      end do
      problem%rhs(3*block - 2:3*block) = 0.0_wp
      if (phase%pressed(tool)) then
        row = force_row(phase%direction(:, tool))
        problem%rhs(3*(block - 1) + row) = -problem%tool_residual(tool)
      else
        reduced%value(:, :, reduced%diagonal(block)) = identity
        problem%rhs(3*block - 2:3*block) = problem%tool_prescribed(:, tool)
      end if
    end do
  end subroutine start_tool_rows

  !> Constrain the pressed tools to their lines of motion; one without contact has a prescribed
  !> motion.
  subroutine finish_tool_rows(model, phase, contact, problem, reduced)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    !> Gets the right-hand side.
    type(linear_problem_t), intent(inout) :: problem
    type(block_matrix_t), intent(inout) :: reduced

    integer :: tool, block, row, i, k

    do tool = 1, model%n_tool
      block = model%tool_row(tool)
      if (block == 0) cycle
      if (.not. phase%pressed(tool)) cycle
      row = force_row(phase%direction(:, tool))
      k = reduced%diagonal(block)
      do i = 1, 3
        if (i == row) cycle
        reduced%value(i, i, k) = 1.0_wp
        reduced%value(i, row, k) = -phase%direction(i, tool)/phase%direction(row, tool)
      end do
      if (any(contact%tool == tool .and. contact%status /= status_gap)) cycle
      reduced%value(row, row, k) = 1.0_wp
      problem%rhs(3*(block - 1) + row) = problem%tool_prescribed(row, tool)
    end do
  end subroutine finish_tool_rows

  !> Return the row of a pressed tool's block that holds its force balance; the other two constrain
  !> the tool to its line of motion.
  pure integer function force_row(direction) result(row)
    real(wp), intent(in) :: direction(3)

    row = maxloc(abs(direction), dim=1)
  end function force_row

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
  subroutine contact_force_increment(model, phase, contact, stiffness, problem, increment)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(contact_work_t), intent(in) :: contact
    type(block_matrix_t), intent(in) :: stiffness
    !> Residuals and solution.
    type(linear_problem_t), intent(in) :: problem
    !> Increments, `(3, n_contact)`, N; a candidate in gap status loses its force.
    real(wp), intent(out) :: increment(:, :)

    real(wp) :: change(3)
    integer :: c, node, k, first

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
        change = change + (stiffness%value(:, 1, k)*problem%solution(first) &
            + stiffness%value(:, 2, k)*problem%solution(first + 1) &
            + stiffness%value(:, 3, k)*problem%solution(first + 2))
      end do
      where (phase%prescribed(:, node)) change = 0.0_wp
      increment(:, c) = -node_residual(phase, problem, node, c) - change
    end do
    if (allocated(stiffness%owner)) call sum_over_ranks(size(increment), increment)
  end subroutine contact_force_increment

end module dd3_system_reduced
