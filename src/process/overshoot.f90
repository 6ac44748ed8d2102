!> Overshoot of an iteration: the residual has grown, and the nonlinearity of the internal forces is
!> the cause.
!>
!> The growth alone is no reason to shorten a step. Where nodes open or close, full steps are those
!> of the active set, and where the sheet rotates the linear rotation stretches it: its residual is
!> large, but the next iteration removes it at once. Therefore the displacements are evaluated that
!> the same matrix assigns to the residual of equilibrium left behind, without that of the contact
!> law. In a problem that is linear but for contact they vanish.
!> Source: P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2011 (natural monotonicity
!> test, simplified Newton correction).
module dd3_process_overshoot
  use dd3_base_kinds, only : wp
  use dd3_linalg_solver, only : solver_report_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_process_attempt, only : attempt_t
  use dd3_process_residual, only : evaluate_norm
  use dd3_system_reduced, only : reduce_equilibrium
  use dd3_system_solve, only : solve_factorised
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: check_overshoot

  !> Norm of the displacements left, over that of the step, above which a step overshoots.
  real(wp), parameter :: largest_ratio = 0.25_wp

contains

  !> Check the last step of the corrector, evaluated in the trial state.
  subroutine check_overshoot(model, trial, system, attempt, overshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    !> Its linear solver still has the matrix of the step.
    type(system_t), intent(inout) :: system
    !> Has the norm of the residuals before the step; gets the work of the linear solver.
    type(attempt_t), intent(inout) :: attempt
    logical, intent(out) :: overshot

    real(wp) :: norm, worst_residual, left(size(system%problem%solution))
    integer :: worst_node
    type(solver_report_t) :: report

    overshot = .false.
    if (attempt%verdict%iterations == 1) return
    call evaluate_norm(model, trial, system, norm, worst_node, worst_residual)
    if (norm <= attempt%correction%residual) return
    call reduce_equilibrium(model, model%phase(trial%phase), system%problem)
    call solve_factorised(system, left, attempt%solver, report)
    overshot = report%converged .and. norm2(left) > largest_ratio*norm2(system%problem%solution)
  end subroutine check_overshoot

end module dd3_process_overshoot
