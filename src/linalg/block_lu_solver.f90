! SPDX-License-Identifier: GPL-3.0-or-later
!> Direct solver: complete LU factorisation on 3x3 blocks, by rows where the numbering gives a
!> narrow band and by the multifrontal method elsewhere, refined by conjugate gradients squared.
module dd3_linalg_block_lu_solver
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_linalg_cgs, only : cgs_t
  use dd3_linalg_fill_pattern, only : fill_limit
  use dd3_linalg_ilu, only : ilu_t, new_ilu
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_multifrontal, only : multifrontal_t
  use dd3_linalg_ordering_cost, only : factor_cost
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  implicit none
  private
  public :: block_lu_solver_t, new_block_lu_solver, make_block_lu_solver

  !> Largest number of refinements.
  integer, parameter :: most_refinements = 10
  !> Time of a block product on dense fronts, and of the work on a front besides, in block products
  !> by rows.
  real(wp), parameter :: front_product = 0.22_wp, front_overhead = 2000.0_wp

  !> Complete factorisation on blocks.
  type, extends(linear_solver_t) :: block_lu_solver_t
    !> Whether the factorisation goes by rows.
    logical :: by_rows = .false.
    !> Cost of a factorisation, in block products by rows.
    real(wp) :: products = 0.0_wp
    type(ilu_t) :: rows
    type(multifrontal_t) :: fronts
    type(cgs_t) :: iteration
  contains
    procedure :: analyse => block_lu_solver_analyse
    procedure :: prepare => block_lu_solver_prepare
    procedure :: setup_scaled => block_lu_solver_setup
    procedure :: factor_scaled => block_lu_solver_factor
    procedure :: solve_scaled => block_lu_solver_solve
    procedure :: factor_bytes => block_lu_solver_factor_bytes
  end type block_lu_solver_t

contains

  !> Create the solver for the registry.
  subroutine make_block_lu_solver(solver, options)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options

    type(block_lu_solver_t), allocatable :: made

    allocate (made)
    call new_block_lu_solver(made, options)
    call move_alloc(made, solver)
  end subroutine make_block_lu_solver

  !> Create the solver.
  subroutine new_block_lu_solver(self, options)
    type(block_lu_solver_t), intent(out) :: self
    type(solver_options_t), intent(in) :: options

    self%options = options
  end subroutine new_block_lu_solver

  !> Set up the factorisation that costs less.
  subroutine block_lu_solver_setup(self, matrix)
    class(block_lu_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    call self%analyse(matrix)
    call self%prepare(matrix)
  end subroutine block_lu_solver_setup

  !> Find the factorisation that costs less.
  subroutine block_lu_solver_analyse(self, matrix)
    class(block_lu_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    real(wp) :: by_rows
    integer :: i, n_block

    self%fronts%threads = self%options%threads
    call self%fronts%analyse(matrix)
    self%products = front_product*self%fronts%products &
        + front_overhead*real(self%fronts%tree%n_front, wp)
    call factor_cost(matrix, [(i, i=1, matrix%n)], fill_limit*size(matrix%column), by_rows, n_block)
    self%by_rows = by_rows <= self%products
    self%description = "complete LU by fronts ("//trim(self%fronts%tree%ordering)//")"
    if (.not. self%by_rows) return
    self%products = by_rows
    self%description = "complete LU by rows"
    call free(self%fronts)
  end subroutine block_lu_solver_analyse

  !> Free everything.
  subroutine free(fronts)
    type(multifrontal_t), intent(out) :: fronts

    fronts%n = 0
  end subroutine free

  !> Set up the factorisation.
  subroutine block_lu_solver_prepare(self, matrix)
    !> Analysed.
    class(block_lu_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    if (self%by_rows) then
      call new_ilu(self%rows, matrix%n)
      call self%rows%setup(matrix)
    else
      call self%fronts%prepare(matrix)
    end if
    call self%iteration%setup(3*matrix%n, self%options%tolerance, most_refinements)
  end subroutine block_lu_solver_prepare

  !> Factorise.
  subroutine block_lu_solver_factor(self, matrix, verdict)
    class(block_lu_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    self%method = "block_lu"
    if (self%by_rows) then
      call self%rows%build(matrix, verdict)
    else
      call self%fronts%build(matrix, verdict)
    end if
  end subroutine block_lu_solver_factor

  !> Solve and refine.
  subroutine block_lu_solver_solve(self, matrix, b, x, report)
    class(block_lu_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    if (self%by_rows) then
      call self%iteration%solve(matrix, self%rows, b, x)
    else
      call self%iteration%solve(matrix, self%fronts, b, x)
    end if
    report%method = "block_lu"
    call self%iteration%add_to(report)
  end subroutine block_lu_solver_solve

  !> Return the memory of the factors and of the workspace, bytes.
  real(wp) function block_lu_solver_factor_bytes(self) result(bytes)
    class(block_lu_solver_t), intent(in) :: self

    if (self%by_rows) then
      bytes = self%rows%bytes()
    else
      bytes = self%fronts%bytes()
    end if
  end function block_lu_solver_factor_bytes

end module dd3_linalg_block_lu_solver
