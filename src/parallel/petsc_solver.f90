! SPDX-License-Identifier: GPL-3.0-or-later
!> Solvers of PETSc: a matrix of 3x3 blocks of which each rank holds its rows, and a Krylov solver
!> (KSP) that PETSc's options database configures.
submodule (dd3_linalg_petsc_solver) dd3_parallel_petsc_solver
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_null_char, c_null_ptr, c_ptr
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_reals, n_ranks, start_ranks, sum_over_ranks
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_solver
  use dd3_external_blas, only : use_one_blas_thread
  use dd3_external_petsc, only : insert_values, ksp_create, ksp_destroy, ksp_get_converged_reason, &
      ksp_get_iteration_number, ksp_get_pc, ksp_reset, ksp_set_from_options, &
      ksp_set_initial_guess_nonzero, &
      ksp_set_operators, ksp_set_options_prefix, ksp_set_up, ksp_solve, mat_assemble, &
      mat_create, mat_create_vecs, mat_destroy, mat_mumps_get_infog, &
      mat_null_space_create_rigid_body, mat_null_space_destroy, mat_residual, mat_set_block_size, &
      mat_set_near_null_space, mat_set_preallocation, mat_set_sizes, mat_set_type, &
      mat_set_values_blocked, norm_2, pc_factor_get_matrix, petsc_comm_world, replace_option, &
      vec_assemble, vec_axpy, vec_destroy, vec_duplicate, vec_get_values, vec_norm, vec_set_values
  use dd3_linalg_dense, only : dgemm
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_mumps, only : first_workspace, icntl_workspace, infog_argument, &
      infog_null_pivots, infog_status, more_workspace, mumps_verdict, needs_workspace
  use dd3_linalg_partition, only : own_rows
  use dd3_linalg_preconditioner, only : perturbed_pivots_t
  use dd3_linalg_solver, only : solver_report_t
  use dd3_parallel_petsc_options, only : set_solver_options
  implicit none

  !> Relative residual of a complete factorisation accepted where the tolerance asks for less.
  real(wp), parameter :: residual_limit = 1.0e-6_wp
  !> Largest round-off of the product of matrix and solution, over the right-hand side, that is
  !> taken for that of a slender sheet and not of a singular matrix.
  real(wp), parameter :: largest_round_off = 1.0e-3_wp
  !> Most restarts of the iterations and refinements of a factorisation, and the ratio of residuals
  !> above which a refinement is the last one.
  integer, parameter :: most_restarts = 5
  real(wp), parameter :: least_gain = 0.5_wp

  !> Solver of PETSc.
  type, extends(linear_solver_t) :: petsc_solver_t
    !> Name in the registry; with "dd3_", the prefix of the options.
    character(len=16) :: name = ""
    !> Whether it iterates.
    logical :: iterative = .false.
    !> MUMPS's additional workspace, per cent.
    integer :: workspace = first_workspace
    !> Matrix, matrix of the preconditioner, Krylov solver, right-hand side, solution, residual and
    !> correction; null until a matrix is factorised.
    type(c_ptr) :: a = c_null_ptr, p = c_null_ptr, ksp = c_null_ptr, b = c_null_ptr, &
        x = c_null_ptr, r = c_null_ptr, d = c_null_ptr
    !> Number of block rows of nodes, to which the preconditioner is restricted.
    integer :: n_node = 0
    !> Scalar rows of this rank, 0-based.
    integer(c_int), allocatable :: own(:)
  contains
    procedure :: setup_scaled => petsc_solver_setup
    procedure :: factor_scaled => petsc_solver_factor
    procedure :: solve_scaled => petsc_solver_solve
    procedure :: release => petsc_solver_release
  end type petsc_solver_t

contains

  module procedure make_petsc_mumps_solver
    call make_solver(solver, options, "petsc_mumps", .false.)
  end procedure make_petsc_mumps_solver

  module procedure make_petsc_gamg_solver
    call make_solver(solver, options, "petsc_gamg", .true.)
  end procedure make_petsc_gamg_solver

  !> Create a solver.
  subroutine make_solver(solver, options, name, iterative)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options
    !> In the registry.
    character(len=*), intent(in) :: name
    logical, intent(in) :: iterative

    type(petsc_solver_t), allocatable :: made

    allocate (made)
    made%options = options
    made%name = name
    made%iterative = iterative
    made%needs_positions = iterative
    made%system%has_values = .false.
    call move_alloc(made, solver)
  end subroutine make_solver

  !> Set the description; PETSc's objects are created with the first matrix.
  subroutine petsc_solver_setup(self, matrix)
    class(petsc_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    character(len=:), allocatable :: ranks

    ranks = to_text(n_ranks())//" ranks"
    if (n_ranks() == 1) ranks = "1 rank"
    self%description = "MUMPS of PETSc on "//ranks
    if (self%iterative) self%description = "GMRES of PETSc with GAMG, smoothed by ILU("// &
        to_text(self%options%ilu_level)//") on the rows of each rank, "//ranks
    self%description = trim(self%description)//", "//to_text(matrix%n)//" block rows"
  end subroutine petsc_solver_setup

  !> Hand the own rows to PETSc and factorise.
  subroutine petsc_solver_factor(self, matrix, verdict)
    class(petsc_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    integer(c_int) :: ignored

    if (.not. c_associated(self%a)) call create_objects(self, matrix)
    self%method = self%name
    call insert_rows(self, matrix, matrix%n, self%a)
    if (.not. c_associated(self%p, self%a)) call insert_rows(self, matrix, self%n_node, self%p)
    if (self%iterative) call set_rigid_motions(self)
    if (.not. self%options%keeps_matrix) deallocate (self%original%value)
    do
      ignored = ksp_set_operators(self%ksp, self%a, self%p)
      if (ksp_set_up(self%ksp) /= 0) then
        verdict%outcome = verdict_retry
        verdict%cause = cause_solver
        verdict%detail = "PETSc could not factorise the matrix"
        return
      end if
      verdict%outcome = verdict_converged
      if (self%iterative) return
      if (.not. needs_workspace(infog(self, infog_status), self%workspace)) exit
      ! PETSc does not factorise again after an error: the analysis is repeated.
      self%workspace = more_workspace*self%workspace
      call replace_option("-dd3_"//trim(self%name)//"_mat_mumps_icntl_"//to_text(icntl_workspace), &
          to_text(self%workspace))
      ignored = ksp_reset(self%ksp)
    end do
    verdict = mumps_verdict(infog(self, infog_status), infog(self, infog_argument))
    self%perturbed = perturbed_pivots_t(blocks=infog(self, infog_null_pivots))
  end subroutine petsc_solver_factor

  !> Return MUMPS's factors.
  type(c_ptr) function factors(self)
    type(petsc_solver_t), intent(in) :: self

    type(c_ptr) :: preconditioner
    integer(c_int) :: ignored

    ignored = ksp_get_pc(self%ksp, preconditioner)
    ignored = pc_factor_get_matrix(preconditioner, factors)
  end function factors

  !> Return a value of MUMPS's `infog`.
  integer function infog(self, position)
    type(petsc_solver_t), intent(in) :: self
    integer, intent(in) :: position

    integer(c_int) :: value, ignored

    ignored = mat_mumps_get_infog(factors(self), int(position, c_int), value)
    infog = int(value)
  end function infog

  !> Create PETSc's objects for a pattern.
  subroutine create_objects(self, matrix)
    type(petsc_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    integer(c_int) :: ignored
    integer :: k, first, last

    call start_ranks()
    call use_one_blas_thread()
    call reserve_blas_buffer()
    call own_rows(matrix, first, last)
    self%own = [(int(k, c_int), k=3*(first - 1), 3*last - 1)]
    self%n_node = matrix%n
    if (allocated(self%positions)) self%n_node = size(self%positions, 2)
    call create_matrix(matrix, trim(merge("aij ", "baij", self%iterative)), self%a)
    self%p = self%a
    if (self%n_node < matrix%n .and. self%iterative) call create_matrix(matrix, "aij", self%p)
    ignored = mat_create_vecs(self%a, self%x, self%b)
    ignored = vec_duplicate(self%b, self%r)
    ignored = vec_duplicate(self%b, self%d)
    call set_solver_options("dd3_"//trim(self%name)//"_", self%iterative, self%options, &
        self%workspace)
    ignored = ksp_create(petsc_comm_world, self%ksp)
    ignored = ksp_set_options_prefix(self%ksp, "dd3_"//trim(self%name)//"_"//c_null_char)
    ignored = ksp_set_from_options(self%ksp)
  end subroutine create_objects

  !> Create a matrix of a pattern.
  subroutine create_matrix(matrix, kind, created)
    type(block_matrix_t), intent(in) :: matrix
    !> PETSc's name.
    character(len=*), intent(in) :: kind
    type(c_ptr), intent(out) :: created

    integer(c_int) :: ignored, n_all, n_own
    integer(c_int), allocatable :: near(:), far(:)
    integer :: i, first, last

    call own_rows(matrix, first, last)
    allocate (near(first:last), far(first:last))
    do i = first, last
      associate (column => matrix%column(matrix%row_start(i):matrix%row_start(i + 1) - 1))
        near(i) = int(count(column >= first .and. column <= last), c_int)
        far(i) = int(size(column), c_int) - near(i)
      end associate
    end do
    n_own = int(3*(last - first + 1), c_int)
    n_all = int(3*matrix%n, c_int)
    ignored = mat_create(petsc_comm_world, created)
    ignored = mat_set_sizes(created, n_own, n_own, n_all, n_all)
    ignored = mat_set_block_size(created, 3_c_int)
    ignored = mat_set_type(created, kind//c_null_char)
    ignored = mat_set_preallocation(created, 3_c_int, near, far, c_null_ptr, c_null_ptr)
  end subroutine create_matrix

  !> Let OpenBLAS allocate its buffer. In a factorisation it would wait for the memory for ever;
  !> here the program ends if there is none.
  subroutine reserve_blas_buffer()
    !> Size of the buffer in reals (128 MiB in OpenBLAS 0.3 on x86-64), and of a product that is not
    !> too small for it.
    integer, parameter :: buffer_size = 134300000/8, n = 64
    real(wp), allocatable :: buffer(:)

    ! The array makes room for the buffer: it is freed before the product.
    allocate (buffer(buffer_size))
    deallocate (buffer)
    allocate (buffer(3*n**2), source=0.0_wp)
    call dgemm("n", "n", n, n, n, 1.0_wp, buffer, n, buffer(n**2 + 1), n, 0.0_wp, &
        buffer(2*n**2 + 1), n)
  end subroutine reserve_blas_buffer

  !> Scale the own rows and hand them to PETSc, which holds the only copy. Of the rows and columns
  !> behind those of the nodes, which are dense, a matrix of the nodes alone has unit diagonals.
  subroutine insert_rows(self, matrix, n_node, to)
    type(petsc_solver_t), intent(in) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Number of block rows of nodes in the original numbering.
    integer, intent(in) :: n_node
    type(c_ptr), intent(in) :: to

    real(wp), parameter :: unit(9) = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    !> Column component, column, row component: the row by scalar rows.
    real(wp), allocatable :: row(:, :, :)
    integer, allocatable :: k(:)
    integer(c_int) :: ignored
    integer :: i, j, first, last

    call own_rows(matrix, first, last)
    do i = first, last
      if (self%system%order(i) > n_node) then
        ignored = mat_set_values_blocked(to, 1_c_int, [int(i - 1, c_int)], 1_c_int, &
            [int(i - 1, c_int)], unit, insert_values)
        cycle
      end if
      k = [(j, j=matrix%row_start(i), matrix%row_start(i + 1) - 1)]
      if (n_node < matrix%n) k = pack(k, self%system%order(matrix%column(k)) <= n_node)
      if (allocated(row)) deallocate (row)
      allocate (row(3, size(k), 3))
      do j = 1, 3
        row(:, :, j) = self%system%scale(j, i)*self%original%value(j, :, self%system%source(k))
      end do
      ignored = mat_set_values_blocked(to, 1_c_int, [int(i - 1, c_int)], int(size(k), c_int), &
          int(matrix%column(k) - 1, c_int), row, insert_values)
    end do
    call mat_assemble(to)
  end subroutine insert_rows

  !> Give the preconditioner the rigid motions of the sheet.
  subroutine set_rigid_motions(self)
    type(petsc_solver_t), intent(in) :: self

    type(c_ptr) :: coordinates, unused, motions
    real(wp), allocatable :: own(:)
    integer(c_int) :: ignored
    integer :: i

    if (.not. allocated(self%positions)) return
    ignored = mat_create_vecs(self%p, coordinates, unused)
    allocate (own(size(self%own)), source=0.0_wp)
    do i = 1, size(own)/3
      associate (node => self%system%order(self%own(3*i)/3 + 1))
        if (node <= self%n_node) own(3*i - 2:3*i) = self%positions(:, node)
      end associate
    end do
    ignored = vec_set_values(coordinates, size(own, kind=c_int), self%own, own, insert_values)
    call vec_assemble(coordinates)
    ignored = mat_null_space_create_rigid_body(coordinates, motions)
    ignored = mat_set_near_null_space(self%p, motions)
    ignored = mat_null_space_destroy(motions)
    ignored = vec_destroy(coordinates)
    ignored = vec_destroy(unused)
  end subroutine set_rigid_motions

  !> Solve, check the true residual and give all ranks the solution.
  subroutine petsc_solver_solve(self, matrix, b, x, report)
    class(petsc_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    real(wp) :: last
    integer(c_int) :: ignored, n, reason

    report%method = self%name
    n = size(self%own, kind=c_int)
    ignored = vec_set_values(self%b, n, self%own, b(self%own + 1), insert_values)
    call vec_assemble(self%b)
    ignored = ksp_solve(self%ksp, self%b, self%x)
    do
      last = report%residual
      call keep_solution(self, matrix, x, report, reason)
      if (report%residual <= self%options%tolerance .or. report%restarts == most_restarts) exit
      if (self%iterative) then
        if (reason < 0) exit
      else if (.not. report%residual < least_gain*last) then
        exit
      end if
      call improve(self)
      report%restarts = report%restarts + 1
    end do
    if (.not. report%converged) report%reason = trim(self%name)//" found no solution (reason "// &
        to_text(int(reason))//" of PETSc, "//to_text(report%iterations)//" iterations)"
  end subroutine petsc_solver_solve

  !> Evaluate the true residual of PETSc's solution, and keep the solution if it is the best so far.
  subroutine keep_solution(self, matrix, x, report, reason)
    type(petsc_solver_t), intent(in) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Of the system whose right-hand side has unit length.
    real(wp), intent(inout) :: x(:)
    !> Gets the iterations, the residual and whether it is small enough.
    type(solver_report_t), intent(inout) :: report
    !> Reason of the end, as PETSc numbers it.
    integer(c_int), intent(out) :: reason

    real(wp) :: norm(1), limit, round_off
    integer(c_int) :: ignored, iterations

    ignored = ksp_get_converged_reason(self%ksp, reason)
    ignored = ksp_get_iteration_number(self%ksp, iterations)
    if (self%iterative) report%iterations = report%iterations + int(iterations)
    ignored = mat_residual(self%a, self%b, self%x, self%r)
    ignored = vec_norm(self%r, norm_2, norm(1))
    call broadcast_reals(0, 1, norm)
    if (.not. ieee_is_finite(norm(1))) return
    if (norm(1) < report%residual) then
      report%residual = norm(1)
      x(:3*matrix%n) = 0.0_wp
      call get_solution(self, x)
    end if
    limit = self%options%tolerance
    if (.not. self%iterative) then
      limit = max(limit, residual_limit)
      ! The rows of the matrix add up to one.
      round_off = epsilon(1.0_wp)*norm2(x)
      if (round_off <= largest_round_off) limit = max(limit, round_off)
    end if
    report%converged = report%residual <= limit
  end subroutine keep_solution

  !> Improve PETSc's solution: refine that of a factorisation by its residual, or iterate again from
  !> it, where the residual of the iterations has drifted from the true one.
  subroutine improve(self)
    type(petsc_solver_t), intent(in) :: self

    integer(c_int) :: ignored

    if (.not. self%iterative) then
      ignored = ksp_solve(self%ksp, self%r, self%d)
      ignored = vec_axpy(self%x, 1.0_wp, self%d)
      return
    end if
    ignored = ksp_set_initial_guess_nonzero(self%ksp, 1_c_int)
    ignored = ksp_solve(self%ksp, self%b, self%x)
    ignored = ksp_set_initial_guess_nonzero(self%ksp, 0_c_int)
  end subroutine improve

  !> Gather the solution on all ranks.
  subroutine get_solution(self, x)
    type(petsc_solver_t), intent(in) :: self
    !> Zero on entry.
    real(wp), intent(inout) :: x(:)

    real(wp), allocatable :: own(:)
    integer(c_int) :: ignored

    allocate (own(size(self%own)))
    ignored = vec_get_values(self%x, size(own, kind=c_int), self%own, own)
    x(self%own + 1) = own
    call sum_over_ranks(size(x), x)
  end subroutine get_solution

  !> Free PETSc's objects.
  subroutine petsc_solver_release(self)
    class(petsc_solver_t), intent(inout) :: self

    integer(c_int) :: ignored

    self%method = ""
    if (.not. c_associated(self%a)) return
    ignored = ksp_destroy(self%ksp)
    if (.not. c_associated(self%p, self%a)) ignored = mat_destroy(self%p)
    ignored = mat_destroy(self%a)
    ignored = vec_destroy(self%b)
    ignored = vec_destroy(self%x)
    ignored = vec_destroy(self%r)
    ignored = vec_destroy(self%d)
  end subroutine petsc_solver_release

end submodule dd3_parallel_petsc_solver
