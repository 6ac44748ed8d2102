! SPDX-License-Identifier: GPL-3.0-or-later
!> Automatic choice of the solver: the complete factorisation on blocks, by rows or by fronts as the
!> counted operations say, and UMFPACK, which interchanges rows freely, where that fails. The choice
!> depends on the matrix alone. CGS with an incomplete factorisation is not considered: on sheets
!> its iterations grow as contact and plasticity spread, see docs/reports/solvers.md. MUMPS is not
!> either: it takes longer, and results would depend on whether the program was built with it.
module dd3_linalg_auto_solver
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_block_lu_solver, only : block_lu_solver_t, new_block_lu_solver
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_umfpack_solver, only : umfpack_solver_t, new_umfpack_solver
  implicit none
  private
  public :: auto_solver_t, make_auto_solver

  !> The complete factorisation, and UMFPACK.
  type, extends(linear_solver_t) :: auto_solver_t
    type(block_lu_solver_t) :: block
    type(umfpack_solver_t) :: direct
    !> Whether UMFPACK is set up, done on first use, and whether it solves with the present matrix.
    logical :: direct_set_up = .false., by_direct = .false.
    !> Why UMFPACK solves with the present matrix.
    character(len=160) :: reason = ""
  contains
    procedure :: setup_scaled => auto_solver_setup
    procedure :: factor_scaled => auto_solver_factor
    procedure :: solve_scaled => auto_solver_solve
    procedure :: release => auto_solver_release
    procedure :: factor_bytes => auto_solver_factor_bytes
  end type auto_solver_t

contains

  !> Create the solver for the registry.
  subroutine make_auto_solver(solver, options)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options

    type(auto_solver_t), allocatable :: made

    allocate (made)
    made%options = options
    call new_block_lu_solver(made%block, options)
    call new_umfpack_solver(made%direct, options)
    call move_alloc(made, solver)
  end subroutine make_auto_solver

  !> Set up the complete factorisation.
  subroutine auto_solver_setup(self, matrix)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    call self%block%setup_scaled(matrix)
    self%description = trim(self%block%description)//"; UMFPACK to fall back on"
  end subroutine auto_solver_setup

  !> Factorise on blocks, or by UMFPACK if that fails.
  subroutine auto_solver_factor(self, matrix, verdict)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    self%by_direct = .false.
    call self%block%factor_scaled(matrix, verdict)
    self%method = self%block%method
    self%perturbed = self%block%perturbed
    if (verdict%outcome == verdict_converged) return
    self%reason = verdict%detail
    call factor_directly(self, matrix, verdict)
  end subroutine auto_solver_factor

  !> Factorise by UMFPACK.
  subroutine factor_directly(self, matrix, verdict)
    type(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    if (.not. self%direct_set_up) call self%direct%setup_scaled(matrix)
    self%direct_set_up = .true.
    call self%direct%factor_scaled(matrix, verdict)
    self%method = self%direct%method
    self%by_direct = verdict%outcome == verdict_converged
  end subroutine factor_directly

  !> Solve on blocks, or by UMFPACK if that fails.
  subroutine auto_solver_solve(self, matrix, b, x, report)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    type(verdict_t) :: verdict

    if (.not. self%by_direct) then
      call self%block%solve_scaled(matrix, b, x, report)
      if (report%converged) return
      self%reason = report%reason
      call factor_directly(self, matrix, verdict)
      report%cause = verdict%cause
      report%reason = verdict%detail
      if (verdict%outcome /= verdict_converged) return
    end if
    report%fallback = .true.
    report%reason = self%reason
    call self%direct%solve_scaled(matrix, b, x, report)
  end subroutine auto_solver_solve

  !> Free UMFPACK's factors.
  subroutine auto_solver_release(self)
    class(auto_solver_t), intent(inout) :: self

    self%method = ""
    call self%direct%release()
    self%direct_set_up = .false.
    self%by_direct = .false.
  end subroutine auto_solver_release

  !> Return the memory of the complete factorisation, bytes.
  real(wp) function auto_solver_factor_bytes(self) result(bytes)
    class(auto_solver_t), intent(in) :: self

    bytes = self%block%factor_bytes()
  end function auto_solver_factor_bytes

end module dd3_linalg_auto_solver
