! SPDX-License-Identifier: GPL-3.0-or-later
!> Direct solver: sparse LU factorisation by UMFPACK.
module dd3_linalg_umfpack_solver
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, cause_singular
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_residual, only : round_off_residual, true_residual
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_umfpack, only : direct_factors_t
  implicit none
  private
  public :: umfpack_solver_t, new_umfpack_solver, make_umfpack_solver

  !> Relative residual accepted where the tolerance asks for less.
  real(wp), parameter :: residual_limit = 1.0e-6_wp

  !> Direct solver of the library UMFPACK.
  type, extends(linear_solver_t) :: umfpack_solver_t
    type(direct_factors_t) :: factors
    !> Solution and residual, `(3n)`.
    real(wp), allocatable :: y(:), r(:)
  contains
    procedure :: setup_scaled => umfpack_solver_setup
    procedure :: factor_scaled => umfpack_solver_factor
    procedure :: solve_scaled => umfpack_solver_solve
    procedure :: release => umfpack_solver_release
  end type umfpack_solver_t

contains

  !> Create the solver for the registry.
  subroutine make_umfpack_solver(solver, options)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options

    type(umfpack_solver_t), allocatable :: made

    allocate (made)
    call new_umfpack_solver(made, options)
    call move_alloc(made, solver)
  end subroutine make_umfpack_solver

  !> Create the solver.
  subroutine new_umfpack_solver(self, options)
    type(umfpack_solver_t), intent(out) :: self
    type(solver_options_t), intent(in) :: options

    self%options = options
  end subroutine new_umfpack_solver

  !> Set up the pattern by columns.
  subroutine umfpack_solver_setup(self, matrix)
    class(umfpack_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    self%description = "UMFPACK"
    call self%factors%setup(matrix)
    if (allocated(self%y)) deallocate (self%y, self%r)
    allocate (self%y(3*matrix%n), self%r(3*matrix%n))
  end subroutine umfpack_solver_setup

  !> Factorise.
  subroutine umfpack_solver_factor(self, matrix, verdict)
    class(umfpack_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    self%method = "umfpack"
    call self%factors%factor(matrix, verdict)
  end subroutine umfpack_solver_factor

  !> Solve and check the true residual.
  subroutine umfpack_solver_solve(self, matrix, b, x, report)
    class(umfpack_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    real(wp) :: residual
    logical :: good

    report%method = "umfpack"
    call self%factors%solve(b, self%y, good)
    if (.not. good) then
      report%reason = "the direct solver found no solution"
      return
    end if
    call true_residual(matrix, b, self%y, self%r, residual)
    if (ieee_is_finite(residual)) then
      if (residual < report%residual) then
        report%residual = residual
        x = self%y
      end if
    end if
    report%converged = report%residual <= max(residual_limit, self%options%tolerance, &
        round_off_residual(matrix, b, self%y))
    if (report%converged) return
    report%cause = cause_singular
    report%reason = "the direct solution does not satisfy the system: nearly singular"
  end subroutine umfpack_solver_solve

  !> Free UMFPACK's factors.
  subroutine umfpack_solver_release(self)
    class(umfpack_solver_t), intent(inout) :: self

    self%method = ""
    call self%factors%release()
  end subroutine umfpack_solver_release

end module dd3_linalg_umfpack_solver
