!> Contact of the candidates: nearest tool, status, force and linearisation, in a trial state
!> (corrector) or at the committed state with its stored status (predictor).
module dd3_system_contact
  use dd3_base_kinds, only : wp
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_contact_closest, only : find_contact, hint_t, hit_t
  use dd3_contact_operator, only : contact_operator_of_status, contact_status, &
      contact_violation, round_off, status_gap, status_slip, status_stick
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_penalty, only : contact_penalty
  use dd3_model_outward_normals, only : outward_normals
  use dd3_model_state, only : state_t
  use dd3_model_tolerances, only : tangential
  implicit none
  private
  public :: contact_work_t, new_contact_work, evaluate_contact, predictor_contact, not_held
  public :: is_normal_held

  !> Value of `held` of a candidate whose status is not held.
  integer, parameter :: not_held = -1
  !> Factor on the penalty of a candidate whose supports hold it along the normal: its force does not
  !> follow from equilibrium, but grows or falls by the penalty times the gap in every iteration.
  real(wp), parameter :: held_factor = 1.0e4_wp
  !> Candidates that a thread takes at a time.
  integer, parameter :: chunk = 64

  !> Contact of the candidates.
  type :: contact_work_t
    !> One of the `status_*` values, `(n_contact)`.
    integer, allocatable :: status(:)
    !> Nearest tool, `(n_contact)`; 0 if none is within the search distance.
    integer, allocatable :: tool(:)
    !> Gap, mm, `(n_contact)`; meaningful if there is a tool.
    real(wp), allocatable :: distance(:)
    !> Outward normal of the tool, `(3, n_contact)`.
    real(wp), allocatable :: normal(:, :)
    !> Contact force lambda, N, `(3, n_contact)`.
    real(wp), allocatable :: lambda(:, :)
    !> Contact force F_equ by the contact law, N, `(3, n_contact)`.
    real(wp), allocatable :: force(:, :)
    !> D, N/mm, and E: `(3, 3, n_contact)`.
    real(wp), allocatable :: d(:, :, :), e(:, :, :)
    !> Status that a candidate is held in, `(n_contact)`, or `not_held`; the status by the contact
    !> law; and the force by which it violates the one held, N.
    integer, allocatable :: held(:), natural(:)
    real(wp), allocatable :: violation(:)
    !> Outward normals of the sheet in the committed state, `(3, n_contact)`.
    real(wp), allocatable :: outward(:, :)
    !> Distance up to which the tools are looked for, mm.
    real(wp) :: search_distance = 0.0_wp
  end type contact_work_t

contains

  !> Allocate the contact work.
  subroutine new_contact_work(self, n_contact)
    type(contact_work_t), intent(out) :: self
    integer, intent(in) :: n_contact

    allocate (self%status(n_contact), self%tool(n_contact), source=0)
    allocate (self%distance(n_contact), source=0.0_wp)
    allocate (self%normal(3, n_contact), self%lambda(3, n_contact), self%force(3, n_contact), &
        source=0.0_wp)
    allocate (self%d(3, 3, n_contact), self%e(3, 3, n_contact), source=0.0_wp)
    allocate (self%outward(3, n_contact), self%violation(n_contact), source=0.0_wp)
    allocate (self%held(n_contact), self%natural(n_contact), source=not_held)
  end subroutine new_contact_work

  !> Evaluate the contact in a trial state: search, status, force and linearisation. The outward
  !> normals are those of the predictor.
  subroutine evaluate_contact(self, model, committed, trial)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Origin of the slip.
    type(state_t), intent(in) :: committed
    !> Gets status, tool and closest points.
    type(state_t), intent(inout) :: trial

    integer :: c

    self%search_distance = model%phase(trial%phase)%search_distance
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
    real(wp) :: slip(3)
    integer :: node, tool

    node = model%contact_node(c)
    hint = trial%hint(:, c)
    call find_nearest_tool(self, model, committed, trial, c, hint, hit)
    tool = self%tool(c)
    trial%contact_tool(c) = tool
    trial%hint(:, c) = hint
    self%lambda(:, c) = trial%lambda(:, c)
    if (tool == 0) then
      call open_candidate(self, c)
    else
      slip = trial%x(:, node) - committed%x(:, node) - trial%tool_displacement(:, tool) &
          + committed%tool_displacement(:, tool)
      self%distance(c) = hit%distance
      self%normal(:, c) = hit%normal
      call evaluate_candidate(self, c, hit, slip, candidate_penalty(model, &
          model%phase(trial%phase), c, hit%normal, trial%penalty_reduced), &
          model%tool(tool)%friction)
    end if
    trial%status(c) = self%status(c)
  end subroutine find_and_evaluate

  !> Return the penalty of a candidate at a point of a tool, N/mm.
  pure real(wp) function candidate_penalty(model, phase, c, normal, reduced) result(penalty)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c
    !> Of the tool.
    real(wp), intent(in) :: normal(3)
    !> Whether a penalty of the input above the automatic one is reduced to it.
    logical, intent(in) :: reduced

    penalty = contact_penalty(model, phase, c, reduced)
    if (is_normal_held(phase, model%contact_node(c), normal)) penalty = held_factor*penalty
  end function candidate_penalty

  !> Whether the prescribed displacements of a node hold it along a normal.
  pure logical function is_normal_held(phase, node, normal)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: node
    real(wp), intent(in) :: normal(3)

    is_normal_held = norm2(merge(0.0_wp, normal, phase%prescribed(:, node))) <= tangential
  end function is_normal_held

  !> Evaluate status, force and linearisation of a candidate near a tool.
  subroutine evaluate_candidate(self, c, hit, slip, penalty, friction)
    type(contact_work_t), intent(inout) :: self
    integer, intent(in) :: c
    type(hit_t), intent(in) :: hit
    !> Slip, mm; penalty, N/mm; coefficient of friction.
    real(wp), intent(in) :: slip(3), penalty, friction

    self%natural(c) = contact_status(hit%normal, hit%distance, self%lambda(:, c), slip, penalty, &
        friction)
    self%status(c) = self%natural(c)
    self%violation(c) = 0.0_wp
    if (self%held(c) /= not_held) then
      self%status(c) = self%held(c)
      self%violation(c) = contact_violation(self%held(c), hit%normal, hit%distance, &
          self%lambda(:, c), slip, penalty, friction)
    end if
    ! A node held in contact under tension slips without friction.
    call contact_operator_of_status(self%status(c), hit%normal, hit%distance, hit%dnormal, &
        self%lambda(:, c), slip, penalty, merge(0.0_wp, friction, self%natural(c) == status_gap), &
        self%force(:, c), self%d(:, :, c), self%e(:, :, c))
  end subroutine evaluate_candidate

  !> Evaluate the contact of the predictor: the committed state with its stored status (a slipping
  !> node lies on the cone, where round-off would make it stick). If a tool has no contact, the
  !> candidates within `touch` of it stick without being pulled, unless it moves away from them.
  !> With the active set, a gap that has closed resists without friction.
  subroutine predictor_contact(self, model, committed)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed

    logical :: touching(model%n_tool)
    integer :: c

    self%outward = outward_normals(model, committed%x)
    self%search_distance = model%tolerance%tool_search
    associate (phase => model%phase(committed%phase))
      touching = .false.
      do c = 1, model%n_contact
        if (committed%status(c) == status_gap) cycle
        if (norm2(committed%lambda(:, c)) &
            <= round_off*contact_penalty(model, phase, c, committed%penalty_reduced)) cycle
        touching(committed%contact_tool(c)) = .true.
      end do
    end associate
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
    !> Whether any candidate is in contact with each tool.
    logical, intent(in) :: touching(:)
    integer, intent(in) :: c

    real(wp), parameter :: no_slip(3) = 0.0_wp
    type(hint_t) :: hint(model%n_tool)
    type(hit_t) :: hit
    real(wp) :: friction
    integer :: tool
    logical :: leaving

    hint = committed%hint(:, c)
    call find_nearest_tool(self, model, committed, committed, c, hint, hit)
    tool = self%tool(c)
    self%lambda(:, c) = committed%lambda(:, c)
    self%status(c) = committed%status(c)
    if (tool == 0) then
      call open_candidate(self, c)
      return
    end if
    self%distance(c) = hit%distance
    self%normal(:, c) = hit%normal
    friction = model%tool(tool)%friction
    associate (phase => model%phase(committed%phase))
      leaving = dot_product(phase%tool_motion(tool, committed%start%tool_displacement), &
          hit%normal) < 0.0_wp
      call set_predictor_status(self%status(c), friction, phase, leaving, touching(tool), hit, &
          model%tolerance%touch)
      call contact_operator_of_status(self%status(c), hit%normal, 0.0_wp, hit%dnormal, &
          self%lambda(:, c), no_slip, candidate_penalty(model, phase, c, hit%normal, &
          committed%penalty_reduced), friction, self%force(:, c), self%d(:, :, c), self%e(:, :, c))
    end associate
  end subroutine find_and_predict

  !> Set the status of a candidate in the predictor.
  pure subroutine set_predictor_status(status, friction, phase, leaving, touching, hit, touch)
    !> Committed on entry.
    integer, intent(inout) :: status
    !> Gets the coefficient of friction: 0 if the committed state has no contact force.
    real(wp), intent(inout) :: friction
    type(phase_t), intent(in) :: phase
    !> Whether the tool moves away from the candidate.
    logical, intent(in) :: leaving
    !> Whether any candidate is in contact with the tool.
    logical, intent(in) :: touching
    type(hit_t), intent(in) :: hit
    !> Distance within which a tool without contact is touched, mm.
    real(wp), intent(in) :: touch

    if (.not. touching) then
      status = status_gap
      if (hit%distance <= touch .and. .not. leaving) status = status_stick
    else if (status == status_gap .and. phase%newton%active_set .and. .not. leaving &
        .and. hit%distance < 0.0_wp) then
      status = status_slip
      friction = 0.0_wp
    end if
  end subroutine set_predictor_status

  !> Set a candidate without a tool near it.
  subroutine open_candidate(self, c)
    type(contact_work_t), intent(inout) :: self
    integer, intent(in) :: c

    self%status(c) = status_gap
    self%natural(c) = status_gap
    self%violation(c) = 0.0_wp
    self%distance(c) = huge(1.0_wp)
    self%normal(:, c) = 0.0_wp
    self%force(:, c) = 0.0_wp
    self%d(:, :, c) = 0.0_wp
    self%e(:, :, c) = 0.0_wp
  end subroutine open_candidate

  !> Find the tool of a candidate: the nearest, or the one it is deepest in, with hysteresis. In the
  !> committed state every candidate is outside the tools; since then it cannot have come deeper
  !> inside a tool than it moved relative to it.
  subroutine find_nearest_tool(self, model, committed, trial, c, hint, nearest)
    !> Gets the tool, 0 if none is within the search distance.
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> The trial state has the tool so far.
    type(state_t), intent(in) :: committed, trial
    !> Number of the candidate.
    integer, intent(in) :: c
    !> Last closest point on each tool, `(n_tool)`.
    type(hint_t), intent(inout) :: hint(:)
    !> Closest point on the nearest tool.
    type(hit_t), intent(out) :: nearest

    type(hit_t) :: hit
    real(wp) :: best, distance, x(3), moved(3)
    integer :: t, node

    self%tool(c) = 0
    best = huge(1.0_wp)
    node = model%contact_node(c)
    associate (phase => model%phase(trial%phase))
      do t = 1, model%n_tool
        if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
        x = trial%x(:, node) - trial%tool_displacement(:, t)
        moved = x - committed%x(:, node) + committed%tool_displacement(:, t)
        call find_contact(model%tool(t)%surface, x, hint(t), self%search_distance, &
            model%tolerance%committed_depth + norm2(moved), hit, self%outward(:, c))
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
