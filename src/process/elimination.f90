! SPDX-License-Identifier: GPL-3.0-or-later
!> Nonlinear elimination: the equilibrium of the few nodes that have most of the residual, with the
!> rest of the sheet and the tools held. Where elements begin to bend over a radius, change their
!> plastic zones or meet a tool within an increment, a step of the corrector overshoots at a few
!> nodes; without them it need not be shortened for all.
!> Source: X.-C. Cai, X. Li, SIAM J. Sci. Comput. 33 (2011) 746-762.
module dd3_process_elimination
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : agreed, sum_over_ranks, this_rank
  use dd3_base_verdict, only : verdict_converged, verdict_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_process_newton, only : newton_converged, newton_course_t, newton_problem_t, solve
  use dd3_system_linear_problem, only : unknowns_t
  use dd3_system_region, only : new_region, region_t
  use dd3_system_system, only : system_t
  use dd3_tools_closest, only : hint_t
  implicit none
  private
  public :: local_equilibrium_t, find_worst

  !> Equilibrium of a region as the problem of an iteration of its own. What it is built on is
  !> pointed to, as in the equilibrium of the sheet.
  type, extends(newton_problem_t) :: local_equilibrium_t
    type(model_t), pointer :: model => null()
    type(state_t), pointer :: committed => null(), trial => null()
    type(system_t), pointer :: system => null()
    type(region_t) :: region
    !> State of the region before the last step, and at first.
    type(unknowns_t), private :: start, origin
    integer, allocatable, private :: start_tool(:), origin_tool(:)
    type(hint_t), allocatable, private :: start_hint(:, :), origin_hint(:, :)
    !> Internal forces of its nodes at first, those of its elements alone among them, `(3, n)`, N,
    !> and the norm of its residual, N.
    real(wp), allocatable, private :: origin_force(:, :), first_force(:, :)
    real(wp), private :: scale = 0.0_wp
  contains
    procedure :: evaluate
    procedure :: is_admissible
    procedure :: linearise
    procedure :: apply
    procedure :: slope
    procedure :: settle
    procedure :: restore
  end type local_equilibrium_t

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
        associate (nodes => model%connectivity(:, e))
          if (any(chosen(nodes))) layer(nodes) = .true.
        end associate
      end do
      chosen = layer
    end do
    if (real(count(chosen), wp) > largest_part*real(model%n_node, wp)) chosen = .false.
  end subroutine find_worst

  !> Return the squares of the residuals of the nodes, with those of the enhanced strains, N2.
  function squares(model, trial, system) result(square)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(system_t), intent(in) :: system
    real(wp) :: square(model%n_node)

    integer :: e, rank

    square = sum(system%problem%law_residual**2, mask=.not. model%phase(trial%phase)%prescribed, &
        dim=1)
    rank = this_rank()
    if (model%part%divided) square = merge(square, 0.0_wp, model%part%node_owner == rank)
    do e = 1, size(model%part%element)
      associate (nodes => model%connectivity(:, model%part%element(e)))
        square(nodes) = square(nodes) + enhanced_square(model, system%enhanced%residual(:, e)) &
            /real(size(nodes), wp)
      end associate
    end do
    call sum_over_ranks(size(square), square)
  end function squares

  !> Return the square of the residual of the enhanced strains of an element, as a force, N2; the
  !> norm has the same.
  pure real(wp) function enhanced_square(model, residual) result(square)
    type(model_t), intent(in) :: model
    !> N/mm.
    real(wp), intent(in) :: residual(:)

    square = sum((residual*(0.5_wp*model%thickness))**2)
  end function enhanced_square

  !> Solve the equilibrium of a region of free nodes. The internal forces follow.
  recursive subroutine settle(self, chosen, converged)
    class(local_equilibrium_t), intent(inout) :: self
    !> The free nodes, `(n_node)`.
    logical, intent(in) :: chosen(:)
    !> If not, the trial state is as before, but for the round-off of the contact.
    logical, intent(out) :: converged

    type(newton_course_t) :: course

    associate (trial => self%trial, region => self%region)
      call new_region(region, self%model, chosen, self%model%phase(trial%phase)%prescribed)
      call keep_start(self)
      self%origin = self%start
      self%origin_tool = self%start_tool
      self%origin_hint = self%start_hint
      self%origin_force = trial%sheet%internal_force(:, region%node)
      call solve(self, local_tolerance, most_iterations, .true., course)
      converged = course%outcome == newton_converged
      if (converged) then
        trial%sheet%internal_force(:, region%node) = self%origin_force &
            + (region%force - self%first_force)
      else
        call self%restore()
      end if
    end associate
  end subroutine settle

  !> Return to the state before.
  subroutine restore(self)
    class(local_equilibrium_t), intent(inout) :: self

    type(verdict_t) :: verdict

    self%start = self%origin
    self%start_tool = self%origin_tool
    self%start_hint = self%origin_hint
    call self%apply(0.0_wp)
    call self%evaluate(.false., verdict)
    self%trial%sheet%internal_force(:, self%region%node) = self%origin_force
  end subroutine restore

  !> Keep the state of the region before a step.
  subroutine keep_start(self)
    class(local_equilibrium_t), intent(inout) :: self

    associate (trial => self%trial, region => self%region)
      self%start%x = trial%x(:, region%node)
      self%start%enhanced = trial%sheet%enhanced(:, region%element)
      self%start%lambda = trial%contact%lambda(:, region%point)
      self%start_tool = trial%contact%tool(region%point)
      self%start_hint = trial%contact%hint(:, region%point)
    end associate
  end subroutine keep_start

  !> Evaluate the residual of the region.
  subroutine evaluate(self, first, verdict)
    class(local_equilibrium_t), intent(inout) :: self
    !> Gives the scale. The stiffness is assembled where it is needed.
    logical, intent(in) :: first
    type(verdict_t), intent(out) :: verdict

    real(wp) :: square(1)
    integer :: k

    associate (region => self%region)
      call region%evaluate(self%model, self%committed, self%trial, self%system, verdict)
      if (verdict%outcome /= verdict_converged) return
      square = 0.0_wp
      do k = 1, size(region%element)
        square = square + enhanced_square(self%model, &
            self%system%enhanced%residual(:, region%element(k)))
      end do
      call sum_over_ranks(1, square)
      self%scaled_norm = agreed(sqrt(square(1) + sum(region%residual**2)))
      if (first) then
        self%first_force = region%force
        self%scale = self%scaled_norm
      end if
      self%scaled_norm = self%scaled_norm/max(self%scale, tiny(1.0_wp))
    end associate
  end subroutine evaluate

  !> Whether the region had a residual at the start, which scales its norm.
  function is_admissible(self) result(admissible)
    class(local_equilibrium_t), intent(in) :: self
    logical :: admissible

    admissible = self%scale > 0.0_wp
  end function is_admissible

  !> Linearise at the trial state and solve for the step.
  subroutine linearise(self, verdict)
    class(local_equilibrium_t), intent(inout) :: self
    type(verdict_t), intent(out) :: verdict

    call keep_start(self)
    call self%region%solve(self%model, self%committed, self%trial, self%system, verdict)
  end subroutine linearise

  !> Set the trial state of the region to that before the step and a fraction of the step.
  subroutine apply(self, fraction)
    class(local_equilibrium_t), intent(inout) :: self
    real(wp), intent(in) :: fraction

    associate (trial => self%trial, region => self%region, start => self%start, &
        step => self%region%step)
      trial%x(:, region%node) = start%x + fraction*step%x
      trial%sheet%enhanced(:, region%element) = start%enhanced + fraction*step%enhanced
      trial%contact%lambda(:, region%point) = start%lambda + fraction*step%lambda
      if (fraction >= 1.0_wp) return
      trial%contact%tool(region%point) = self%start_tool
      trial%contact%hint(:, region%point) = self%start_hint
    end associate
  end subroutine apply

  !> Return the work of the residual in the last step, mJ.
  function slope(self) result(work)
    class(local_equilibrium_t), intent(in) :: self
    real(wp) :: work

    real(wp) :: own(1)

    associate (region => self%region)
      own = sum(self%system%enhanced%residual(:, region%element)*region%step%enhanced)
      call sum_over_ranks(1, own)
      work = agreed(own(1) + sum(region%residual*region%step%x))
    end associate
  end function slope

end module dd3_process_elimination
