! SPDX-License-Identifier: GPL-3.0-or-later
!> Compliant formulation of the contact: the force of a point follows from the height of its layer
!> that a tool compresses, and from its slip.
module dd3_system_compliant_contact
  use dd3_base_kinds, only : wp
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_contact_compliant, only : compliant_operator, fraction_of, layer_t, rotated
  use dd3_contact_friction, only : friction_limit_t, friction_t, sliding_t
  use dd3_contact_operator, only : status_gap, status_slip, tangential_length
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_model_contact_layer, only : layer_at, offset_at
  use dd3_sheet_surface_point, only : surface_point_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_turning, only : turning_rate
  use dd3_system_bound_rows, only : eliminate_bound_nodes
  use dd3_system_contact_search, only : crossing_hit, find_candidate, find_committed_candidate, &
      find_nearest_border, may_cross
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_formulation, only : formulation_t
  use dd3_system_linear_problem, only : linear_problem_t, unknowns_t
  use dd3_system_partition, only : partition_t
  use dd3_system_point_rows, only : add_points, set_point_forces
  use dd3_tools_closest, only : hit_t
  use dd3_tools_crossing, only : crossing_t
  use dd3_tools_placement, only : relative_displacement
  implicit none
  private
  public :: compliant_contact_t

  !> The formulation.
  type, extends(formulation_t) :: compliant_contact_t
  contains
    procedure :: evaluate
    procedure :: predict
    procedure :: reduce
    procedure :: read_forces
  end type compliant_contact_t

  !> Part of the layer that is left, where the predictor takes its stiffness at first contact.
  real(wp), parameter :: at_onset = 0.5_wp
  !> Points that a thread takes at a time.
  integer, parameter :: chunk = 64

contains

  !> Evaluate the points in a trial state.
  subroutine evaluate(self, contact, model, committed, trial, points)
    class(compliant_contact_t), intent(in) :: self
    type(contact_work_t), intent(inout) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: points(:)

    integer :: k

    !$omp parallel do num_threads(threads_for(size(points), least_nodes)) private(k) &
    !$omp& schedule(dynamic, chunk)
    do k = 1, size(points)
      call evaluate_point(contact, model, committed, trial, points(k))
    end do
    !$omp end parallel do
  end subroutine evaluate

  !> Evaluate the contact at a point.
  subroutine evaluate_point(contact, model, committed, trial, c)
    type(contact_work_t), intent(inout) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: c

    type(hit_t) :: hit
    real(wp) :: slip(3)

    if (model%contact_point(c)%moves) then
      call evaluate_crossing(contact, model, committed, trial, c)
      return
    end if
    call find_candidate(contact, model, committed, trial, c, hit, slip)
    if (contact%tool(c) > 0) call evaluate_layer(contact, trial, c, &
        layer_at(model, model%phase(trial%phase), contact%tool(c), c), hit, slip, &
        model%tool(contact%tool(c))%friction)
    trial%contact%status(c) = contact%status(c)
  end subroutine evaluate_point

  !> Evaluate the contact of an edge of the mesh with the borders of the tools.
  subroutine evaluate_crossing(self, model, committed, trial, c)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    integer, intent(in) :: c

    type(surface_point_t) :: point
    type(crossing_t) :: crossing
    real(wp) :: slip(3)

    call find_nearest_border(self, model, trial, c, crossing)
    trial%contact%tool(c) = self%tool(c)
    trial%contact%status(c) = status_gap
    if (self%tool(c) == 0) return
    trial%contact%place(c) = crossing%place
    point = model%contact_point(c)%at_place(crossing%place)
    associate (tool => self%tool(c), phase => model%phase(trial%phase))
      slip = relative_displacement(committed%placement(tool), trial%placement(tool), &
          point%position(committed%x), point%position(trial%x))
      self%rise(c) = dot_product(slip, crossing%normal)
      call evaluate_layer(self, trial, c, fraction_of(layer_at(model, phase, tool, c), &
          crossing%weight), crossing_hit(crossing), slip, model%tool(tool)%friction, crossing)
    end associate
    trial%contact%status(c) = self%status(c)
  end subroutine evaluate_crossing

  !> Evaluate status, force and linearisation of a candidate near the layer of a tool. One that
  !> changes its tool has no tangential force of its history.
  subroutine evaluate_layer(self, trial, c, layer, hit, slip, friction, crossing)
    type(contact_work_t), intent(inout) :: self
    type(state_t), intent(in) :: trial
    integer, intent(in) :: c
    type(layer_t), intent(in) :: layer
    type(hit_t), intent(in) :: hit
    real(wp), intent(in) :: slip(3)
    type(friction_t), intent(in) :: friction
    !> If the point is one; the layer is then its fraction by the weight.
    type(crossing_t), intent(in), optional :: crossing

    type(sliding_t) :: sliding
    real(wp) :: gap, committed(3)

    gap = hit%distance + offset_at(trial, self%tool(c), c)
    sliding = sliding_at(self, c, crossing)
    committed = 0.0_wp
    if (self%tool(c) == self%committed_tool(c)) committed = &
        rotated(self%committed_force(:, c), self%committed_normal(:, c), hit%normal)
    self%onset(c) = layer%height
    self%status(c) = status_gap
    call compliant_operator(layer, hit%normal, gap, hit%dnormal, trial%contact%lambda(:, c), &
        committed, slip, friction, sliding, self%status(c), self%force(:, c), self%d(:, :, c), &
        self%e(:, :, c), hit%gap_gradient)
    self%distance(c) = gap - layer%compliance*dot_product(hit%normal, self%force(:, c)) &
        - layer%height
    if (present(crossing)) call add_crossing_terms(self, c, layer, crossing, gap, &
        trial%contact%lambda(:, c), committed, slip, friction, sliding)
  end subroutine evaluate_layer

  !> Return what friction depends on at a point; a crossing has its fraction of the area.
  pure type(sliding_t) function sliding_at(self, c, crossing) result(sliding)
    type(contact_work_t), intent(in) :: self
    integer, intent(in) :: c
    type(crossing_t), intent(in), optional :: crossing

    sliding = self%sliding(c)
    if (present(crossing)) sliding%area = crossing%weight*sliding%area
  end function sliding_at

  !> Add the derivatives of the force at a crossing that a point on a surface does not have: by the
  !> normal as the edge turns, and by the weight.
  subroutine add_crossing_terms(self, c, layer, crossing, gap, lambda, committed, slip, friction, &
      sliding)
    !> Has force, status and derivatives of the law.
    type(contact_work_t), intent(inout) :: self
    integer, intent(in) :: c
    type(layer_t), intent(in) :: layer
    type(crossing_t), intent(in) :: crossing
    !> mm.
    real(wp), intent(in) :: gap
    !> As for `compliant_operator`.
    real(wp), intent(in) :: lambda(3), committed(3), slip(3)
    type(friction_t), intent(in) :: friction
    type(sliding_t), intent(in) :: sliding

    real(wp), parameter :: still(3, 3) = 0.0_wp
    type(friction_limit_t) :: limit
    real(wp) :: square, force(3), d(3, 3, 2), e(3, 3), change(3)
    real(wp) :: by_normal, normal_force
    integer :: status, i

    self%by_edge(:, :, c) = 0.0_wp
    status = self%status(c)
    if (status == status_gap) return
    associate (along => crossing%along, n => crossing%normal)
      square = dot_product(along, along)
      if (square > tiny(1.0_wp)) then
        call compliant_operator(layer, n, gap, still, lambda, committed, slip, friction, sliding, &
            status, force, d(:, :, 1), e)
        call compliant_operator(layer, n, gap, spread(along, 2, 3)*spread(along, 1, 3), lambda, &
            committed, slip, friction, sliding, status, force, d(:, :, 2), e)
        change = matmul(d(:, :, 2) - d(:, :, 1), along)/square
        do i = 1, 3
          self%by_edge(:, i, c) = -change*n(i)
        end do
      end if
      ! On the line of the law's scale the normal force is proportional to the area as far as the
      ! layer is softer than that. The limit Y of the friction follows as A times a function of N/A.
      by_normal = dot_product(n, matmul(self%e(:, :, c), n))
      change = dot_product(n, self%force(:, c))*n
      force = self%force(:, c) - change
      change = (1.0_wp - by_normal)/crossing%weight*change
      if (status == status_slip) then
        normal_force = -dot_product(n, self%force(:, c))
        limit = friction%limit(normal_force, sliding, tangential_length(n, slip))
        change = change + (1.0_wp - by_normal*limit%slope*normal_force &
            /max(limit%value, tiny(1.0_wp)))/crossing%weight*force
      end if
    end associate
    do i = 1, 3
      self%d(:, i, c) = self%d(:, i, c) + change*crossing%weight_by_point(i)
      self%by_edge(:, i, c) = self%by_edge(:, i, c) + change*crossing%weight_by_edge(i)
    end do
  end subroutine add_crossing_terms

  !> Evaluate the points at the committed state.
  subroutine predict(self, contact, model, committed, touching)
    class(compliant_contact_t), intent(in) :: self
    type(contact_work_t), intent(inout) :: contact
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    logical, intent(in) :: touching(:)

    type(hit_t) :: hit
    integer :: c

    !$omp parallel do num_threads(threads_for(model%n_contact, least_nodes)) private(c, hit) &
    !$omp& schedule(dynamic, chunk)
    do c = 1, model%n_contact
      if (model%contact_point(c)%moves) then
        contact%near(c) = may_cross(model, committed, c)
        call predict_crossing(contact, model, committed, touching, c)
        cycle
      end if
      call find_committed_candidate(contact, model, committed, c, hit)
      if (contact%tool(c) > 0) call predict_layer(contact, model, committed, c, &
          layer_at(model, model%phase(committed%phase), contact%tool(c), c), hit, &
          touching(contact%tool(c)))
    end do
    !$omp end parallel do
  end subroutine predict

  !> Evaluate the contact of an edge of the mesh with borders in the predictor.
  subroutine predict_crossing(self, model, committed, touching, c)
    type(contact_work_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Whether any candidate, of any rank, is in contact with each tool.
    logical, intent(in) :: touching(:)
    integer, intent(in) :: c

    type(surface_point_t) :: point
    type(crossing_t) :: crossing

    self%place(c) = committed%contact%place(c)
    self%committed_tool(c) = 0
    call find_nearest_border(self, model, committed, c, crossing)
    self%status(c) = status_gap
    if (self%tool(c) == 0) return
    self%status(c) = committed%contact%status(c)
    point = model%contact_point(c)%at_place(crossing%place)
    self%committed_x(:, c) = point%position(committed%x)
    self%turning(:, c) = turning_rate(model%phase(committed%phase), committed, self%tool(c), &
        self%committed_x(:, c))
    self%committed_tool(c) = committed%contact%tool(c)
    self%committed_normal(:, c) = crossing%normal
    self%committed_force(:, c) = committed%contact%lambda(:, c)
    associate (phase => model%phase(committed%phase), tool => self%tool(c))
      call predict_layer(self, model, committed, c, fraction_of(layer_at(model, phase, tool, c), &
          crossing%weight), crossing_hit(crossing), touching(tool), crossing)
    end associate
  end subroutine predict_crossing

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
    type(sliding_t) :: sliding
    real(wp) :: gap, committed(3)

    gap = hit%distance + offset_at(state, self%tool(c), c)
    self%onset(c) = layer%height
    self%distance(c) = gap - layer%height
    if (.not. touching .and. self%distance(c) <= model%tolerance%touch) gap = &
        min(gap, at_onset*layer%height)
    committed = 0.0_wp
    if (self%committed_tool(c) == self%tool(c)) committed = self%committed_force(:, c)
    self%rise(c) = 0.0_wp
    sliding = sliding_at(self, c, crossing)
    associate (friction => model%tool(self%tool(c))%friction)
      call compliant_operator(layer, hit%normal, gap, hit%dnormal, state%contact%lambda(:, c), &
          committed, no_slip, friction, sliding, self%status(c), self%force(:, c), &
          self%d(:, :, c), self%e(:, :, c), hit%gap_gradient)
      if (present(crossing)) call add_crossing_terms(self, c, layer, crossing, gap, &
          state%contact%lambda(:, c), committed, no_slip, friction, sliding)
    end associate
  end subroutine predict_layer

  !> Add the points to the linear system.
  subroutine reduce(self, matrix, problem, contact, partition, position, model, state)
    class(compliant_contact_t), intent(inout) :: self
    type(block_matrix_t), intent(inout) :: matrix
    type(linear_problem_t), intent(inout) :: problem
    type(contact_work_t), intent(in) :: contact
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: position(:, :, :)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    call add_points(matrix, problem, contact, position, model, state)
    call eliminate_bound_nodes(matrix, problem%rhs, model, state%x, problem%bound_force)
    call partition%complete_rows(matrix)
    call partition%complete_forces(model%n_node, problem%rhs)
  end subroutine reduce

  !> Set the increments of the forces of the points.
  subroutine read_forces(self, contact, problem, model, state, step)
    class(compliant_contact_t), intent(in) :: self
    type(contact_work_t), intent(in) :: contact
    type(linear_problem_t), intent(in) :: problem
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(unknowns_t), intent(inout) :: step

    call set_point_forces(contact, problem, model, state, step)
  end subroutine read_forces

end module dd3_system_compliant_contact
