!> Rows of the tools that can be pressed in the reduced system: for each the balance of its force
!> along its line, and two that constrain it to the line.
module dd3_system_tool_rows
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_linear_problem, only : linear_problem_t
  implicit none
  private
  public :: start_tool_rows, share_tool_rows, finish_tool_rows, add_to_tool_row, force_row

contains

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

end module dd3_system_tool_rows
