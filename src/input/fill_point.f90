! SPDX-License-Identifier: GPL-3.0-or-later
!> Fills the single-point runs of the case.
module dd3_input_fill_point
  use dd3_base_kinds, only : wp, pi
  use dd3_base_text, only : lower_case
  use dd3_input_block, only : block_t, entry_t
  use dd3_input_case, only : point_spec_t, point_goal_t
  implicit none
  private
  public :: fill_point

  !> Degrees per radian.
  real(wp), parameter :: degrees = 180.0_wp/pi

contains

  !> Fill a run. Its material and the material's frame must be set.
  subroutine fill_point(point, block)
    type(point_spec_t), intent(inout) :: point
    type(block_t), intent(in) :: block

    integer :: i, k

    point%name = block%name
    point%source = block
    if (block%has("angle")) point%frame = frame_at(block%number("angle")/degrees)
    point%by_gradient = block%has("gradient")
    if (block%has("control")) then
      k = block%find("control")
      do i = 1, min(6, size(block%entry(k)%value))
        point%by_stress(i) = index(lower_case(block%entry(k)%value(i)%text), "s") == 1
      end do
    end if
    allocate (point%goal(count([(is_goal(block%entry(i)), i=1, block%n_entry)])))
    k = 0
    do i = 1, block%n_entry
      if (.not. is_goal(block%entry(i))) cycle
      k = k + 1
      call fill_goal(point%goal(k), block%entry(i))
    end do
    if (block%has("duration")) call fill_durations(point%goal, block%numbers("duration"))
  end subroutine fill_point

  !> Whether an entry is a valid target.
  pure logical function is_goal(entry)
    type(entry_t), intent(in) :: entry

    is_goal = entry%valid .and. (entry%key == "target" .or. entry%key == "gradient")
  end function is_goal

  !> Fill a target: its values, then the number of steps.
  pure subroutine fill_goal(goal, entry)
    type(point_goal_t), intent(inout) :: goal
    type(entry_t), intent(in) :: entry

    integer :: last

    last = size(entry%number)
    goal%value = entry%number(:last - 1)
    goal%steps = nint(entry%number(last))
    goal%at = entry%value(1)%at
  end subroutine fill_goal

  !> Set the times of the targets; those without one keep none.
  pure subroutine fill_durations(goal, duration)
    type(point_goal_t), intent(inout) :: goal(:)
    !> One for each target, or one for all, s.
    real(wp), intent(in) :: duration(:)

    integer :: n

    n = min(size(goal), size(duration))
    goal(:n)%duration = duration(:n)
    if (size(duration) == 1) goal%duration = duration(1)
  end subroutine fill_durations

  !> Return the directions of the sheet as columns, with x at an angle (radians) from the rolling
  !> direction.
  pure function frame_at(angle) result(frame)
    real(wp), intent(in) :: angle
    real(wp) :: frame(3, 3)

    frame(:, 1) = [cos(angle), -sin(angle), 0.0_wp]
    frame(:, 2) = [sin(angle), cos(angle), 0.0_wp]
    frame(:, 3) = [0.0_wp, 0.0_wp, 1.0_wp]
  end function frame_at

end module dd3_input_fill_point
