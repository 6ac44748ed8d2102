!> Sparse square matrix of 3x3 blocks, stored by block rows with sorted columns, and its pattern
!> from the elements' connectivity. The product keeps one partial sum per column of the blocks, so
!> that no addition has to wait for the one before it.
module dd3_linalg_matrix
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: block_matrix_t, new_pattern, new_pattern_from_rows, find_positions, position_of, &
    multiply, clear, copy_blocks, add_element

  !> Sparse matrix of 3x3 blocks. Vectors that go with it have rank 1 and size 3n.
  type :: block_matrix_t
    !> Number of block rows and columns.
    integer :: n = 0
    !> Where each block row begins in `column` and `value`, `(n + 1)`.
    integer, allocatable :: row_start(:)
    !> Block column of each block, ascending within a row.
    integer, allocatable :: column(:)
    !> Where the diagonal block of each row stands, `(n)`.
    integer, allocatable :: diagonal(:)
    !> The blocks: row component, column component, block, `(3, 3, :)`.
    real(wp), allocatable :: value(:, :, :)
  end type block_matrix_t

  !> Lists one after the other: list i is `item(start(i):start(i + 1) - 1)`.
  type :: lists_t
    !> Where each list begins.
    integer, allocatable :: start(:)
    !> Members of all lists.
    integer, allocatable :: item(:)
  end type lists_t

contains

  !> Builds the pattern of a mesh: the nodes of one element are coupled. Extra block rows and
  !> columns come after the nodes'; each is coupled with a list of nodes and with itself. All values
  !> are zero.
  subroutine new_pattern(self, n_node, connectivity, extra_start, extra_node)
    !> The matrix made.
    type(block_matrix_t), intent(out) :: self
    !> Number of nodes.
    integer, intent(in) :: n_node
    !> Nodes of each element, `(n_element_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    !> Where the nodes of each extra row begin in `extra_node`, `(n_extra + 1)`.
    integer, intent(in), optional :: extra_start(:)
    !> Nodes of the extra rows, one list after the other.
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
        call take(i)
        if (i <= n_node) then
          call take_node(i)
        else
          call take_list(extra, i - n_node)
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

    !> Takes all that is coupled with a node into the row.
    subroutine take_node(node)
      !> The node.
      integer, intent(in) :: node
      integer :: k

      do k = at_element%start(node), at_element%start(node + 1) - 1
        call take_list(element, at_element%item(k))
      end do
      do k = at_extra%start(node), at_extra%start(node + 1) - 1
        call take(n_node + at_extra%item(k))
      end do
    end subroutine take_node

    !> Takes the members of a list into the row.
    subroutine take_list(lists, number)
      !> The lists.
      type(lists_t), intent(in) :: lists
      !> Which of them.
      integer, intent(in) :: number
      integer :: k

      do k = lists%start(number), lists%start(number + 1) - 1
        call take(lists%item(k))
      end do
    end subroutine take_list

    !> Takes one column into the row, unless it is there already.
    subroutine take(j)
      !> The column.
      integer, intent(in) :: j

      if (marker(j) == i) return
      marker(j) = i
      if (pass == 2) column(row_start(i) + n_row) = j
      n_row = n_row + 1
    end subroutine take

  end subroutine new_pattern

  !> Builds a matrix of a given pattern; a diagonal block that is missing is added. All values are
  !> zero.
  subroutine new_pattern_from_rows(self, row_start, column)
    !> The matrix made.
    type(block_matrix_t), intent(out) :: self
    !> Where each block row begins in `column`, `(n + 1)`.
    integer, intent(in) :: row_start(:)
    !> Block columns, ascending within a row.
    integer, intent(in) :: column(:)
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

    !> Notes the place of the diagonal block, and makes it where it is missing.
    subroutine add_diagonal(missing)
      !> Whether it is missing.
      logical, intent(in) :: missing

      self%diagonal(i) = next
      if (.not. missing) return
      self%column(next) = i
      next = next + 1
    end subroutine add_diagonal

  end subroutine new_pattern_from_rows

  !> Turns lists round: list j of the result holds the numbers of the lists that hold j.
  subroutine transpose_lists(lists, n, turned)
    !> The lists.
    type(lists_t), intent(in) :: lists
    !> Largest member.
    integer, intent(in) :: n
    !> The lists turned round.
    type(lists_t), intent(out) :: turned
    integer, allocatable :: next(:)
    integer :: i, j, k

    allocate (turned%start(n + 1), turned%item(size(lists%item)))
    turned%start = 0
    do k = 1, size(lists%item)
      turned%start(lists%item(k) + 1) = turned%start(lists%item(k) + 1) + 1
    end do
    turned%start(1) = 1
    do j = 1, n
      turned%start(j + 1) = turned%start(j + 1) + turned%start(j)
    end do
    next = turned%start
    do i = 1, size(lists%start) - 1
      do k = lists%start(i), lists%start(i + 1) - 1
        j = lists%item(k)
        turned%item(next(j)) = i
        next(j) = next(j) + 1
      end do
    end do
  end subroutine transpose_lists

  !> Sorts numbers upwards by insertion, fast for lists that are nearly in order.
  pure subroutine sort(list)
    !> The numbers.
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

  !> Finds where the blocks of each element go: block (node a, node b) of element e is added to
  !> `value(:, :, position(a, b, e))`.
  subroutine find_positions(self, connectivity, position)
    !> The matrix.
    type(block_matrix_t), intent(in) :: self
    !> Nodes of each element, `(n_element_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    !> Position of each block, `(n_element_node, n_element_node, n_element)`; 0 where none is
    !> stored.
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

  !> Where a block is stored; 0 if it is not.
  pure integer function position_of(self, row, column)
    !> The matrix.
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

  !> Sets all blocks to zero.
  pure subroutine clear(self)
    !> The matrix.
    type(block_matrix_t), intent(inout) :: self

    call set_zero(size(self%value), self%value)
  end subroutine clear

  !> Kernel of `clear`: one stretch, where the array of blocks would be cleared block by block.
  pure subroutine set_zero(n, value)
    !> Number of values.
    integer, intent(in) :: n
    !> The values.
    real(wp), intent(out) :: value(n)

    value = 0.0_wp
  end subroutine set_zero

  !> Copies the blocks of a matrix into one of the same pattern.
  pure subroutine copy_blocks(from, to)
    !> The matrix copied.
    type(block_matrix_t), intent(in) :: from
    !> Its copy.
    type(block_matrix_t), intent(inout) :: to

    call copy_values(size(from%value), from%value, to%value)
  end subroutine copy_blocks

  !> Kernel of `copy_blocks`.
  pure subroutine copy_values(n, from, to)
    !> Number of values.
    integer, intent(in) :: n
    !> The values.
    real(wp), intent(in) :: from(n)
    !> Their copies.
    real(wp), intent(out) :: to(n)

    to = from
  end subroutine copy_values

  !> Adds the blocks of an element.
  pure subroutine add_element(self, n_node, position, block)
    !> The matrix.
    type(block_matrix_t), intent(inout) :: self
    !> Number of nodes of the element.
    integer, intent(in) :: n_node
    !> Where they go: row node, column node.
    integer, intent(in) :: position(n_node, n_node)
    !> The blocks: row component, column component, column node, row node.
    real(wp), intent(in) :: block(9, n_node, n_node)

    call add_blocks(n_node, position, block, size(self%column), self%value)
  end subroutine add_element

  !> Kernel of `add_element`.
  pure subroutine add_blocks(n_node, position, block, n_block, value)
    !> Number of nodes of the element.
    integer, intent(in) :: n_node
    !> See `add_element`.
    integer, intent(in) :: position(n_node, n_node)
    !> See `add_element`.
    real(wp), intent(in) :: block(9, n_node, n_node)
    !> Number of blocks of the matrix.
    integer, intent(in) :: n_block
    !> Blocks of the matrix.
    real(wp), intent(inout) :: value(9, n_block)
    integer :: a, b, k

    do a = 1, n_node
      do b = 1, n_node
        k = position(a, b)
        value(:, k) = value(:, k) + block(:, b, a)
      end do
    end do
  end subroutine add_blocks

  !> Product y = A x.
  pure subroutine multiply(self, x, y)
    !> The matrix.
    type(block_matrix_t), intent(in) :: self
    !> The vector, `(3n)`.
    real(wp), intent(in) :: x(3*self%n)
    !> The product, `(3n)`.
    real(wp), intent(out) :: y(3*self%n)

    call multiply_rows(self%n, size(self%column), self%row_start, self%column, self%value, x, y)
  end subroutine multiply

  !> Kernel of the product.
  pure subroutine multiply_rows(n, n_block, row_start, column, value, x, y)
    !> Number of block rows, and of blocks.
    integer, intent(in) :: n, n_block
    !> See `block_matrix_t`.
    integer, intent(in) :: row_start(n + 1), column(n_block)
    !> See `block_matrix_t`.
    real(wp), intent(in) :: value(3, 3, n_block)
    !> The vector.
    real(wp), intent(in) :: x(3, n)
    !> The product.
    real(wp), intent(out) :: y(3, n)
    real(wp) :: a(3), b(3), c(3)
    integer :: i, j, k

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
  end subroutine multiply_rows

end module dd3_linalg_matrix
