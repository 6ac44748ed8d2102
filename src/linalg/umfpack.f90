!> The direct solver: sparse LU with pivoting by the unsymmetric multifrontal method (Davis 2004,
!> UMFPACK 5). The symbolic phase is made once per pattern; solutions are refined with the matrix
!> itself.
module dd3_linalg_umfpack
  use, intrinsic :: iso_c_binding, only : c_int, c_double, c_ptr, c_null_ptr, c_associated
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_linalg_blas_threads, only : use_one_blas_thread
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: direct_factors_t

  !> Sizes of UMFPACK's arrays of settings and statistics.
  integer, parameter :: control_size = 20, info_size = 90
  !> What to solve: A x = b.
  integer(c_int), parameter :: plain_system = 0
  !> Place of the estimated reciprocal condition number in the statistics, and its smallest value
  !> allowed.
  integer, parameter :: place_of_condition = 68
  !> See above.
  real(c_double), parameter :: smallest_condition = 1.0e-16_c_double
  !> Status values: done, singular, out of memory.
  integer(c_int), parameter :: status_ok = 0, status_singular = 1, status_memory = -1

  !> A matrix by compressed columns and its factors.
  type :: direct_factors_t
    !> Number of unknowns.
    integer :: n = 0
    !> Where the columns begin (0-based), and the rows of their members (0-based, ascending).
    integer(c_int), allocatable :: start(:), row(:)
    !> The members.
    real(c_double), allocatable :: value(:)
    !> Position of the first of each block's three members in each of its three columns, `(3, :)`.
    integer, allocatable :: position(:, :)
    !> UMFPACK's settings.
    real(c_double) :: control(control_size) = 0.0_c_double
    !> UMFPACK's symbolic and numeric factors.
    type(c_ptr) :: symbolic = c_null_ptr, numeric = c_null_ptr
  contains
    procedure :: setup => direct_setup
    procedure :: factor => direct_factor
    procedure :: solve => direct_solve
    procedure :: release => direct_release
  end type direct_factors_t

  interface
    !> Sets the defaults.
    subroutine umfpack_di_defaults(control) bind(c, name="umfpack_di_defaults")
      import :: c_double
      !> The settings.
      real(c_double), intent(out) :: control(*)
    end subroutine umfpack_di_defaults

    !> Symbolic factorisation.
    integer(c_int) function umfpack_di_symbolic(n_row, n_column, start, row, value, symbolic, &
      control, info) &
      bind(c, name="umfpack_di_symbolic")
      import :: c_int, c_double, c_ptr
      !> Number of rows and columns.
      integer(c_int), value :: n_row, n_column
      !> Where the columns begin, and their rows.
      integer(c_int), intent(in) :: start(*), row(*)
      !> The members.
      real(c_double), intent(in) :: value(*)
      !> The result.
      type(c_ptr), intent(out) :: symbolic
      !> Settings.
      real(c_double), intent(in) :: control(*)
      !> Statistics.
      real(c_double), intent(out) :: info(*)
    end function umfpack_di_symbolic

    !> Numeric factorisation.
    integer(c_int) function umfpack_di_numeric(start, row, value, symbolic, numeric, control, &
      info) &
      bind(c, name="umfpack_di_numeric")
      import :: c_int, c_double, c_ptr
      !> Where the columns begin, and their rows.
      integer(c_int), intent(in) :: start(*), row(*)
      !> The members.
      real(c_double), intent(in) :: value(*)
      !> Symbolic factors.
      type(c_ptr), value :: symbolic
      !> The result.
      type(c_ptr), intent(out) :: numeric
      !> Settings.
      real(c_double), intent(in) :: control(*)
      !> Statistics.
      real(c_double), intent(out) :: info(*)
    end function umfpack_di_numeric

    !> Solution, with iterative refinement.
    integer(c_int) function umfpack_di_solve(system, start, row, value, x, b, numeric, control, &
      info) &
      bind(c, name="umfpack_di_solve")
      import :: c_int, c_double, c_ptr
      !> What to solve.
      integer(c_int), value :: system
      !> Where the columns begin, and their rows.
      integer(c_int), intent(in) :: start(*), row(*)
      !> The members.
      real(c_double), intent(in) :: value(*)
      !> The solution.
      real(c_double), intent(out) :: x(*)
      !> Right-hand side.
      real(c_double), intent(in) :: b(*)
      !> Numeric factors.
      type(c_ptr), value :: numeric
      !> Settings.
      real(c_double), intent(in) :: control(*)
      !> Statistics.
      real(c_double), intent(out) :: info(*)
    end function umfpack_di_solve

    !> Frees symbolic factors.
    subroutine umfpack_di_free_symbolic(symbolic) bind(c, name="umfpack_di_free_symbolic")
      import :: c_ptr
      !> The factors.
      type(c_ptr), intent(inout) :: symbolic
    end subroutine umfpack_di_free_symbolic

    !> Frees numeric factors.
    subroutine umfpack_di_free_numeric(numeric) bind(c, name="umfpack_di_free_numeric")
      import :: c_ptr
      !> The factors.
      type(c_ptr), intent(inout) :: numeric
    end subroutine umfpack_di_free_numeric
  end interface

contains

  !> Pattern by columns, once per pattern of the block matrix.
  subroutine direct_setup(self, matrix)
    !> The factors.
    class(direct_factors_t), intent(inout) :: self
    !> A matrix of the pattern.
    type(block_matrix_t), intent(in) :: matrix
    integer, allocatable :: blocks(:), rank(:)
    integer :: i, j, k, c, at

    call self%release()
    call use_one_blas_thread()
    call umfpack_di_defaults(self%control)
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

  !> Factorises a matrix of the pattern. The symbolic phase, which looks at the values too, is made
  !> with the first one.
  subroutine direct_factor(self, matrix, verdict)
    !> The factors.
    class(direct_factors_t), intent(inout) :: self
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix
    !> Retry for a singular matrix.
    type(verdict_t), intent(out) :: verdict
    real(c_double) :: info(info_size)
    integer(c_int) :: status

    call spread(size(matrix%column), self%position, matrix%value, self%value)
    if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
    self%numeric = c_null_ptr
    status = status_ok
    if (.not. c_associated(self%symbolic)) then
      status = umfpack_di_symbolic(int(self%n, c_int), int(self%n, c_int), self%start, self%row, &
          self%value, self%symbolic, self%control, info)
    end if
    if (status == status_ok) then
      status = umfpack_di_numeric(self%start, self%row, self%value, self%symbolic, self%numeric, &
        self%control, info)
    end if
    if (status == status_ok) then
      if (.not. info(place_of_condition) > smallest_condition) status = status_singular
    end if
    verdict%outcome = verdict_retry
    select case (status)
    case (status_ok)
      verdict%outcome = verdict_converged
    case (status_singular)
      verdict%reason = "the matrix is singular"
    case (status_memory)
      verdict%reason = "not enough memory for the direct solver"
    case default
      verdict%reason = "the direct solver failed with status "//to_text(int(status))
    end select
  end subroutine direct_factor

  !> Copies blocks into columns.
  pure subroutine spread(n_block, position, block, column)
    !> Number of blocks.
    integer, intent(in) :: n_block
    !> Where the columns of each block go.
    integer, intent(in) :: position(3, n_block)
    !> The blocks.
    real(wp), intent(in) :: block(3, 3, n_block)
    !> The members by columns.
    real(wp), intent(inout) :: column(9*n_block)
    integer :: k, c

    do k = 1, n_block
      do c = 1, 3
        column(position(c, k):position(c, k) + 2) = block(:, c, k)
      end do
    end do
  end subroutine spread

  !> Solves with the factors.
  subroutine direct_solve(self, b, x, good)
    !> The factors.
    class(direct_factors_t), intent(in) :: self
    !> Right-hand side.
    real(wp), intent(in) :: b(:)
    !> Solution.
    real(wp), intent(out) :: x(:)
    !> Whether there is one.
    logical, intent(out) :: good
    real(c_double) :: info(info_size)

    good = .false.
    x = 0.0_wp
    if (.not. c_associated(self%numeric)) return
    good = umfpack_di_solve(plain_system, self%start, self%row, self%value, x, b, self%numeric, &
      self%control, info) &
           == status_ok
  end subroutine direct_solve

  !> Frees the factors.
  subroutine direct_release(self)
    !> The factors.
    class(direct_factors_t), intent(inout) :: self

    if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
    if (c_associated(self%symbolic)) call umfpack_di_free_symbolic(self%symbolic)
    self%numeric = c_null_ptr
    self%symbolic = c_null_ptr
  end subroutine direct_release

end module dd3_linalg_umfpack
