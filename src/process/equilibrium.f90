! SPDX-License-Identifier: GPL-3.0-or-later
!> Equilibrium of a trial state, as the problem that the corrector solves: element forces, loads,
!> contact and supports, with all non-linearities (plasticity, large rotations, contact, friction)
!> in one residual.
!> Source: Menezes and Teodosiu 2000.
module dd3_process_equilibrium
  use dd3_base_clock, only : section_assembly, section_contact, section_material
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : agreed, any_rank, count_over_ranks, sum_over_ranks, this_rank
  use dd3_base_verdict, only : verdict_converged, verdict_retry, verdict_t, cause_large_step, &
      cause_led_inside, cause_lost_tool, cause_residual, cause_tool_force, cause_unsettled
  use dd3_model_bound_nodes, only : follow_parents
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : is_normal_held
  use dd3_model_pressed_tools, only : as_forces, turn_tools, unknowns_of
  use dd3_model_reactions, only : size_of_internal_forces
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : add_stiffness
  use dd3_model_terms_viscous, only : has_viscous
  use dd3_process_forces, only : evaluate_forces, lost_tool
  use dd3_process_newton, only : newton_problem_t
  use dd3_process_norm, only : convergence_tolerance, norm_of, residual_t
  use dd3_process_tool_balance, only : balance_tools
  use dd3_system_internal, only : assemble_stiffness, update_material
  use dd3_system_linear_problem, only : unknowns_t
  use dd3_system_reduced, only : read_step
  use dd3_system_solve, only : solve_info_t, solve_reduced
  use dd3_system_system, only : system_t
  use dd3_tools_closest, only : hint_t
  implicit none
  private
  public :: equilibrium_t

  !> The problem. What it is built on is pointed to, as the procedures of an abstract problem have
  !> no argument for it; it must not outlive that.
  type, extends(newton_problem_t) :: equilibrium_t
    type(model_t), pointer :: model => null()
    type(state_t), pointer :: committed => null()
    !> State that is corrected.
    type(state_t), pointer :: trial => null()
    !> Evaluated at the trial state.
    type(system_t), pointer :: system => null()
    !> Trial state before the last step, and that step.
    type(unknowns_t) :: start, step
    !> Norm of the contact forces of this rank in the last solution, N: the step before it is
    !> shortened, of which eq. (19) estimates the distance from the solution.
    real(wp), private :: force_step = 0.0_wp
    integer, allocatable, private :: start_tool(:)
    type(hint_t), allocatable, private :: start_hint(:, :)
    !> Rotations of the tools there, `(3, 3, n_tool)`.
    real(wp), allocatable, private :: start_rotation(:, :, :)
    type(residual_t) :: residual
    !> Contact status in the last three linearisations, the newest first, `(n_contact, 3)`.
    integer, allocatable :: status(:, :)
    !> Work of the linear solver.
    type(solve_info_t) :: solver
    !> Whether the phase releases the sheet.
    logical :: releases = .false.
    !> Whether the stiffness of the trial state is assembled.
    logical, private :: assembled = .false.
    !> Node that moves farthest in the solution of the last linearisation, and by how much, mm.
    integer, private :: farthest = 0
    real(wp), private :: farthest_moved = 0.0_wp
  contains
    procedure :: attach
    procedure :: begin
    procedure :: evaluate
    procedure :: measure
    procedure :: is_admissible
    procedure :: linearise
    procedure :: apply
    procedure :: slope
    procedure :: explain
    procedure :: changing
  end type equilibrium_t

  !> Work of the residual in a step that is round-off, over the norms of internal forces and step.
  !> Without it the sign of round-off shortens steps in a sheet that has lost its forces: 13
  !> iterations for 3 where a ram leaves the held cube of tests/cases/held_under_tool.
  real(wp), parameter :: negligible_work = 1.0e-12_wp
  !> Largest displacement of a node in an iteration, and that of a nearly singular tangent, over the
  !> thickness of the sheet.
  real(wp), parameter :: longest_step = 1.0_wp, nearly_singular = 20.0_wp
  !> Number of contact status kept, and the value before the first.
  integer, parameter :: n_kept = 3, unknown = -1

contains

  !> Set what the problem is built on, and begin at the trial state as it is.
  subroutine attach(self, model, committed, trial, system)
    class(equilibrium_t), intent(inout) :: self
    type(model_t), target, intent(in) :: model
    type(state_t), target, intent(in) :: committed
    type(state_t), target, intent(inout) :: trial
    type(system_t), target, intent(inout) :: system

    self%model => model
    self%committed => committed
    self%trial => trial
    self%system => system
    allocate (self%status(size(trial%contact%status), n_kept), source=unknown)
    call keep_start(self)
    self%step = self%start%scaled(0.0_wp)
  end subroutine attach

  !> Begin at the committed state with the step of the prediction. The tools make the whole of their
  !> step, whatever fraction the sheet makes.
  subroutine begin(self, step)
    class(equilibrium_t), intent(inout) :: self
    type(unknowns_t), intent(in) :: step

    associate (trial => self%trial, problem => self%system%problem)
      call keep_start(self)
      trial%tools%displacement = trial%tools%displacement + step%tool
      call turn_tools(self%start_rotation, step%tilt, trial%tools%rotation)
      call keep_start(self)
      self%step = step
      self%step%tool = 0.0_wp
      self%step%tilt = 0.0_wp
      self%force_step = norm2(step%lambda)
      problem%prescribed = 0.0_wp
      problem%tool_prescribed = 0.0_wp
    end associate
    call self%apply(1.0_wp)
  end subroutine begin

  !> Evaluate stresses, internal forces, contact and residual of the trial state.
  subroutine evaluate(self, first, verdict)
    class(equilibrium_t), intent(inout) :: self
    !> Of the increment: the stiffness is assembled with the stresses.
    logical, intent(in) :: first
    type(verdict_t), intent(out) :: verdict

    associate (system => self%system)
      call system%profile%start()
      call update_material(system, self%model, self%committed, self%trial, first, verdict)
      call system%profile%add(section_material)
      self%assembled = first
      if (verdict%outcome /= verdict_converged) return
      call evaluate_forces(self%model, self%committed, self%trial, system)
      call system%profile%add(section_contact)
      call self%measure()
      if (system%formulation%balances_tools .and. .not. first) call balance(self)
    end associate
  end subroutine evaluate

  !> Set the norm of the trial state after the last step.
  subroutine measure(self)
    class(equilibrium_t), intent(inout) :: self

    self%residual = norm_of(self%model, self%trial, self%system, self%force_step)
    self%scaled_norm = self%residual%scaled
  end subroutine measure

  !> Once all else has converged, balance the pressed tools by their motion alone.
  subroutine balance(self)
    class(equilibrium_t), intent(inout) :: self

    logical :: moved

    associate (phase => self%model%phase(self%trial%phase))
      if (self%residual%sheet >= convergence_tolerance(phase, self%trial)) return
    end associate
    call balance_tools(self%model, self%committed, self%trial, self%system, moved)
    if (moved) call self%measure()
  end subroutine balance

  !> Whether no pressed tool has lost the sheet, no candidate lies inside a tool, and the nodes with
  !> prescribed displacements have reached their positions.
  function is_admissible(self) result(admissible)
    class(equilibrium_t), intent(in) :: self
    logical :: admissible

    associate (model => self%model, trial => self%trial, contact => self%system%contact, &
        problem => self%system%problem)
      admissible = .not. any_rank(any(contact%distance + contact%onset < -model%tolerance%depth &
          .and. contact%tool > 0))
      if (admissible) admissible = lost_tool(model, trial) == 0
      if (problem%missed) admissible = admissible .and. all(abs(problem%target - trial%x) &
          <= model%tolerance%closed .or. .not. model%phase(trial%phase)%prescribed)
    end associate
  end function is_admissible

  !> Linearise at the trial state and solve for the step.
  subroutine linearise(self, verdict)
    class(equilibrium_t), intent(inout) :: self
    !> Retry if there is no solution, or if it shows that a sheet that is released snaps.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: residual(3, self%model%n_node)

    residual = self%system%problem%residual
    self%status(:, 2:) = self%status(:, :n_kept - 1)
    self%status(:, 1) = self%system%contact%status
    associate (model => self%model, trial => self%trial, system => self%system, &
        phase => self%model%phase(self%trial%phase))
      call system%profile%start()
      if (.not. self%assembled) call assemble_stiffness(system, model, self%committed, trial)
      system%problem%residual = system%problem%residual - system%enhanced%force
      call add_stiffness(trial%term, model, trial%configuration_t, system%matrix)
      if (system%problem%missed) then
        where (phase%prescribed) system%problem%prescribed = system%problem%target - trial%x
      end if
      call system%profile%add(section_assembly)
      call solve_reduced(system, model, trial, self%solver, verdict)
      if (verdict%outcome /= verdict_converged) return
      call keep_start(self)
      call read_step(system, model, trial, self%step)
      self%force_step = norm2(self%step%lambda)
      self%step%enhanced = self%step%enhanced - system%enhanced%offset
      system%problem%residual = residual
    end associate
    call limit_step(self, verdict)
  end subroutine linearise

  !> Keep the trial state before a step.
  subroutine keep_start(self)
    class(equilibrium_t), intent(inout) :: self

    associate (trial => self%trial)
      self%start = unknowns_t(trial%x, trial%sheet%enhanced, trial%contact%lambda, &
          trial%tools%displacement, 0.0_wp*trial%tools%displacement)
      self%start_rotation = trial%tools%rotation
      self%start_tool = trial%contact%tool
      self%start_hint = trial%contact%hint
    end associate
  end subroutine keep_start

  !> Shorten a step that moves a node farther than the sheet is thick. Where nodes have lost contact
  !> for an iteration the tangent is nearly singular, and its step moves the sheet to where no
  !> contact is found again. In a release it is the sign of a snap, which viscous forces follow.
  !> Source: A. R. Conn, N. I. M. Gould, Ph. L. Toint, Trust-Region Methods, SIAM 2000, section 6.1.
  subroutine limit_step(self, verdict)
    class(equilibrium_t), intent(inout) :: self
    !> Retry in a release without viscous forces if the tangent is nearly singular.
    type(verdict_t), intent(inout) :: verdict

    real(wp) :: fraction

    associate (step => self%step, moved => maxval(abs(self%step%x), dim=1), &
        problem => self%system%problem, thickness => self%model%thickness)
      self%farthest = maxloc(moved, dim=1)
      self%farthest_moved = moved(self%farthest)
      if (self%farthest_moved <= longest_step*thickness) return
      if (self%releases .and. .not. has_viscous(self%trial%term)) then
        if (self%farthest_moved <= nearly_singular*thickness) return
        verdict%outcome = verdict_retry
        call explain(self, verdict)
        return
      end if
      fraction = longest_step*thickness/self%farthest_moved
      step%x = fraction*step%x
      step%enhanced = fraction*step%enhanced
      step%lambda = fraction*step%lambda
      step%tool = fraction*step%tool
      step%tilt = fraction*step%tilt
      problem%missed = .true.
    end associate
  end subroutine limit_step

  !> Set the trial state to that before the step and a fraction of the step. A fraction may miss the
  !> prescribed positions.
  subroutine apply(self, fraction)
    class(equilibrium_t), intent(inout) :: self
    real(wp), intent(in) :: fraction

    associate (trial => self%trial, start => self%start, step => self%step)
      trial%x = start%x + fraction*step%x
      call follow_parents(self%model, trial%x)
      trial%sheet%enhanced = start%enhanced + fraction*step%enhanced
      trial%contact%lambda = start%lambda + fraction*step%lambda
      trial%tools%displacement = start%tool + fraction*step%tool
      call turn_tools(self%start_rotation, fraction*step%tilt, trial%tools%rotation)
      if (fraction >= 1.0_wp) return
      trial%contact%tool = self%start_tool
      trial%contact%hint = self%start_hint
      self%system%problem%missed = .true.
    end associate
  end subroutine apply

  !> Return the work of the residuals of nodes, enhanced strains and pressed tools in the last step,
  !> mJ; zero if it is round-off.
  function slope(self) result(work)
    class(equilibrium_t), intent(in) :: self
    real(wp) :: work

    real(wp) :: own(1), least
    logical :: free(3, self%model%n_node)
    integer :: tool, rank

    rank = this_rank()
    associate (model => self%model, problem => self%system%problem, step => self%step, &
        phase => self%model%phase(self%trial%phase))
      free = .not. phase%prescribed
      if (model%part%divided) then
        free = free .and. spread(model%part%node_owner == rank, 1, 3)
      end if
      own = sum(problem%law_residual*step%x, mask=free) &
          + sum(sum(self%system%enhanced%residual*step%enhanced, dim=1))
      call sum_over_ranks(1, own)
      work = own(1)
      do tool = 1, model%n_tool
        if (phase%pressed(tool)) work = work - dot_product(problem%tool_residual(:, tool), &
            unknowns_of(phase, tool, step%tool(:, tool), step%tilt(:, tool)))
      end do
      least = negligible_work*size_of_internal_forces(model, self%trial)*norm2(step%x)
      if (abs(work) <= least) work = 0.0_wp
      work = agreed(work)
    end associate
  end function slope

  !> Return the number of candidates whose status changed in the last linearisations.
  integer function changing(self)
    class(equilibrium_t), intent(in) :: self

    changing = count_over_ranks(count(any(self%status /= unknown .and. &
        self%status /= spread(self%status(:, 1), 2, n_kept), dim=2)))
  end function changing

  !> Set the cause why the trial state is not in equilibrium: a nearly singular tangent, a pressed
  !> tool without contact, a node led into a tool, a contact status that has not settled, the force
  !> on a tool, or the residual of a node.
  subroutine explain(self, verdict)
    class(equilibrium_t), intent(in) :: self
    type(verdict_t), intent(inout) :: verdict

    real(wp) :: imbalance(self%model%n_tool)
    integer :: t

    associate (model => self%model, trial => self%trial, &
        phase => self%model%phase(self%trial%phase))
      verdict%node = self%farthest
      verdict%value(1) = self%farthest_moved
      verdict%cause = cause_large_step
      if (self%farthest_moved > nearly_singular*model%thickness) return
      verdict%tool = lost_tool(model, trial)
      verdict%cause = cause_lost_tool
      if (verdict%tool > 0) return
      verdict%node = self%residual%worst_node
      verdict%cause = cause_led_inside
      if (any_rank(is_led_inside(self, model%candidate_of(verdict%node)))) return
      verdict%cause = cause_unsettled
      if (self%changing() > 0) return
      verdict%cause = cause_residual
      verdict%value(1) = self%residual%worst
      if (self%residual%tools < self%scaled_norm) return
      imbalance = [(norm2(as_forces(phase, t, self%system%problem%tool_residual(:, t))), &
          t=1, model%n_tool)]
      verdict%tool = maxloc(imbalance, dim=1, mask=phase%pressed)
      if (verdict%tool == 0) return
      verdict%cause = cause_tool_force
      verdict%node = 0
      verdict%value(1) = imbalance(verdict%tool)
    end associate
  end subroutine explain

  !> Whether a candidate lies in a tool out of which its supports do not let it.
  pure logical function is_led_inside(self, c)
    class(equilibrium_t), intent(in) :: self
    !> Number of the candidate; 0 for none on this rank.
    integer, intent(in) :: c

    is_led_inside = .false.
    if (c == 0) return
    associate (contact => self%system%contact)
      if (contact%tool(c) == 0 .or. contact%distance(c) >= -self%model%tolerance%closed) return
      is_led_inside = is_normal_held(self%model%phase(self%trial%phase), &
          self%model%contact_node(c), contact%normal(:, c))
    end associate
  end function is_led_inside

end module dd3_process_equilibrium
