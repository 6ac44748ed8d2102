!> Iterative solver, direct solver, or the first with the second to fall back on; all work on a
!> renumbered and scaled copy of the system, and judge a solution by its true residual.
!>
!> Where the iteration fails several times in a row on a pattern, the direct solver is taken at once
!> for a number of factorisations; then the iteration gets another chance, and after each further
!> failure a longer rest.
module dd3_linalg_combined_solver
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_cgs, only : cgs_t, dot, true_residual
  use dd3_linalg_ilu, only : ilu_t, new_ilu
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_ordering, only : find_ordering
  use dd3_linalg_scaled_system, only : scaled_system_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_umfpack, only : direct_factors_t
  implicit none
  private
  public :: combined_solver_t, new_combined_solver

  !> Failures in a row after which the iteration rests.
  integer, parameter :: failures_allowed = 3
  !> Factorisations of the first rest, and of the longest.
  integer, parameter :: first_rest = 20, longest_rest = 320
  !> Relative residual up to which a direct solution counts as one.
  real(wp), parameter :: direct_limit = 1.0e-6_wp

  !> An iterative and a direct solver.
  type, extends(linear_solver_t) :: combined_solver_t
    !> Which of the two are used.
    logical :: has_iterative = .true., has_direct = .true.
    !> Copy of the system.
    type(scaled_system_t) :: system
    !> Approximate inverse of the iteration.
    type(ilu_t) :: preconditioner
    !> The iteration.
    type(cgs_t) :: iteration
    !> Factors of the direct solver.
    type(direct_factors_t) :: factors
    !> Whether the direct solver knows the pattern.
    logical :: direct_set_up = .false.
    !> Which of the two can solve with the present matrix.
    logical :: iterative_ready = .false., direct_ready = .false.
    !> Failures of the iteration in a row, factorisations left of its rest, and length of the next
    !> one.
    integer :: failures = 0, rest = 0, next_rest = first_rest
    !> Whether the iteration has failed with the present matrix, and why the direct solver stands in
    !> for it.
    logical :: failed = .false.
    !> See `failed`.
    character(len=160) :: reason = ""
    !> Right-hand side, solution, the direct solution and its residual in the copy's numbering,
    !> `(3n)`.
    real(wp), allocatable :: b(:), x(:), y(:), r(:)
  contains
    procedure :: setup => combined_setup
    procedure :: factor => combined_factor
    procedure :: solve => combined_solve
    procedure :: release => combined_release
  end type combined_solver_t

contains

  !> Makes a solver.
  subroutine new_combined_solver(self, options, iterative, direct)
    !> The solver made.
    type(combined_solver_t), intent(out) :: self
    !> The choices.
    type(solver_options_t), intent(in) :: options
    !> Which of the two are used.
    logical, intent(in) :: iterative, direct

    self%options = options
    allocate (self%memory(0))
    self%has_iterative = iterative
    self%has_direct = direct
    call new_ilu(self%preconditioner, options%ilu_level, may_raise=iterative .and. direct)
  end subroutine new_combined_solver

  !> Prepares for matrices of one pattern.
  subroutine combined_setup(self, matrix)
    !> The solver.
    class(combined_solver_t), intent(inout) :: self
    !> A matrix of the pattern.
    type(block_matrix_t), intent(in) :: matrix
    type(error_t), allocatable :: error
    integer, allocatable :: order(:)
    integer :: n

    call self%release()
    n = 3*matrix%n
    self%description = ""
    call find_ordering(trim(self%options%ordering), matrix, order, error)
    if (allocated(error)) call find_ordering("none", matrix, order, error)
    call self%system%setup(matrix, order)
    if (self%has_iterative) then
      call self%preconditioner%setup(self%system%matrix)
      self%description = "CGS with "//self%preconditioner%description
      call self%iteration%setup(n, self%options%tolerance, self%options%iterations)
    end if
    if (self%has_direct .and. self%has_iterative) then
      self%description = trim(self%description)//", UMFPACK to fall back on"
    else if (self%has_direct) then
      self%description = "UMFPACK"
    end if
    if (allocated(self%b)) deallocate (self%b, self%x, self%y, self%r)
    allocate (self%b(n), self%x(n), self%y(n), self%r(n))
    self%failures = 0
    self%rest = 0
    self%next_rest = first_rest
  end subroutine combined_setup

  !> Factorises: the preconditioner, or the direct factors where the iteration is not used, rests,
  !> or cannot start.
  subroutine combined_factor(self, matrix, verdict)
    !> The solver.
    class(combined_solver_t), intent(inout) :: self
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix
    !> Retry for a matrix that cannot be solved with.
    type(verdict_t), intent(out) :: verdict

    self%iterative_ready = .false.
    self%direct_ready = .false.
    self%failed = .false.
    self%reason = ""
    call self%system%fill(matrix, verdict)
    if (verdict%outcome /= verdict_converged) return
    if (self%has_iterative .and. self%rest == 0) then
      call self%preconditioner%build(self%system%matrix, verdict)
      self%iterative_ready = verdict%outcome == verdict_converged
      if (.not. self%iterative_ready .and. self%has_direct) call note_failure(self, verdict%reason)
    else if (self%has_iterative) then
      self%rest = self%rest - 1
      self%reason = "CGS rests after "//to_text(self%failures)//" failures in a row"
    end if
    if (self%has_direct .and. .not. self%iterative_ready) call factor_directly(self, verdict)
  end subroutine combined_factor

  !> Makes the direct factors.
  subroutine factor_directly(self, verdict)
    !> The solver.
    type(combined_solver_t), intent(inout) :: self
    !> Retry for a singular matrix.
    type(verdict_t), intent(out) :: verdict

    if (.not. self%direct_set_up) call self%factors%setup(self%system%matrix)
    self%direct_set_up = .true.
    call self%factors%factor(self%system%matrix, verdict)
    self%direct_ready = verdict%outcome == verdict_converged
  end subroutine factor_directly

  !> Remembers that the iteration failed with the present matrix.
  subroutine note_failure(self, reason)
    !> The solver.
    type(combined_solver_t), intent(inout) :: self
    !> Why.
    character(len=*), intent(in) :: reason

    self%reason = reason
    if (self%failed) return
    self%failed = .true.
    self%failures = self%failures + 1
    if (self%failures < failures_allowed) return
    self%rest = self%next_rest
    self%next_rest = min(2*self%next_rest, longest_rest)
  end subroutine note_failure

  !> Solves with the matrix factorised last.
  subroutine combined_solve(self, b, x, report)
    !> The solver.
    class(combined_solver_t), intent(inout) :: self
    !> Right-hand side.
    real(wp), intent(in) :: b(:)
    !> Solution.
    real(wp), intent(out) :: x(:)
    !> What it took.
    type(solver_report_t), intent(out) :: report
    real(wp) :: length

    x = 0.0_wp
    report%method = merge("cgs    ", "umfpack", self%iterative_ready)
    call self%system%scale_rhs(b, self%b)
    length = sqrt(dot(self%b, self%b))
    if (.not. ieee_is_finite(length)) then
      report%reason = "the right-hand side is not finite"
      return
    end if
    if (length <= sqrt(tiny(length))) then
      report%converged = .true.
      report%residual = 0.0_wp
      return
    end if
    self%b = self%b/length
    self%x = 0.0_wp
    report%residual = 1.0_wp
    if (self%iterative_ready) call solve_iteratively(self, report)
    if (self%has_direct .and. .not. report%converged) call solve_directly(self, report)
    self%x = length*self%x
    call self%system%give_back(self%x, x)
  end subroutine combined_solve

  !> Solves by the iteration.
  subroutine solve_iteratively(self, report)
    !> The solver.
    type(combined_solver_t), intent(inout) :: self
    !> What it took.
    type(solver_report_t), intent(inout) :: report

    call self%iteration%solve(self%system%matrix, self%preconditioner, self%b, self%x)
    report%converged = self%iteration%converged
    report%iterations = self%iteration%iterations
    report%restarts = self%iteration%restarts
    report%residual = self%iteration%residual
    report%reason = self%iteration%reason
    if (report%converged) then
      self%failures = 0
      self%next_rest = first_rest
    else if (self%has_direct) then
      call note_failure(self, self%iteration%reason)
    end if
  end subroutine solve_iteratively

  !> Solves with the direct factors, which are made now if need be; keeps the better of two
  !> solutions.
  subroutine solve_directly(self, report)
    !> The solver.
    type(combined_solver_t), intent(inout) :: self
    !> What it took.
    type(solver_report_t), intent(inout) :: report
    type(verdict_t) :: verdict
    real(wp) :: residual
    logical :: good

    report%fallback = self%has_iterative
    report%reason = self%reason
    if (.not. self%direct_ready) call factor_directly(self, verdict)
    if (.not. self%direct_ready) then
      report%reason = trim(verdict%reason)
      return
    end if
    call self%factors%solve(self%b, self%y, good)
    report%method = "umfpack"
    if (.not. good) then
      report%reason = "the direct solver found no solution"
      return
    end if
    call true_residual(self%system%matrix, self%b, self%y, self%r, residual)
    if (ieee_is_finite(residual)) then
      if (residual < report%residual) then
        report%residual = residual
        self%x = self%y
      end if
    end if
    report%converged = report%residual <= max(direct_limit, self%options%tolerance)
    if (.not. report%converged) &
      report%reason = "the direct solution does not satisfy the system: nearly singular"
  end subroutine solve_directly

  !> Gives back what UMFPACK holds.
  subroutine combined_release(self)
    !> The solver.
    class(combined_solver_t), intent(inout) :: self

    call self%factors%release()
    self%direct_set_up = .false.
    self%direct_ready = .false.
  end subroutine combined_release

end module dd3_linalg_combined_solver
