! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of the phases: one action for each tool, consistent with the phases before.
module dd3_input_phase_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_text, only : to_text
  use dd3_input_cushion_check, only : check_cushions
  use dd3_input_case, only : case_t, phase_spec_t, tool_gap_t, tool_vector_t
  use dd3_input_phase_tables, only : check_tables
  use dd3_input_turn_check, only : check_motions, check_tilts, check_turns
  use dd3_settings_until, only : until_never
  implicit none
  private
  public :: check_phases

  !> Motion of a tool; tools are held at the start.
  integer, parameter :: held = 0, moved = 1, pressed = 2
  !> Largest number of increments of a phase, if none is smaller than the trial increment.
  real(wp), parameter :: most_increments = 1.0e7_wp
  !> Largest trial increment, in motions of the controlling tool.
  real(wp), parameter :: largest_trial = 1.0e3_wp

contains

  !> Check all phases in order, up to the first one with other errors.
  subroutine check_phases(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: force(:, :)
    integer, allocatable :: motion(:)
    logical :: turned(size(case%tool)), tilting(size(case%tool))
    integer :: i

    turned = .false.
    tilting = .false.
    allocate (force(3, size(case%tool)), source=0.0_wp)
    allocate (motion(size(case%tool)), source=held)
    do i = 1, size(case%phase)
      if (.not. case%phase(i)%source%valid) return
      call check_actions(case, case%phase(i), motion, force, errors)
      call check_control(case, case%phase(i), errors)
      call check_trial(case%phase(i), errors)
      call check_time(case%phase(i), errors)
      call check_until(case, case%phase(i), motion, errors)
      call check_motions(case%phase(i), errors)
      call check_tilts(case, case%phase(i), motion == pressed, tilting, errors)
      call check_cushions(case, case%phase(i), motion == pressed, force, errors)
      turned = turned .or. tilting
      call check_turns(case, case%phase(i), turned, errors)
      call check_loads(case%phase(i), errors)
      call check_tables(case%phase(i), errors)
    end do
  end subroutine check_phases

  !> Check the actions on the tools and update their motion.
  subroutine check_actions(case, phase, motion, force, errors)
    type(case_t), intent(in) :: case
    type(phase_spec_t), intent(in) :: phase
    !> Motion of each tool.
    integer, intent(inout) :: motion(:)
    !> Last force on each pressed tool, `(3, n_tool)`, N.
    real(wp), intent(inout) :: force(:, :)
    type(error_list_t), intent(inout) :: errors

    logical :: named(size(motion)), released(size(motion))
    integer :: i

    named = .false.
    released = .false.
    do i = 1, size(phase%hold)
      call name_tool(case, phase%hold(i)%tool, phase%hold(i)%at, named, errors)
      motion(phase%hold(i)%tool) = held
    end do
    do i = 1, size(phase%move)
      call name_tool(case, phase%move(i)%tool, phase%move(i)%at, named, errors)
      motion(phase%move(i)%tool) = moved
    end do
    do i = 1, size(phase%gap)
      call name_tool(case, phase%gap(i)%tool, phase%gap(i)%at, named, errors)
      call check_gap(phase%gap(i), errors)
      motion(phase%gap(i)%tool) = moved
    end do
    do i = 1, size(phase%press)
      call name_tool(case, phase%press(i)%tool, phase%press(i)%at, named, errors)
      call check_press(phase%press(i), motion, force, errors)
    end do
    do i = 1, size(phase%release)
      call name_tool(case, phase%release(i)%tool, phase%release(i)%at, released, errors)
    end do
    released = released .or. phase%unload
    call check_withdrawn(phase, released, errors)
    where (released .and. motion == pressed) motion = held
    do i = 1, size(phase%gap)
      call check_other_tool(case, phase%gap(i), motion, phase%gap%tool, errors)
    end do
    ! A moved tool is held in a later phase that does not name it.
    do i = 1, size(motion)
      if (motion(i) == moved .and. .not. named(i)) motion(i) = held
    end do
  end subroutine check_actions

  !> Report what a tool that the phase withdraws cannot do: it goes at a constant rate, by `move` if
  !> that is given.
  subroutine check_withdrawn(phase, withdrawn, errors)
    type(phase_spec_t), intent(in) :: phase
    !> `(n_tool)`.
    logical, intent(in) :: withdrawn(:)
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: released
    integer :: i

    released = "released"
    if (phase%unload) released = "released, by unload,"
    do i = 1, size(phase%hold)
      if (withdrawn(phase%hold(i)%tool) .and. .not. phase%at_once) call errors%push_input( &
          phase%hold(i)%at, "a tool cannot be held and "//released//" in the same phase", &
          "no hold, or release of the other tools only", code="E124")
    end do
    do i = 1, size(phase%press)
      if (withdrawn(phase%press(i)%tool)) call errors%push_input(phase%press(i)%at, &
          "a tool cannot be pressed and "//released//" in the same phase", code="E124")
    end do
    do i = 1, size(phase%gap)
      if (withdrawn(phase%gap(i)%tool)) call errors%push_input(phase%gap(i)%at, &
          "a tool cannot keep a gap and be "//released//" in the same phase", &
          "move for the path of a released tool", code="E124")
    end do
    if (phase%at_once) then
      call refuse(phase%hold%at)
      call refuse(phase%move%at)
      call refuse(phase%turn%at)
      call refuse(phase%release%at)
    end if
    do i = 1, size(phase%move)
      if (withdrawn(phase%move(i)%tool) .and. size(phase%move_table) > 0) then
        call errors%push_input(phase%move(i)%at, "move_table does not act on a tool that is "// &
          released//" in the same phase: it is withdrawn at a constant rate", code="E124")
      end if
    end do

  contains

    !> Report actions of tools that the phase takes away.
    subroutine refuse(at)
      type(location_t), intent(in) :: at(:)

      integer :: k

      do k = 1, size(at)
        call errors%push_input(at(k), "a tool has no contact in a phase with unload = at_once", &
            "no hold, move, turn or release; or unload = on, which withdraws the tools", &
            code="E124")
      end do
    end subroutine refuse

  end subroutine check_withdrawn

  !> Mark a tool as named; report it if it was named before.
  subroutine name_tool(case, tool, at, named, errors)
    type(case_t), intent(in) :: case
    integer, intent(in) :: tool
    !> Where it is named.
    type(location_t), intent(in) :: at
    !> Tools named so far.
    logical, intent(inout) :: named(:)
    type(error_list_t), intent(inout) :: errors

    if (named(tool)) then
      call errors%push_input(at, "tool '"//case%tool(tool)%source%called()// &
          "' is given two actions in this phase", &
          "one of hold, move, gap and press for each tool", code="E122")
    end if
    named(tool) = .true.
  end subroutine name_tool

  !> Check that a gap is positive and between two tools.
  subroutine check_gap(gap, errors)
    type(tool_gap_t), intent(in) :: gap
    type(error_list_t), intent(inout) :: errors

    if (gap%tool == gap%other) call errors%push_input(gap%at, "a gap is between two tools", &
        "gap = tool tool number", code="E144")
    if (.not. gap%value > 0.0_wp) call errors%push_input(gap%at, "the gap is not positive", &
        "a number > 0", code="E133")
  end subroutine check_gap

  !> Check that the motion of the tool from which another one has a gap is known beforehand.
  subroutine check_other_tool(case, gap, motion, led, errors)
    type(case_t), intent(in) :: case
    type(tool_gap_t), intent(in) :: gap
    !> Motion of each tool, and the tools that the phase leads to a gap.
    integer, intent(in) :: motion(:), led(:)
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: reason

    if (gap%tool == gap%other) return
    if (motion(gap%other) == pressed) then
      reason = "is pressed"
    else if (any(led == gap%other)) then
      reason = "is led to a gap itself"
    else
      return
    end if
    call errors%push_input(gap%at, "the gap is not known beforehand, as '"// &
        case%tool(gap%other)%source%called()//"' "//reason//" in this phase", &
        "a gap from a tool that is held or moved", code="E144")
  end subroutine check_other_tool

  !> Check the force on a tool: it is not zero at first, and keeps its direction while the tool is
  !> pressed.
  subroutine check_press(press, motion, force, errors)
    type(tool_vector_t), intent(in) :: press
    !> Motion of each tool.
    integer, intent(inout) :: motion(:)
    !> Last force on each pressed tool, `(3, n_tool)`, N.
    real(wp), intent(inout) :: force(:, :)
    type(error_list_t), intent(inout) :: errors

    real(wp) :: before(3)

    before = 0.0_wp
    if (motion(press%tool) == pressed) before = force(:, press%tool)
    motion(press%tool) = pressed
    if (norm2(press%vector) > 0.0_wp) force(:, press%tool) = press%vector
    if (.not. norm2(press%vector) > 0.0_wp) then
      if (norm2(before) > 0.0_wp) return
      call errors%push_input(press%at, "a zero force has no direction", "press = tool fx fy fz", &
          code="E135")
    else if (norm2(before) > 0.0_wp) then
      if (norm2(press%vector/norm2(press%vector) - before/norm2(before)) <= 1.0e-6_wp) return
      call errors%push_input(press%at, "the force on a pressed tool cannot change its direction", &
          "a force in the direction of the last one, or a phase in between that holds the tool", &
          code="E135")
    end if
  end subroutine check_press

  !> Check that the phase is driven by a tool that moves, or by loads.
  subroutine check_control(case, phase, errors)
    type(case_t), intent(in) :: case
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    integer :: i, n_actions

    n_actions = size(phase%gap) + size(phase%move) + size(phase%press) + size(phase%displace)
    n_actions = n_actions + size(phase%load) + merge(1, 0, phase%has_gravity)
    n_actions = n_actions + size(phase%release) + size(phase%free) + merge(1, 0, phase%unload)
    n_actions = n_actions + size(phase%motion) + size(phase%pressure) + size(phase%turn)
    if (phase%control == 0) then
      if (n_actions == 0) then
        call errors%push_input(phase%source%opened, "the phase has no action", &
            "at least one of move, turn, gap, press, displace, place, free, load, release, "// &
            "unload, rotate, bend, pressure, gravity", code="E144")
      end if
      if (phase%trial > 1.0_wp) then
        call errors%push_input(phase%source%at("trial"), "trial = "//to_text(phase%trial)// &
            " is out of range", "a fraction of the phase, at most 1, for control = load", &
            code="E133")
      end if
      return
    end if
    if (size(phase%move_table) > 0) call errors%push_input(phase%source%at("move_table"), &
        "a tool with a table of its motion cannot control the phase", "control = load", code="E144")
    do i = 1, size(phase%move)
      if (phase%move(i)%tool /= phase%control) cycle
      if (.not. norm2(phase%move(i)%vector) > 0.0_wp) then
        call errors%push_input(phase%move(i)%at, "the move of the controlling tool is zero", &
            code="E144")
      end if
      return
    end do
    call errors%push_input(phase%source%at("control"), "the controlling tool '"// &
        case%tool(phase%control)%source%called()//"' has no move in this phase", "move = "// &
        case%tool(phase%control)%source%called()//" dx dy dz, or control = load", code="E144")
  end subroutine check_control

  !> Check the trial increment against the motion of the controlling tool, or against the phase.
  subroutine check_trial(phase, errors)
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: unit, bound
    real(wp) :: length
    integer :: i

    length = 1.0_wp
    unit = ""
    if (phase%control > 0) then
      length = 0.0_wp
      unit = " mm"
      do i = 1, size(phase%move)
        if (phase%move(i)%tool == phase%control) length = norm2(phase%move(i)%vector)
      end do
    end if
    if (.not. length > 0.0_wp) return
    associate (r_max => min(1.0_wp, phase%limits%r_max%value), trial => phase%trial)
      if (trial*r_max < length/most_increments) then
        bound = ""
        if (r_max < 1.0_wp) bound = ", with r_max = "//to_text(r_max)//","
        call errors%push_input(phase%source%at("trial"), "trial = "//to_text(trial)//bound// &
            " divides the phase into more than 1e7 increments", "at least "// &
            to_text(length/most_increments/r_max)//unit, code="E133")
      else if (phase%control > 0 .and. trial > largest_trial*length) then
        call errors%push_input(phase%source%at("trial"), "trial = "//to_text(trial)// &
            " is out of range: the controlling tool moves by "//to_text(length)//unit, &
            "at most "//to_text(largest_trial*length)//unit, code="E133")
      end if
    end associate
  end subroutine check_trial

  !> Report sets with two loads or two pressures: only the last one would act.
  subroutine check_loads(phase, errors)
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    integer :: i, j

    do i = 2, size(phase%load)
      if (any([(phase%load(j)%set == phase%load(i)%set, j=1, i - 1)])) call errors%push_input( &
          phase%load(i)%at, "'"//phase%load(i)%set//"' is given two loads in this phase", &
          "one load for each set", code="E122")
    end do
    do i = 2, size(phase%pressure)
      if (any([(phase%pressure(j)%set == phase%pressure(i)%set, j=1, i - 1)])) then
        call errors%push_input(phase%pressure(i)%at, "'"//phase%pressure(i)%set// &
          "' is given two pressures in this phase", "one pressure for each set", code="E122")
      end if
    end do
  end subroutine check_loads

  !> Check that the time of a phase is given once, and a speed for a tool that moves.
  subroutine check_time(phase, errors)
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    if (.not. phase%speed > 0.0_wp) return
    if (phase%duration > 0.0_wp) then
      call errors%push_input(phase%source%at("speed"), "both duration and speed are given", &
          "one of them", code="E164")
    else if (.not. any(phase%move%tool == phase%control)) then
      call errors%push_input(phase%source%at("speed"), "the phase has no controlling tool with "// &
          "a `move`", "duration = seconds", code="E164")
    end if
  end subroutine check_time

  !> Check the condition that ends the phase early.
  subroutine check_until(case, phase, motion, errors)
    type(case_t), intent(in) :: case
    type(phase_spec_t), intent(in) :: phase
    !> Motion of each tool.
    integer, intent(in) :: motion(:)
    type(error_list_t), intent(inout) :: errors

    if (phase%until%kind == until_never) return
    if (.not. phase%until%value > 0.0_wp) then
      call errors%push_input(phase%until%at, "the magnitude is not positive", "a number > 0", &
          code="E133")
    end if
    if (motion(phase%until%tool) == held) then
      call errors%push_input(phase%until%at, "tool '"// &
          case%tool(phase%until%tool)%source%called()// &
          "' does not move in this phase", "a tool that is moved or pressed", code="E144")
    end if
  end subroutine check_until

end module dd3_input_phase_check
