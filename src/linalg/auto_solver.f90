!> Automatic choice: CGS, with UMFPACK as fallback.
!>
!> After several failures in a row on one pattern, CGS is skipped for a number of factorisations,
!> tried again, and skipped for twice that number after each further failure.
module dd3_linalg_auto_solver
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_cgs_solver, only : cgs_solver_t, new_cgs_solver
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_umfpack_solver, only : umfpack_solver_t, new_umfpack_solver
  implicit none
  private
  public :: auto_solver_t, make_auto_solver, memory_failures, memory_rest, memory_next_rest

  !> Entries of `memory`: consecutive failures of CGS, factorisations for which it is still skipped,
  !> and length of the next such rest.
  integer, parameter :: memory_failures = 1, memory_rest = 2, memory_next_rest = 3
  !> Number of these entries.
  integer, parameter :: memory_size = 3
  !> Consecutive failures that start a rest.
  integer, parameter :: failures_allowed = 3
  !> Shortest and longest rest, in factorisations.
  integer, parameter :: first_rest = 20, longest_rest = 320

  !> CGS with UMFPACK as fallback.
  type, extends(linear_solver_t) :: auto_solver_t
    type(cgs_solver_t) :: cgs
    type(umfpack_solver_t) :: direct
    !> Whether `direct` is set up; done on first use.
    logical :: direct_set_up = .false.
    !> Whether CGS and UMFPACK can solve with the present matrix.
    logical :: cgs_ready = .false., direct_ready = .false.
    !> Whether a failure of CGS with the present matrix has been recorded.
    logical :: failure_recorded = .false.
    !> Why UMFPACK is used for the present matrix.
    character(len=160) :: reason = ""
  contains
    procedure :: setup_scaled => auto_solver_setup
    procedure :: factor_scaled => auto_solver_factor
    procedure :: solve_scaled => auto_solver_solve
    procedure :: release => auto_solver_release
  end type auto_solver_t

contains

  !> Create the solver for the registry.
  subroutine make_auto_solver(solver, options)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options

    type(auto_solver_t), allocatable :: made

    allocate (made)
    made%options = options
    call new_cgs_solver(made%cgs, options, may_raise=.true.)
    call new_umfpack_solver(made%direct, options)
    call move_alloc(made, solver)
  end subroutine make_auto_solver

  !> Set up CGS and forget earlier failures.
  subroutine auto_solver_setup(self, matrix)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    call self%cgs%setup_scaled(matrix)
    self%description = trim(self%cgs%description)//", UMFPACK to fall back on"
    allocate (self%memory(memory_size))
    self%memory(memory_failures) = 0
    self%memory(memory_rest) = 0
    self%memory(memory_next_rest) = first_rest
  end subroutine auto_solver_setup

  !> Build the preconditioner, or the direct factors if CGS is skipped or cannot start.
  subroutine auto_solver_factor(self, matrix, verdict)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    self%cgs_ready = .false.
    self%direct_ready = .false.
    self%failure_recorded = .false.
    self%reason = ""
    if (self%memory(memory_rest) == 0) then
      call self%cgs%factor_scaled(matrix, verdict)
      self%cgs_ready = verdict%outcome == verdict_converged
      if (.not. self%cgs_ready) call record_failure(self, verdict%reason)
    else
      self%memory(memory_rest) = self%memory(memory_rest) - 1
      self%reason = "CGS skipped after "//to_text(self%memory(memory_failures)) &
          //" failures in a row"
    end if
    if (.not. self%cgs_ready) call factor_directly(self, matrix, verdict)
    self%method = merge("cgs    ", "umfpack", self%cgs_ready)
  end subroutine auto_solver_factor

  !> Factorise by UMFPACK.
  subroutine factor_directly(self, matrix, verdict)
    type(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    if (.not. self%direct_set_up) call self%direct%setup_scaled(matrix)
    self%direct_set_up = .true.
    call self%direct%factor_scaled(matrix, verdict)
    self%direct_ready = verdict%outcome == verdict_converged
  end subroutine factor_directly

  !> Count a failure of CGS, once per matrix; too many start a rest.
  subroutine record_failure(self, reason)
    type(auto_solver_t), intent(inout) :: self
    character(len=*), intent(in) :: reason

    self%reason = reason
    if (self%failure_recorded) return
    self%failure_recorded = .true.
    associate (failures => self%memory(memory_failures), rest => self%memory(memory_rest), &
        next_rest => self%memory(memory_next_rest))
      failures = failures + 1
      if (failures < failures_allowed) return
      rest = next_rest
      next_rest = min(2*next_rest, longest_rest)
    end associate
  end subroutine record_failure

  !> Solve by CGS if it is ready, else or on failure by UMFPACK.
  subroutine auto_solver_solve(self, matrix, b, x, report)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    type(verdict_t) :: verdict

    if (self%cgs_ready) then
      call self%cgs%solve_scaled(matrix, b, x, report)
      if (report%converged) then
        self%memory(memory_failures) = 0
        self%memory(memory_next_rest) = first_rest
        return
      end if
      call record_failure(self, trim(report%reason))
    end if
    report%fallback = .true.
    report%reason = self%reason
    if (.not. self%direct_ready) call factor_directly(self, matrix, verdict)
    if (self%direct_ready) then
      call self%direct%solve_scaled(matrix, b, x, report)
    else
      report%reason = verdict%reason
    end if
  end subroutine auto_solver_solve

  !> Free UMFPACK's factors.
  subroutine auto_solver_release(self)
    class(auto_solver_t), intent(inout) :: self

    self%method = ""
    call self%direct%release()
    self%direct_set_up = .false.
    self%direct_ready = .false.
  end subroutine auto_solver_release

end module dd3_linalg_auto_solver
