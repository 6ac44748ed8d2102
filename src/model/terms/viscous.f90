! SPDX-License-Identifier: GPL-3.0-or-later
!> Viscous forces against the velocity of the nodes, in a release: a sheet that snaps has no
!> equilibrium near the one before, and approaches the next in several increments. A failed attempt
!> makes them stronger; strong ones go on in the next increments, weaker after those that take few
!> iterations, until they vanish: a wide sheet between tools that open buckles at many places, one
!> after another. The state accepted is out of balance by these forces. No increment that ends a
!> phase has them, so that a release ends in equilibrium.
!> Source: C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508-523 (pseudo-transient
!> continuation).
module dd3_model_terms_viscous
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_element_kinematics, only : point_volumes
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_partition, only : holds_row
  use dd3_linalg_tensor, only : identity
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_model_terms_floating, only : bending_stiffness
  use dd3_model_terms_term, only : extended, term_box_t, term_t
  implicit none
  private
  public :: viscous_t, set_viscous, has_viscous, viscous_strength, viscous_work
  public :: viscous_range, stronger, goes_on, weaken_viscous

  !> The term.
  type, extends(term_t) :: viscous_t
    !> Sum of the coefficients of the nodes in the running increment, and at first in the next,
    !> N/mm; 0 without viscous forces.
    real(wp) :: strength = 0.0_wp
    !> Coefficient of each node, its force over its displacement in the increment, by its volume,
    !> `(n_node)`, N/mm; not allocated without viscous forces.
    real(wp), allocatable :: coefficient(:)
    !> Positions of the nodes at the start of the increment, `(3, n_node)`, mm.
    real(wp), allocatable :: before(:, :)
    !> Work dissipated since the start of the job, and until the start of the phase, mJ.
    real(wp) :: work = 0.0_wp, start = 0.0_wp
  contains
    procedure :: begin_phase
    procedure :: begin_increment
    procedure :: add_force
    procedure :: add_stiffness
    procedure :: accept
    procedure :: dissipated
    procedure :: extend
    procedure :: walk
  end type viscous_t

  !> Least strength, over the stiffness of the sheet in bending.
  real(wp), parameter :: least = 1.0e-3_wp
  !> Thicknesses by which the contact forces that are left would move the sheet against the strength
  !> of failure `reached` in succession, and the least factor from one strength to the next.
  real(wp), parameter :: snap = 10.0_wp, growth = 8.0_wp
  integer, parameter :: reached = 3
  !> Iterations of an increment that keeps the strength, and the power of their ratio to it that
  !> reduces the strength.
  real(wp), parameter :: many = 12.0_wp, power = 2.0_wp

contains

  !> Set the strength of an attempt.
  subroutine set_viscous(terms, model, strength)
    type(term_box_t), intent(inout) :: terms(:)
    type(model_t), intent(in) :: model
    !> N/mm.
    real(wp), intent(in) :: strength

    integer :: k

    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (viscous_t)
        call set_strength(this, model, strength)
      end select
    end do
  end subroutine set_viscous

  !> Whether viscous forces act in the attempt.
  pure logical function has_viscous(terms)
    type(term_box_t), intent(in) :: terms(:)

    has_viscous = viscous_strength(terms) > 0.0_wp
  end function has_viscous

  !> Return the strength, N/mm.
  pure real(wp) function viscous_strength(terms) result(strength)
    type(term_box_t), intent(in) :: terms(:)

    integer :: k

    strength = 0.0_wp
    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (viscous_t)
        strength = this%strength
      end select
    end do
  end function viscous_strength

  !> Return the work of viscous forces since the start of the running phase, mJ.
  pure real(wp) function viscous_work(terms) result(work)
    type(term_box_t), intent(in) :: terms(:)

    integer :: k

    work = 0.0_wp
    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (viscous_t)
        work = this%work - this%start
      end select
    end do
  end function viscous_work

  !> Return the least strength and that which holds the contact forces that are left, N/mm.
  function viscous_range(model, state) result(range)
    type(model_t), intent(in) :: model
    !> Committed.
    class(configuration_t), intent(in) :: state
    real(wp) :: range(2)

    real(wp) :: force(1)

    force = sum(norm2(state%contact%lambda, dim=1))
    call sum_over_ranks(1, force)
    range(1) = least*bending_stiffness(model)
    range(2) = max(force(1)/(snap*model%thickness), range(1)*growth**(reached - 1))
  end function viscous_range

  !> Return the strength after a failed attempt, N/mm.
  pure real(wp) function stronger(strength, range)
    !> Of the attempt, and of `viscous_range`, N/mm.
    real(wp), intent(in) :: strength, range(2)

    real(wp) :: factor

    stronger = range(1)
    if (strength < range(1)) return
    factor = (range(2)/range(1))**(1.0_wp/real(reached - 1, wp))
    stronger = strength*merge(factor, growth, &
        strength*factor <= range(2)*(1.0_wp + epsilon(factor)))
  end function stronger

  !> Whether viscous forces go on in the next increment: those above the strength after the second
  !> failure.
  pure logical function goes_on(strength, range)
    !> N/mm.
    real(wp), intent(in) :: strength, range(2)

    goes_on = strength > sqrt(product(range))*(1.0_wp + sqrt(epsilon(strength)))
  end function goes_on

  !> Reduce the strength of the next increment by the iterations of the one accepted.
  subroutine weaken_viscous(terms, iterations, range)
    type(term_box_t), intent(inout) :: terms(:)
    integer, intent(in) :: iterations
    !> Of `viscous_range`, N/mm.
    real(wp), intent(in) :: range(2)

    integer :: k

    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (viscous_t)
        if (.not. this%strength > 0.0_wp) return
        this%strength = this%strength*min(1.0_wp, (real(iterations, wp)/many)**power)
        if (.not. goes_on(this%strength, range)) this%strength = 0.0_wp
      end select
    end do
  end subroutine weaken_viscous

  !> Set the strength, and the coefficients of the nodes by their volumes.
  subroutine set_strength(self, model, strength)
    type(viscous_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> N/mm.
    real(wp), intent(in) :: strength

    real(wp) :: x(3, model%n_node), volume(model%element%n_point)
    integer :: e

    self%strength = strength
    if (allocated(self%coefficient)) deallocate (self%coefficient)
    if (.not. strength > 0.0_wp) return
    allocate (self%coefficient(model%n_node), source=0.0_wp)
    x = model%start_positions()
    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e))
        call point_volumes(model%element, x(:, nodes), volume)
        self%coefficient(nodes) = self%coefficient(nodes) + sum(volume)/real(size(nodes), wp)
      end associate
    end do
    self%coefficient = strength/sum(self%coefficient)*self%coefficient
  end subroutine set_strength

  !> Keep the work until the start of the phase, and begin without viscous forces.
  subroutine begin_phase(self, model, number, state)
    class(viscous_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state

    self%start = self%work
    call set_strength(self, model, 0.0_wp)
  end subroutine begin_phase

  !> Begin with the strength that the increment before has left.
  subroutine begin_increment(self, model, committed)
    class(viscous_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed

    self%before = committed%x
    call set_strength(self, model, self%strength)
  end subroutine begin_increment

  !> Add the forces on the nodes.
  subroutine add_force(self, model, state, force)
    class(viscous_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    if (.not. allocated(self%coefficient)) return
    force = force - spread(self%coefficient, 1, 3)*(state%x - self%before)
  end subroutine add_force

  !> Add the coefficients to the stiffness.
  subroutine add_stiffness(self, model, state, stiffness)
    class(viscous_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    type(block_matrix_t), intent(inout) :: stiffness

    integer :: node, k

    if (.not. allocated(self%coefficient)) return
    do node = 1, model%n_node
      if (.not. holds_row(stiffness, node)) cycle
      k = stiffness%diagonal(node)
      stiffness%value(:, :, k) = stiffness%value(:, :, k) + self%coefficient(node)*identity
    end do
  end subroutine add_stiffness

  !> Set the work, the forces at the end of the increment by its displacements, and take the forces
  !> from the external ones.
  subroutine accept(self, model, old, new)
    class(viscous_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: old
    type(configuration_t), intent(inout) :: new

    real(wp) :: work

    if (.not. allocated(self%coefficient)) return
    work = sum(self%coefficient*sum((new%x - old%x)**2, dim=1))
    self%work = self%work + work
    new%work%external = new%work%external + 0.5_wp*work
    new%external_force = new%external_force + spread(self%coefficient, 1, 3)*(new%x - old%x)
  end subroutine accept

  !> Return the work dissipated, mJ.
  pure real(wp) function dissipated(self)
    class(viscous_t), intent(in) :: self

    dissipated = self%work
  end function dissipated

  !> Extend the nodal values by those of new nodes.
  subroutine extend(self, old_model, model, state)
    class(viscous_t), intent(inout) :: self
    type(model_t), intent(in) :: old_model, model
    type(configuration_t), intent(in) :: state

    if (allocated(self%before)) self%before = extended(self%before, model%n_node)
    if (allocated(self%coefficient)) self%coefficient = &
        [self%coefficient, spread(0.0_wp, 1, model%n_node - old_model%n_node)]
  end subroutine extend

  !> Pass the components to a visitor.
  subroutine walk(self, visitor)
    class(viscous_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%one_real("viscous_strength", self%strength)
    call visitor%one_real("viscous_work", self%work)
    call visitor%one_real("start_viscous_work", self%start)
  end subroutine walk

end module dd3_model_terms_viscous
