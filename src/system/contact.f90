!> Contact of the candidate nodes: which tool each belongs to, its status, force and linearisation,
!> in a trial state (corrector) or at the committed state with the status it was left in
!> (predictor).
module dd3_system_contact
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : find_contact, hint_t, hit_t
  use dd3_contact_operator, only : contact_operator, contact_operator_of_status, round_off, &
      status_gap, status_stick
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: contact_work_t, new_contact_work, evaluate_contact, predictor_contact, touch

  !> Distance up to which a tool that touches nothing counts as touching, mm.
  real(wp), parameter :: touch = 1.0e-4_wp
  !> How far the predictor looks for tools, mm: whatever comes near limits the increment.
  real(wp), parameter :: far = 1.0e3_wp
  !> A node stays with its tool unless another is nearer by this, mm.
  real(wp), parameter :: hysteresis = 1.0e-6_wp

  !> Contact of the candidates.
  type :: contact_work_t
    !> One of the `status_*` values, `(n_contact)`.
    integer, allocatable :: status(:)
    !> Nearest tool, `(n_contact)`; 0 where none is within the search distance.
    integer, allocatable :: tool(:)
    !> Gap, mm, `(n_contact)`; meaningful where there is a tool.
    real(wp), allocatable :: distance(:)
    !> Outward normal of the tool, `(3, n_contact)`.
    real(wp), allocatable :: normal(:, :)
    !> Contact force lambda, N, `(3, n_contact)`.
    real(wp), allocatable :: lambda(:, :)
    !> Contact force F_equ by the contact law, N, `(3, n_contact)`.
    real(wp), allocatable :: force(:, :)
    !> D, N/mm, and E: `(3, 3, n_contact)`.
    real(wp), allocatable :: d(:, :, :), e(:, :, :)
  end type contact_work_t

contains

  !> Allocates the contact work for so many candidates.
  subroutine new_contact_work(self, n_contact)
    !> The contact work.
    type(contact_work_t), intent(out) :: self
    !> Number of candidates.
    integer, intent(in) :: n_contact

    allocate (self%status(n_contact), self%tool(n_contact), source=0)
    allocate (self%distance(n_contact), source=0.0_wp)
    allocate (self%normal(3, n_contact), self%lambda(3, n_contact), self%force(3, n_contact), &
        source=0.0_wp)
    allocate (self%d(3, 3, n_contact), self%e(3, 3, n_contact), source=0.0_wp)
  end subroutine new_contact_work

  !> Contact in a trial state: search, status, force and linearisation; writes status, tool and
  !> hints into the state.
  subroutine evaluate_contact(self, model, phase, old, new)
    !> The contact work.
    type(contact_work_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state: the slip counts from it.
    type(state_t), intent(in) :: old
    !> The trial state.
    type(state_t), intent(inout) :: new

    type(hit_t) :: hit
    real(wp) :: slip(3), reach(model%n_tool)
    integer :: c, node, tool

    reach = phase%search_distance
    do c = 1, model%n_contact
      node = model%contact_node(c)
      call nearest_tool(model, phase, new%x(:, node), new%tool_displacement, c, reach, &
                        new%contact_tool(c), new%hint(:, c), hit)
      tool = new%contact_tool(c)
      self%tool(c) = tool
      self%lambda(:, c) = new%lambda(:, c)
      if (tool == 0) then
        call open_node(self, c)
      else
        slip = new%x(:, node) - old%x(:, node) - new%tool_displacement(:, tool) &
            + old%tool_displacement(:, tool)
        self%distance(c) = hit%distance
        self%normal(:, c) = hit%normal
        call contact_operator(hit%normal, hit%distance, hit%dnormal, self%lambda(:, c), slip, &
            phase%penalty, &
                              model%tool(tool)%friction, self%force(:, c), self%d(:, :, c), &
                              self%e(:, :, c), &
                              self%status(c))
      end if
      new%status(c) = self%status(c)
    end do
  end subroutine evaluate_contact

  !> Contact of the predictor: the committed state with the status as it was stored (a slipping node
  !> lies on the cone, round-off would make it stick). A tool that touches nothing takes the nodes
  !> within `touch` as sticking, without pulling them, unless it moves away from them.
  subroutine predictor_contact(self, model, phase, state)
    !> The contact work.
    type(contact_work_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state

    real(wp), parameter :: no_slip(3) = 0.0_wp
    type(hint_t) :: hint(model%n_tool)
    type(hit_t) :: hit
    logical :: touching(model%n_tool), leaving
    real(wp) :: reach(model%n_tool)
    integer :: c, tool

    touching = .false.
    do c = 1, model%n_contact
      if (state%status(c) == status_gap) cycle
      if (norm2(state%lambda(:, c)) <= phase%penalty*round_off) cycle
      touching(state%contact_tool(c)) = .true.
    end do
    reach = far
    do c = 1, model%n_contact
      hint = state%hint(:, c)
      self%tool(c) = state%contact_tool(c)
      call nearest_tool(model, phase, state%x(:, model%contact_node(c)), state%tool_displacement, &
          c, reach, &
                        self%tool(c), hint, hit)
      tool = self%tool(c)
      self%lambda(:, c) = state%lambda(:, c)
      self%status(c) = state%status(c)
      if (tool == 0) then
        call open_node(self, c)
        cycle
      end if
      self%distance(c) = hit%distance
      self%normal(:, c) = hit%normal
      if (.not. touching(tool)) then
        leaving = dot_product(phase%move(:, tool), hit%normal) < 0.0_wp
        self%status(c) = status_gap
        if (hit%distance <= touch .and. .not. leaving) self%status(c) = status_stick
      end if
      call contact_operator_of_status(self%status(c), hit%normal, 0.0_wp, hit%dnormal, &
          self%lambda(:, c), no_slip, &
                                      phase%penalty, model%tool(tool)%friction, self%force(:, c), &
                                      self%d(:, :, c), self%e(:, :, c))
    end do
  end subroutine predictor_contact

  !> A node without a tool near it.
  subroutine open_node(self, c)
    !> The contact work.
    type(contact_work_t), intent(inout) :: self
    !> The candidate.
    integer, intent(in) :: c

    self%status(c) = status_gap
    self%distance(c) = huge(1.0_wp)
    self%normal(:, c) = 0.0_wp
    self%force(:, c) = 0.0_wp
    self%d(:, :, c) = 0.0_wp
    self%e(:, :, c) = 0.0_wp
  end subroutine open_node

  !> The tool a candidate belongs to: the nearest, or the one it is deepest in, with hysteresis.
  subroutine nearest_tool(model, phase, x, tool_displacement, c, reach, tool, hint, nearest)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    !> Displacement of the tools, mm.
    real(wp), intent(in) :: tool_displacement(:, :)
    !> The candidate.
    integer, intent(in) :: c
    !> How far each tool's surface is looked for, mm.
    real(wp), intent(in) :: reach(:)
    !> Its tool until now; gets the nearest, 0 where none is within the search distance.
    integer, intent(inout) :: tool
    !> Where its closest points were, one for each tool.
    type(hint_t), intent(inout) :: hint(:)
    !> The closest point on that tool.
    type(hit_t), intent(out) :: nearest

    type(hit_t) :: hit
    real(wp) :: best, distance
    integer :: previous, t

    previous = tool
    tool = 0
    best = huge(1.0_wp)
    do t = 1, model%n_tool
      if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
      call find_contact(model%tool(t)%surface, x - tool_displacement(:, t), hint(t), reach(t), &
                        model%contact_depth, hit)
      if (.not. hit%found) cycle
      distance = hit%distance
      if (t == previous) distance = distance - hysteresis
      if (distance >= best) cycle
      best = distance
      tool = t
      nearest = hit
    end do
  end subroutine nearest_tool

end module dd3_system_contact
