! SPDX-License-Identifier: GPL-3.0-or-later
!> Draw-beads: their forces on the nodes and their stiffness. The points of a bead are found in the
!> committed state and keep their place in the material for the increment, so that the restraining
!> force depends on the displacements through the slip alone. The next increment finds new points;
!> each interval passes on the means of force and slip path over its points. An interval beside the
!> sheet has no force and keeps its slip path.
module dd3_model_terms_drawbeads
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_partition, only : holds_row
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_model_terms_bead_points, only : bead_point_t, covered_length, find_bead_points
  use dd3_model_terms_term, only : extended, term_t
  implicit none
  private
  public :: drawbeads_t, new_drawbeads, presses_by_bead

  !> The term.
  type, extends(term_t) :: drawbeads_t
    !> Restraining force per length of each interval, N/mm, and its slip path, mm, `(n_interval)`.
    real(wp), allocatable :: force(:), path(:)
    !> Forces on the nodes, `(3, n_node)`, N; size 0 without draw-beads.
    real(wp), allocatable :: load(:, :)
    !> Force of each bead on the sheet, `(3, n_bead)`, its restraining force, `(n_bead)`, N, and its
    !> length on the sheet, `(n_bead)`, mm.
    real(wp), allocatable :: total(:, :), restraint(:), length(:)
    !> Fraction of the normal force of each bead at the start of the phase, `(n_bead)`.
    real(wp), allocatable :: normal(:)
    !> Work dissipated since the start of the job, mJ.
    real(wp) :: work = 0.0_wp
    !> Points in the increment, and the components above in the committed state before it.
    type(bead_point_t), allocatable :: point(:)
    real(wp), allocatable, private :: force_before(:), path_before(:), load_before(:, :)
    real(wp), allocatable, private :: total_before(:, :)
  contains
    procedure :: lose
    procedure :: begin_phase
    procedure :: begin_increment
    procedure :: evaluate
    procedure :: add_force
    procedure :: add_stiffness
    procedure :: add_tool_force
    procedure :: accept
    procedure :: dissipated
    procedure :: columns
    procedure :: values
    procedure :: extend
    procedure :: walk
    procedure, private :: normal_fraction
    procedure, private :: keep
    procedure, private :: add_load
  end type drawbeads_t

  !> Openings of the tools, in thicknesses of the sheet, at which a draw-bead has left it, and at
  !> which its normal force, elastic between the tools, has ended.
  real(wp), parameter :: height = 5.0_wp, elastic = 0.1_wp

contains

  !> Make the term without forces.
  function new_drawbeads(model) result(self)
    type(model_t), intent(in) :: model
    type(drawbeads_t) :: self

    integer :: n_bead, n_interval, n_node, b

    n_bead = size(model%drawbead)
    n_node = merge(model%n_node, 0, n_bead > 0)
    n_interval = sum([(size(model%drawbead(b)%line, 3), b=1, n_bead)])
    allocate (self%force(n_interval), self%path(n_interval), source=0.0_wp)
    allocate (self%load(3, n_node), self%total(3, n_bead), source=0.0_wp)
    allocate (self%restraint(n_bead), self%length(n_bead), self%normal(n_bead), source=0.0_wp)
    allocate (self%point(0))
    call self%keep()
  end function new_drawbeads

  !> Keep the forces before an increment.
  pure subroutine keep(self)
    class(drawbeads_t), intent(inout) :: self

    self%force_before = self%force
    self%path_before = self%path
    self%load_before = self%load
    self%total_before = self%total
  end subroutine keep

  !> Return the fraction of the restraint with which a draw-bead acts: that of a withdrawn tool has
  !> left the sheet when the tools have opened by `height` thicknesses.
  pure real(wp) function grip(model, state, bead)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    integer, intent(in) :: bead

    grip = closed(model, state, bead, height)
  end function grip

  !> Return the fraction that is left of what acts in a bead until its tool, without one the
  !> farthest of all, has opened by so many thicknesses.
  pure real(wp) function closed(model, state, bead, opening)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    integer, intent(in) :: bead
    real(wp), intent(in) :: opening

    real(wp) :: distance

    closed = 1.0_wp
    associate (phase => model%phase(state%phase), tool => model%drawbead(bead)%tool)
      if (.not. phase%beads%leaves(bead)) return
      if (tool > 0) then
        distance = phase%opened(tool, state%progress)
      else
        distance = phase%most_opened(state%progress)
      end if
    end associate
    closed = max(0.0_wp, 1.0_wp - distance/(opening*model%thickness))
  end function closed

  !> Whether the normal force of a draw-bead of a withdrawn tool still acts.
  pure logical function presses_by_bead(model, state, tool)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    integer, intent(in) :: tool

    integer :: b

    presses_by_bead = .false.
    do b = 1, size(model%drawbead)
      if (model%drawbead(b)%tool /= tool .or. .not. abs(model%drawbead(b)%normal) > 0.0_wp) cycle
      if (model%phase(state%phase)%beads%leaves(b)) presses_by_bead = presses_by_bead &
          .or. closed(model, state, b, elastic) > 0.0_wp
    end do
  end function presses_by_bead

  !> Give up the forces of beads that act no longer.
  subroutine lose(self, model, number, state, force, lost)
    class(drawbeads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)
    logical, intent(inout) :: lost

    type(drawbeads_t) :: remaining
    logical :: remains(size(model%drawbead))

    if (size(self%load) == 0 .or. number == 1) return
    associate (beads => model%phase(number)%beads)
      remains = beads%active .and. .not. beads%new
      if (all(remains .or. .not. model%phase(number - 1)%beads%active)) return
      select type (self)
      type is (drawbeads_t)
        remaining = self
      end select
      call remaining%keep()
      call find_bead_points(model, remains, state%x, remaining%point, &
          state%tools%displacement)
      call remaining%evaluate(model, state, state)
    end associate
    if (all(abs(self%load - remaining%load) <= 0.0_wp)) return
    force = force - (self%load - remaining%load)
    self%load = remaining%load
    lost = .true.
  end subroutine lose

  !> Set the fractions of the normal forces. That of a bead grows to 1 over the phase in which it
  !> begins to act and, if that ended early, over the next one. The restraint of a bead that begins
  !> to act has no history, also if its tool had left and returns.
  subroutine begin_phase(self, model, number, state)
    class(drawbeads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state

    integer :: b

    self%normal = self%normal_fraction(state%progress)
    do b = 1, size(model%drawbead)
      if (.not. model%phase(number)%beads%new(b)) cycle
      self%normal(b) = 0.0_wp
      associate (bead => model%drawbead(b))
        self%force(bead%offset + 1:bead%offset + size(bead%line, 3)) = 0.0_wp
        self%path(bead%offset + 1:bead%offset + size(bead%line, 3)) = 0.0_wp
      end associate
    end do
  end subroutine begin_phase

  !> Return the fraction of the normal force of each bead that acts.
  pure function normal_fraction(self, progress) result(fraction)
    class(drawbeads_t), intent(in) :: self
    real(wp), intent(in) :: progress
    real(wp) :: fraction(size(self%normal))

    fraction = self%normal + (1.0_wp - self%normal)*progress
  end function normal_fraction

  !> Find the points of the active beads for the next increment, with the stiffness of slips that
  !> continue.
  subroutine begin_increment(self, model, committed)
    class(drawbeads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed

    integer :: p

    if (size(self%load) == 0) return
    call self%keep()
    call find_bead_points(model, model%phase(committed%phase)%beads%active, committed%x, &
        self%point, committed%tools%displacement)
    do p = 1, size(self%point)
      associate (point => self%point(p), i => self%point(p)%interval, &
          share => grip(model, committed, self%point(p)%bead))
        point%stiffness = 0.0_wp
        if (share > 0.0_wp) point%stiffness = share*model%drawbead(point%bead) &
            %sliding_stiffness(self%force(i)/share, self%path(i))
      end associate
    end do
  end subroutine begin_increment

  !> Evaluate forces, path and lengths in a trial state.
  subroutine evaluate(self, model, committed, trial)
    class(drawbeads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed, trial

    real(wp) :: weight(size(self%force)), fraction(size(self%normal)), force, path
    integer :: p, b

    if (size(self%load) == 0) return
    weight = 0.0_wp
    fraction = self%normal_fraction(trial%progress) &
        *[(closed(model, trial, b, elastic), b=1, size(fraction))]
    self%force = 0.0_wp
    self%path = 0.0_wp
    self%load = 0.0_wp
    self%total = 0.0_wp
    self%restraint = 0.0_wp
    do p = 1, size(self%point)
      associate (point => self%point(p), i => self%point(p)%interval, &
          bead => model%drawbead(self%point(p)%bead), &
          share => grip(model, trial, self%point(p)%bead))
        force = 0.0_wp
        path = self%path_before(i)
        if (share > 0.0_wp) call bead%restrain(self%force_before(i)/share, self%path_before(i), &
            slip(point, bead%tool, committed, trial), force, path, point%stiffness)
        force = share*force
        point%stiffness = share*point%stiffness
        call self%add_load(point, force, fraction(point%bead)*bead%normal)
        weight(i) = weight(i) + point%weight
        self%force(i) = self%force(i) + point%weight*force
        self%path(i) = self%path(i) + point%weight*path
        self%restraint(point%bead) = self%restraint(point%bead) + point%weight*abs(force)
      end associate
    end do
    where (weight > 0.0_wp)
      self%force = self%force/weight
      self%path = self%path/weight
    end where
    do b = 1, size(self%length)
      self%length(b) = 0.0_wp
      if (grip(model, trial, b) > 0.0_wp) self%length(b) = covered_length(self%point, b)
      if (.not. model%phase(trial%phase)%beads%active(b)) cycle
      associate (bead => model%drawbead(b))
        do p = bead%offset + 1, bead%offset + size(bead%line, 3)
          if (weight(p) <= 0.0_wp) self%path(p) = self%path_before(p)
        end do
      end associate
    end do
  end subroutine evaluate

  !> Return the slip at a point since the committed state, mm.
  pure real(wp) function slip(point, tool, committed, trial)
    type(bead_point_t), intent(in) :: point
    !> Tool that carries the bead; 0 for none.
    integer, intent(in) :: tool
    type(configuration_t), intent(in) :: committed, trial

    real(wp) :: motion(3)

    motion = matmul(trial%x(:, point%node) - committed%x(:, point%node), point%shape)
    if (tool > 0) motion = motion - (trial%tools%displacement(:, tool) &
        - committed%tools%displacement(:, tool))
    slip = dot_product(point%across, motion)
  end function slip

  !> Add the force of a bead on the sheet at a point to those of the nodes and of the bead.
  pure subroutine add_load(self, point, restraint, normal)
    class(drawbeads_t), intent(inout) :: self
    type(bead_point_t), intent(in) :: point
    !> Restraining and normal force, N/mm.
    real(wp), intent(in) :: restraint, normal

    real(wp) :: force(3)
    integer :: a

    force = -restraint*point%direction
    force(3) = force(3) + normal
    do a = 1, size(point%node)
      associate (load => self%load(:, point%node(a)))
        load = load + point%weight*point%shape(a)*force
      end associate
    end do
    self%total(:, point%bead) = self%total(:, point%bead) + point%weight*force
  end subroutine add_load

  !> Add the forces on the nodes.
  subroutine add_force(self, model, state, force)
    class(drawbeads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    if (size(self%load) > 0) force = force + self%load
  end subroutine add_force

  !> Add the stiffness against slips.
  subroutine add_stiffness(self, model, state, stiffness)
    class(drawbeads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    type(block_matrix_t), intent(inout) :: stiffness

    integer :: p, a, b, i, k

    do p = 1, size(self%point)
      associate (this => self%point(p))
        do a = 1, size(this%node)
          if (.not. holds_row(stiffness, this%node(a))) cycle
          do b = 1, size(this%node)
            k = position_of(stiffness, this%node(a), this%node(b))
            do i = 1, 3
              stiffness%value(:, i, k) = stiffness%value(:, i, k) + this%stiffness*this%weight &
                  *this%shape(a)*this%shape(b)*this%across(i)*this%direction
            end do
          end do
        end do
      end associate
    end do
  end subroutine add_stiffness

  !> Add the forces on the tools that carry the beads.
  subroutine add_tool_force(self, model, force)
    class(drawbeads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    real(wp), intent(inout) :: force(:, :)

    integer :: b

    do b = 1, size(self%total, 2)
      associate (tool => model%drawbead(b)%tool)
        if (tool > 0) force(:, tool) = force(:, tool) - self%total(:, b)
      end associate
    end do
  end subroutine add_tool_force

  !> Set the work: that of the tools that carry the beads, and what these dissipate.
  subroutine accept(self, model, old, new)
    class(drawbeads_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: old
    type(configuration_t), intent(inout) :: new

    real(wp) :: work, tool_work
    integer :: b

    if (size(self%load) == 0) return
    work = 0.5_wp*sum((self%load_before + self%load)*(new%x - old%x))
    tool_work = 0.0_wp
    do b = 1, size(model%drawbead)
      associate (tool => model%drawbead(b)%tool)
        if (tool > 0) tool_work = tool_work + 0.5_wp*dot_product(self%total_before(:, b) &
            + self%total(:, b), new%tools%displacement(:, tool) - old%tools%displacement(:, tool))
      end associate
    end do
    new%work%external = new%work%external - work
    new%work%tools = new%work%tools + tool_work
    self%work = self%work + tool_work - work
  end subroutine accept

  !> Return the work dissipated, mJ.
  pure real(wp) function dissipated(self)
    class(drawbeads_t), intent(in) :: self

    dissipated = self%work
  end function dissipated

  !> Return restraining force and length on the sheet of each bead, and the work.
  pure subroutine columns(self, model, names, units)
    class(drawbeads_t), intent(in) :: self
    type(model_t), intent(in) :: model
    character(len=:), allocatable, intent(inout) :: names, units

    integer :: b

    do b = 1, size(model%drawbead)
      names = names//","//model%drawbead(b)%name//"_restraint,"//model%drawbead(b)%name//"_length"
      units = units//",N,mm"
    end do
    if (size(model%drawbead) > 0) names = names//",bead_work"
    if (size(model%drawbead) > 0) units = units//",mJ"
  end subroutine columns

  !> Append the values of these columns.
  pure subroutine values(self, row)
    class(drawbeads_t), intent(in) :: self
    real(wp), allocatable, intent(inout) :: row(:)

    integer :: b

    if (size(self%length) > 0) then
      row = [row, [(self%restraint(b), self%length(b), b=1, size(self%length))], self%work]
    end if
  end subroutine values

  !> Extend the nodal values by those of new nodes, and carry force and path over to the intervals,
  !> which are as long as the elements.
  subroutine extend(self, old_model, model, state)
    class(drawbeads_t), intent(inout) :: self
    type(model_t), intent(in) :: old_model, model
    type(configuration_t), intent(in) :: state

    if (size(self%load) == 0) return
    self%load = extended(self%load, model%n_node)
    self%force = on_intervals(old_model, model, self%force)
    self%path = on_intervals(old_model, model, self%path)
    deallocate (self%point)
    allocate (self%point(0))
    call self%keep()
  end subroutine extend

  !> Return values of the intervals of all beads on those of a refined sheet.
  pure function on_intervals(old_model, model, old) result(new)
    type(model_t), intent(in) :: old_model, model
    real(wp), intent(in) :: old(:)
    real(wp), allocatable :: new(:)

    integer :: b

    allocate (new(0))
    do b = 1, size(model%drawbead)
      associate (from => old_model%drawbead(b), to => model%drawbead(b))
        new = [new, to%means(from, old(from%offset + 1:from%offset + size(from%line, 3)))]
      end associate
    end do
  end function on_intervals

  !> Pass the components to a visitor.
  subroutine walk(self, visitor)
    class(drawbeads_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("bead_force", size(self%force), self%force)
    call visitor%reals("bead_path", size(self%path), self%path)
    call visitor%reals("bead_load", size(self%load), self%load)
    call visitor%reals("bead_total", size(self%total), self%total)
    call visitor%reals("bead_restraint", size(self%restraint), self%restraint)
    call visitor%reals("bead_length", size(self%length), self%length)
    call visitor%reals("bead_normal", size(self%normal), self%normal)
    call visitor%one_real("bead_work", self%work)
  end subroutine walk

end module dd3_model_terms_drawbeads
