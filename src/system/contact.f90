! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact of the candidates of this rank: nearest tool, status, force and linearisation, in a trial
!> state (corrector) or at the committed state with its stored status (predictor).
module dd3_system_contact
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_contact_closest, only : border_t, hint_t, hit_t
  use dd3_contact_compliant, only : compliant_operator, layer_t, rotated
  use dd3_contact_operator, only : contact_operator_of_status, contact_status, &
      round_off, status_gap, status_slip, status_stick
  use dd3_contact_placement, only : placement_t, relative_displacement
  use dd3_contact_tool, only : find_on_tool
  use dd3_model_contact_layer, only : border_at, contact_penalty, layer_at
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : is_normal_held, is_slip_prescribed, phase_t
  use dd3_model_outward_normals, only : outward_normals
  use dd3_model_state, only : state_t
  use dd3_model_turning, only : turning_rate
  use dd3_system_contact_work, only : contact_work_t, open_candidate
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
        call find_and_evaluate(self, model, committed, trial, points(c))
      end do
      return
    end if
    !$omp parallel do num_threads(threads_for(model%n_contact, least_nodes)) private(c) &
    !$omp& schedule(dynamic, chunk)
    do c = 1, model%n_contact
      call find_and_evaluate(self, model, committed, trial, c)
    end do
    !$omp end parallel do
  end subroutine evaluate_contact

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
  subroutine evaluate_layer(self, trial, c, layer, hit, slip, friction)
    type(contact_work_t), intent(inout) :: self
    type(state_t), intent(in) :: trial
    integer, intent(in) :: c
    type(layer_t), intent(in) :: layer
    type(hit_t), intent(in) :: hit
    !> Slip, mm, and coefficient of friction.
    real(wp), intent(in) :: slip(3), friction

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
  end subroutine evaluate_layer

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
      call find_and_predict(self, model, committed, touching, c)
    end do
    !$omp end parallel do
  end subroutine predictor_contact

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
  subroutine predict_layer(self, model, state, c, layer, hit, touching)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state
    integer, intent(in) :: c
    type(layer_t), intent(in) :: layer
    type(hit_t), intent(in) :: hit
    !> Whether any candidate is in contact with the tool.
    logical, intent(in) :: touching

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
