! SPDX-License-Identifier: GPL-3.0-or-later
!> Sparse LU factors with pivoting by the unsymmetric multifrontal method (Davis 2004, UMFPACK 5).
!> The symbolic factorisation depends on the pattern alone, so that results do not depend on which
!> matrix comes first; solutions are refined iteratively.
module dd3_linalg_umfpack
  use, intrinsic :: iso_c_binding, only : c_int, c_double, c_ptr, c_null_ptr, c_associated
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_singular, &
      cause_solver, cause_solver_memory
  use dd3_external_blas, only : use_one_blas_thread
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: direct_factors_t

  !> Sizes of UMFPACK's arrays of control parameters and statistics.
  integer, parameter :: control_size = 20, info_size = 90
  !> UMFPACK_A: solve A x = b.
  integer(c_int), parameter :: system_plain = 0
  !> UMFPACK_STRATEGY: position of the pivoting strategy in the control parameters.
  integer, parameter :: control_strategy = 6
  !> UMFPACK_STRATEGY_SYMMETRIC: the pattern is nearly symmetric, with few zeros on the diagonal.
  !> Without values UMFPACK does not choose it by itself.
  real(c_double), parameter :: strategy_symmetric = 3.0_c_double
  !> UMFPACK_ORDERING: position of the column ordering in the control parameters.
  integer, parameter :: control_ordering = 11
  !> UMFPACK_ORDERING_BEST: the best of AMD, METIS and the nested dissection of CHOLMOD.
  real(c_double), parameter :: ordering_best = 4.0_c_double
  !> UMFPACK_RCOND: position of the estimated reciprocal condition number in the statistics.
  integer, parameter :: info_rcond = 68
  !> Reciprocal condition number below which a matrix counts as singular.
  real(c_double), parameter :: rcond_limit = 1.0e-16_c_double
  !> UMFPACK's status values.
  integer(c_int), parameter :: status_ok = 0, status_singular = 1, status_memory = -1

  !> Matrix by compressed columns and its factors.
  type :: direct_factors_t
    !> Number of unknowns.
    integer :: n = 0
    !> Where the columns begin, and the row of each entry, ascending; both 0-based.
    integer(c_int), allocatable :: start(:), row(:)
    !> Entries of the matrix.
    real(c_double), allocatable :: value(:)
    !> Position in `value` of the first entry of each column of each block, `(3, :)`.
    integer, allocatable :: position(:, :)
    !> UMFPACK's control parameters.
    real(c_double) :: control(control_size) = 0.0_c_double
    !> UMFPACK's symbolic and numeric factors.
    type(c_ptr) :: symbolic = c_null_ptr, numeric = c_null_ptr
  contains
    procedure :: setup => direct_setup
    procedure :: factor => direct_factor
    procedure :: solve => direct_solve
    procedure :: release => direct_release
  end type direct_factors_t

  ! Of UMFPACK: columns and rows as in `direct_factors_t`, `info` returns statistics.
  interface
    !> Set the default control parameters.
    subroutine umfpack_di_defaults(control) bind(c, name="umfpack_di_defaults")
      import :: c_double
      real(c_double), intent(out) :: control(*)
    end subroutine umfpack_di_defaults

    !> Symbolic factorisation; returns the status.
    integer(c_int) function umfpack_di_symbolic(n_row, n_column, start, row, value, symbolic, &
        control, info) bind(c, name="umfpack_di_symbolic")
      import :: c_int, c_double, c_ptr
      integer(c_int), value :: n_row, n_column
      integer(c_int), intent(in) :: start(*), row(*)
      !> Entries of the matrix; null to use the pattern alone.
      type(c_ptr), value :: value
      type(c_ptr), intent(out) :: symbolic
      real(c_double), intent(in) :: control(*)
      real(c_double), intent(out) :: info(*)
    end function umfpack_di_symbolic

    !> Numeric factorisation; returns the status.
    integer(c_int) function umfpack_di_numeric(start, row, value, symbolic, numeric, control, &
        info) bind(c, name="umfpack_di_numeric")
      import :: c_int, c_double, c_ptr
      integer(c_int), intent(in) :: start(*), row(*)
      real(c_double), intent(in) :: value(*)
      type(c_ptr), value :: symbolic
      type(c_ptr), intent(out) :: numeric
      real(c_double), intent(in) :: control(*)
      real(c_double), intent(out) :: info(*)
    end function umfpack_di_numeric

    !> Solution with iterative refinement; returns the status.
    integer(c_int) function umfpack_di_solve(system, start, row, value, x, b, numeric, control, &
        info) bind(c, name="umfpack_di_solve")
      import :: c_int, c_double, c_ptr
      !> Which system to solve, see `system_plain`.
      integer(c_int), value :: system
      integer(c_int), intent(in) :: start(*), row(*)
      real(c_double), intent(in) :: value(*)
      real(c_double), intent(out) :: x(*)
      real(c_double), intent(in) :: b(*)
      type(c_ptr), value :: numeric
      real(c_double), intent(in) :: control(*)
      real(c_double), intent(out) :: info(*)
    end function umfpack_di_solve

    !> Free symbolic factors.
    subroutine umfpack_di_free_symbolic(symbolic) bind(c, name="umfpack_di_free_symbolic")
      import :: c_ptr
      type(c_ptr), intent(inout) :: symbolic
    end subroutine umfpack_di_free_symbolic

    !> Free numeric factors.
    subroutine umfpack_di_free_numeric(numeric) bind(c, name="umfpack_di_free_numeric")
      import :: c_ptr
      type(c_ptr), intent(inout) :: numeric
    end subroutine umfpack_di_free_numeric
  end interface

contains

  !> Build the pattern by columns.
  subroutine direct_setup(self, matrix)
    class(direct_factors_t), intent(inout) :: self
    !> Matrix of the pattern; its values are not used.
    type(block_matrix_t), intent(in) :: matrix

    ! Number of blocks in each block column, and of those above each block.
    integer, allocatable :: blocks(:), rank(:)
    integer :: i, j, k, c, at

    call self%release()
    call use_one_blas_thread()
    call umfpack_di_defaults(self%control)
    self%control(control_strategy) = strategy_symmetric
    self%control(control_ordering) = ordering_best
    self%n = 3*matrix%n
    allocate (blocks(matrix%n), rank(size(matrix%column)))
    blocks = 0
    do k = 1, size(matrix%column)
      rank(k) = blocks(matrix%column(k))
      blocks(matrix%column(k)) = rank(k) + 1
    end do
    if (allocated(self%start)) deallocate (self%start, self%row, self%value, self%position)
    allocate (self%start(self%n + 1), self%row(9*size(rank)), self%value(9*size(rank)), &
        self%position(3, size(rank)))
    self%value = 0.0_wp
    self%start(1) = 0
    do j = 1, self%n
      self%start(j + 1) = self%start(j) + 3*blocks((j + 2)/3)
    end do
    do i = 1, matrix%n
      do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
        do c = 1, 3
          at = self%start(3*matrix%column(k) - 3 + c) + 3*rank(k) + 1
          self%position(c, k) = at
          self%row(at:at + 2) = [3*i - 3, 3*i - 2, 3*i - 1]
        end do
      end do
    end do
  end subroutine direct_setup

  !> Factorise a matrix of the pattern.
  subroutine direct_factor(self, matrix, verdict)
    class(direct_factors_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Retry if the matrix is singular or UMFPACK fails.
    type(verdict_t), intent(out) :: verdict

    real(c_double) :: info(info_size)
    integer(c_int) :: status

    call copy_by_columns(size(matrix%column), self%position, matrix%value, self%value)
    if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
    self%numeric = c_null_ptr
    status = status_ok
    if (.not. c_associated(self%symbolic)) then
      status = umfpack_di_symbolic(int(self%n, c_int), int(self%n, c_int), self%start, self%row, &
          c_null_ptr, self%symbolic, self%control, info)
    end if
    if (status == status_ok) then
      status = umfpack_di_numeric(self%start, self%row, self%value, self%symbolic, self%numeric, &
          self%control, info)
    end if
    if (status == status_ok) then
      if (.not. info(info_rcond) > rcond_limit) status = status_singular
    end if
    verdict%outcome = verdict_retry
    select case (status)
    case (status_ok)
      verdict%outcome = verdict_converged
    case (status_singular)
      verdict%cause = cause_singular
      verdict%detail = "the matrix is singular"
    case (status_memory)
      verdict%cause = cause_solver_memory
      verdict%detail = "not enough memory for the direct solver"
    case default
      verdict%cause = cause_solver
      verdict%detail = "the direct solver failed with status "//to_text(int(status))
    end select
  end subroutine direct_factor

  !> Kernel: copy blocks into columns.
  pure subroutine copy_by_columns(n_block, position, block, column)
    integer, intent(in) :: n_block
    !> See `direct_factors_t`.
    integer, intent(in) :: position(3, n_block)
    real(wp), intent(in) :: block(3, 3, n_block)
    real(wp), intent(inout) :: column(9*n_block)

    integer :: k, c

    do k = 1, n_block
      do c = 1, 3
        column(position(c, k):position(c, k) + 2) = block(:, c, k)
      end do
    end do
  end subroutine copy_by_columns

  !> Solve with the factors.
  subroutine direct_solve(self, b, x, good)
    class(direct_factors_t), intent(in) :: self
    real(wp), intent(in) :: b(:)
    real(wp), intent(out) :: x(:)
    !> Whether there is a solution; x is zero without factors.
    logical, intent(out) :: good

    real(c_double) :: info(info_size)

    good = .false.
    x = 0.0_wp
    if (.not. c_associated(self%numeric)) return
    good = status_ok == umfpack_di_solve(system_plain, self%start, self%row, self%value, x, b, &
        self%numeric, self%control, info)
  end subroutine direct_solve

  !> Free the factors.
  subroutine direct_release(self)
    class(direct_factors_t), intent(inout) :: self

    if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
    if (c_associated(self%symbolic)) call umfpack_di_free_symbolic(self%symbolic)
    self%numeric = c_null_ptr
    self%symbolic = c_null_ptr
  end subroutine direct_release

end module dd3_linalg_umfpack
