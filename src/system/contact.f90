! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact of the candidates of this rank: nearest tool, status, force and linearisation, in a trial
!> state (corrector) or at the committed state with its stored status (predictor).
module dd3_system_contact
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_contact_compliant, only : compliant_operator, fraction_of, layer_t, rotated
  use dd3_contact_operator, only : contact_operator_of_status, contact_status, &
      round_off, status_gap, status_slip, status_stick
  use dd3_model_contact_layer, only : border_at, contact_penalty, layer_at
  use dd3_model_contact_point, only : contact_point_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : is_normal_held, is_slip_prescribed, phase_t
  use dd3_model_outward_normals, only : outward_normals
  use dd3_model_state, only : state_t
  use dd3_model_turning, only : turning_rate
  use dd3_system_contact_work, only : contact_work_t, open_candidate
  use dd3_tools_closest, only : border_t, hint_t, hit_t
  use dd3_tools_crossing, only : crossing_t, near_border
  use dd3_tools_placement, only : placement_t, relative_displacement
  use dd3_tools_tool, only : find_crossing_on_tool, find_on_tool
  implicit none
  private
  public :: evaluate_contact, predictor_contact

  !> Factor on the penalty of a candidate whose supports hold it along the normal: its force does
  !> not follow from equilibrium, but grows or falls by the penalty times the gap in every
  !> iteration.
  real(wp), parameter :: held_factor = 1.0e4_wp
  !> Part of the layer that is left, where the predictor takes its stiffness at first contact.
  real(wp), parameter :: at_onset = 0.5_wp
  !> Candidates that a thread takes at a time.
  integer, parameter :: chunk = 64

contains

  !> Evaluate the contact in a trial state: search, status, force and linearisation. The outward
  !> normals are those of the predictor.
  subroutine evaluate_contact(self, model, committed, trial, points)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Origin of the slip.
    type(state_t), intent(in) :: committed
    !> Gets status, tool and closest points.
    type(state_t), intent(inout) :: trial
    !> Numbers of the candidates; all if not present.
    integer, intent(in), optional :: points(:)

    integer :: c

    self%search_distance = model%phase(trial%phase)%search_distance
    if (present(points)) then
      do c = 1, size(points)
        call evaluate_point(self, model, committed, trial, points(c))
      end do
      return
    end if
    !$omp parallel do num_threads(threads_for(model%n_contact, least_nodes)) private(c) &
    !$omp& schedule(dynamic, chunk)
    do c = 1, model%n_contact
      call evaluate_point(self, model, committed, trial, c)
    end do
    !$omp end parallel do
  end subroutine evaluate_contact

  !> Evaluate the contact at a point.
  subroutine evaluate_point(self, model, committed, trial, c)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: c

    if (model%contact_point(c)%moves) then
      call evaluate_crossing(self, model, committed, trial, c)
    else
      call find_and_evaluate(self, model, committed, trial, c)
    end if
  end subroutine evaluate_point

  !> Evaluate the contact of an edge of the mesh with the borders of the tools.
  subroutine evaluate_crossing(self, model, committed, trial, c)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: c

    type(contact_point_t) :: point
    type(crossing_t) :: crossing
    real(wp) :: slip(3)

    call find_nearest_border(self, model, trial, c, crossing)
    trial%contact_tool(c) = self%tool(c)
    trial%status(c) = status_gap
    if (self%tool(c) == 0) return
    trial%place(c) = crossing%place
    point = model%contact_point(c)%at_place(crossing%place)
    associate (tool => self%tool(c), phase => model%phase(trial%phase))
      slip = relative_displacement(committed%placement(tool), trial%placement(tool), &
          point%position(committed%x), point%position(trial%x))
      call evaluate_layer(self, trial, c, fraction_of(layer_at(model, phase, c), &
          crossing%weight), crossing_hit(crossing), slip, model%tool(tool)%friction, crossing)
    end associate
    trial%status(c) = self%status(c)
  end subroutine evaluate_crossing

  !> Return a crossing as a closest point.
  pure type(hit_t) function crossing_hit(crossing) result(hit)
    type(crossing_t), intent(in) :: crossing

    hit%distance = crossing%distance
    hit%normal = crossing%normal
    hit%gap_gradient = crossing%normal
    hit%dnormal = crossing%dnormal
  end function crossing_hit

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
              self%outward(:, c), border_at(model, phase, c), self%search_distance, crossing)
          if (.not. crossing%found .or. crossing%distance >= nearest%distance) cycle
          nearest = crossing
          self%tool(c) = t
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
    if (model%phase(state%phase)%mixed) return
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

  !> Evaluate the contact of one candidate.
  subroutine find_and_evaluate(self, model, committed, trial, c)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: c

    type(hint_t) :: hint(model%n_tool)
    type(hit_t) :: hit
    real(wp) :: x(3), slip(3), penalty(2)
    integer :: tool

    hint = trial%hint(:, c)
    x = model%contact_point(c)%position(trial%x)
    call find_nearest_tool(self, model, committed, trial, c, x, hint, hit)
    tool = self%tool(c)
    trial%contact_tool(c) = tool
    trial%hint(:, c) = hint
    if (tool == 0) then
      call open_candidate(self, c)
    else
      slip = relative_displacement(committed%placement(tool), trial%placement(tool), &
          self%committed_x(:, c), x)
      self%normal(:, c) = hit%normal
      associate (phase => model%phase(trial%phase))
        if (.not. phase%mixed) then
          call evaluate_layer(self, trial, c, layer_at(model, phase, c), hit, slip, &
              model%tool(tool)%friction)
        else
          penalty = candidate_penalty(model, phase, c, hit%normal, slip)
          self%onset(c) = 0.0_wp
          self%distance(c) = hit%distance
          self%status(c) = contact_status(hit%normal, self%distance(c), trial%lambda(:, c), slip, &
              penalty, model%tool(tool)%friction)
          call contact_operator_of_status(self%status(c), hit%normal, self%distance(c), &
              hit%dnormal, trial%lambda(:, c), slip, penalty, model%tool(tool)%friction, &
              self%force(:, c), self%d(:, :, c), self%e(:, :, c))
        end if
      end associate
    end if
    trial%status(c) = self%status(c)
  end subroutine find_and_evaluate

  !> Return the penalties of a candidate on gap and slip at a point of a tool, N/mm. The tangential
  !> force of a candidate whose supports prescribe a slip does not follow from equilibrium, but from
  !> sigma_t: in every iteration it takes the direction of its last value and the penalty times the
  !> slip. With the stiffness of the sheet under the candidate the slip outweighs a friction force,
  !> and the force has the direction of the slip at once.
  pure function candidate_penalty(model, phase, c, normal, slip) result(penalty)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c
    !> Of the tool, and relative to it, mm.
    real(wp), intent(in) :: normal(3), slip(3)
    real(wp) :: penalty(2)

    penalty = contact_penalty(model, phase, c)
    associate (node => model%contact_node(c))
      if (is_normal_held(phase, node, normal)) penalty = held_factor*penalty
      if (is_slip_prescribed(phase, node, normal, slip)) penalty(2) = &
          max(penalty(2), model%contact_stiffness(c))
    end associate
  end function candidate_penalty

  !> Return the distance by which the layer of a tool lies behind its place at a point, mm.
  pure real(wp) function offset_at(state, tool, c)
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool, c

    offset_at = state%layer_offset(tool)
    if (state%start%held_offset(c) >= 0.0_wp) offset_at = state%start%held_offset(c)
  end function offset_at

  !> Evaluate status, force and linearisation of a candidate near the layer of a tool. One that
  !> changes its tool has no tangential force of its history.
  subroutine evaluate_layer(self, trial, c, layer, hit, slip, friction, crossing)
    type(contact_work_t), intent(inout) :: self
    type(state_t), intent(in) :: trial
    integer, intent(in) :: c
    type(layer_t), intent(in) :: layer
    type(hit_t), intent(in) :: hit
    !> Slip, mm, and coefficient of friction.
    real(wp), intent(in) :: slip(3), friction
    !> If the point is one; the layer is then its fraction by the weight.
    type(crossing_t), intent(in), optional :: crossing

    real(wp) :: gap, committed(3)

    gap = hit%distance + offset_at(trial, self%tool(c), c)
    committed = 0.0_wp
    if (self%tool(c) == self%committed_tool(c)) committed = &
        rotated(self%committed_force(:, c), self%committed_normal(:, c), hit%normal)
    self%onset(c) = layer%height
    self%distance(c) = gap - layer%height
    self%status(c) = status_gap
    call compliant_operator(layer, hit%normal, gap, hit%dnormal, trial%lambda(:, c), committed, &
        slip, friction, self%status(c), self%force(:, c), self%d(:, :, c), self%e(:, :, c), &
        hit%gap_gradient)
    if (present(crossing)) call add_crossing_terms(self, c, layer, crossing, gap, &
        trial%lambda(:, c), committed, slip, friction)
  end subroutine evaluate_layer

  !> Add the derivatives of the force at a crossing that a point on a surface does not have: by the
  !> normal as the edge turns, and by the weight.
  subroutine add_crossing_terms(self, c, layer, crossing, gap, lambda, committed, slip, friction)
    !> Has force, status and derivatives of the law.
    type(contact_work_t), intent(inout) :: self
    integer, intent(in) :: c
    type(layer_t), intent(in) :: layer
    type(crossing_t), intent(in) :: crossing
    !> mm.
    real(wp), intent(in) :: gap
    !> As for `compliant_operator`.
    real(wp), intent(in) :: lambda(3), committed(3), slip(3), friction

    real(wp), parameter :: still(3, 3) = 0.0_wp
    real(wp) :: square, force(3), d(3, 3, 2), e(3, 3), change(3)
    integer :: status, i

    self%by_edge(:, :, c) = 0.0_wp
    status = self%status(c)
    if (status == status_gap) return
    associate (along => crossing%along, n => crossing%normal)
      square = dot_product(along, along)
      if (square > tiny(1.0_wp)) then
        call compliant_operator(layer, n, gap, still, lambda, committed, slip, friction, status, &
            force, d(:, :, 1), e)
        call compliant_operator(layer, n, gap, spread(along, 2, 3)*spread(along, 1, 3), lambda, &
            committed, slip, friction, status, force, d(:, :, 2), e)
        change = matmul(d(:, :, 2) - d(:, :, 1), along)/square
        do i = 1, 3
          self%by_edge(:, i, c) = -change*n(i)
        end do
      end if
      ! On the line of the law's scale the normal force is proportional to the area as far as the
      ! layer is softer than that.
      change = self%force(:, c)
      if (status == status_stick) change = dot_product(n, change)*n
      change = (1.0_wp - dot_product(n, matmul(self%e(:, :, c), n)))/crossing%weight*change
    end associate
    do i = 1, 3
      self%d(:, i, c) = self%d(:, i, c) + change*crossing%weight_by_point(i)
      self%by_edge(:, i, c) = self%by_edge(:, i, c) + change*crossing%weight_by_edge(i)
    end do
  end subroutine add_crossing_terms

  !> Evaluate the contact of the predictor: the committed state with its stored status (a slipping
  !> node lies on the cone, where round-off would make it stick). If a tool has no contact, the
  !> candidates within `touch` of it stick without being pulled, unless it moves away from them.
  !> A gap that has closed resists without friction.
  subroutine predictor_contact(self, model, committed)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed

    logical :: touching(model%n_tool)
    integer :: c, tool

    self%outward = outward_normals(model, committed%x)
    self%turn_limited = .false.
    self%search_distance = model%tolerance%tool_search
    associate (phase => model%phase(committed%phase))
      touching = .false.
      do c = 1, model%n_contact
        if (committed%status(c) == status_gap) cycle
        if (norm2(committed%lambda(:, c)) <= round_off*contact_penalty(model, phase, c)) cycle
        touching(committed%contact_tool(c)) = .true.
      end do
    end associate
    touching = [(any_rank(touching(tool)), tool=1, model%n_tool)]
    !$omp parallel do num_threads(threads_for(model%n_contact, least_nodes)) private(c) &
    !$omp& schedule(dynamic, chunk)
    do c = 1, model%n_contact
      if (model%contact_point(c)%moves) then
        self%near(c) = may_cross(model, committed, c)
        call predict_crossing(self, model, committed, touching, c)
      else
        call find_and_predict(self, model, committed, touching, c)
      end if
    end do
    !$omp end parallel do
  end subroutine predictor_contact

  !> Evaluate the contact of an edge of the mesh with borders in the predictor.
  subroutine predict_crossing(self, model, committed, touching, c)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Whether any candidate, of any rank, is in contact with each tool.
    logical, intent(in) :: touching(:)
    integer, intent(in) :: c

    type(contact_point_t) :: point
    type(crossing_t) :: crossing

    self%place(c) = committed%place(c)
    self%committed_tool(c) = 0
    call find_nearest_border(self, model, committed, c, crossing)
    self%status(c) = status_gap
    if (self%tool(c) == 0) return
    self%status(c) = committed%status(c)
    point = model%contact_point(c)%at_place(crossing%place)
    self%committed_x(:, c) = point%position(committed%x)
    self%turning(:, c) = turning_rate(model%phase(committed%phase), committed, self%tool(c), &
        self%committed_x(:, c))
    self%committed_tool(c) = committed%contact_tool(c)
    self%committed_normal(:, c) = crossing%normal
    self%committed_force(:, c) = committed%lambda(:, c)
    associate (phase => model%phase(committed%phase))
      call predict_layer(self, model, committed, c, fraction_of(layer_at(model, phase, c), &
          crossing%weight), crossing_hit(crossing), touching(self%tool(c)), crossing)
    end associate
  end subroutine predict_crossing

  !> Evaluate the contact of one candidate in the predictor.
  subroutine find_and_predict(self, model, committed, touching, c)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Whether any candidate, of any rank, is in contact with each tool.
    logical, intent(in) :: touching(:)
    integer, intent(in) :: c

    real(wp), parameter :: no_slip(3) = 0.0_wp
    type(hint_t) :: hint(model%n_tool)
    type(hit_t) :: hit
    real(wp) :: friction
    integer :: tool
    logical :: leaving

    hint = committed%hint(:, c)
    self%committed_x(:, c) = model%contact_point(c)%position(committed%x)
    call find_nearest_tool(self, model, committed, committed, c, self%committed_x(:, c), hint, hit)
    self%committed_turn(c) = hit%turn
    tool = self%tool(c)
    self%status(c) = committed%status(c)
    self%committed_tool(c) = 0
    if (tool == 0) then
      call open_candidate(self, c)
      return
    end if
    self%normal(:, c) = hit%normal
    self%turning(:, c) = turning_rate(model%phase(committed%phase), committed, tool, &
        self%committed_x(:, c))
    self%committed_tool(c) = committed%contact_tool(c)
    self%committed_normal(:, c) = hit%normal
    self%committed_force(:, c) = committed%lambda(:, c)
    associate (phase => model%phase(committed%phase))
      if (.not. phase%mixed) then
        call predict_layer(self, model, committed, c, layer_at(model, phase, c), hit, &
            touching(tool))
        return
      end if
      self%onset(c) = 0.0_wp
      self%distance(c) = hit%distance
      friction = model%tool(tool)%friction
      leaving = dot_product(phase%tool_rate(tool, committed%progress, &
          committed%start%tool_displacement) + self%turning(:, c), hit%normal) < 0.0_wp
      if (.not. touching(tool)) then
        self%status(c) = status_gap
        if (hit%distance <= model%tolerance%touch .and. .not. leaving) self%status(c) = status_stick
      else if (self%status(c) == status_gap .and. .not. leaving .and. hit%distance < 0.0_wp) then
        self%status(c) = status_slip
        friction = 0.0_wp
      end if
      call contact_operator_of_status(self%status(c), hit%normal, 0.0_wp, hit%dnormal, &
          committed%lambda(:, c), no_slip, &
          candidate_penalty(model, phase, c, hit%normal, no_slip), friction, self%force(:, c), &
          self%d(:, :, c), self%e(:, :, c))
    end associate
  end subroutine find_and_predict

  !> Evaluate a candidate near the layer of a tool in the predictor, with its committed status. If
  !> the tool has no contact, those within `touch` of the layer resist as inside it: at the onset
  !> its slope is zero.
  subroutine predict_layer(self, model, state, c, layer, hit, touching, crossing)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state
    integer, intent(in) :: c
    type(layer_t), intent(in) :: layer
    type(hit_t), intent(in) :: hit
    !> Whether any candidate is in contact with the tool.
    logical, intent(in) :: touching
    !> If the point is one; the layer is then its fraction by the weight.
    type(crossing_t), intent(in), optional :: crossing

    real(wp), parameter :: no_slip(3) = 0.0_wp
    real(wp) :: gap, committed(3)

    gap = hit%distance + offset_at(state, self%tool(c), c)
    self%onset(c) = layer%height
    self%distance(c) = gap - layer%height
    if (.not. touching .and. self%distance(c) <= model%tolerance%touch) gap = &
        min(gap, at_onset*layer%height)
    committed = 0.0_wp
    if (self%committed_tool(c) == self%tool(c)) committed = self%committed_force(:, c)
    call compliant_operator(layer, hit%normal, gap, hit%dnormal, state%lambda(:, c), &
        committed, no_slip, model%tool(self%tool(c))%friction, self%status(c), &
        self%force(:, c), self%d(:, :, c), self%e(:, :, c), hit%gap_gradient)
    if (present(crossing)) call add_crossing_terms(self, c, layer, crossing, gap, &
        state%lambda(:, c), committed, no_slip, model%tool(self%tool(c))%friction)
  end subroutine predict_layer

  !> Find the tool of a candidate: the nearest, or the one it is deepest in, with hysteresis. In the
  !> committed state every candidate is outside the tools, or no deeper inside than their layers lie
  !> back; since then it cannot have come deeper inside a tool than it moved relative to it.
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
    real(wp) :: best, distance, moved(3)
    integer :: t

    self%tool(c) = 0
    border = border_at(model, model%phase(trial%phase), c)
    if (self%turn_limited) border%turn = self%committed_turn(c)
    best = huge(1.0_wp)
    associate (phase => model%phase(trial%phase))
      do t = 1, model%n_tool
        if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
        placement = trial%placement(t)
        moved = relative_displacement(committed%placement(t), placement, &
            self%committed_x(:, c), position)
        call find_on_tool(model%tool(t), placement, position, hint(t), self%search_distance, &
            model%tolerance%committed_depth + committed%layer_offset(t) + norm2(moved), hit, &
            self%outward(:, c), border)
        if (.not. hit%found) cycle
        distance = hit%distance
        if (t == trial%contact_tool(c)) distance = distance - model%tolerance%hysteresis
        if (distance >= best) cycle
        best = distance
        self%tool(c) = t
        nearest = hit
      end do
    end associate
  end subroutine find_nearest_tool

end module dd3_system_contact
