! SPDX-License-Identifier: GPL-3.0-or-later
!> Sparse square matrix of 3x3 blocks, stored by block rows with sorted columns.
module dd3_linalg_matrix
  use dd3_base_kinds, only : wp
  use dd3_base_threads, only : least_values, threads_for
  implicit none
  private
  public :: block_matrix_t, lists_t, new_pattern, new_pattern_from_rows, find_positions, &
      position_of, keep_rows, set_unit_row, multiply, clear, copy_blocks, copy_values, add_element

  !> Sparse matrix of 3x3 blocks. Vectors that go with it have rank 1 and size 3n.
  type :: block_matrix_t
    !> Number of block rows and columns.
    integer :: n = 0
    !> Where each block row begins in `column` and `value`, `(n + 1)`.
    integer, allocatable :: row_start(:)
    !> Block column of each block, ascending within a row.
    integer, allocatable :: column(:)
    !> Position of the diagonal block of each row, `(n)`.
    integer, allocatable :: diagonal(:)
    !> Blocks: row component, column component, block, `(3, 3, :)`.
    real(wp), allocatable :: value(:, :, :)
    !> Rank of each block row, `(n)`; not allocated if there is one rank. A rank has the rows of its
    !> own and some others, to which it adds; the rest has no blocks.
    integer, allocatable :: owner(:)
  end type block_matrix_t

  !> Several lists in one array: list i is `item(start(i):start(i + 1) - 1)`.
  type :: lists_t
    integer, allocatable :: start(:), item(:)
  end type lists_t

contains

  !> Create a zero matrix with the pattern of a mesh, in which the nodes of an element are coupled.
  !> The nodes' block rows and columns are followed by extra ones, each coupled with a list of nodes
  !> and with itself.
  subroutine new_pattern(self, n_node, connectivity, extra_start, extra_node)
    type(block_matrix_t), intent(out) :: self
    integer, intent(in) :: n_node
    !> Nodes of each element, `(n_element_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    !> Where the nodes of each extra row begin in `extra_node`, `(n_extra + 1)`.
    integer, intent(in), optional :: extra_start(:)
    !> Nodes of the extra rows.
    integer, intent(in), optional :: extra_node(:)

    type(lists_t) :: element, extra, at_element, at_extra
    integer, allocatable :: marker(:), row_start(:), column(:)
    integer :: i, n, n_extra, n_row, m, pass

    m = size(connectivity, 1)
    element%start = [(1 + m*(i - 1), i=1, size(connectivity, 2) + 1)]
    element%item = reshape(connectivity, [size(connectivity)])
    extra%start = [1]
    allocate (extra%item(0))
    if (present(extra_start) .and. present(extra_node)) then
      extra%start = extra_start
      extra%item = extra_node
    end if
    n_extra = size(extra%start) - 1
    n = n_node + n_extra
    call transpose_lists(element, n, at_element)
    call transpose_lists(extra, n, at_extra)
    allocate (marker(n), row_start(n + 1), column(0))
    do pass = 1, 2
      marker = 0
      row_start(1) = 1
      do i = 1, n
        n_row = 0
        call add_column(i)
        if (i <= n_node) then
          call add_node(i)
        else
          call add_list(extra, i - n_node)
        end if
        row_start(i + 1) = row_start(i) + n_row
        if (pass == 2) call sort(column(row_start(i):row_start(i + 1) - 1))
      end do
      if (pass == 1) then
        deallocate (column)
        allocate (column(row_start(n + 1) - 1))
      end if
    end do
    call new_pattern_from_rows(self, row_start, column)

  contains

    !> Add the columns coupled with a node to the row.
    subroutine add_node(node)
      integer, intent(in) :: node

      integer :: k

      do k = at_element%start(node), at_element%start(node + 1) - 1
        call add_list(element, at_element%item(k))
      end do
      do k = at_extra%start(node), at_extra%start(node + 1) - 1
        call add_column(n_node + at_extra%item(k))
      end do
    end subroutine add_node

    !> Add the columns of one list to the row.
    subroutine add_list(lists, number)
      type(lists_t), intent(in) :: lists
      integer, intent(in) :: number

      integer :: k

      do k = lists%start(number), lists%start(number + 1) - 1
        call add_column(lists%item(k))
      end do
    end subroutine add_list

    !> Add column j to the row unless it is there already.
    subroutine add_column(j)
      integer, intent(in) :: j

      if (marker(j) == i) return
      marker(j) = i
      if (pass == 2) column(row_start(i) + n_row) = j
      n_row = n_row + 1
    end subroutine add_column

  end subroutine new_pattern

  !> Create a zero matrix of a given pattern; missing diagonal blocks are added.
  subroutine new_pattern_from_rows(self, row_start, column)
    type(block_matrix_t), intent(out) :: self
    !> See `block_matrix_t`.
    integer, intent(in) :: row_start(:), column(:)

    integer :: i, k, next

    self%n = size(row_start) - 1
    allocate (self%row_start(self%n + 1), self%diagonal(self%n), self%column(size(column) + self%n))
    next = 1
    do i = 1, self%n
      self%row_start(i) = next
      self%diagonal(i) = 0
      do k = row_start(i), row_start(i + 1) - 1
        if (self%diagonal(i) == 0 .and. column(k) >= i) call add_diagonal(column(k) > i)
        self%column(next) = column(k)
        next = next + 1
      end do
      if (self%diagonal(i) == 0) call add_diagonal(.true.)
    end do
    self%row_start(self%n + 1) = next
    self%column = self%column(:next - 1)
    allocate (self%value(3, 3, next - 1))
    self%value = 0.0_wp

  contains

    !> Set the position of the diagonal block and insert it if missing.
    subroutine add_diagonal(missing)
      logical, intent(in) :: missing

      self%diagonal(i) = next
      if (.not. missing) return
      self%column(next) = i
      next = next + 1
    end subroutine add_diagonal

  end subroutine new_pattern_from_rows

  !> Keep the blocks of some rows alone; the others have none, and no diagonal block.
  subroutine keep_rows(self, kept)
    type(block_matrix_t), intent(inout) :: self
    logical, intent(in) :: kept(:)

    integer, allocatable :: row_start(:)
    integer :: i, n

    allocate (row_start(self%n + 1))
    row_start(1) = 1
    do i = 1, self%n
      n = 0
      if (kept(i)) n = self%row_start(i + 1) - self%row_start(i)
      row_start(i + 1) = row_start(i) + n
      associate (moved => row_start(i) - self%row_start(i))
        self%column(row_start(i):row_start(i + 1) - 1) = &
            self%column(self%row_start(i):self%row_start(i) + n - 1)
        self%diagonal(i) = merge(self%diagonal(i) + moved, 0, kept(i))
      end associate
    end do
    self%row_start = row_start
    self%column = self%column(:row_start(self%n + 1) - 1)
    deallocate (self%value)
    allocate (self%value(3, 3, size(self%column)), source=0.0_wp)
  end subroutine keep_rows

  !> Invert lists: list j of the result holds the numbers of the lists that hold j.
  subroutine transpose_lists(lists, n, transposed)
    type(lists_t), intent(in) :: lists
    !> Largest item.
    integer, intent(in) :: n
    type(lists_t), intent(out) :: transposed

    integer, allocatable :: next(:)
    integer :: i, j, k

    allocate (transposed%start(n + 1), transposed%item(size(lists%item)))
    transposed%start = 0
    do k = 1, size(lists%item)
      transposed%start(lists%item(k) + 1) = transposed%start(lists%item(k) + 1) + 1
    end do
    transposed%start(1) = 1
    do j = 1, n
      transposed%start(j + 1) = transposed%start(j + 1) + transposed%start(j)
    end do
    next = transposed%start
    do i = 1, size(lists%start) - 1
      do k = lists%start(i), lists%start(i + 1) - 1
        j = lists%item(k)
        transposed%item(next(j)) = i
        next(j) = next(j) + 1
      end do
    end do
  end subroutine transpose_lists

  !> Sort numbers in ascending order (insertion sort, fast for nearly sorted lists).
  pure subroutine sort(list)
    integer, intent(inout) :: list(:)

    integer :: i, j, moved

    do i = 2, size(list)
      moved = list(i)
      j = i - 1
      do while (j >= 1)
        if (list(j) <= moved) exit
        list(j + 1) = list(j)
        j = j - 1
      end do
      list(j + 1) = moved
    end do
  end subroutine sort

  !> Find the positions in `value` of the blocks of each element.
  subroutine find_positions(self, connectivity, position)
    type(block_matrix_t), intent(in) :: self
    !> Nodes of each element, `(n_element_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    !> Row node, column node, element, `(n_element_node, n_element_node, n_element)`; 0 if the
    !> pattern lacks the block.
    integer, allocatable, intent(out) :: position(:, :, :)

    integer :: a, b, e, m

    m = size(connectivity, 1)
    allocate (position(m, m, size(connectivity, 2)))
    do e = 1, size(connectivity, 2)
      do b = 1, m
        do a = 1, m
          position(a, b, e) = position_of(self, connectivity(a, e), connectivity(b, e))
        end do
      end do
    end do
  end subroutine find_positions

  !> Return the position in `value` of a block; 0 if the pattern lacks it.
  pure integer function position_of(self, row, column)
    type(block_matrix_t), intent(in) :: self
    !> Block row and column.
    integer, intent(in) :: row, column

    integer :: low, high, middle

    position_of = 0
    low = self%row_start(row)
    high = self%row_start(row + 1) - 1
    do while (low <= high)
      middle = (low + high)/2
      if (self%column(middle) == column) then
        position_of = middle
        return
      else if (self%column(middle) < column) then
        low = middle + 1
      else
        high = middle - 1
      end if
    end do
  end function position_of

  !> Make the row of one component of a block row a unit row.
  pure subroutine set_unit_row(self, row, component)
    type(block_matrix_t), intent(inout) :: self
    integer, intent(in) :: row, component

    self%value(component, :, self%row_start(row):self%row_start(row + 1) - 1) = 0.0_wp
    self%value(component, component, self%diagonal(row)) = 1.0_wp
  end subroutine set_unit_row

  !> Set all blocks to zero.
  subroutine clear(self)
    type(block_matrix_t), intent(inout) :: self

    if (.not. allocated(self%value)) allocate (self%value(3, 3, size(self%column)))
    call set_zero(size(self%value), self%value)
  end subroutine clear

  !> Kernel of `clear`, on a flat array: gfortran clears an array of blocks block by block.
  subroutine set_zero(n, value)
    integer, intent(in) :: n
    real(wp), intent(out) :: value(n)

    integer :: i

    !$omp parallel do num_threads(threads_for(n, least_values))
    do i = 1, n
      value(i) = 0.0_wp
    end do
    !$omp end parallel do
  end subroutine set_zero

  !> Copy the blocks of a matrix into one of the same pattern.
  subroutine copy_blocks(from, to)
    type(block_matrix_t), intent(in) :: from
    type(block_matrix_t), intent(inout) :: to

    !> Blocks that a thread copies at a time.
    integer, parameter :: chunk = 512
    integer :: first, n

    n = size(from%column)
    !$omp parallel do num_threads(threads_for(9*n, least_values))
    do first = 1, n, chunk
      call copy_values(9*min(chunk, n - first + 1), from%value(1, 1, first), to%value(1, 1, first))
    end do
    !$omp end parallel do
  end subroutine copy_blocks

  !> Kernel: copy values as one contiguous array, whatever its shape.
  pure subroutine copy_values(n, from, to)
    integer, intent(in) :: n
    real(wp), intent(in) :: from(n)
    real(wp), intent(out) :: to(n)

    to = from
  end subroutine copy_values

  !> Add the blocks of an element.
  pure subroutine add_element(self, n_node, position, block)
    type(block_matrix_t), intent(inout) :: self
    !> Number of nodes of the element.
    integer, intent(in) :: n_node
    !> Positions found by `find_positions`: row node, column node.
    integer, intent(in) :: position(n_node, n_node)
    !> Blocks: row and column component, column node, row node.
    real(wp), intent(in) :: block(9, n_node, n_node)

    call add_blocks(n_node, position, block, size(self%column), self%value)
  end subroutine add_element

  !> Kernel of `add_element`.
  pure subroutine add_blocks(n_node, position, block, n_block, value)
    integer, intent(in) :: n_node, position(n_node, n_node)
    real(wp), intent(in) :: block(9, n_node, n_node)
    integer, intent(in) :: n_block
    real(wp), intent(inout) :: value(9, n_block)

    integer :: a, b, k

    do a = 1, n_node
      do b = 1, n_node
        k = position(a, b)
        value(:, k) = value(:, k) + block(:, b, a)
      end do
    end do
  end subroutine add_blocks

  !> Evaluate the product y = A x.
  subroutine multiply(self, x, y)
    type(block_matrix_t), intent(in) :: self
    real(wp), intent(in) :: x(3*self%n)
    real(wp), intent(out) :: y(3*self%n)

    call multiply_rows(self%n, size(self%column), self%row_start, self%column, self%value, x, y)
  end subroutine multiply

  !> Kernel of the product, with one partial sum per column of the blocks, so that no addition waits
  !> for the previous one.
  subroutine multiply_rows(n, n_block, row_start, column, value, x, y)
    integer, intent(in) :: n, n_block, row_start(n + 1), column(n_block)
    real(wp), intent(in) :: value(3, 3, n_block), x(3, n)
    real(wp), intent(out) :: y(3, n)

    real(wp) :: a(3), b(3), c(3)
    integer :: i, j, k

    !$omp parallel do num_threads(threads_for(9*n_block, least_values)) private(a, b, c, j, k)
    do i = 1, n
      a = 0.0_wp
      b = 0.0_wp
      c = 0.0_wp
      do k = row_start(i), row_start(i + 1) - 1
        j = column(k)
        a = a + value(:, 1, k)*x(1, j)
        b = b + value(:, 2, k)*x(2, j)
        c = c + value(:, 3, k)*x(3, j)
      end do
      y(:, i) = a + b + c
    end do
    !$omp end parallel do
  end subroutine multiply_rows

end module dd3_linalg_matrix
