! SPDX-License-Identifier: GPL-3.0-or-later
!> Renumbered, row-scaled copy of a linear system. Each row is divided by the sum of its absolute
!> values, so that equilibrium, contact and displacement rows have the same weight.
module dd3_linalg_scaled_system
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_singular
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_partition, only : holds_row, own_rows
  implicit none
  private
  public :: scaled_system_t

  !> Renumbered and scaled copy of a linear system.
  type :: scaled_system_t
    !> Copy: its block row i is the original's block row `order(i)`. It may have a part of the rows,
    !> and has the same columns then: the unknowns that are left out are zero.
    type(block_matrix_t) :: matrix
    !> Original number of each block row of the copy.
    integer, allocatable :: order(:)
    !> Factor of each scalar row of the copy, `(3, n)`; zero in rows of other ranks.
    real(wp), allocatable :: scale(:, :)
    !> Position in the original of each block of the copy.
    integer, allocatable :: source(:)
    !> First and last block row of the copy that this rank holds.
    integer :: first = 1, last = 0
    !> Whether the copy has values; without them only the factors of the rows are set.
    logical :: has_values = .true.
  contains
    procedure :: setup => scaled_system_setup
    procedure :: fill => scaled_system_fill
    procedure :: scale_rhs => scaled_system_scale_rhs
    procedure :: restore_order => scaled_system_restore_order
  end type scaled_system_t

contains

  !> Build the pattern of the copy, with the rows of this rank.
  subroutine scaled_system_setup(self, matrix, order)
    class(scaled_system_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row of the copy.
    integer, intent(in) :: order(:)

    integer, allocatable :: rank(:)
    integer :: i, k, n, n_block, next

    n = size(order)
    allocate (rank(matrix%n), source=0)
    rank(order) = [(i, i=1, n)]
    n_block = 0
    do i = 1, n
      if (holds_row(matrix, order(i))) n_block = n_block + count(rank(matrix%column( &
          matrix%row_start(order(i)):matrix%row_start(order(i) + 1) - 1)) > 0)
    end do
    self%order = order
    self%matrix = block_matrix_t()
    if (allocated(matrix%owner)) self%matrix%owner = matrix%owner(order)
    if (allocated(self%source)) deallocate (self%source, self%scale)
    allocate (self%source(n_block))
    allocate (self%scale(3, n), source=0.0_wp)
    allocate (self%matrix%row_start(n + 1), self%matrix%diagonal(n), source=0)
    allocate (self%matrix%column(n_block))
    allocate (self%matrix%value(3, 3, merge(n_block, 0, self%has_values)), source=0.0_wp)
    self%matrix%n = n
    next = 1
    do i = 1, n
      self%matrix%row_start(i) = next
      if (.not. holds_row(matrix, order(i))) cycle
      do k = matrix%row_start(order(i)), matrix%row_start(order(i) + 1) - 1
        if (rank(matrix%column(k)) == 0) cycle
        self%matrix%column(next) = rank(matrix%column(k))
        self%source(next) = k
        next = next + 1
      end do
    end do
    self%matrix%row_start(n + 1) = next
    call sort_rows(n, n_block, self%matrix%row_start, self%matrix%column, self%source)
    do i = 1, n
      associate (first => self%matrix%row_start(i), last => self%matrix%row_start(i + 1) - 1)
        self%matrix%diagonal(i) = first - 1 + findloc(self%matrix%column(first:last), i, dim=1)
      end associate
    end do
    call own_rows(self%matrix, self%first, self%last)
  end subroutine scaled_system_setup

  !> Sort the blocks of each row in ascending order of their columns, by transposing the pattern
  !> twice. The row of a pressed tool has the columns of all points it touches.
  pure subroutine sort_rows(n, n_block, row_start, column, source)
    integer, intent(in) :: n, n_block, row_start(n + 1)
    integer, intent(inout) :: column(n_block), source(n_block)

    integer, allocatable :: row(:), of_column(:)
    integer :: column_start(n + 1), start(n + 1)

    allocate (row(n_block), of_column(n_block))
    call transpose_pattern(n, n_block, row_start, column, source, column_start, row, of_column)
    call transpose_pattern(n, n_block, column_start, row, of_column, start, column, source)
  end subroutine sort_rows

  !> Transpose a pattern; the rows of the result have ascending columns.
  pure subroutine transpose_pattern(n, n_block, row_start, column, item, start, row, moved)
    integer, intent(in) :: n, n_block, row_start(n + 1), column(n_block)
    !> What each block carries with it.
    integer, intent(in) :: item(n_block)
    integer, intent(out) :: start(n + 1), row(n_block), moved(n_block)

    integer :: next(n), i, k

    next = 0
    do k = 1, n_block
      next(column(k)) = next(column(k)) + 1
    end do
    start(1) = 1
    do i = 1, n
      start(i + 1) = start(i) + next(i)
    end do
    next = start(:n)
    do i = 1, n
      do k = row_start(i), row_start(i + 1) - 1
        associate (place => next(column(k)))
          row(place) = i
          moved(place) = item(k)
          place = place + 1
        end associate
      end do
    end do
  end subroutine transpose_pattern

  !> Copy and scale the values of a matrix of the pattern.
  subroutine scaled_system_fill(self, matrix, verdict)
    class(scaled_system_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Retry if a row is zero or not finite; `row` is that in the copy.
    type(verdict_t), intent(out) :: verdict

    integer :: bad_row

    associate (copy => self%matrix)
      call scale_rows(copy%n, size(copy%column), self%first, self%last, copy%row_start, &
          self%source, self%has_values, matrix%value, copy%value, self%scale, bad_row)
    end associate
    if (allocated(matrix%owner)) call share_bad_row(self%matrix%n, bad_row)
    verdict%outcome = verdict_converged
    if (bad_row == 0) return
    verdict%outcome = verdict_retry
    verdict%row = bad_row
    verdict%cause = cause_singular
    verdict%detail = "row of zeros or value that is not finite"
  end subroutine scaled_system_fill

  !> Give all ranks the first bad row.
  subroutine share_bad_row(n, bad_row)
    !> Number of block rows.
    integer, intent(in) :: n
    !> Among the rows of this rank on entry, among all on return; 0 if there is none.
    integer, intent(inout) :: bad_row

    integer :: left(1)

    left = 0
    if (bad_row > 0) left = n + 1 - bad_row
    call largest_over_ranks(1, left)
    bad_row = 0
    if (left(1) > 0) bad_row = n + 1 - left(1)
  end subroutine share_bad_row

  !> Kernel: copy and scale the blocks of all rows that are not bad; see `scaled_system_t` for the
  !> arrays.
  subroutine scale_rows(n, n_block, first, last, row_start, source, copies, from, to, scale, &
      bad_row)
    integer, intent(in) :: n, n_block, first, last, row_start(n + 1), source(n_block)
    !> Whether the copy has values.
    logical, intent(in) :: copies
    !> Blocks of the original and of the copy.
    real(wp), intent(in) :: from(3, 3, *)
    real(wp), intent(inout) :: to(3, 3, *), scale(3, n)
    !> First block row with a scalar row that is zero or not finite; 0 if there is none.
    integer, intent(out) :: bad_row

    real(wp) :: a(3), b(3), c(3)
    integer :: i, k, m

    bad_row = n + 1
    !$omp parallel do num_threads(threads_for(last - first + 1, least_nodes)) &
    !$omp& private(a, b, c, k, m) reduction(min: bad_row)
    do i = first, last
      a = 0.0_wp
      b = 0.0_wp
      c = 0.0_wp
      do k = row_start(i), row_start(i + 1) - 1
        m = source(k)
        a = a + abs(from(:, 1, m))
        b = b + abs(from(:, 2, m))
        c = c + abs(from(:, 3, m))
      end do
      a = a + b + c
      if (.not. all(ieee_is_finite(a))) then
        bad_row = min(bad_row, i)
      else if (any(a < 1.0e3_wp*tiny(a))) then
        bad_row = min(bad_row, i)
      end if
      if (bad_row <= i) cycle
      a = 1.0_wp/a
      scale(:, i) = a
      if (.not. copies) cycle
      do k = row_start(i), row_start(i + 1) - 1
        m = source(k)
        to(:, 1, k) = a*from(:, 1, m)
        to(:, 2, k) = a*from(:, 2, m)
        to(:, 3, k) = a*from(:, 3, m)
      end do
    end do
    !$omp end parallel do
    if (bad_row > n) bad_row = 0
  end subroutine scale_rows

  !> Renumber and scale a right-hand side; it is zero in rows of other ranks.
  pure subroutine scaled_system_scale_rhs(self, b, scaled)
    class(scaled_system_t), intent(in) :: self
    real(wp), intent(in) :: b(:)
    real(wp), intent(out) :: scaled(:)

    integer :: i, j

    do i = 1, self%matrix%n
      j = self%order(i)
      scaled(3*i - 2:3*i) = self%scale(:, i)*b(3*j - 2:3*j)
    end do
  end subroutine scaled_system_scale_rhs

  !> Return a solution to the original numbering; unknowns that are left out keep their values.
  pure subroutine scaled_system_restore_order(self, copy, x)
    class(scaled_system_t), intent(in) :: self
    !> Solution in the copy's numbering.
    real(wp), intent(in) :: copy(:)
    real(wp), intent(inout) :: x(:)

    integer :: i, j

    do i = 1, self%matrix%n
      j = self%order(i)
      x(3*j - 2:3*j) = copy(3*i - 2:3*i)
    end do
  end subroutine scaled_system_restore_order

end module dd3_linalg_scaled_system
