! SPDX-License-Identifier: GPL-3.0-or-later
!> Rotation of the tools in a state.
module dd3_model_turning
  use dd3_base_kinds, only : pi, wp
  use dd3_linalg_tensor, only : cross, rotation_about
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_pressed_tools, only : contact_moment
  use dd3_model_state, only : state_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: begin_turns, set_rotations, turning_rate, tool_origins, turned_angle, torque

contains

  !> Refer the displacements of the tools that a phase turns to the points on its axes.
  pure subroutine begin_turns(phase, state)
    type(phase_t), intent(in) :: phase
    !> At the start of the phase; gets centres and displacements.
    type(state_t), intent(inout) :: state

    integer :: t

    do t = 1, size(phase%turn)
      if (.not. phase%turns(t)) cycle
      call state%tools%refer_to(t, phase%turn(t)%centre)
    end do
    state%start%tool_rotation = state%tools%rotation
    state%start%tool_angle = state%tools%angle
  end subroutine begin_turns

  !> Set the rotations of the tools at the progress of a state.
  pure subroutine set_rotations(phase, state)
    type(phase_t), intent(in) :: phase
    type(state_t), intent(inout) :: state

    real(wp) :: angle, before(3, 3)
    integer :: t

    do t = 1, size(phase%turn)
      if (.not. phase%turns(t)) cycle
      angle = phase%turn_factor(state%progress)*phase%turn(t)%angle
      before = state%tools%rotation(:, :, t)
      associate (start => state%start%tool_rotation(:, :, t), &
          now => state%tools%rotation(:, :, t), untilted => state%tools%untilted(:, :, t))
        now = matmul(rotation_about(matmul(start, phase%turn(t)%axis), angle), start)
        ! Its tilt turns with it.
        untilted = matmul(now, matmul(transpose(before), untilted))
      end associate
      state%tools%angle(t) = state%start%tool_angle(t) + angle
    end do
  end subroutine set_rotations

  !> Return the part of its turn in the displacement of a tool's point per progress of the phase,
  !> mm.
  pure function turning_rate(phase, state, tool, x) result(rate)
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    !> Place of the point, mm.
    real(wp), intent(in) :: x(3)
    real(wp) :: rate(3)

    rate = 0.0_wp
    if (.not. phase%turns(tool)) return
    rate = phase%turn_slope(state%progress)*phase%turn(tool)%angle &
        *cross(matmul(state%tools%rotation(:, :, tool), phase%turn(tool)%axis), &
        x - state%tools%centre(:, tool) - state%tools%displacement(:, tool))
  end function turning_rate

  !> Return the displacements of the origins of the tools' files, `(3, n_tool)`, mm.
  pure function tool_origins(state) result(displacement)
    type(state_t), intent(in) :: state
    real(wp), allocatable :: displacement(:, :)

    type(placement_t) :: placement
    integer :: t

    displacement = state%tools%displacement
    do t = 1, size(displacement, 2)
      placement = state%placement(t)
      displacement(:, t) = placement%translation
    end do
  end function tool_origins

  !> Return the angle by which a tool has turned since the start of the job, degrees.
  pure real(wp) function turned_angle(state, tool) result(angle)
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool

    angle = 180.0_wp/pi*state%tools%angle(tool)
  end function turned_angle

  !> Return the moment of the contact forces on a tool about the axis of its turn in the running
  !> phase or the last one before, N.mm; 0 if it has not turned.
  real(wp) function torque(model, state, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool

    type(placement_t) :: placement
    integer :: i

    torque = 0.0_wp
    placement = state%placement(tool)
    do i = state%phase, 1, -1
      if (.not. model%phase(i)%turns(tool)) cycle
      associate (turn => model%phase(i)%turn(tool))
        torque = dot_product(placement%vector_to_global(turn%axis), contact_moment(model, state, &
            tool, state%contact%lambda, placement%vector_to_global(turn%centre) &
            + placement%translation))
      end associate
      return
    end do
  end function torque

end module dd3_model_turning
