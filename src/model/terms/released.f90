! SPDX-License-Identifier: GPL-3.0-or-later
!> Forces of lost constraints: supports that a phase frees, tools and draw-beads that it takes away,
!> and the forces out of balance of a sheet that is taken over from another run. They turn with the
!> sheet and fall linearly over the phase, so that the sheet is released gradually. Where the whole
!> sheet is released, the nodal forces of its stresses fade in their place (`fading_stress` of the
!> sheet's state); of these the term has the rate alone.
module dd3_model_terms_released
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_partition, only : holds_row
  use dd3_model_carried_forces, only : carried_forces, carried_stiffness
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_model_terms_term, only : extended, term_box_t, term_t
  implicit none
  private
  public :: released_t, new_released, hold_released, released_tool, has_released, remaining_force

  !> The term. Forces are those of the nodes on the constraints, `(3, n_node)`, N.
  type, extends(term_t) :: released_t
    !> At the start of the phase, and what is left of them.
    real(wp), allocatable :: start(:, :), left(:, :)
    !> Whether they turn with the sheet. Those of a sheet that is taken over keep their directions,
    !> as the tools did from which most of them come.
    logical :: turns = .true.
    !> Tool that released each node, while the force fades, `(n_node)`; 0 for none, -1 for what held
    !> a sheet that is taken over.
    integer, allocatable :: tool(:)
  contains
    procedure :: lose
    procedure :: add_rate
    procedure :: evaluate
    procedure :: add_force
    procedure :: add_stiffness
    procedure :: add_tool_force
    procedure :: magnitude
    procedure :: extend
    procedure :: walk
  end type released_t

contains

  !> Make the term without forces.
  function new_released(model) result(self)
    type(model_t), intent(in) :: model
    type(released_t) :: self

    allocate (self%start(3, model%n_node), self%left(3, model%n_node), source=0.0_wp)
    allocate (self%tool(model%n_node), source=0)
  end function new_released

  !> Give up what is left; the forces at the start of the next phase contain it.
  subroutine lose(self, model, number, state, force, lost)
    class(released_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)
    logical, intent(inout) :: lost

    where (all(abs(self%left) <= 0.0_wp, dim=1)) self%tool = 0
    force = force + self%left
  end subroutine lose

  !> Set the forces from which a phase starts.
  subroutine hold_released(terms, force, tool, turns)
    type(term_box_t), intent(inout) :: terms(:)
    !> Forces of the nodes on all lost constraints, `(3, n_node)`, N.
    real(wp), intent(in) :: force(:, :)
    !> Tool that has released each node at the start of this phase, `(n_node)`; 0 for none, -1 for
    !> another run.
    integer, intent(in) :: tool(:)
    logical, intent(in) :: turns

    integer :: k

    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (released_t)
        this%start = force
        this%left = force
        this%turns = turns
        where (tool /= 0) this%tool = tool
      end select
    end do
  end subroutine hold_released

  !> Return the tool that released each node while its force fades, `(n_node)`; 0 for none, -1 for
  !> another run.
  pure function released_tool(terms) result(tool)
    type(term_box_t), intent(in) :: terms(:)
    integer, allocatable :: tool(:)

    integer :: k

    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (released_t)
        tool = this%tool
      end select
    end do
  end function released_tool

  !> Return the forces that are left, `(3, n_node)`, N.
  pure function remaining_force(terms) result(force)
    type(term_box_t), intent(in) :: terms(:)
    real(wp), allocatable :: force(:, :)

    integer :: k

    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (released_t)
        force = this%left
      end select
    end do
  end function remaining_force

  !> Whether the running phase has such forces at its start.
  pure logical function has_released(terms)
    type(term_box_t), intent(in) :: terms(:)

    integer :: k

    has_released = .false.
    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (released_t)
        has_released = any(abs(this%start) > 0.0_wp)
      end select
    end do
  end function has_released

  !> Return the forces at their full size, turned with the sheet.
  pure function carried(self, model, state) result(force)
    class(released_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    force = self%start
    if (self%turns) force = carried_forces(model%fibre_end, state%start%x, state%x, self%start)
  end function carried

  !> Add the change by their fall.
  subroutine add_rate(self, model, committed, step, force)
    class(released_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed
    real(wp), intent(in) :: step
    real(wp), intent(inout) :: force(:, :)

    force = force + step*(model%phase(committed%phase)%fading_rate(committed%progress) &
        *carried(self, model, committed))
    if (committed%sheet%fades) force = force - step*( &
        model%phase(committed%phase)%fading_rate(committed%progress) &
        *committed%sheet%fading_force)
  end subroutine add_rate

  !> Set what is left in a trial state.
  subroutine evaluate(self, model, committed, trial)
    class(released_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed, trial

    self%left = model%phase(trial%phase)%fading(trial%progress)*carried(self, model, trial)
  end subroutine evaluate

  !> Add the forces on the nodes.
  subroutine add_force(self, model, state, force)
    class(released_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    force = force - self%left
  end subroutine add_force

  !> Add the stiffness of forces that turn.
  subroutine add_stiffness(self, model, state, stiffness)
    class(released_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    type(block_matrix_t), intent(inout) :: stiffness

    real(wp) :: factor, block(3, 3)
    integer :: node, k

    if (.not. self%turns) return
    factor = model%phase(state%phase)%fading(state%progress)
    do node = 1, model%n_node
      associate (other => model%fibre_end(node), force => self%start(:, node), &
          before => state%start%x, x => state%x, value => stiffness%value)
        if (other == 0 .or. all(abs(force) <= 0.0_wp)) cycle
        if (.not. holds_row(stiffness, node)) cycle
        block = factor*carried_stiffness(before(:, other) - before(:, node), &
            x(:, other) - x(:, node), force)
        k = position_of(stiffness, node, other)
        value(:, :, k) = value(:, :, k) + block
        k = stiffness%diagonal(node)
        value(:, :, k) = value(:, :, k) - block
      end associate
    end do
  end subroutine add_stiffness

  !> Add what is left to the forces on the tools that have gone.
  subroutine add_tool_force(self, model, force)
    class(released_t), intent(in) :: self
    type(model_t), intent(in) :: model
    real(wp), intent(inout) :: force(:, :)

    integer :: node

    do node = 1, model%n_node
      associate (tool => self%tool(node))
        if (tool > 0) force(:, tool) = force(:, tool) + self%left(:, node)
      end associate
    end do
  end subroutine add_tool_force

  !> Return the largest force of a node at the start of the phase, N.
  pure real(wp) function magnitude(self)
    class(released_t), intent(in) :: self

    magnitude = maxval(norm2(self%start, dim=1))
  end function magnitude

  !> Extend the nodal values by those of new nodes.
  subroutine extend(self, old_model, model, state)
    class(released_t), intent(inout) :: self
    type(model_t), intent(in) :: old_model, model
    type(configuration_t), intent(in) :: state

    self%start = extended(self%start, model%n_node)
    self%left = extended(self%left, model%n_node)
    self%tool = [self%tool, spread(0, 1, model%n_node - old_model%n_node)]
  end subroutine extend

  !> Pass the components to a visitor.
  subroutine walk(self, visitor)
    class(released_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("released_start", size(self%start), self%start)
    call visitor%reals("released_left", size(self%left), self%left)
    call visitor%one_logical("released_turns", self%turns)
    call visitor%integers("released_tool", size(self%tool), self%tool)
  end subroutine walk

end module dd3_model_terms_released
