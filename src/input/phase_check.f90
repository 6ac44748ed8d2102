!> Checks that each phase says what its tools do, once and without contradiction.
module dd3_input_phase_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_text, only : to_text
  use dd3_input_case, only : case_t, phase_spec_t, tool_vector_t, until_never
  implicit none
  private
  public :: check_phases

  !> What a tool does; held is what it begins with.
  integer, parameter :: held = 0, moved = 1, pressed = 2

contains

  !> Checks all phases in order. A phase with other errors is passed over.
  subroutine check_phases(case, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: force(:, :)
    integer, allocatable :: motion(:)
    logical, allocatable :: gone(:)
    integer :: i

    allocate (force(3, size(case%tool)), source=0.0_wp)
    allocate (motion(size(case%tool)), source=held)
    allocate (gone(size(case%tool)), source=.false.)
    do i = 1, size(case%phase)
      if (.not. case%phase(i)%source%valid) return
      call check_actions(case, case%phase(i), motion, force, gone, errors)
      call check_control(case, case%phase(i), errors)
      call check_until(case, case%phase(i), motion, errors)
    end do
  end subroutine check_phases

  !> Checks what the tools are told, and keeps account of it.
  subroutine check_actions(case, phase, motion, force, gone, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> The phase.
    type(phase_spec_t), intent(in) :: phase
    !> What each tool does.
    integer, intent(inout) :: motion(:)
    !> The last force on each pressed tool, N.
    real(wp), intent(inout) :: force(:, :)
    !> Which tools have been released.
    logical, intent(inout) :: gone(:)
    !> Receives all errors found.
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
    do i = 1, size(phase%press)
      call name_tool(case, phase%press(i)%tool, phase%press(i)%at, named, errors)
      call check_press(phase%press(i), motion, force, errors)
      if (gone(phase%press(i)%tool)) call errors%push_input(phase%press(i)%at, "tool '"// &
          case%tool(phase%press(i)%tool)%source%called()//"' was released in an earlier phase: "// &
          "nothing would resist the force", "a tool whose contact is not switched off")
    end do
    do i = 1, size(phase%release)
      call name_tool(case, phase%release(i)%tool, phase%release(i)%at, released, errors)
      if (any(phase%press%tool == phase%release(i)%tool)) then
        call errors%push_input(phase%release(i)%at, &
            "a tool cannot be pressed and released in one phase")
      end if
      if (motion(phase%release(i)%tool) == pressed) motion(phase%release(i)%tool) = held
    end do
    gone = gone .or. released
    ! A moved tool stands still in a later phase that does not name it.
    do i = 1, size(motion)
      if (motion(i) == moved .and. .not. named(i)) motion(i) = held
    end do
  end subroutine check_actions

  !> Reports a tool that is told two things.
  subroutine name_tool(case, tool, at, named, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> The tool.
    integer, intent(in) :: tool
    !> Where it is named.
    type(location_t), intent(in) :: at
    !> The tools named so far.
    logical, intent(inout) :: named(:)
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    if (named(tool)) then
      call errors%push_input(at, "tool '"//case%tool(tool)%source%called()// &
          "' is told two things in one phase", "one of hold, move and press for each tool")
    end if
    named(tool) = .true.
  end subroutine name_tool

  !> Checks the force on a tool: it has a line, and keeps it and its sense while the tool is
  !> pressed.
  subroutine check_press(press, motion, force, errors)
    !> The tool and the force.
    type(tool_vector_t), intent(in) :: press
    !> What each tool does.
    integer, intent(inout) :: motion(:)
    !> The last force on each pressed tool, N.
    real(wp), intent(inout) :: force(:, :)
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: before(3)

    before = 0.0_wp
    if (motion(press%tool) == pressed) before = force(:, press%tool)
    motion(press%tool) = pressed
    if (norm2(press%vector) > 0.0_wp) force(:, press%tool) = press%vector
    if (.not. norm2(press%vector) > 0.0_wp) then
      if (norm2(before) > 0.0_wp) return
      call errors%push_input(press%at, "a force of zero gives no line to move along", &
          "press = tool fx fy fz")
    else if (norm2(before) > 0.0_wp) then
      if (norm2(press%vector/norm2(press%vector) - before/norm2(before)) <= 1.0e-6_wp) return
      call errors%push_input(press%at, &
          "a pressed tool moves along one line: its force cannot turn", &
          "a force in the direction of the last one, or a phase between that holds the tool")
    end if
  end subroutine check_press

  !> Checks what drives the phase.
  subroutine check_control(case, phase, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> The phase.
    type(phase_spec_t), intent(in) :: phase
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: i, n_actions

    n_actions = size(phase%move) + size(phase%press) + size(phase%displace) + size(phase%load)
    n_actions = n_actions + size(phase%release)
    if (phase%control == 0) then
      if (n_actions == 0) then
        call errors%push_input(phase%source%opened, "nothing happens in this phase", &
            "at least one of move, press, displace, load, release")
      end if
      if (phase%trial > 1.0_wp) then
        call errors%push_input(phase%source%at("trial"), "trial = "//to_text(phase%trial)// &
            " is out of range", "a fraction of the phase, at most 1, where control = load")
      end if
      return
    end if
    do i = 1, size(phase%move)
      if (phase%move(i)%tool /= phase%control) cycle
      if (.not. norm2(phase%move(i)%vector) > 0.0_wp) then
        call errors%push_input(phase%move(i)%at, "the controlling tool's move has no length")
      end if
      return
    end do
    call errors%push_input(phase%source%at("control"), "the controlling tool '"// &
        case%tool(phase%control)%source%called()//"' has no move in this phase", "move = "// &
        case%tool(phase%control)%source%called()//" dx dy dz, or control = load")
  end subroutine check_control

  !> Checks what ends the phase early.
  subroutine check_until(case, phase, motion, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> The phase.
    type(phase_spec_t), intent(in) :: phase
    !> What each tool does.
    integer, intent(in) :: motion(:)
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    if (phase%until%kind == until_never) return
    if (.not. phase%until%value > 0.0_wp) then
      call errors%push_input(phase%until%at, "until asks for a magnitude", "a number > 0")
    end if
    if (motion(phase%until%tool) == held) then
      call errors%push_input(phase%until%at, "tool '"// &
          case%tool(phase%until%tool)%source%called()// &
          "' stands still in this phase: it has no line of motion", &
          "a tool that is moved or pressed")
    end if
  end subroutine check_until

end module dd3_input_phase_check
