!> What every solver of linear systems provides: a set-up once per pattern, a factorisation per
!> matrix, solutions per right-hand side, and a report that says what was really done.
module dd3_linalg_solver
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: linear_solver_t, solver_options_t, solver_report_t

  !> What the user can choose.
  type :: solver_options_t
    !> Name of the solver: cgs, umfpack or auto.
    character(len=24) :: method = "auto"
    !> Level of fill of the incomplete factorisation; any level from the number of rows on is a
    !> complete one. `auto` may take a complete one where it costs no more than the iterations it
    !> saves.
    integer :: ilu_level = 2
    !> Residual wanted, relative to the right-hand side, rows scaled.
    real(wp) :: tolerance = 1.0e-10_wp
    !> Iterations allowed, restarts included.
    integer :: iterations = 200
    !> Numbering of the incomplete factorisation: none, amd or rcm.
    character(len=24) :: ordering = "none"
  end type solver_options_t

  !> What a solution took. Residuals are those of the system whose rows have been scaled to one.
  type :: solver_report_t
    !> Solver that gave the solution.
    character(len=24) :: method = ""
    !> Whether the residual wanted was reached.
    logical :: converged = .false.
    !> Iterations made, restarts included, and restarts made.
    integer :: iterations = 0, restarts = 0
    !> |b - A x|/|b|, computed from the solution returned.
    real(wp) :: residual = huge(1.0_wp)
    !> Whether the direct solver stood in for the iterative one.
    logical :: fallback = .false.
    !> Why it did, or why the solution failed; empty when all went well.
    character(len=160) :: reason = ""
  end type solver_report_t

  !> A solver of A x = b.
  type, abstract :: linear_solver_t
    !> The choices it was made with.
    type(solver_options_t) :: options
    !> What it does, for the log; known after the set-up.
    character(len=160) :: description = ""
    integer, allocatable :: memory(:)
  contains
    !> Once per pattern.
    procedure(setup_interface), deferred :: setup
    !> Once per matrix.
    procedure(factor_interface), deferred :: factor
    !> Once per right-hand side.
    procedure(solve_interface), deferred :: solve
    !> Gives back what the solver holds outside Fortran.
    procedure(release_interface), deferred :: release
  end type linear_solver_t

  abstract interface
    !> Prepares for matrices of one pattern.
    subroutine setup_interface(self, matrix)
      import :: linear_solver_t, block_matrix_t
      !> The solver.
      class(linear_solver_t), intent(inout) :: self
      !> A matrix of the pattern; its values are not read.
      type(block_matrix_t), intent(in) :: matrix
    end subroutine setup_interface

    !> Factorises a matrix of the pattern set up.
    subroutine factor_interface(self, matrix, verdict)
      import :: linear_solver_t, block_matrix_t, verdict_t
      !> The solver.
      class(linear_solver_t), intent(inout) :: self
      !> The matrix; it is copied.
      type(block_matrix_t), intent(in) :: matrix
      !> Retry for a matrix that cannot be solved with: singular, or not finite.
      type(verdict_t), intent(out) :: verdict
    end subroutine factor_interface

    !> Solves with the matrix factorised last.
    subroutine solve_interface(self, b, x, report)
      import :: linear_solver_t, solver_report_t, wp
      !> The solver.
      class(linear_solver_t), intent(inout) :: self
      !> Right-hand side, `(3n)`.
      real(wp), intent(in) :: b(:)
      !> Solution, `(3n)`; the best one found where none was good enough.
      real(wp), intent(out) :: x(:)
      !> What it took.
      type(solver_report_t), intent(out) :: report
    end subroutine solve_interface

    !> Gives back what the solver holds outside Fortran; it can be set up again afterwards.
    subroutine release_interface(self)
      import :: linear_solver_t
      !> The solver.
      class(linear_solver_t), intent(inout) :: self
    end subroutine release_interface
  end interface

end module dd3_linalg_solver
