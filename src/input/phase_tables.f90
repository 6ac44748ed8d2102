! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of the tables of a phase.
module dd3_input_phase_tables
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_block, only : token_t
  use dd3_input_case, only : phase_spec_t
  implicit none
  private
  public :: check_tables

  !> Least difference of the progress of two points of a table.
  real(wp), parameter :: least_progress = 1.0e-6_wp

contains

  !> Check all tables of a phase.
  subroutine check_tables(phase, errors)
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    call check_table(phase, "table", phase%table, size(phase%displace) + size(phase%motion) &
        + size(phase%load) + size(phase%pressure), &
        "displace, place, rotate, bend, load or pressure", &
        errors)
    call check_table(phase, "move_table", phase%move_table, size(phase%move) + size(phase%gap), &
        "move or gap", errors)
    call check_table(phase, "turn_table", phase%turn_table, size(phase%turn), "turn", errors)
    call check_press_table(phase, errors)
  end subroutine check_tables

  !> Check that a table begins at 0 0, that its progress increases to 1, and that it acts on
  !> something.
  subroutine check_table(phase, key, x, n_actions, actions, errors)
    type(phase_spec_t), intent(in) :: phase
    character(len=*), intent(in) :: key
    !> Progress and factor, in pairs; size 0 if not given.
    real(wp), intent(in) :: x(:)
    !> Number and names of the actions with this factor.
    integer, intent(in) :: n_actions
    character(len=*), intent(in) :: actions
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: form
    integer :: n

    n = size(x)
    if (n == 0) return
    form = key//" = 0 0  s1 f1 ... 1 fn, with the progress s increasing from 0 to 1"
    associate (value => phase%source%entry(phase%source%find(key))%value)
      if (mod(n, 2) == 1 .or. n < 4) then
        call errors%push_input(value(1)%at, "expected pairs of progress and factor, at least "// &
            "two, got "//to_text(n)//" numbers", form, code="E132")
        return
      end if
      if (any(abs(x(:2)) > 0.0_wp)) call errors%push_input(value(1)%at, &
          "the table does not begin with 0 0", form, code="E134")
      if (n_actions == 0) call errors%push_input(value(1)%at, &
          "the table has no effect in this phase", "a phase with "//actions, code="E125")
      call check_progress(x(3:), value(3:), form, errors)
    end associate
  end subroutine check_table

  !> Check that the progress of the table of forces increases to 1, that no factor is negative, and
  !> that a tool is pressed.
  subroutine check_press_table(phase, errors)
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    character(len=*), parameter :: form = "press_table = s1 f1 ... 1 fn, with the progress s "// &
        "increasing to 1 and factors f >= 0"
    integer :: n, i

    n = size(phase%press_table)
    if (n == 0) return
    associate (x => phase%press_table, &
        value => phase%source%entry(phase%source%find("press_table"))%value)
      if (mod(n, 2) == 1) then
        call errors%push_input(value(1)%at, "expected pairs of progress and factor, got "// &
            to_text(n)//" numbers", form, code="E132")
        return
      end if
      if (size(phase%press) == 0) call errors%push_input(value(1)%at, &
          "the table has no effect in this phase", "a phase with press", code="E125")
      call check_progress(x, value, form, errors)
      do i = 2, n, 2
        if (x(i) < 0.0_wp) call errors%push_input(value(i)%at, "the factor is negative", form, &
            code="E133")
      end do
    end associate
  end subroutine check_press_table

  !> Check that the progress of a table increases from 0 to 1.
  subroutine check_progress(x, value, form, errors)
    !> Progress and factor, in pairs, without those of the start.
    real(wp), intent(in) :: x(:)
    type(token_t), intent(in) :: value(:)
    !> Form of the table.
    character(len=*), intent(in) :: form
    type(error_list_t), intent(inout) :: errors

    real(wp) :: previous
    integer :: i

    previous = 0.0_wp
    do i = 1, size(x) - 1, 2
      if (x(i) - previous < least_progress) then
        call errors%push_input(value(i)%at, "the progress does not increase here", form, &
              code="E134")
      end if
      previous = x(i)
    end do
    if (abs(previous - 1.0_wp) > 0.0_wp) call errors%push_input(value(size(x) - 1)%at, &
        "the table does not end at a progress of 1", form, code="E134")
  end subroutine check_progress

end module dd3_input_phase_tables
