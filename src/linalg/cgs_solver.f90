! SPDX-License-Identifier: GPL-3.0-or-later
!> Iterative solver: conjugate gradients squared, preconditioned by ILU(k).
module dd3_linalg_cgs_solver
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_linalg_cgs, only : cgs_t
  use dd3_linalg_ilu, only : ilu_t, new_ilu
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  implicit none
  private
  public :: cgs_solver_t, new_cgs_solver, make_cgs_solver

  !> CGS with ILU(k).
  type, extends(linear_solver_t) :: cgs_solver_t
    type(ilu_t) :: preconditioner
    type(cgs_t) :: iteration
  contains
    procedure :: setup_scaled => cgs_solver_setup
    procedure :: factor_scaled => cgs_solver_factor
    procedure :: solve_scaled => cgs_solver_solve
    procedure :: factor_bytes => cgs_solver_factor_bytes
  end type cgs_solver_t

contains

  !> Create the solver for the registry.
  subroutine make_cgs_solver(solver, options)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options

    type(cgs_solver_t), allocatable :: made

    allocate (made)
    call new_cgs_solver(made, options)
    call move_alloc(made, solver)
  end subroutine make_cgs_solver

  !> Create the solver.
  subroutine new_cgs_solver(self, options)
    type(cgs_solver_t), intent(out) :: self
    type(solver_options_t), intent(in) :: options

    self%options = options
    call new_ilu(self%preconditioner, options%ilu_level)
  end subroutine new_cgs_solver

  !> Set up the preconditioner and the vectors of the iteration.
  subroutine cgs_solver_setup(self, matrix)
    class(cgs_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    call self%preconditioner%setup(matrix)
    self%description = "CGS with "//self%preconditioner%description
    call self%iteration%setup(3*matrix%n, self%options%tolerance, self%options%iterations)
  end subroutine cgs_solver_setup

  !> Build the preconditioner.
  subroutine cgs_solver_factor(self, matrix, verdict)
    class(cgs_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    self%method = "cgs"
    call self%preconditioner%build(matrix, verdict)
  end subroutine cgs_solver_factor

  !> Iterate.
  subroutine cgs_solver_solve(self, matrix, b, x, report)
    class(cgs_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    call self%iteration%solve(matrix, self%preconditioner, b, x)
    call self%iteration%add_to(report)
  end subroutine cgs_solver_solve

  !> Return the memory of the preconditioner, bytes.
  real(wp) function cgs_solver_factor_bytes(self) result(bytes)
    class(cgs_solver_t), intent(in) :: self

    bytes = self%preconditioner%bytes()
  end function cgs_solver_factor_bytes

end module dd3_linalg_cgs_solver
