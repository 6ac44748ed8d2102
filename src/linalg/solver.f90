! SPDX-License-Identifier: GPL-3.0-or-later
!> Abstract linear solver: set up once per sparsity pattern, factorised once per matrix, solved once
!> per right-hand side.
!>
!> What all solvers share is done here: they work on a renumbered, row-scaled copy of the system and
!> on right-hand sides of unit length. A solver implements `setup_scaled`, `factor_scaled` and
!> `solve_scaled` on that copy, and `release` if it holds memory outside Fortran.
module dd3_linalg_solver
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : i8, wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_base_verdict, only : verdict_t, verdict_converged, cause_singular, cause_solver
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_ordering, only : find_ordering
  use dd3_linalg_partition, only : order_by_owner
  use dd3_linalg_preconditioner, only : perturbed_pivots_t
  use dd3_linalg_residual, only : dot
  use dd3_linalg_scaled_system, only : scaled_system_t
  implicit none
  private
  public :: linear_solver_t, solver_options_t, solver_report_t

  !> Choice and settings of a solver. The initial values mean "not set" and are refused by
  !> `new_linear_solver`; defaults are the input's.
  type :: solver_options_t
    !> Name in the solver registry.
    character(len=24) :: method = ""
    !> Level of fill of the incomplete factorisation; complete from the number of block rows on.
    integer :: ilu_level = -1
    !> Target residual of the row-scaled system, relative to the right-hand side.
    real(wp) :: tolerance = 0.0_wp
    !> Maximum number of iterations, restarts included.
    integer :: iterations = 0
    !> Numbering of the block rows, see `ordering_names`.
    character(len=24) :: ordering = ""
    !> Number of threads; the results do not depend on it.
    integer :: threads = 1
    !> Whether the matrix keeps its values where the solver has a copy.
    logical :: keeps_matrix = .true.
    !> Folder in which MUMPS keeps its factors; empty for the memory.
    character(len=255) :: factor_folder = ""
  end type solver_options_t

  !> Outcome of one solution.
  type :: solver_report_t
    !> Solver that gave the solution.
    character(len=24) :: method = ""
    !> Whether the residual is small enough.
    logical :: converged = .false.
    !> Iterations, restarts included, and number of restarts.
    integer :: iterations = 0, restarts = 0
    !> |b - A x|/|b| of the row-scaled system, evaluated for the solution returned.
    real(wp) :: residual = huge(1.0_wp)
    !> Whether the direct solver replaced the iterative one.
    logical :: fallback = .false.
    !> One of the `cause_*` values of a verdict, if not converged.
    integer :: cause = cause_solver
    !> Reason for the fallback or for the failure, else empty.
    character(len=160) :: reason = ""
  end type solver_report_t

  !> Solver of A x = b.
  type, abstract :: linear_solver_t
    type(solver_options_t) :: options
    !> One line for the log, known after `setup`.
    character(len=160) :: description = ""
    !> Solver that the present matrix is factorised for; empty if there is none.
    character(len=24) :: method = ""
    !> Of the present factorisation; set by `factor_scaled` in the numbering of the copy, after
    !> `factor` in that of the matrix.
    type(perturbed_pivots_t) :: perturbed = perturbed_pivots_t()
    !> Renumbered and scaled copy of the system.
    type(scaled_system_t) :: system
    !> The matrix, in `factor_scaled`: for a solver whose copy has no values.
    type(block_matrix_t), pointer :: original => null()
    !> Whether the solver needs the positions of the nodes, and these, `(3, n_node)`, mm, set before
    !> `factor`. The block rows of the nodes are the first ones.
    logical :: needs_positions = .false.
    real(wp), allocatable :: positions(:, :)
    !> Right-hand side and solution in its numbering, `(3n)`.
    real(wp), allocatable, private :: scaled_b(:), scaled_x(:)
  contains
    procedure, non_overridable :: setup
    procedure, non_overridable :: factor
    procedure, non_overridable :: solve
    procedure(setup_interface), deferred :: setup_scaled
    procedure(factor_interface), deferred :: factor_scaled
    procedure(solve_interface), deferred :: solve_scaled
    procedure :: release
    procedure, non_overridable :: bytes
    procedure :: factor_bytes
  end type linear_solver_t

  abstract interface
    !> Prepare for matrices of one pattern; set `description`.
    subroutine setup_interface(self, matrix)
      import :: linear_solver_t, block_matrix_t
      class(linear_solver_t), intent(inout) :: self
      !> Scaled matrix of the pattern; its values must not be used.
      type(block_matrix_t), intent(in) :: matrix
    end subroutine setup_interface

    !> Factorise a scaled matrix; set `method`, and `perturbed` if pivots were.
    subroutine factor_interface(self, matrix, verdict)
      import :: linear_solver_t, block_matrix_t, verdict_t
      class(linear_solver_t), intent(inout) :: self
      !> Scaled matrix of the pattern set up.
      type(block_matrix_t), intent(in) :: matrix
      !> Retry if the matrix is singular; `row` is set if a block row is to blame.
      type(verdict_t), intent(out) :: verdict
    end subroutine factor_interface

    !> Solve with the matrix factorised last.
    subroutine solve_interface(self, matrix, b, x, report)
      import :: linear_solver_t, block_matrix_t, solver_report_t, wp
      class(linear_solver_t), intent(inout) :: self
      !> Scaled matrix factorised last.
      type(block_matrix_t), intent(in) :: matrix
      !> Right-hand side of unit length, `(3n)`.
      real(wp), intent(in) :: b(:)
      !> Best solution known so far, with `report%residual`; replaced by a better one, `(3n)`.
      real(wp), intent(inout) :: x(:)
      type(solver_report_t), intent(inout) :: report
    end subroutine solve_interface
  end interface

contains

  !> Prepare for matrices of one pattern.
  subroutine setup(self, matrix, rows)
    class(linear_solver_t), intent(inout) :: self
    !> Matrix of the pattern; its values are not used.
    type(block_matrix_t), intent(in) :: matrix
    !> Block rows that are solved, in this order; the unknowns of the others are zero.
    integer, intent(in), optional :: rows(:)

    type(error_t), allocatable :: error
    integer, allocatable :: order(:)

    call self%release()
    if (present(rows)) then
      order = rows
    else if (allocated(matrix%owner)) then
      order = order_by_owner(matrix)
    else
      call find_ordering(trim(self%options%ordering), matrix, order, error)
      if (allocated(error)) call find_ordering("none", matrix, order, error)
    end if
    call self%system%setup(matrix, order)
    if (allocated(self%scaled_b)) deallocate (self%scaled_b, self%scaled_x)
    allocate (self%scaled_b(3*size(order)), self%scaled_x(3*size(order)))
    call self%setup_scaled(self%system%matrix)
  end subroutine setup

  !> Copy, scale and factorise a matrix of the pattern set up.
  subroutine factor(self, matrix, verdict)
    class(linear_solver_t), intent(inout) :: self
    !> Loses its values if the options say so and the solver has a copy.
    type(block_matrix_t), intent(inout), target :: matrix
    !> Retry if the matrix is singular or not finite; `row` is set if a block row is to blame.
    type(verdict_t), intent(out) :: verdict

    self%method = ""
    self%perturbed = perturbed_pivots_t()
    call self%system%fill(matrix, verdict)
    self%original => matrix
    if (verdict%outcome == verdict_converged) call self%factor_scaled(self%system%matrix, verdict)
    self%original => null()
    associate (order => self%system%order, row => self%perturbed%row)
      if (verdict%row > 0) verdict%row = order(verdict%row)
      if (row > 0) row = order(row)
    end associate
  end subroutine factor

  !> Solve with the matrix factorised last.
  subroutine solve(self, b, x, report)
    class(linear_solver_t), intent(inout) :: self
    !> Right-hand side, `(3n)`.
    real(wp), intent(in) :: b(:)
    !> Solution, or the best approximation found, `(3n)`.
    real(wp), intent(out) :: x(:)
    type(solver_report_t), intent(out) :: report

    character(len=*), parameter :: singular = "the matrix is singular: "
    real(wp) :: length, square(1)

    x = 0.0_wp
    report%method = self%method
    call self%system%scale_rhs(b, self%scaled_b)
    square = dot(self%scaled_b, self%scaled_b)
    call sum_over_ranks(1, square)
    length = sqrt(square(1))
    if (.not. ieee_is_finite(length)) then
      report%reason = "the right-hand side is not finite"
      return
    end if
    if (length <= sqrt(tiny(length))) then
      report%converged = .true.
      report%residual = 0.0_wp
      return
    end if
    self%scaled_b = self%scaled_b/length
    self%scaled_x = 0.0_wp
    report%residual = 1.0_wp
    call self%solve_scaled(self%system%matrix, self%scaled_b, self%scaled_x, report)
    if (self%perturbed%blocks > 0 .and. .not. report%converged) then
      report%cause = cause_singular
      report%reason = singular//report%reason(:len(report%reason) - len(singular))
    end if
    self%scaled_x = length*self%scaled_x
    call self%system%restore_order(self%scaled_x, x)
  end subroutine solve

  !> Return the memory that the solver takes, bytes; known after `setup`.
  real(wp) function bytes(self)
    class(linear_solver_t), intent(in) :: self

    !> Bytes of a block of the copy, with its column and its position in the original.
    real(wp), parameter :: per_block = 80.0_wp

    bytes = self%factor_bytes() &
        + per_block*real(size(self%system%matrix%column, kind=i8), wp)
  end function bytes

  !> Return the memory of the factors, bytes; 0 if it is not known before the factorisation.
  real(wp) function factor_bytes(self)
    class(linear_solver_t), intent(in) :: self

    factor_bytes = 0.0_wp
  end function factor_bytes

  !> Release the factors held outside Fortran; the solver can be set up again.
  subroutine release(self)
    class(linear_solver_t), intent(inout) :: self

    self%method = ""
  end subroutine release

end module dd3_linalg_solver
