! SPDX-License-Identifier: GPL-3.0-or-later
!> Rows of the tools that can be pressed in the reduced system: for each the balance of its force
!> along its line, and two that constrain it to the line.
module dd3_system_tool_rows
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank, sum_over_ranks, this_rank
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_system_system, only : system_t
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

  !> Begin the force balance of the pressed tools, to which the candidates of all ranks add.
  subroutine start_tool_rows(system, model, phase)
    !> Its reduced matrix is that of the sheet, zero in these rows.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    integer :: tool

    system%problem%rhs(3*model%n_node + 1:) = 0.0_wp
    if (this_rank() > 0) return
    do tool = 1, model%n_tool
      if (phase%pressed(tool)) system%problem%rhs(3*(model%tool_row(tool) - 1) &
          + force_row(phase%direction(:, tool))) = -system%problem%tool_residual(tool)
    end do
  end subroutine start_tool_rows

  !> Constrain the pressed tools to their lines of motion. One without contact has a prescribed
  !> motion, as the tools that are not pressed in this phase.
  subroutine finish_tool_rows(system, model, phase)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    integer :: tool, block, row, i, k

    associate (problem => system%problem, contact => system%contact, value => system%matrix%value)
      do tool = 1, model%n_tool
        block = model%tool_row(tool)
        if (block == 0) cycle
        k = system%matrix%diagonal(block)
        if (.not. phase%pressed(tool)) then
          value(:, :, k) = identity
          problem%rhs(3*block - 2:3*block) = problem%tool_prescribed(:, tool)
          cycle
        end if
        row = force_row(phase%direction(:, tool))
        do i = 1, 3
          if (i == row) cycle
          value(i, i, k) = 1.0_wp
          value(i, row, k) = -phase%direction(i, tool)/phase%direction(row, tool)
        end do
        if (any_rank(any(contact%tool == tool .and. contact%status /= status_gap))) cycle
        value(row, row, k) = 1.0_wp
        problem%rhs(3*(block - 1) + row) = problem%tool_prescribed(row, tool)
      end do
    end associate
  end subroutine finish_tool_rows

  !> Return the row of a pressed tool's block that holds its force balance; the other two constrain
  !> the tool to its line of motion.
  pure integer function force_row(direction) result(row)
    real(wp), intent(in) :: direction(3)

    row = maxloc(abs(direction), dim=1)
  end function force_row

  !> Sum up the rows of the pressed tools, to which each rank has added those of its points.
  subroutine share_tool_rows(system, model, phase)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    integer :: tool, first, last

    associate (rhs => system%problem%rhs(3*model%n_node + 1:))
      call sum_over_ranks(size(rhs), rhs)
    end associate
    do tool = 1, model%n_tool
      if (.not. phase%pressed(tool)) cycle
      first = system%matrix%row_start(model%tool_row(tool))
      last = system%matrix%row_start(model%tool_row(tool) + 1) - 1
      call sum_over_ranks(9*(last - first + 1), system%matrix%value(:, :, first:last))
    end do
  end subroutine share_tool_rows

end module dd3_system_tool_rows
