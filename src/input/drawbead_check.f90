! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of relations between the values of the draw-beads.
module dd3_input_drawbead_check
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t, drawbead_spec_t
  implicit none
  private
  public :: check_drawbeads

contains

  !> Check all draw-beads. Blocks with earlier errors are skipped.
  subroutine check_drawbeads(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i

    do i = 1, size(case%drawbead)
      associate (bead => case%drawbead(i))
        if (.not. bead%source%valid) cycle
        call check_line(bead%source, errors)
        call check_table(bead%source, errors)
      end associate
    end do
  end subroutine check_drawbeads

  !> Check that the line is given once; points of the input must be pairs.
  subroutine check_line(block, errors)
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    integer :: n

    if (.not. block%has("points") .and. .not. block%has("file")) then
      call errors%push_input(block%opened, "the line of *DRAWBEAD "//block%called()// &
          " is missing", "points = x1 y1 x2 y2 ..., or file = a file of points", code="E121")
    else if (block%has("points") .and. block%has("file")) then
      call errors%push_input(block%at("file"), "the line is given by points as well", &
          "one of points and file", code="E124")
    else if (block%has("points")) then
      n = size(block%numbers("points"))
      if (n < 4 .or. mod(n, 2) > 0) call errors%push_input(block%at("points"), &
          "expected the coordinates of two or more points, got "//to_text(n)//" numbers", &
          "points = x1 y1 x2 y2 ...", code="E132")
    end if
  end subroutine check_line

  !> Check that a table begins at zero and increases.
  subroutine check_table(block, errors)
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: table(:)
    integer :: i

    if (.not. block%has("table")) return
    if (block%given("rise")) then
      call errors%push_input(block%at("rise"), "the force is given by a table as well", &
          "one of rise and table", code="E124")
    end if
    table = block%numbers("table")
    associate (value => block%entry(block%find("table"))%value)
      if (mod(size(table), 2) > 0) then
        call errors%push_input(value(size(value))%at, "this path has no factor", &
            "pairs: path and factor", code="E132")
        return
      end if
      if (table(1) > 0.0_wp) call errors%push_input(value(1)%at, &
          "the table does not begin at path 0", "table = 0 f1  s2 f2 ...", code="E134")
      do i = 3, size(table), 2
        if (table(i) > table(i - 2)) cycle
        call errors%push_input(value(i)%at, "the path does not increase here", &
            "each path larger than the one before", code="E134")
        return
      end do
    end associate
  end subroutine check_table

end module dd3_input_drawbead_check
