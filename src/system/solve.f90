!> One solution of the reduced system.
module dd3_system_solve
  use dd3_base_clock, only : section_assembly, section_factorisation, section_solve
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_linalg_solver, only : solver_report_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_system_reduced, only : reduce
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: solve_info_t, solve_reduced

  !> What the linear solver did in an increment.
  type :: solve_info_t
    !> Sum of its iterations.
    integer :: iterations = 0
    !> The solver that ran; where one stood in for another, that one.
    character(len=24) :: solver = ""
    !> Why the iterative solver gave up, empty where it did not.
    character(len=160) :: reason = ""
  end type solve_info_t

contains

  !> Builds the reduced system from stiffness, contact and right-hand sides, and solves it.
  subroutine solve_reduced(self, model, phase, info, verdict)
    !> Matrices, right-hand sides and solver; gets the solution.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> What the solver did, added up over an increment.
    type(solve_info_t), intent(inout) :: info
    !> Whether there is a solution.
    type(verdict_t), intent(out) :: verdict

    type(solver_report_t) :: report

    call self%profile%start()
    call reduce(model, phase, self%contact, self%stiffness, self%problem, self%reduced)
    call self%profile%add(section_assembly)
    call self%solver%factor(self%reduced, verdict)
    call self%profile%add(section_factorisation)
    if (verdict%node > model%n_node) call name_tool(model, verdict)
    if (verdict%outcome /= verdict_converged) return
    call self%solver%solve(self%problem%rhs, self%problem%solution, report)
    call self%profile%add(section_solve)
    info%iterations = info%iterations + report%iterations
    if (len_trim(info%solver) == 0 .or. report%fallback) info%solver = report%method
    if (report%fallback) info%reason = report%reason
    if (.not. report%converged) then
      verdict%outcome = verdict_retry
      verdict%reason = "linear solver: "//report%reason(:len(verdict%reason) - 15)
      verdict%norm = report%residual
    end if
  end subroutine solve_reduced

  !> Puts the tool in the place of its block row, which is empty where nothing resists the tool.
  subroutine name_tool(model, verdict)
    !> The model.
    type(model_t), intent(in) :: model
    !> The verdict on the matrix.
    type(verdict_t), intent(inout) :: verdict

    verdict%tool = findloc(model%tool_block, verdict%node, dim=1)
    verdict%node = 0
    verdict%reason = "nothing resists the pressed tool "//model%tool(verdict%tool)%name
  end subroutine name_tool

end module dd3_system_solve
