!> Sparsity pattern of an incomplete LU factorisation by level of fill (Watts 1981; Saad, Iterative
!> Methods for Sparse Linear Systems, 2nd ed. 2003, section 10.3.3): entries of the matrix have
!> level 0, fill-in at (i,j) through row k has level lev(i,k) + lev(k,j) + 1, the least over all k
!> counts, and entries above a given level are dropped.
module dd3_linalg_fill_pattern
  use dd3_base_kinds, only : i8
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: fill_pattern_t, new_fill_pattern, elimination_cost

  !> Pattern of L, diagonal and U together.
  type :: fill_pattern_t
    !> Number of block rows.
    integer :: n = 0
    !> Where each row begins in `column`, `(n + 1)`.
    integer, allocatable :: row_start(:)
    !> Block columns, ascending within a row.
    integer, allocatable :: column(:)
    !> Position of the diagonal blocks in `column`, `(n)`.
    integer, allocatable :: diagonal(:)
  end type fill_pattern_t

contains

  !> Build the pattern of the factors.
  subroutine new_fill_pattern(self, matrix, level, most)
    type(fill_pattern_t), intent(out) :: self
    !> Matrix of the pattern; its values are not used.
    type(block_matrix_t), intent(in) :: matrix
    !> Highest level kept.
    integer, intent(in) :: level
    !> Maximum number of blocks; beyond it the lists are not allocated on return.
    integer, intent(in), optional :: most

    ! The row being built: a linked list of columns in ascending order from 0 to n + 1.
    integer, allocatable :: chain(:), chain_level(:)
    ! Levels of the finished rows.
    integer, allocatable :: level_of(:)
    integer :: i, k

    self%n = matrix%n
    allocate (self%row_start(self%n + 1), self%diagonal(self%n))
    allocate (self%column(2*size(matrix%column)), level_of(2*size(matrix%column)))
    allocate (chain(0:self%n + 1), chain_level(self%n))
    self%row_start(1) = 1
    do i = 1, self%n
      call start_row(i)
      k = chain(0)
      do while (k < i)
        call merge_row(k)
        k = chain(k)
      end do
      call store_row(i)
      if (present(most)) then
        if (self%row_start(i + 1) > most) then
          deallocate (self%row_start, self%column, self%diagonal)
          return
        end if
      end if
    end do
    self%column = self%column(:self%row_start(self%n + 1) - 1)

  contains

    !> Start the list with row i of the matrix.
    subroutine start_row(i)
      integer, intent(in) :: i

      integer :: position, previous

      previous = 0
      do position = matrix%row_start(i), matrix%row_start(i + 1) - 1
        chain(previous) = matrix%column(position)
        previous = matrix%column(position)
        chain_level(previous) = 0
      end do
      chain(previous) = self%n + 1
    end subroutine start_row

    !> Add the fill-in that comes through row k of U.
    subroutine merge_row(k)
      integer, intent(in) :: k

      integer :: position, j, new_level, previous

      previous = k
      do position = self%diagonal(k) + 1, self%row_start(k + 1) - 1
        new_level = chain_level(k) + level_of(position) + 1
        if (new_level > level) cycle
        j = self%column(position)
        do while (chain(previous) < j)
          previous = chain(previous)
        end do
        if (chain(previous) == j) then
          chain_level(j) = min(chain_level(j), new_level)
        else
          chain(j) = chain(previous)
          chain(previous) = j
          chain_level(j) = new_level
        end if
        previous = j
      end do
    end subroutine merge_row

    !> Append the list to the pattern as row i.
    subroutine store_row(i)
      integer, intent(in) :: i

      integer :: position, j

      position = self%row_start(i)
      j = chain(0)
      do while (j <= self%n)
        if (position > size(self%column)) then
          call double_size(self%column)
          call double_size(level_of)
        end if
        self%column(position) = j
        level_of(position) = chain_level(j)
        if (j == i) self%diagonal(i) = position
        position = position + 1
        j = chain(j)
      end do
      self%row_start(i + 1) = position
    end subroutine store_row

  end subroutine new_fill_pattern

  !> Double the size of a list.
  subroutine double_size(list)
    integer, allocatable, intent(inout) :: list(:)

    integer, allocatable :: larger(:)

    allocate (larger(2*size(list)))
    larger(:size(list)) = list
    call move_alloc(larger, list)
  end subroutine double_size

  !> Return the number of block products that a factorisation on the pattern takes.
  pure integer(i8) function elimination_cost(self)
    type(fill_pattern_t), intent(in) :: self

    integer :: i, k, length

    elimination_cost = 0
    do i = 1, self%n
      do k = self%row_start(i), self%diagonal(i) - 1
        length = self%row_start(self%column(k) + 1) - self%diagonal(self%column(k))
        elimination_cost = elimination_cost + int(length, i8)
      end do
    end do
  end function elimination_cost

end module dd3_linalg_fill_pattern
