!> The solvers' own copy of a linear system: renumbered, and each row divided by the sum of its
!> magnitudes, so that equilibrium rows, contact rows and rows of fixed displacements weigh the
!> same.
module dd3_linalg_scaled_system
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: scaled_system_t

  !> A renumbered and scaled copy of a linear system.
  type :: scaled_system_t
    !> The copy: its block row i is the original's row `order(i)`.
    type(block_matrix_t) :: matrix
    !> Original number of each block row, `(n)`.
    integer, allocatable :: order(:)
    !> Factor of each row of the copy, `(3, n)`.
    real(wp), allocatable :: scale(:, :)
    !> Position in the original of each block of the copy.
    integer, allocatable :: source(:)
  contains
    procedure :: setup => scaled_system_setup
    procedure :: fill => scaled_system_fill
    procedure :: scale_rhs => scaled_system_scale_rhs
    procedure :: give_back => scaled_system_give_back
  end type scaled_system_t

contains

  !> Makes the pattern of the copy.
  subroutine scaled_system_setup(self, matrix, order)
    !> The system.
    class(scaled_system_t), intent(out) :: self
    !> The original.
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each row of the copy.
    integer, intent(in) :: order(:)
    integer, allocatable :: rank(:)
    integer :: i, k, n, next, first

    n = matrix%n
    self%order = order
    allocate (rank(n), self%source(size(matrix%column)), self%scale(3, n))
    allocate (self%matrix%row_start(n + 1), self%matrix%diagonal(n))
    allocate (self%matrix%column(size(matrix%column)), self%matrix%value(3, 3, size(matrix%column)))
    self%matrix%n = n
    self%matrix%value = 0.0_wp
    self%scale = 1.0_wp
    rank(order) = [(i, i=1, n)]
    next = 1
    do i = 1, n
      first = next
      self%matrix%row_start(i) = first
      do k = matrix%row_start(order(i)), matrix%row_start(order(i) + 1) - 1
        self%matrix%column(next) = rank(matrix%column(k))
        self%source(next) = k
        next = next + 1
      end do
      call sort_pairs(self%matrix%column(first:next - 1), self%source(first:next - 1))
      self%matrix%diagonal(i) = first - 1 + findloc(self%matrix%column(first:next - 1), i, dim=1)
    end do
    self%matrix%row_start(n + 1) = next
  end subroutine scaled_system_setup

  !> Sorts pairs upwards by their first members (insertion).
  pure subroutine sort_pairs(key, item)
    !> First members.
    integer, intent(inout) :: key(:)
    !> Second members.
    integer, intent(inout) :: item(:)
    integer :: i, j, moved_key, moved_item

    do i = 2, size(key)
      moved_key = key(i)
      moved_item = item(i)
      j = i - 1
      do while (j >= 1)
        if (key(j) <= moved_key) exit
        key(j + 1) = key(j)
        item(j + 1) = item(j)
        j = j - 1
      end do
      key(j + 1) = moved_key
      item(j + 1) = moved_item
    end do
  end subroutine sort_pairs

  !> Copies and scales the values of a matrix of the pattern; a row of zeros or a member that is not
  !> finite ends it.
  subroutine scaled_system_fill(self, matrix, verdict)
    !> The system.
    class(scaled_system_t), intent(inout) :: self
    !> The original.
    type(block_matrix_t), intent(in) :: matrix
    !> Retry where the matrix is no good.
    type(verdict_t), intent(out) :: verdict
    integer :: worst

    associate (copy => self%matrix)
      call scale_rows(copy%n, size(copy%column), copy%row_start, self%source, matrix%value, &
        copy%value, self%scale, worst)
    end associate
    verdict%outcome = verdict_converged
    if (worst == 0) return
    verdict%outcome = verdict_retry
    verdict%node = self%order(worst)
    verdict%reason = "row of zeros or a member that is not finite in block row " &
      //to_text(verdict%node)//" of the matrix"
  end subroutine scaled_system_fill

  !> Kernel of the scaling; stops at the first bad row.
  pure subroutine scale_rows(n, n_block, row_start, source, from, to, scale, worst)
    !> Number of block rows, and of blocks.
    integer, intent(in) :: n, n_block
    !> Where the rows begin, and where each block comes from.
    integer, intent(in) :: row_start(n + 1), source(n_block)
    !> Values of the original.
    real(wp), intent(in) :: from(3, 3, n_block)
    !> Values of the copy.
    real(wp), intent(inout) :: to(3, 3, n_block)
    !> Factor of each row.
    real(wp), intent(inout) :: scale(3, n)
    !> The bad row; 0 if there is none.
    integer, intent(out) :: worst
    real(wp) :: a(3), b(3), c(3)
    integer :: i, k, m

    do i = 1, n
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
      worst = i
      if (.not. all(ieee_is_finite(a))) return
      if (any(a < 1.0e3_wp*tiny(a))) return
      a = 1.0_wp/a
      scale(:, i) = a
      do k = row_start(i), row_start(i + 1) - 1
        m = source(k)
        to(:, 1, k) = a*from(:, 1, m)
        to(:, 2, k) = a*from(:, 2, m)
        to(:, 3, k) = a*from(:, 3, m)
      end do
    end do
    worst = 0
  end subroutine scale_rows

  !> Renumbers and scales a right-hand side.
  pure subroutine scaled_system_scale_rhs(self, b, scaled)
    !> The system.
    class(scaled_system_t), intent(in) :: self
    !> The original, `(3n)`.
    real(wp), intent(in) :: b(:)
    !> The copy, `(3n)`.
    real(wp), intent(out) :: scaled(:)
    integer :: i, j

    do i = 1, self%matrix%n
      j = self%order(i)
      scaled(3*i - 2:3*i) = self%scale(:, i)*b(3*j - 2:3*j)
    end do
  end subroutine scaled_system_scale_rhs

  !> Takes a solution back to the original numbering.
  pure subroutine scaled_system_give_back(self, copy, x)
    !> The system.
    class(scaled_system_t), intent(in) :: self
    !> The solution in the copy's numbering, `(3n)`.
    real(wp), intent(in) :: copy(:)
    !> The solution, `(3n)`.
    real(wp), intent(out) :: x(:)
    integer :: i, j

    do i = 1, self%matrix%n
      j = self%order(i)
      x(3*j - 2:3*j) = copy(3*i - 2:3*i)
    end do
  end subroutine scaled_system_give_back

end module dd3_linalg_scaled_system
