! SPDX-License-Identifier: GPL-3.0-or-later
!> Viscous forces against the velocity of the nodes, in attempts at an increment of a release after
!> others that failed: a sheet that snaps has no equilibrium near the one before, and approaches the
!> next in several increments. The state accepted is out of balance by these forces; the first
!> attempt at each increment has none, so that the snap ends in equilibrium.
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
  public :: viscous_t, set_viscous, has_viscous, viscous_work, viscous_coefficients

  !> The term.
  type, extends(term_t) :: viscous_t
    !> Force of each node over its displacement in the increment, `(n_node)`, N/mm; not allocated
    !> without viscous forces.
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

  !> Least sum of the coefficients, over the stiffness of the sheet in bending: that of the first
  !> attempt with viscous forces.
  real(wp), parameter :: least = 1.0e-3_wp
  !> Thicknesses by which the contact forces that are left would move the sheet against the
  !> coefficients of attempt `reached`, and the factor from one attempt to the next behind it. A
  !> sheet moves in an increment by what the least coefficients that converge let it.
  real(wp), parameter :: snap = 10.0_wp, growth = 8.0_wp
  integer, parameter :: reached = 3

contains

  !> Set the coefficients of an attempt.
  subroutine set_viscous(terms, coefficient)
    type(term_box_t), intent(inout) :: terms(:)
    !> `(n_node)`, N/mm.
    real(wp), intent(in) :: coefficient(:)

    integer :: k

    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (viscous_t)
        this%coefficient = coefficient
      end select
    end do
  end subroutine set_viscous

  !> Whether viscous forces act.
  pure logical function has_viscous(terms)
    type(term_box_t), intent(in) :: terms(:)

    integer :: k

    has_viscous = .false.
    do k = 1, size(terms)
      select type (this => terms(k)%of)
      type is (viscous_t)
        has_viscous = allocated(this%coefficient)
      end select
    end do
  end function has_viscous

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

  !> Return the viscous force of each node over its displacement in the increment, N/mm, by its
  !> volume.
  function viscous_coefficients(model, state, attempt) result(coefficient)
    type(model_t), intent(in) :: model
    !> Committed.
    class(configuration_t), intent(in) :: state
    !> Number of the attempt with viscous forces, from 1.
    integer, intent(in) :: attempt
    real(wp) :: coefficient(model%n_node)

    real(wp) :: x(3, model%n_node), volume(model%element%n_point), force(1), low, high
    integer :: e

    x = model%start_positions()
    coefficient = 0.0_wp
    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e))
        call point_volumes(model%element, x(:, nodes), volume)
        coefficient(nodes) = coefficient(nodes) + sum(volume)/real(size(nodes), wp)
      end associate
    end do
    force = sum(norm2(state%contact%lambda, dim=1))
    call sum_over_ranks(1, force)
    low = least*bending_stiffness(model)
    high = max(force(1)/(snap*model%thickness), low*growth**(reached - 1))
    coefficient = coefficient/sum(coefficient)*growth**max(0, attempt - reached) &
        *low*(high/low)**(real(min(attempt, reached) - 1, wp)/real(reached - 1, wp))
  end function viscous_coefficients

  !> Keep the work until the start of the phase.
  subroutine begin_phase(self, model, number, state)
    class(viscous_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state

    self%start = self%work
    if (allocated(self%coefficient)) deallocate (self%coefficient)
  end subroutine begin_phase

  !> Begin without viscous forces.
  subroutine begin_increment(self, model, committed)
    class(viscous_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed

    self%before = committed%x
    if (allocated(self%coefficient)) deallocate (self%coefficient)
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

    call visitor%one_real("viscous_work", self%work)
    call visitor%one_real("start_viscous_work", self%start)
  end subroutine walk

end module dd3_model_terms_viscous
