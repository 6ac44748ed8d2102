! SPDX-License-Identifier: GPL-3.0-or-later
!> Loads of the input, each the total force on a node set, and the weight of the sheet. They grow
!> from their values at the start of the phase to those of the input: loads by the table of the
!> phase, the weight in proportion, and over the next phase if this one ends early.
!>
!> A sheet whose supports leave it free, above the tools or on a few points of them, has no
!> equilibrium under its weight until it lies on the tools. Its weight acts at once; forces opposite
!> to it and springs at the nodes carry it at the start of the phase and fade: it is laid down.
module dd3_model_terms_loads
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_partition, only : holds_row
  use dd3_linalg_tensor, only : identity
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_model_terms_gravity, only : gravity_name, is_free
  use dd3_model_terms_load_sets, only : load_set_t
  use dd3_model_terms_term, only : extended, term_box_t, term_t
  implicit none
  private
  public :: loads_t, new_loads, nodal_forces, is_laid_down
  public :: laying_factor, laying_rate, spring_stiffness

  !> Displacement at which the spring at a node of a free sheet carries its weight once more, in
  !> thicknesses of the sheet.
  real(wp), parameter :: spring_length = 0.25_wp
  !> Decades by which the forces that lay a sheet down fall over a phase before the rest is taken
  !> away, and that rest.
  real(wp), parameter :: decades = 6.0_wp, rest = 10.0_wp**(-decades)

  !> The term.
  type, extends(term_t) :: loads_t
    !> Total force on each set, and those at the start and at the end of the phase, `(3, n_load)`,
    !> N.
    real(wp), allocatable :: now(:, :), start(:, :), final(:, :)
    !> Forces of the nodes on what lays the sheet down, at the start of the phase, and what is left
    !> of them with their springs, `(3, n_node)`, N.
    real(wp), allocatable :: laying(:, :), laying_left(:, :)
  contains
    procedure :: lose
    procedure :: begin_phase
    procedure :: add_rate
    procedure :: evaluate
    procedure :: add_force
    procedure :: add_final_force
    procedure :: add_stiffness
    procedure :: magnitude
    procedure :: extend
    procedure :: walk
    procedure, private :: set_laying
    procedure, private :: lays_down
    procedure, private :: laying_forces
    procedure, private :: change
  end type loads_t

contains

  !> Make the term without forces.
  function new_loads(model) result(self)
    type(model_t), intent(in) :: model
    type(loads_t) :: self

    associate (n => size(model%load_set))
      allocate (self%now(3, n), self%start(3, n), self%final(3, n), source=0.0_wp)
    end associate
    allocate (self%laying(3, model%n_node), self%laying_left(3, model%n_node), source=0.0_wp)
  end function new_loads

  !> Return the stiffness of the spring at a node of a free sheet that is laid down, N/mm.
  pure real(wp) function spring_stiffness(force, thickness)
    !> Force that carries the node at the start, N.
    real(wp), intent(in) :: force(3)
    !> Of the sheet at the node, mm.
    real(wp), intent(in) :: thickness

    spring_stiffness = norm2(force)/(spring_length*thickness)
  end function spring_stiffness

  !> Return the fraction of the forces that lay a sheet down, and of their springs, that is left at
  !> a progress of the phase. It falls by the same factor in equal increments: the sheet is softer
  !> than the springs at first by four or more decades, and sags where they are alike.
  pure real(wp) function laying_factor(progress)
    real(wp), intent(in) :: progress

    laying_factor = (10.0_wp**(-decades*progress) - rest)/(1.0_wp - rest)
  end function laying_factor

  !> Return the negative derivative of `laying_factor`.
  pure real(wp) function laying_rate(progress)
    real(wp), intent(in) :: progress

    laying_rate = log(10.0_wp)*decades*10.0_wp**(-decades*progress)/(1.0_wp - rest)
  end function laying_rate

  !> Add the forces of loads on the nodes.
  pure subroutine nodal_forces(set, load, force)
    type(load_set_t), intent(in) :: set(:)
    !> Total force on each set, `(3, size(set))`, N.
    real(wp), intent(in) :: load(:, :)
    !> `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)

    integer :: s, k

    do s = 1, size(set)
      associate (node => set(s)%node)
        do k = 1, size(node)
          if (allocated(set(s)%weight)) then
            force(:, node(k)) = force(:, node(k)) + load(:, s)*set(s)%weight(k)
          else
            force(:, node(k)) = force(:, node(k)) + load(:, s)/real(size(node), wp)
          end if
        end do
      end associate
    end do
  end subroutine nodal_forces

  !> Give up what is left of the forces that laid the sheet down in a phase that ended early.
  subroutine lose(self, model, number, state, force, lost)
    class(loads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)
    logical, intent(inout) :: lost

    force = force + self%laying_left
    self%laying = 0.0_wp
    self%laying_left = 0.0_wp
  end subroutine lose

  !> Begin at the present loads. The weight of a free sheet acts at once.
  subroutine begin_phase(self, model, number, state)
    class(loads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state

    real(wp), allocatable :: final(:, :)
    integer :: s

    self%start = self%now
    final = model%phase(number)%loads%final
    do s = 1, size(model%load_set)
      if (.not. model%phase(number)%loads%keeps(s)) cycle
      final(:, s) = self%start(:, s)
      if (model%load_set(s)%name == gravity_name) final(:, s) = self%final(:, s)
    end do
    self%final = final
    do s = 1, size(model%load_set)
      associate (set => model%load_set(s), from => self%start(:, s), to => self%final(:, s))
        if (set%name /= gravity_name .or. norm2(from) > 0.0_wp .or. .not. norm2(to) > 0.0_wp) cycle
        if (.not. is_free(model, number, state%x)) cycle
        from = to
        self%now(:, s) = to
        call self%set_laying(set, s)
      end associate
    end do
    self%laying_left = self%laying
  end subroutine begin_phase

  !> Set the forces that carry the weight at the start of the phase.
  pure subroutine set_laying(self, set, number)
    class(loads_t), intent(inout) :: self
    !> The weight, and its number.
    type(load_set_t), intent(in) :: set
    integer, intent(in) :: number

    integer :: i

    do i = 1, size(set%node)
      self%laying(:, set%node(i)) = set%weight(i)*self%start(:, number)
    end do
  end subroutine set_laying

  !> Whether the sheet is laid down in the running phase.
  pure logical function is_laid_down(terms)
    type(term_box_t), intent(in) :: terms(:)

    integer :: k

    is_laid_down = .false.
    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (loads_t)
        is_laid_down = this%lays_down()
      end select
    end do
  end function is_laid_down

  !> Whether forces lay the sheet down.
  pure logical function lays_down(self)
    class(loads_t), intent(in) :: self

    lays_down = any(abs(self%laying) > 0.0_wp)
  end function lays_down

  !> Return the forces that lay the sheet down, with those of their springs, at their full size, N.
  pure function laying_forces(self, model, state) result(force)
    class(loads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    integer :: node

    force = self%laying
    do node = 1, model%n_node
      if (all(abs(force(:, node)) <= 0.0_wp)) cycle
      force(:, node) = force(:, node) + spring_stiffness(force(:, node), &
          model%thickness_at(node))*(state%x(:, node) - state%start%x(:, node))
    end do
  end function laying_forces

  !> Add the change of the loads and of what lays the sheet down.
  subroutine add_rate(self, model, committed, step, force)
    class(loads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed
    real(wp), intent(in) :: step
    real(wp), intent(inout) :: force(:, :)

    if (self%lays_down()) force = force + step*(laying_rate(committed%progress) &
        *self%laying_forces(model, committed))
    associate (phase => model%phase(committed%phase), progress => committed%progress)
      call nodal_forces(model%load_set, step*self%change(model, phase%slope(progress), &
          phase%fading_rate(progress)), force)
    end associate
  end subroutine add_rate

  !> Return the change of the loads over the phase times a factor, `(3, n_load)`, N.
  pure function change(self, model, factor, factor_of_weight)
    class(loads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: factor, factor_of_weight
    real(wp) :: change(3, size(self%now, 2))

    integer :: s

    change = factor*(self%final - self%start)
    do s = 1, size(model%load_set)
      if (model%load_set(s)%name /= gravity_name) cycle
      change(:, s) = factor_of_weight*(self%final(:, s) - self%start(:, s))
    end do
  end function change

  !> Set loads and laying forces in a trial state.
  subroutine evaluate(self, model, committed, trial)
    class(loads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed, trial

    associate (phase => model%phase(trial%phase), progress => trial%progress)
      self%now = self%start + self%change(model, phase%factor(progress), &
          1.0_wp - phase%fading(progress))
    end associate
    if (self%lays_down()) then
      self%laying_left = laying_factor(trial%progress)*self%laying_forces(model, trial)
    end if
  end subroutine evaluate

  !> Add the forces on the nodes.
  subroutine add_force(self, model, state, force)
    class(loads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    if (self%lays_down()) force = force - self%laying_left
    call nodal_forces(model%load_set, self%now, force)
  end subroutine add_force

  !> Add the loads at the end of the phase.
  subroutine add_final_force(self, model, state, force)
    class(loads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    call nodal_forces(model%load_set, self%final, force)
  end subroutine add_final_force

  !> Add the stiffness of the springs that lay the sheet down.
  subroutine add_stiffness(self, model, state, stiffness)
    class(loads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    type(block_matrix_t), intent(inout) :: stiffness

    integer :: node, k

    do node = 1, model%n_node
      if (.not. holds_row(stiffness, node)) cycle
      if (all(abs(self%laying(:, node)) <= 0.0_wp)) cycle
      k = stiffness%diagonal(node)
      stiffness%value(:, :, k) = stiffness%value(:, :, k) + laying_factor(state%progress) &
          *spring_stiffness(self%laying(:, node), model%thickness_at(node))*identity
    end do
  end subroutine add_stiffness

  !> Return the largest load of the phase, N.
  pure real(wp) function magnitude(self)
    class(loads_t), intent(in) :: self

    magnitude = maxval([0.0_wp, norm2(self%start, dim=1), norm2(self%final, dim=1)])
  end function magnitude

  !> Distribute what lays the sheet down by the masses of the nodes of the refined sheet, as its
  !> weight.
  subroutine extend(self, old_model, model, state)
    class(loads_t), intent(inout) :: self
    type(model_t), intent(in) :: old_model, model
    type(configuration_t), intent(in) :: state

    integer :: s
    logical :: laid_down

    laid_down = self%lays_down()
    self%laying = extended(self%laying, model%n_node)
    self%laying_left = extended(self%laying_left, model%n_node)
    if (.not. laid_down) return
    do s = 1, size(model%load_set)
      if (model%load_set(s)%name == gravity_name) call self%set_laying(model%load_set(s), s)
    end do
    self%laying_left = laying_factor(state%progress)*self%laying_forces(model, state)
  end subroutine extend

  !> Pass the components to a visitor.
  subroutine walk(self, visitor)
    class(loads_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("load", size(self%now), self%now)
    call visitor%reals("start_load", size(self%start), self%start)
    call visitor%reals("final_load", size(self%final), self%final)
    call visitor%reals("laying", size(self%laying), self%laying)
    call visitor%reals("laying_left", size(self%laying_left), self%laying_left)
  end subroutine walk

end module dd3_model_terms_loads
