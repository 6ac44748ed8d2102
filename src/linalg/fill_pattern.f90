! SPDX-License-Identifier: GPL-3.0-or-later
!> Sparsity pattern of an incomplete LU factorisation by level of fill (Watts 1981; Saad, Iterative
!> Methods for Sparse Linear Systems, 2nd ed. 2003, section 10.3.3): entries of the matrix have
!> level 0, fill-in at (i,j) through row k has level lev(i,k) + lev(k,j) + 1, the least over all k
!> counts, and entries above a given level are dropped.
module dd3_linalg_fill_pattern
  use dd3_base_kinds, only : i8
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: fill_pattern_t, new_fill_pattern, elimination_cost, fill_limit

  !> Most blocks of a complete factorisation, as a multiple of the matrix's.
  integer, parameter :: fill_limit = 12

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

  !> Row being built: a linked list of columns in ascending order.
  type :: row_t
    !> Column after each one, from 0 (start) to n + 1 (end), `(0:n)`.
    integer, allocatable :: next(:)
    !> Level of each column in the list, `(n)`.
    integer, allocatable :: level(:)
  end type row_t

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

    type(row_t) :: row
    ! Level of each block in `column`.
    integer, allocatable :: block_level(:)
    integer :: i, k

    self%n = matrix%n
    allocate (self%row_start(self%n + 1), self%diagonal(self%n))
    allocate (self%column(2*size(matrix%column)), block_level(2*size(matrix%column)))
    allocate (row%next(0:self%n), row%level(self%n))
    self%row_start(1) = 1
    do i = 1, self%n
      call load_row(row, matrix, i)
      k = row%next(0)
      do while (k < i)
        call merge_row(row, self, block_level, k, level)
        k = row%next(k)
      end do
      call store_row(row, self, block_level, i)
      if (present(most)) then
        if (self%row_start(i + 1) > most) then
          deallocate (self%row_start, self%column, self%diagonal)
          return
        end if
      end if
    end do
    self%column = self%column(:self%row_start(self%n + 1) - 1)
  end subroutine new_fill_pattern

  !> Start the list with row i of the matrix.
  subroutine load_row(row, matrix, i)
    type(row_t), intent(inout) :: row
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: i

    integer :: position, previous

    previous = 0
    do position = matrix%row_start(i), matrix%row_start(i + 1) - 1
      row%next(previous) = matrix%column(position)
      previous = matrix%column(position)
      row%level(previous) = 0
    end do
    row%next(previous) = matrix%n + 1
  end subroutine load_row

  !> Add the fill-in that comes through row k of U to the list.
  subroutine merge_row(row, self, block_level, k, level)
    type(row_t), intent(inout) :: row
    type(fill_pattern_t), intent(in) :: self
    !> Level of each block of the pattern.
    integer, intent(in) :: block_level(:)
    integer, intent(in) :: k
    !> Highest level kept.
    integer, intent(in) :: level

    integer :: position, j, new_level, previous

    previous = k
    do position = self%diagonal(k) + 1, self%row_start(k + 1) - 1
      new_level = row%level(k) + block_level(position) + 1
      if (new_level > level) cycle
      j = self%column(position)
      do while (row%next(previous) < j)
        previous = row%next(previous)
      end do
      if (row%next(previous) == j) then
        row%level(j) = min(row%level(j), new_level)
      else
        row%next(j) = row%next(previous)
        row%next(previous) = j
        row%level(j) = new_level
      end if
      previous = j
    end do
  end subroutine merge_row

  !> Append the list to the pattern as row i.
  subroutine store_row(row, self, block_level, i)
    type(row_t), intent(in) :: row
    type(fill_pattern_t), intent(inout) :: self
    !> Level of each block of the pattern.
    integer, allocatable, intent(inout) :: block_level(:)
    integer, intent(in) :: i

    integer :: position, j

    position = self%row_start(i)
    j = row%next(0)
    do while (j <= self%n)
      if (position > size(self%column)) then
        call double_size(self%column)
        call double_size(block_level)
      end if
      self%column(position) = j
      block_level(position) = row%level(j)
      if (j == i) self%diagonal(i) = position
      position = position + 1
      j = row%next(j)
    end do
    self%row_start(i + 1) = position
  end subroutine store_row

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
