! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of the cushions and spacers of pressed tools in a phase.
module dd3_input_cushion_check
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_case, only : case_t, phase_spec_t, tool_spacer_t, tool_stroke_t
  implicit none
  private
  public :: check_cushions

  character(len=*), parameter :: table_form = "stroke_table = tool s1 f1 s2 f2 ..., with the "// &
      "stroke increasing and factors f >= 0"

contains

  !> Check the pins, the tables of the stroke and the spacers of a phase.
  subroutine check_cushions(case, phase, is_pressed, force, errors)
    type(case_t), intent(in) :: case
    type(phase_spec_t), intent(in) :: phase
    !> Tools that are pressed in the phase, and their last forces, `(3, n_tool)`, N.
    logical, intent(in) :: is_pressed(:)
    real(wp), intent(in) :: force(:, :)
    type(error_list_t), intent(inout) :: errors

    integer :: i

    do i = 1, size(phase%pin)
      if (.not. phase%pin(i)%share > 0.0_wp) call errors%push_input(phase%pin(i)%at, &
          "the share of the pin is not positive", "pin = tool x y z share, share > 0", code="E133")
    end do
    do i = 1, size(phase%stroke)
      call check_pressed(phase%stroke(i)%tool, "stroke_table", phase%stroke(i)%at)
      if (any(phase%stroke(:i - 1)%tool == phase%stroke(i)%tool)) call errors%push_input( &
          phase%stroke(i)%at, "a second table of the same tool", "one for each tool", code="E122")
      call check_table(phase%stroke(i), errors)
    end do
    do i = 1, size(phase%spacer)
      call check_pressed(phase%spacer(i)%tool, "spacer", phase%spacer(i)%at)
      call check_spacer(case, phase%spacer(i), is_pressed, force, errors)
    end do
    if (phase%contact%mixed .and. size(phase%stroke) + size(phase%spacer) > 0) call &
        errors%push_input(phase%source%opened, "there are no cushions and spacers in the mixed "// &
        "formulation", "formulation = compliant", code="E124")

  contains

    !> Report a tool that is not pressed.
    subroutine check_pressed(tool, key, at)
      integer, intent(in) :: tool
      character(len=*), intent(in) :: key
      type(location_t), intent(in) :: at

      if (.not. is_pressed(tool)) call errors%push_input(at, "tool '"// &
          case%tool(tool)%source%called()//"' is not pressed in this phase", "press beside "//key, &
          code="E144")
    end subroutine check_pressed

  end subroutine check_cushions

  !> Check that a table has two or more pairs, the strokes increasing and no factor negative.
  subroutine check_table(stroke, errors)
    type(tool_stroke_t), intent(in) :: stroke
    type(error_list_t), intent(inout) :: errors

    associate (x => stroke%table)
      if (size(x) < 4 .or. mod(size(x), 2) == 1) then
        call errors%push_input(stroke%at, "expected pairs of stroke and factor, got "// &
            to_text(size(x))//" numbers", table_form, code="E132")
        return
      end if
      if (any(x(3::2) <= x(1:size(x) - 3:2))) call errors%push_input(stroke%at, &
          "the stroke does not increase", table_form, code="E134")
      if (any(x(2::2) < 0.0_wp)) call errors%push_input(stroke%at, "a factor is negative", &
          table_form, code="E133")
    end associate
  end subroutine check_table

  !> Check that a spacer lies between a tool pressed along z and one that is not pressed.
  subroutine check_spacer(case, spacer, is_pressed, force, errors)
    type(case_t), intent(in) :: case
    type(tool_spacer_t), intent(in) :: spacer
    logical, intent(in) :: is_pressed(:)
    real(wp), intent(in) :: force(:, :)
    type(error_list_t), intent(inout) :: errors

    if (spacer%tool == spacer%other) then
      call errors%push_input(spacer%at, "a spacer is between two tools", &
          "spacer = tool tool gap stiffness x y", code="E144")
      return
    end if
    if (is_pressed(spacer%other)) call errors%push_input(spacer%at, "tool '"// &
        case%tool(spacer%other)%source%called()//"' is pressed too", &
        "a spacer to a tool that is held or moved", code="E144")
    if (any(abs(force(:2, spacer%tool)) > 0.0_wp)) call errors%push_input(spacer%at, &
        "the force on tool '"//case%tool(spacer%tool)%source%called()//"' is not along z", &
        "spacers of a tool that is pressed along z", code="E144")
    if (.not. (spacer%gap > 0.0_wp .and. spacer%stiffness > 0.0_wp)) call errors%push_input( &
        spacer%at, "the gap or the stiffness of the spacer is not positive", &
        "spacer = tool tool gap stiffness x y, gap > 0, stiffness > 0", code="E133")
  end subroutine check_spacer

end module dd3_input_cushion_check
