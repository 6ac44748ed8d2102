! SPDX-License-Identifier: GPL-3.0-or-later
!> Search of the contact points for the tools: the nearest tool of a point, and the border of a tool
!> that an edge of the mesh crosses.
module dd3_system_contact_search
  use dd3_base_kinds, only : wp
  use dd3_model_contact_layer, only : border_at, deflection_at, offset_at
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_turning, only : turning_rate
  use dd3_system_contact_work, only : contact_work_t, open_candidate
  use dd3_tools_closest, only : border_t, hint_t, hit_t
  use dd3_tools_crossing, only : crossing_t, near_border
  use dd3_tools_placement, only : placement_t, relative_displacement
  use dd3_tools_tool, only : find_crossing_on_tool, find_on_tool
  implicit none
  private
  public :: find_candidate, find_committed_candidate, find_nearest_border, may_cross, crossing_hit

contains

  !> Find the tool of a candidate in a trial state, with the closest point on it and the slip since
  !> the committed state.
  subroutine find_candidate(self, model, committed, trial, c, hit, slip)
    !> Gets the tool, 0 if none is within the search distance.
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Gets tool and closest points.
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: c
    type(hit_t), intent(out) :: hit
    !> mm.
    real(wp), intent(out) :: slip(3)

    type(hint_t) :: hint(model%n_tool)
    real(wp) :: x(3)

    slip = 0.0_wp
    hint = trial%contact%hint(:, c)
    x = model%contact_point(c)%position(trial%x)
    call find_nearest_tool(self, model, committed, trial, c, x, hint, hit)
    trial%contact%tool(c) = self%tool(c)
    trial%contact%hint(:, c) = hint
    if (self%tool(c) == 0) then
      call open_candidate(self, c)
      return
    end if
    slip = relative_displacement(committed%placement(self%tool(c)), &
        trial%placement(self%tool(c)), self%committed_x(:, c), x)
    self%normal(:, c) = hit%normal
    self%rise(c) = dot_product(slip, hit%normal)
  end subroutine find_candidate

  !> Find the tool of a candidate in the committed state, and keep its contact there.
  subroutine find_committed_candidate(self, model, committed, c, hit)
    !> Gets the tool, 0 if none is within the search distance.
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    integer, intent(in) :: c
    type(hit_t), intent(out) :: hit

    type(hint_t) :: hint(model%n_tool)

    hint = committed%contact%hint(:, c)
    self%committed_x(:, c) = model%contact_point(c)%position(committed%x)
    call find_nearest_tool(self, model, committed, committed, c, self%committed_x(:, c), hint, hit)
    self%committed_turn(c) = hit%turn
    self%status(c) = committed%contact%status(c)
    self%committed_tool(c) = 0
    if (self%tool(c) == 0) then
      call open_candidate(self, c)
      return
    end if
    self%normal(:, c) = hit%normal
    self%turning(:, c) = turning_rate(model%phase(committed%phase), committed, self%tool(c), &
        self%committed_x(:, c))
    self%committed_tool(c) = committed%contact%tool(c)
    self%committed_normal(:, c) = hit%normal
    self%committed_force(:, c) = committed%contact%lambda(:, c)
  end subroutine find_committed_candidate

  !> Find the tool of a candidate: the nearest, or the one it is deepest in, with hysteresis. In the
  !> committed state every candidate is outside the tools, or no deeper inside than their layers lie
  !> back and its tool deflects; since then it cannot have come deeper inside a tool than it moved
  !> relative to it.
  subroutine find_nearest_tool(self, model, committed, trial, c, position, hint, nearest)
    !> Gets the tool, 0 if none is within the search distance.
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> The trial state has the tool so far.
    type(state_t), intent(in) :: committed, trial
    !> Number of the candidate.
    integer, intent(in) :: c
    !> Of the candidate in the trial state, mm.
    real(wp), intent(in) :: position(3)
    !> Last closest point on each tool, `(n_tool)`.
    type(hint_t), intent(inout) :: hint(:)
    !> Closest point on the nearest tool.
    type(hit_t), intent(out) :: nearest

    type(hit_t) :: hit
    type(placement_t) :: placement
    type(border_t) :: border
    real(wp) :: best, distance, depth, moved(3)
    integer :: t

    self%tool(c) = 0
    border = border_at(model, model%phase(trial%phase), c)
    if (self%turn_limited) border%turn = self%committed_turn(c)
    best = huge(1.0_wp)
    depth = model%tolerance%committed_depth + deflection_at(model, committed, c)
    associate (phase => model%phase(trial%phase))
      do t = 1, model%n_tool
        if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
        placement = trial%placement(t)
        moved = relative_displacement(committed%placement(t), placement, &
            self%committed_x(:, c), position)
        call find_on_tool(model%tool(t), placement, position, hint(t), self%search_distance, &
            depth + offset_at(committed, t, c) + norm2(moved), hit, &
            self%outward(:, c, model%touched_faces(t)), border)
        if (.not. hit%found) cycle
        distance = hit%distance
        if (t == trial%contact%tool(c)) distance = distance - model%tolerance%hysteresis
        if (distance >= best) cycle
        best = distance
        call take_tool(self, model, c, t)
        nearest = hit
      end do
    end associate
  end subroutine find_nearest_tool

  !> Set the tool of a candidate, and the area on which it acts there.
  subroutine take_tool(self, model, c, tool)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: c, tool

    self%tool(c) = tool
    if (allocated(self%area)) self%sliding(c)%area = self%area(c, model%touched_faces(tool))
  end subroutine take_tool

  !> Find the border that an edge of the mesh is nearest to, among those that it crosses.
  subroutine find_nearest_border(self, model, state, c, nearest)
    !> Gets tool, 0 for none, normal and place.
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: c
    type(crossing_t), intent(out) :: nearest

    type(crossing_t) :: crossing
    integer :: t

    self%tool(c) = 0
    associate (phase => model%phase(state%phase), node => model%contact_point(c)%node)
      if (self%near(c)) then
        do t = 1, model%n_tool
          if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
          call find_crossing_on_tool(model%tool(t), state%placement(t), state%x(:, node(:2)), &
              self%outward(:, c, model%touched_faces(t)), border_at(model, phase, c), &
              self%search_distance, crossing)
          if (.not. crossing%found .or. crossing%distance >= nearest%distance) cycle
          nearest = crossing
          call take_tool(self, model, c, t)
        end do
      end if
    end associate
    if (self%tool(c) == 0) then
      call open_candidate(self, c)
      return
    end if
    self%normal(:, c) = nearest%normal
    self%place(c) = nearest%place
    self%by_place(:, :, c) = reshape([nearest%by_point, nearest%by_edge], [3, 2])
  end subroutine find_nearest_border

  !> Whether an edge of the mesh may come to the border of a tool in the increment: with its own
  !> length as margin.
  logical function may_cross(model, state, c)
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state
    integer, intent(in) :: c

    type(placement_t) :: placement
    real(wp) :: ends(3, 2), margin
    integer :: t

    may_cross = .false.
    do t = 1, model%n_tool
      if (.not. (model%candidate(t, c) .and. model%phase(state%phase)%active(t))) cycle
      placement = state%placement(t)
      ends(:, 1) = placement%to_tool(state%x(:, model%contact_point(c)%node(1)))
      ends(:, 2) = placement%to_tool(state%x(:, model%contact_point(c)%node(2)))
      margin = norm2(ends(:, 2) - ends(:, 1))
      may_cross = near_border(model%tool(t)%surface, minval(ends, dim=2) - margin, &
          maxval(ends, dim=2) + margin)
      if (may_cross) return
    end do
  end function may_cross

  !> Return a crossing as a closest point.
  pure type(hit_t) function crossing_hit(crossing) result(hit)
    type(crossing_t), intent(in) :: crossing

    hit%distance = crossing%distance
    hit%normal = crossing%normal
    hit%gap_gradient = crossing%normal
    hit%dnormal = crossing%dnormal
  end function crossing_hit

end module dd3_system_contact_search
