! SPDX-License-Identifier: GPL-3.0-or-later
!> Direct solver: complete LU factorisation by MUMPS, refined by conjugate gradients squared.
module dd3_linalg_mumps_solver
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_external_mumps_library, only : library_present
  use dd3_linalg_cgs, only : cgs_t
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_mumps, only : mumps_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  implicit none
  private
  public :: mumps_solver_t, new_mumps_solver, make_mumps_solver, mumps_package

  !> Largest number of refinements.
  integer, parameter :: most_refinements = 10
  !> Debian package that the program was built without; empty if it has MUMPS.
  character(len=*), parameter :: mumps_package = merge("                ", "libmumps-seq-dev", &
      library_present)

  !> Direct solver of the library MUMPS.
  type, extends(linear_solver_t) :: mumps_solver_t
    type(mumps_t) :: factors
    type(cgs_t) :: iteration
  contains
    procedure :: setup_scaled => mumps_solver_setup
    procedure :: factor_scaled => mumps_solver_factor
    procedure :: solve_scaled => mumps_solver_solve
    procedure :: release => mumps_solver_release
    procedure :: factor_bytes => mumps_solver_factor_bytes
  end type mumps_solver_t

contains

  !> Create the solver for the registry.
  subroutine make_mumps_solver(solver, options)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options

    type(mumps_solver_t), allocatable :: made

    allocate (made)
    call new_mumps_solver(made, options)
    call move_alloc(made, solver)
  end subroutine make_mumps_solver

  !> Create the solver.
  subroutine new_mumps_solver(self, options)
    type(mumps_solver_t), intent(out) :: self
    type(solver_options_t), intent(in) :: options

    self%options = options
  end subroutine new_mumps_solver

  !> Analyse the pattern.
  subroutine mumps_solver_setup(self, matrix)
    class(mumps_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    self%factors%folder = self%options%factor_folder
    call self%factors%setup(matrix)
    self%description = self%factors%description
    call self%iteration%setup(3*matrix%n, self%options%tolerance, most_refinements)
  end subroutine mumps_solver_setup

  !> Factorise.
  subroutine mumps_solver_factor(self, matrix, verdict)
    class(mumps_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    self%method = "mumps"
    call self%factors%build(matrix, verdict)
    self%perturbed = self%factors%perturbed
  end subroutine mumps_solver_factor

  !> Solve and refine.
  subroutine mumps_solver_solve(self, matrix, b, x, report)
    class(mumps_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    call self%iteration%solve(matrix, self%factors, b, x)
    report%method = "mumps"
    call self%iteration%add_to(report)
  end subroutine mumps_solver_solve

  !> Free MUMPS's factors.
  subroutine mumps_solver_release(self)
    class(mumps_solver_t), intent(inout) :: self

    self%method = ""
    call self%factors%release()
  end subroutine mumps_solver_release

  !> Return the memory of the factors and of the workspace, bytes.
  real(wp) function mumps_solver_factor_bytes(self) result(bytes)
    class(mumps_solver_t), intent(in) :: self

    bytes = self%factors%bytes()
  end function mumps_solver_factor_bytes

end module dd3_linalg_mumps_solver
