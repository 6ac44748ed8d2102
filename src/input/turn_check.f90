! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of what turns in a phase: sets that are rotated or bent, tools that turn or tilt.
module dd3_input_turn_check
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t, phase_spec_t
  implicit none
  private
  public :: check_motions, check_tilts, check_turns

contains

  !> Check the axes of rotations and bends.
  subroutine check_motions(phase, errors)
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    integer :: i

    do i = 1, size(phase%motion)
      if (norm2(phase%motion(i)%value(4:6)) > 0.0_wp) cycle
      call errors%push_input(phase%motion(i)%at, "the axis has no direction", &
          "set, x y z of a point, three components of a direction, angle", code="E135")
    end do
  end subroutine check_motions

  !> Check the axes of the turns, that a tool turns about one axis, that no gap is measured from or
  !> to a tool that has turned, and that none carries a draw-bead.
  subroutine check_turns(case, phase, turned, errors)
    type(case_t), intent(in) :: case
    type(phase_spec_t), intent(in) :: phase
    !> Tools that have turned so far.
    logical, intent(inout) :: turned(:)
    type(error_list_t), intent(inout) :: errors

    logical :: named(size(case%tool))
    integer :: i

    named = .false.
    do i = 1, size(phase%turn)
      associate (turn => phase%turn(i))
        if (.not. norm2(turn%value(4:6)) > 0.0_wp) call errors%push_input(turn%at, &
            "the axis has no direction", &
            "tool, x y z of a point, three components of a direction, angle", code="E135")
        if (named(turn%tool)) call errors%push_input(turn%at, "tool '"// &
            case%tool(turn%tool)%source%called()//"' is given two turns in this phase", &
            "one turn for each tool", code="E122")
        if (any(case%drawbead%tool == turn%tool)) call errors%push_input(turn%at, "tool '"// &
            case%tool(turn%tool)%source%called()//"' carries a draw-bead, which cannot turn", &
            "a draw-bead without this tool", code="E144")
        named(turn%tool) = .true.
      end associate
    end do
    turned = turned .or. named
    do i = 1, size(phase%gap)
      if (any(turned([phase%gap(i)%tool, phase%gap(i)%other]))) call errors%push_input( &
          phase%gap(i)%at, "the gap is not known beforehand, as one of the tools turns or tilts", &
          "a move of a tool that turns or tilts", code="E144")
    end do
  end subroutine check_turns

  !> Check that the tools that tilt are pressed, have no prescribed turn, carry no draw-bead and
  !> have compliant contact.
  subroutine check_tilts(case, phase, is_pressed, tilting, errors)
    type(case_t), intent(in) :: case
    type(phase_spec_t), intent(in) :: phase
    !> Tools that are pressed in the phase.
    logical, intent(in) :: is_pressed(:)
    !> Tools that tilt, `(n_tool)`: as long as they are pressed.
    logical, intent(inout) :: tilting(:)
    type(error_list_t), intent(inout) :: errors

    logical :: named(size(tilting))
    integer :: i

    named = .false.
    do i = 1, size(phase%tilt)
      associate (tilt => phase%tilt(i), name => "tool '"// &
          case%tool(phase%tilt(i)%tool)%source%called()//"'")
        if (named(tilt%tool)) call errors%push_input(tilt%at, name//" is given two pivots in "// &
            "this phase", "one pivot for each tool", code="E122")
        if (.not. is_pressed(tilt%tool)) call errors%push_input(tilt%at, name//" is not "// &
            "pressed in this phase", "press beside tilt", code="E144")
        if (any(case%drawbead%tool == tilt%tool)) call errors%push_input(tilt%at, name// &
            " carries a draw-bead, which cannot tilt", "a draw-bead without this tool", code="E144")
        if (tilt%stiffness < 0.0_wp) call errors%push_input(tilt%at, "the stiffness against "// &
            "tilt is negative", "a stiffness in N.mm/rad, or 0", code="E133")
        named(tilt%tool) = .true.
      end associate
    end do
    tilting = (tilting .or. named) .and. is_pressed
    do i = 1, size(phase%turn)
      if (tilting(phase%turn(i)%tool)) call errors%push_input(phase%turn(i)%at, "tool '"// &
          case%tool(phase%turn(i)%tool)%source%called()//"' tilts in this phase", &
          "turn or tilt, not both", code="E144")
    end do
    if (any(tilting) .and. phase%contact%mixed) call errors%push_input(phase%source%opened, &
        "tools do not tilt in the mixed formulation", "formulation = compliant", code="E124")
  end subroutine check_tilts

end module dd3_input_turn_check
