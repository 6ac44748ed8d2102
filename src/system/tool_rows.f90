! SPDX-License-Identifier: GPL-3.0-or-later
!> Rows of the tools that can be pressed in the reduced system, one for each unknown: the balance of
!> the forces along its line, and of the moments about the axes of its tilt.
module dd3_system_tool_rows
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank, sum_over_ranks, this_rank
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_pressed_tools, only : is_free, support_stiffness
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: start_tool_rows, share_tool_rows, finish_tool_rows, add_block

contains

  !> Add a block to the matrix.
  subroutine add_block(matrix, row, column, block)
    type(block_matrix_t), intent(inout) :: matrix
    !> Block row and block column.
    integer, intent(in) :: row, column
    real(wp), intent(in) :: block(3, 3)

    integer :: k

    k = position_of(matrix, row, column)
    matrix%value(:, :, k) = matrix%value(:, :, k) + block
  end subroutine add_block

  !> Begin the balance of the pressed tools, to which the candidates of all ranks add.
  subroutine start_tool_rows(system, model, phase)
    !> Its reduced matrix is that of the sheet, zero in these rows.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    integer :: tool

    associate (rhs => system%problem%rhs)
      rhs(3*model%n_node + 1:) = 0.0_wp
      if (this_rank() > 0) return
      do tool = 1, model%n_tool
        associate (row => 3*model%tool_row(tool))
          if (phase%pressed(tool)) rhs(row - 2:row) = -system%problem%tool_residual(:, tool)
        end associate
      end do
    end associate
  end subroutine start_tool_rows

  !> Complete the rows by the support of the tools against tilt, and prescribe the unknowns that
  !> have no balance. A pressed tool without contact has a prescribed displacement.
  subroutine finish_tool_rows(system, model, phase)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    real(wp) :: stiffness(3, 3)
    integer :: tool, i
    logical :: touching(model%n_tool), balanced(3)

    touching = [(any_rank(any(system%contact%tool == tool .and. &
        system%contact%status /= status_gap)), tool=1, model%n_tool)]
    associate (problem => system%problem)
      do tool = 1, model%n_tool
        associate (row => model%tool_row(tool))
          if (row == 0) cycle
          balanced = is_free(phase, tool) .and. (touching(tool) .or. problem%supported(tool))
          stiffness = problem%tool_stiffness(:, :, tool) &
              + spread(support_stiffness(phase, tool), 2, 3)*identity
          associate (block => system%matrix%value(:, :, system%matrix%diagonal(row)), &
              rhs => problem%rhs(3*row - 2:3*row))
            where (.not. balanced) rhs = [dot_product(phase%direction(:, tool), &
                problem%tool_prescribed(:, tool)), 0.0_wp, 0.0_wp]
            do i = 1, 3
              if (.not. balanced(i)) block(i, i) = 1.0_wp
              if (balanced(i)) block(i, :) = block(i, :) - stiffness(i, :)
            end do
          end associate
        end associate
      end do
    end associate
  end subroutine finish_tool_rows

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
