!> The start of a phase: what only the state at that moment can tell.
module dd3_process_stage
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : find_contact, hint_t, hit_t
  use dd3_contact_operator, only : status_gap
  use dd3_input_case, only : until_displacement, until_force
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: begin_phase, next_output_progress, phase_is_over, until_value, progress_tolerance
  public :: look_along, reach, along

  !> How far a pressed tool that touches nothing is looked for along its line, mm.
  real(wp), parameter :: reach = 1.0e3_wp
  !> A component of a normal along a force up to this is none: the force acts along the surface.
  real(wp), parameter :: along = 1.0e-6_wp
  !> Advances of a pressed tool towards the sheet; each covers at least the smallest gap left.
  integer, parameter :: most_advances = 200
  !> A gap this small counts as touch, mm.
  real(wp), parameter :: closed = 1.0e-9_wp
  !> Share of a phase within which its end, or an output, is met.
  real(wp), parameter :: progress_tolerance = 1.0e-9_wp

contains

  !> Begins a phase: forces go on from where they are, released contacts become forces that fade
  !> over the phase, and a pressed tool that touches nothing approaches to touch.
  !>
  !> A release is predicted elastic: beyond the largest force a tool can bear, the tangents of
  !> loading would lead the sheet on along the falling branch instead of back.
  subroutine begin_phase(model, number, phase, state)
    !> The model.
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> The phase with its start filled in.
    type(phase_t), intent(out) :: phase
    !> The committed state.
    type(state_t), intent(inout) :: state

    integer :: c, tool
    logical :: released

    phase = model%phase(number)
    state%phase = number
    state%progress = 0.0_wp
    phase%load_start = state%load
    where (spread(phase%keeps_load, 1, 3)) phase%load_end = phase%load_start
    call take_press_start(phase, state)
    where (spread(phase%pressed .and. phase%keeps_press, 1, 3)) phase%press_end = phase%press_start
    call take_until_side(phase, state)
    released = .false.
    do c = 1, model%n_contact
      tool = state%contact_tool(c)
      if (tool == 0) cycle
      if (phase%active(tool)) cycle
      state%fading(:, c) = state%fading(:, c) + state%lambda(:, c)
      state%fading_tool(c) = tool
      state%lambda(:, c) = 0.0_wp
      state%status(c) = status_gap
      state%contact_tool(c) = 0
      released = .true.
    end do
    phase%fading = state%fading
    if (released) state%plastic = .false.
    do tool = 1, model%n_tool
      if (phase%pressed(tool) .and. phase%active(tool)) call approach(model, phase, tool, state)
    end do
    phase%tool_start = state%tool_displacement
  end subroutine begin_phase

  !> The force on a pressed tool goes on from its last value; on one that was held or moved until
  !> now, from what it bears along its line.
  subroutine take_press_start(phase, state)
    !> The phase.
    type(phase_t), intent(inout) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state

    integer :: tool

    phase%press_start = 0.0_wp
    do tool = 1, size(phase%pressed)
      if (.not. phase%pressed(tool)) cycle
      if (norm2(state%tool_load(:, tool)) > 0.0_wp) then
        phase%press_start(:, tool) = state%tool_load(:, tool)
      else
        phase%press_start(:, tool) = phase%direction(:, tool) &
          *max(0.0_wp, -dot_product(phase%direction(:, tool), state%tool_force(:, tool)))
      end if
    end do
  end subroutine take_press_start

  !> From which side the force is met that ends the phase early: the one it begins on.
  subroutine take_until_side(phase, state)
    !> The phase.
    type(phase_t), intent(inout) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state

    if (phase%until%kind /= until_force) return
    phase%until_from_below = abs(until_value(phase, state)) <= phase%until%value
  end subroutine take_until_side

  !> What has the size of the early end when it is met: the displacement of its tool along its line
  !> since the phase began, mm, or the force on it along that line, N.
  pure real(wp) function until_value(phase, state) result(value)
    !> The phase.
    type(phase_t), intent(in) :: phase
    !> The state.
    type(state_t), intent(in) :: state

    associate (tool => phase%until%tool)
      if (phase%until%kind == until_displacement) then
        value = dot_product(phase%direction(:, tool), state%tool_displacement(:, tool) &
            - phase%tool_start(:, tool))
      else
        value = dot_product(phase%direction(:, tool), state%tool_force(:, tool))
      end if
    end associate
  end function until_value

  !> Moves a pressed tool that touches nothing along its line until it touches.
  subroutine approach(model, phase, tool, state)
    !> The model.
    type(model_t), intent(in) :: model
    !> The phase.
    type(phase_t), intent(in) :: phase
    !> The tool.
    integer, intent(in) :: tool
    !> The committed state.
    type(state_t), intent(inout) :: state

    real(wp) :: smallest, facing
    integer :: k

    if (any(state%contact_tool == tool .and. state%status /= status_gap)) return
    do k = 1, most_advances
      call look_along(model, phase, tool, state, smallest, facing)
      if (smallest <= closed .or. smallest > reach .or. facing <= along) return
      state%tool_displacement(:, tool) = state%tool_displacement(:, tool) &
          + smallest*phase%direction(:, tool)
    end do
  end subroutine approach

  !> How far a pressed tool is from the sheet, and whether its force pushes it there.
  subroutine look_along(model, phase, tool, state, smallest, facing)
    !> The model.
    type(model_t), intent(in) :: model
    !> The phase.
    type(phase_t), intent(in) :: phase
    !> The tool.
    integer, intent(in) :: tool
    !> The committed state.
    type(state_t), intent(in) :: state
    !> The smallest gap, mm; a large number where no node is before the tool.
    real(wp), intent(out) :: smallest
    !> The largest component along the force that a normal of the tool has where nodes are before
    !> it: below 0 the force points away from them.
    real(wp), intent(out) :: facing

    type(hint_t) :: hint
    type(hit_t) :: hit
    integer :: c

    smallest = huge(1.0_wp)
    facing = -1.0_wp
    do c = 1, model%n_contact
      if (.not. model%candidate(tool, c)) cycle
      hint = hint_t()
      call find_contact(model%tool(tool)%surface, &
          state%x(:, model%contact_node(c)) - state%tool_displacement(:, tool), hint, reach, &
          model%contact_depth, hit)
      if (.not. hit%found) cycle
      smallest = min(smallest, hit%distance)
      facing = max(facing, dot_product(hit%normal, phase%direction(:, tool)))
    end do
  end subroutine look_along

  !> Progress of the phase at the next output of fields; the phase's end is always one.
  real(wp) function next_output_progress(model, phase, state) result(progress)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state

    real(wp) :: travel
    integer :: i

    progress = huge(1.0_wp)
    if (phase%length <= 0.0_wp) return
    travel = state%progress*phase%length
    if (model%output%fields_every > 0.0_wp) then
      progress = (aint(travel/model%output%fields_every + progress_tolerance) + 1) &
        *model%output%fields_every/phase%length
    else if (allocated(model%output%fields_at)) then
      do i = 1, size(model%output%fields_at)
        if (model%output%fields_at(i) <= travel + progress_tolerance*phase%length) cycle
        progress = model%output%fields_at(i)/phase%length
        exit
      end do
    end if
    if (progress > 1.0_wp) progress = huge(1.0_wp)
  end function next_output_progress

  !> Whether the phase has come to its end, or met its early end.
  logical function phase_is_over(phase, state)
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state

    phase_is_over = state%progress >= 1.0_wp - progress_tolerance
    if (phase%until%tool > 0) phase_is_over = phase_is_over .or. until_met(phase, state)
  end function phase_is_over

  !> Whether the early end is met, within a thousandth of the force or a millionth of the
  !> displacement.
  logical function until_met(phase, state)
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state

    real(wp), parameter :: displacement_tolerance = 1.0e-6_wp, force_tolerance = 1.0e-3_wp
    real(wp) :: tolerance, met

    tolerance = force_tolerance
    if (phase%until%kind == until_displacement) tolerance = displacement_tolerance
    met = abs(until_value(phase, state))
    if (phase%until_from_below) then
      until_met = met >= phase%until%value*(1.0_wp - tolerance)
    else
      until_met = met <= phase%until%value*(1.0_wp + tolerance)
    end if
  end function until_met

end module dd3_process_stage
