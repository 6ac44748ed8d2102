! SPDX-License-Identifier: GPL-3.0-or-later
!> Norm that decides the convergence of a trial state: the residuals of nodes, contact and enhanced
!> strains, or the balance of the pressed tools if that is farther off. It is a continuous function
!> of the state evaluated and of the last step. All its factors and tolerances stand here; they have
!> no unit.
!> Source: Oliveira and Menezes 2004, eq. (19), scaled by the norm of the internal forces where it
!> exceeds that of the contact forces, and such that a residual that is round-off has converged.
!> Round-off: a node's position is the multiple of `spacing` nearest to the solution, and the
!> stiffness turns that difference into a force that no iteration removes. Tisseur 2001, Newton's
!> method in floating point arithmetic, SIAM J. Matrix Anal. Appl. 22, 1038-1057: the residual of
!> Newton's method stalls at u |J| |x|, u the unit round-off and J the Jacobian. Here the
!> differences are random, uniform in the interval of rounding, so that their variance is
!> spacing**2/12 and the squares of their forces add. The parameters of the enhanced strains follow
!> the step before it is rounded: to the condensed stiffness that of the elements without them comes
!> on top, which is larger by 1e2 to 1e4 in thin elements.
module dd3_process_norm
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : agreed, broadcast_reals, norm_over_ranks, rank_of_smallest, &
      sum_over_ranks, this_rank
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_pressed_tools, only : as_forces
  use dd3_model_reactions, only : size_of_internal_forces
  use dd3_model_state, only : state_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: residual_t, norm_of, attainable_residual
  public :: convergence_tolerance, opening_phase_tolerance, final_tolerance
  public :: pressed_force, balanced

  !> Norm of the residuals.
  type :: residual_t
    !> N.
    real(wp) :: norm = 0.0_wp
    !> Norm of residuals and step over their scale, eq. (19); largest imbalance of a pressed tool
    !> over its force, weighted; and the norm that decides.
    real(wp) :: sheet = 0.0_wp, tools = 0.0_wp, scaled = 0.0_wp
    !> Node with the largest residual, and that residual, N.
    integer :: worst_node = 0
    real(wp) :: worst = 0.0_wp
  end type residual_t

  !> Largest tolerance of the norm when all tools are released, and under gravity: the residual
  !> stresses, by which it is scaled, are far larger than those that bend a slender sheet.
  !> Smaller: a more accurate shape for more iterations; a strip drawn by 30 mm and released ends
  !> 0.06 mm elsewhere with 1e-2, 0.01 mm with 1e-3.
  real(wp), parameter :: free_tolerance = 1.0e-5_wp
  !> The same while the tools are withdrawn and touch the sheet: its shape is not final, and stick
  !> and slip at the last nodes do not settle to the last digit.
  real(wp), parameter :: opening_tolerance = 1.0e-3_wp
  !> Residual that counts as zero, over the root mean square of the round-off. In S-shaped rails
  !> (input_files/rail, 48 to 1080 elements) residuals stall at 1.0 to 3.5 times the latter, as the
  !> parameters of the enhanced strains, the stresses and the forces are rounded too.
  real(wp), parameter :: round_off_factor = 5.0_wp
  !> Weight of the balance of a pressed tool, its residual over its force: what is off at the end of
  !> an increment is a step in the force of the next. A strip drawn under a holder of 35 N has a
  !> punch force 0.004 % off with 10, 0.08 % with 3, 0.2 % with 1, in 157, 145, 149 iterations.
  real(wp), parameter :: tool_weight = 10.0_wp
  !> Residual of a pressed tool, over its force, that counts as balanced.
  real(wp), parameter :: balanced = 1.0e-6_wp
  !> Fraction of other forces that scales the force of a tool if its own force is smaller.
  real(wp), parameter :: least_force = 1.0e-3_wp

contains

  !> Return the value that the scaled norm has to fall below.
  pure real(wp) function convergence_tolerance(phase, state) result(tolerance)
    type(phase_t), intent(in) :: phase
    !> Trial state, with whether the tools had opened before.
    type(state_t), intent(in) :: state

    if (any(phase%withdrawn) .and. .not. state%open .and. state%progress < 1.0_wp) then
      tolerance = opening_phase_tolerance(phase)
    else
      tolerance = final_tolerance(phase)
    end if
  end function convergence_tolerance

  !> Return the tolerance of a phase that withdraws tools, until they have left the sheet.
  pure real(wp) function opening_phase_tolerance(phase) result(tolerance)
    type(phase_t), intent(in) :: phase

    tolerance = min(phase%newton%tolerance, opening_tolerance)
  end function opening_phase_tolerance

  !> Return the tolerance of a phase, of one that withdraws tools after that.
  pure real(wp) function final_tolerance(phase) result(tolerance)
    type(phase_t), intent(in) :: phase

    tolerance = phase%newton%tolerance
    if (phase%unloaded .or. phase%has_gravity .or. &
        (size(phase%active) > 0 .and. .not. any(phase%active .and. .not. phase%withdrawn))) then
      tolerance = min(tolerance, free_tolerance)
    end if
  end function final_tolerance

  !> Return the norm of a trial state: eq. (19), or the imbalance of a pressed tool if that is
  !> larger.
  type(residual_t) function norm_of(model, trial, system, step) result(residual)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    !> Evaluated at the trial state.
    type(system_t), intent(in) :: system
    !> Norm of the last full step of the contact forces of this rank, N.
    real(wp), intent(in) :: step

    call evaluate_residual(model, trial, system, residual)
    call scale_norm(model, trial, system, step, residual)
    residual%tools = tool_weight*tool_imbalance(model, trial, system)
    if (residual%tools <= tool_weight*balanced) residual%tools = 0.0_wp
    residual%scaled = max(residual%sheet, residual%tools)
  end function norm_of

  !> Evaluate the norm of the residuals of equilibrium and contact at the free degrees of freedom,
  !> and of the enhanced strains.
  subroutine evaluate_residual(model, trial, system, found)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(system_t), intent(in) :: system
    type(residual_t), intent(out) :: found

    real(wp) :: contribution(model%n_node), square(1), worst(2)
    integer :: node, c, rank

    rank = this_rank()
    associate (phase => model%phase(trial%phase), problem => system%problem)
      contribution = sum(problem%law_residual**2, mask=.not. phase%prescribed, dim=1)
      if (model%part%divided) then
        where (model%part%node_owner /= rank) contribution = 0.0_wp
      end if
      do c = 1, model%n_contact
        node = model%contact_node(c)
        contribution(node) = contribution(node) + sum(problem%contact_residual(:, c)**2)
      end do
      node = maxloc(contribution, dim=1)
      worst = [real(node, wp), contribution(node)]
      call broadcast_reals(rank_of_smallest(-worst(2), node), 2, worst)
      found%worst_node = nint(worst(1))
      found%worst = sqrt(max(worst(2), 0.0_wp))
      square = sum(contribution) + sum((system%enhanced%residual*(0.5_wp*model%thickness))**2)
      call sum_over_ranks(1, square)
    end associate
    found%norm = sqrt(square(1))
  end subroutine evaluate_residual

  !> Set the norm of residuals and step over their scale, eq. (19).
  subroutine scale_norm(model, trial, system, step, residual)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(system_t), intent(in) :: system
    real(wp), intent(in) :: step
    type(residual_t), intent(inout) :: residual

    real(wp) :: force, scale, round_off

    associate (phase => model%phase(trial%phase))
      force = agreed(norm_over_ranks(step) + residual%norm)
      scale = agreed(max(norm_over_ranks(norm2(trial%contact%lambda)), &
          size_of_internal_forces(model, trial)))
      if (force >= convergence_tolerance(phase, trial)*scale) then
        round_off = attainable_residual(system%column_square, trial%x)
        scale = max(scale, round_off/convergence_tolerance(phase, trial))
      end if
    end associate
    residual%sheet = force/scale
  end subroutine scale_norm

  !> Return the norm of the residual below which it is round-off, N.
  function attainable_residual(square, x) result(residual)
    !> Sums of the squares in the columns of the stiffness over the rows of this rank, with those of
    !> the enhanced parameters, `(3, n_node)`, (N/mm)2.
    real(wp), intent(in) :: square(:, :)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp) :: residual

    real(wp) :: variance(1)

    variance = sum(square*(spacing(x)**2/12.0_wp))
    call sum_over_ranks(1, variance)
    residual = round_off_factor*sqrt(variance(1))
  end function attainable_residual

  !> Return the largest residual of a pressed tool in contact, over its force.
  pure real(wp) function tool_imbalance(model, trial, system) result(imbalance)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(system_t), intent(in) :: system

    integer :: tool

    imbalance = 0.0_wp
    do tool = 1, model%n_tool
      if (.not. model%phase(trial%phase)%pressed(tool)) cycle
      if (trial%tools%touches(tool)) imbalance = max(imbalance, &
          norm2(as_forces(model%phase(trial%phase), tool, system%problem%tool_residual(:, tool))) &
          /pressed_force(trial, tool))
    end do
  end function tool_imbalance

  !> Return the scale of the force on a pressed tool, N. The scale of one that is eased to zero is a
  !> fraction of its force at the start of the phase and of the internal forces.
  pure real(wp) function pressed_force(trial, tool)
    type(state_t), intent(in) :: trial
    integer, intent(in) :: tool

    pressed_force = max(norm2(trial%tools%load(:, tool)), &
        least_force*norm2(trial%start%tool_load(:, tool)), &
        least_force*norm2(trial%start%tool_load_end(:, tool)), &
        least_force*norm2(trial%sheet%internal_force), &
        tiny(1.0_wp))
  end function pressed_force

end module dd3_process_norm
