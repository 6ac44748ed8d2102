! SPDX-License-Identifier: GPL-3.0-or-later
!> Nonlinear elimination: the equilibrium of the few nodes that have most of the residual, with the
!> rest of the sheet and the tools held. Where elements begin to bend over a radius, change their
!> plastic zones or meet a tool within an increment, a step of the corrector overshoots at a few
!> nodes; without them it need not be shortened for all. A region is the equilibrium of the sheet on
!> a smaller system, with its own norm.
!> Source: X.-C. Cai, X. Li, SIAM J. Sci. Comput. 33 (2011) 746-762.
module dd3_process_elimination
  use dd3_base_clock, only : section_elimination
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : agreed, sum_over_ranks, this_rank
  use dd3_base_verdict, only : verdict_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_terms_viscous, only : has_viscous
  use dd3_process_equilibrium, only : equilibrium_t
  use dd3_process_forces, only : evaluate_residuals
  use dd3_process_newton, only : newton_converged, newton_course_t, solve
  use dd3_process_norm, only : residual_t
  use dd3_system_region, only : lend, new_region
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: sheet_equilibrium_t, region_equilibrium_t, find_worst

  !> Equilibrium of the sheet, with elimination.
  type, extends(equilibrium_t) :: sheet_equilibrium_t
  contains
    procedure :: eliminate
  end type sheet_equilibrium_t

  !> Equilibrium of a region, on its system.
  type, extends(equilibrium_t) :: region_equilibrium_t
    !> Norm of its residual, N, and internal forces of its elements, `(3, n_node)`, N, at first.
    real(wp), private :: scale = 1.0_wp
    real(wp), allocatable, private :: first_force(:, :)
  contains
    procedure :: measure
    procedure :: is_admissible
    procedure :: settle
    procedure :: restore
  end type region_equilibrium_t

  !> Part of the square of the residual that the worst nodes have. Larger: larger regions.
  real(wp), parameter :: part_of_residual = 0.9_wp
  !> Ratio of squares that count as equal, as where round-off alone tells nodes apart that are
  !> symmetric to each other.
  real(wp), parameter :: tie = 0.99_wp
  !> Layers of elements around the worst nodes, and the largest part of all nodes in a region. More:
  !> fewer iterations of the sheet, whose residual is not local then, for more of the regions.
  integer, parameter :: n_layers = 2
  real(wp), parameter :: largest_part = 0.2_wp
  !> Residual of a region over that at first at which its iterations end, and their largest number.
  real(wp), parameter :: local_tolerance = 0.1_wp
  integer, parameter :: most_iterations = 20

contains

  !> Find the nodes of a region: the worst ones with the elements around them.
  subroutine find_worst(model, trial, system, chosen)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    !> Has the residuals.
    type(system_t), intent(in) :: system
    !> None if they are too many, or if there is no residual.
    logical, intent(out) :: chosen(:)

    real(wp) :: square(model%n_node), enough, low, high, middle
    logical :: layer(model%n_node)
    integer :: k, e

    square = squares(model, trial, system)
    enough = part_of_residual*sum(square)
    low = 0.0_wp
    high = maxval(square)
    do k = 1, digits(high)
      middle = 0.5_wp*(low + high)
      if (sum(square, mask=square >= middle) >= enough) then
        low = middle
      else
        high = middle
      end if
    end do
    chosen = square >= tie*low .and. square > 0.0_wp
    do k = 1, n_layers
      layer = chosen
      do e = 1, model%n_element
        associate (nodes => model%coupling(:, e))
          if (any(chosen(nodes))) layer(nodes) = .true.
        end associate
      end do
      chosen = layer
    end do
    ! A bound node moves with its parents, and all elements at it are those of the region.
    do k = 1, model%n_bound
      chosen(model%bound(1, k)) = any(chosen(model%bound_point(k)%node( &
          :model%bound_point(k)%n_node)))
    end do
    if (real(count(chosen), wp) > largest_part*real(model%n_node, wp)) chosen = .false.
  end subroutine find_worst

  !> Return the squares of the residuals of the free nodes, with those of the enhanced strains of
  !> the system's elements, N2; the norm of the sheet has the same.
  function squares(model, trial, system) result(square)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(system_t), intent(in) :: system
    real(wp) :: square(model%n_node)

    integer :: i, rank

    associate (problem => system%problem, phase => model%phase(trial%phase))
      square = sum(problem%law_residual**2, dim=1, &
          mask=.not. (phase%prescribed .or. spread(problem%held, 1, 3)))
    end associate
    rank = this_rank()
    if (model%part%divided) square = merge(square, 0.0_wp, model%part%node_owner == rank)
    do i = 1, size(system%batches%element)
      associate (e => system%batches%element(i), &
          nodes => model%connectivity(:, model%part%element(system%batches%element(i))))
        square(nodes) = square(nodes) + sum((system%enhanced%residual(:, e) &
            *(0.5_wp*model%thickness))**2)/real(size(nodes), wp)
      end associate
    end do
    call sum_over_ranks(size(square), square)
  end function squares

  !> Solve the equilibrium of the nodes with most of the residual alone, in the compliant
  !> formulation; without it if that leaves the norm above the bound. The contact is that of the
  !> region's last evaluation: elsewhere it does not change.
  recursive subroutine eliminate(self, bound, eliminated)
    class(sheet_equilibrium_t), intent(inout) :: self
    real(wp), intent(in) :: bound
    logical, intent(out) :: eliminated

    type(system_t), target :: region
    type(region_equilibrium_t) :: local, origin
    type(residual_t) :: before
    real(wp) :: force(3, self%model%n_node)
    logical :: chosen(self%model%n_node), converged

    eliminated = .false.
    associate (model => self%model, committed => self%committed, trial => self%trial, &
        system => self%system)
      if (.not. (system%formulation%eliminates &
          .and. model%phase(trial%phase)%newton%elimination)) return
      if (has_viscous(trial%term)) return
      call system%profile%start()
      call find_worst(model, trial, system, chosen)
      if (any(chosen)) then
        before = self%residual
        force = trial%sheet%internal_force
        call new_region(region, model, trial, chosen)
        call local%attach(model, committed, trial, region)
        origin = local
        call lend(system, region)
        call local%settle(force, converged)
        call lend(region, system)
        if (converged) then
          call evaluate_residuals(model, committed, trial, system)
          call self%measure()
          eliminated = self%residual%scaled < min(bound, before%scaled)
        end if
        if (.not. eliminated) then
          call lend(system, region)
          call origin%restore(force)
          call lend(region, system)
          if (converged) call evaluate_residuals(model, committed, trial, system)
          self%residual = before
          self%scaled_norm = before%scaled
        end if
        call region%solver%release()
      end if
      call system%profile%add(section_elimination)
    end associate
  end subroutine eliminate

  !> Solve the equilibrium of the region. The internal forces follow.
  recursive subroutine settle(self, force, converged)
    class(region_equilibrium_t), intent(inout) :: self
    !> Internal forces of the sheet before, `(3, n_node)`, N.
    real(wp), intent(in) :: force(:, :)
    logical, intent(out) :: converged

    type(newton_course_t) :: course

    call solve(self, local_tolerance, most_iterations, .true., course)
    converged = course%outcome == newton_converged
    if (converged) self%trial%sheet%internal_force = force &
        + (self%trial%sheet%internal_force - self%first_force)
  end subroutine settle

  !> Return to the state that the region began at.
  subroutine restore(self, force)
    class(region_equilibrium_t), intent(inout) :: self
    !> Internal forces of the sheet there, `(3, n_node)`, N.
    real(wp), intent(in) :: force(:, :)

    type(verdict_t) :: verdict

    call self%apply(0.0_wp)
    call self%evaluate(.false., verdict)
    self%trial%sheet%internal_force = force
  end subroutine restore

  !> Set the norm of the region's residual, over that at first.
  subroutine measure(self)
    class(region_equilibrium_t), intent(inout) :: self

    self%residual%norm = agreed(sqrt(sum(squares(self%model, self%trial, self%system))))
    if (.not. allocated(self%first_force)) then
      self%scale = max(self%residual%norm, tiny(1.0_wp))
      self%first_force = self%trial%sheet%internal_force
    end if
    self%residual%scaled = self%residual%norm/self%scale
    self%scaled_norm = self%residual%scaled
  end subroutine measure

  !> Whether the region had a residual at the start, which scales its norm.
  function is_admissible(self) result(admissible)
    class(region_equilibrium_t), intent(in) :: self
    logical :: admissible

    admissible = self%scale > 0.0_wp
  end function is_admissible

end module dd3_process_elimination
