! SPDX-License-Identifier: GPL-3.0-or-later
!> Solution of the reduced system.
module dd3_system_solve
  use dd3_base_clock, only : section_assembly, section_factorisation, section_solve
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_lost_tool, &
      cause_singular
  use dd3_linalg_preconditioner, only : perturbed_pivots_t
  use dd3_linalg_solver, only : solver_report_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_partition, only : share_verdict
  use dd3_system_reduced, only : reduce
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: solve_info_t, solve_reduced

  !> Work of the linear solver in an attempt.
  type :: solve_info_t
    !> Sum over all solutions.
    integer :: iterations = 0
    !> Solver used; after a fallback, the one fallen back on.
    character(len=24) :: solver = ""
    !> Reason of a fallback, empty without one.
    character(len=160) :: reason = ""
    !> Sum over all factorisations, with the first pivot, in block rows of the reduced system.
    type(perturbed_pivots_t) :: perturbed = perturbed_pivots_t()
  end type solve_info_t

contains

  !> Build the reduced system from stiffness, contact and right-hand sides, and solve it.
  subroutine solve_reduced(system, model, state, info, verdict)
    !> Gets the solution.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    !> State of the linearisation.
    type(state_t), intent(in) :: state
    !> Summed over the attempt.
    type(solve_info_t), intent(inout) :: info
    !> Retry if there is no solution.
    type(verdict_t), intent(out) :: verdict

    type(solver_report_t) :: report

    call system%profile%start()
    call reduce(system, model, state)
    call system%profile%add(section_assembly)
    if (system%solver%needs_positions) system%solver%positions = state%x
    system%column_square = system%formulation%squares(system%matrix, model%n_node) &
        + system%enhanced%unfollowed_square
    call system%solver%factor(system%matrix, verdict)
    call share_verdict(verdict)
    call system%profile%add(section_factorisation)
    call add_perturbed(system%solver%perturbed, info%perturbed)
    if (verdict%outcome == verdict_converged) then
      call solve_factorised(system, system%problem%solution, info, report)
      if (.not. report%converged) then
        verdict%outcome = verdict_retry
        verdict%cause = report%cause
        verdict%detail = report%reason
        verdict%norm = report%residual
        if (report%cause == cause_singular) verdict%row = system%solver%perturbed%row
      end if
      call share_verdict(verdict)
      if (verdict%outcome == verdict_converged) return
    else if (len_trim(info%solver) == 0) then
      info%solver = system%solver%method
    end if
    call name_row(model, verdict)
  end subroutine solve_reduced

  !> Turn the block row of a verdict into its node or tool. A tool whose row is empty or singular is
  !> lost: nothing resists it.
  pure subroutine name_row(model, verdict)
    type(model_t), intent(in) :: model
    type(verdict_t), intent(inout) :: verdict

    if (verdict%row <= model%n_node) then
      verdict%node = verdict%row
    else
      verdict%tool = findloc(model%tool_row, verdict%row, dim=1)
      if (verdict%cause == cause_singular) verdict%cause = cause_lost_tool
    end if
    verdict%row = 0
  end subroutine name_row

  !> Add the perturbed pivots of a factorisation.
  pure subroutine add_perturbed(pivots, sum)
    type(perturbed_pivots_t), intent(in) :: pivots
    type(perturbed_pivots_t), intent(inout) :: sum

    if (sum%blocks == 0) sum = perturbed_pivots_t(0, pivots%row, pivots%component)
    sum%blocks = sum%blocks + pivots%blocks
  end subroutine add_perturbed

  !> Solve the system factorised last for the present right-hand side.
  subroutine solve_factorised(system, solution, info, report)
    type(system_t), intent(inout) :: system
    !> `(3*n_row)`.
    real(wp), intent(out) :: solution(:)
    !> Summed over the attempt.
    type(solve_info_t), intent(inout) :: info
    type(solver_report_t), intent(out) :: report

    call system%profile%start()
    call system%solver%solve(system%problem%rhs, solution, report)
    call system%partition%share_solution(solution)
    call system%profile%add(section_solve)
    info%iterations = info%iterations + report%iterations
    if (len_trim(info%solver) == 0 .or. report%fallback) info%solver = report%method
    if (report%fallback) info%reason = report%reason
  end subroutine solve_factorised

end module dd3_system_solve
