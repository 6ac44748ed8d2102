! SPDX-License-Identifier: GPL-3.0-or-later
!> Symbolic factorisation for the multifrontal method: the tree of the fronts of a complete LU
!> factorisation with a symmetric pattern.
!>
!> The rows are numbered by METIS or by approximate minimum degree, whichever costs less, and the
!> elimination tree in postorder; neighbouring rows with the same pattern, or nearly so, are the
!> pivots of one front (Liu, SIAM J. Matrix Anal. Appl. 11, 1990; relaxed amalgamation: Ashcraft and
!> Grimes, ACM Trans. Math. Softw. 15, 1989).
module dd3_linalg_front_tree
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_metis, only : nested_dissection
  use dd3_linalg_ordering, only : find_ordering
  use dd3_linalg_ordering_cost, only : factor_cost
  implicit none
  private
  public :: front_tree_t, choose_ordering, new_front_tree, rows_of

  !> Fronts in postorder. The pivots of front f are the rows `first(f)` to `first(f + 1) - 1` of the
  !> new numbering; its border are the later rows that they are coupled with.
  type :: front_tree_t
    integer :: n_front = 0
    !> Name of the ordering.
    character(len=8) :: ordering = ""
    !> Original number of each block row, `(n)`.
    integer, allocatable :: order(:)
    !> First pivot of each front, `(n_front + 1)`.
    integer, allocatable :: first(:)
    !> Front that the border goes to, `(n_front)`; 0 for a root.
    integer, allocatable :: parent(:)
    !> Last front that goes to each front, and the one before that goes to the same, `(n_front)`; 0
    !> for none.
    integer, allocatable :: last_child(:), previous(:)
    !> Where the border of each front begins in `border`, `(n_front + 1)`.
    integer, allocatable :: border_start(:)
    !> Rows of the borders, ascending in a front, and their places in the parent's front.
    integer, allocatable :: border(:), place(:)
  end type front_tree_t

  !> Pivots and fraction of zeros up to which a front is merged with its parent.
  integer, parameter :: small(3) = [4, 16, 48]
  real(wp), parameter :: zeros(3) = [0.8_wp, 0.2_wp, 0.08_wp]

contains

  !> Build the tree of a matrix with a symmetric pattern; its values are not used.
  subroutine new_front_tree(self, matrix)
    type(front_tree_t), intent(out) :: self
    type(block_matrix_t), intent(in) :: matrix

    integer, allocatable :: parent(:), length(:), front_of(:)

    call choose_ordering(matrix, self%order, self%ordering)
    call elimination_tree(matrix, self%order, parent, length)
    call number_in_postorder(self%order, parent, length)
    call find_fronts(self, parent, length)
    call amalgamate(self, parent, length)
    call connect(self, parent, front_of)
    call find_borders(self, matrix, front_of)
  end subroutine new_front_tree

  !> Choose the ordering with the least cost.
  subroutine choose_ordering(matrix, order, name)
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row.
    integer, allocatable, intent(out) :: order(:)
    character(len=*), intent(out) :: name

    type(error_t), allocatable :: error
    integer, allocatable :: other(:)
    real(wp) :: cost, other_cost
    integer :: n_block
    logical :: found

    name = "AMD"
    call find_ordering("amd", matrix, order, error)
    if (allocated(error)) call find_ordering("none", matrix, order, error)
    call nested_dissection(matrix, other, found)
    if (.not. found) return
    call factor_cost(matrix, order, huge(1), cost, n_block)
    call factor_cost(matrix, other, huge(1), other_cost, n_block)
    if (other_cost >= cost) return
    name = "METIS"
    order = other
  end subroutine choose_ordering

  !> Return the number of block rows of a front, border included.
  pure integer function rows_of(self, f)
    type(front_tree_t), intent(in) :: self
    integer, intent(in) :: f

    rows_of = self%first(f + 1) - self%first(f) + self%border_start(f + 1) - self%border_start(f)
  end function rows_of

  !> Find the elimination tree, and the number of blocks below the diagonal in each column of L.
  pure subroutine elimination_tree(matrix, order, parent, length)
    type(block_matrix_t), intent(in) :: matrix
    !> Original number of each block row.
    integer, intent(in) :: order(:)
    !> 0 for a root.
    integer, allocatable, intent(out) :: parent(:), length(:)

    integer, allocatable :: mark(:), new_number(:)
    integer :: i, k, at

    allocate (parent(matrix%n), length(matrix%n), mark(matrix%n), source=0)
    allocate (new_number(matrix%n))
    new_number(order) = [(i, i=1, matrix%n)]
    do i = 1, matrix%n
      mark(i) = i
      do at = matrix%row_start(order(i)), matrix%row_start(order(i) + 1) - 1
        k = new_number(matrix%column(at))
        if (k >= i) cycle
        do while (mark(k) /= i)
          if (parent(k) == 0) parent(k) = i
          length(k) = length(k) + 1
          mark(k) = i
          k = parent(k)
        end do
      end do
    end do
  end subroutine elimination_tree

  !> Number the rows in postorder of the tree; children keep their order.
  pure subroutine number_in_postorder(order, parent, length)
    integer, intent(inout) :: order(:), parent(:), length(:)

    integer :: n, i, next
    integer, allocatable :: child(:), sibling(:), new_number(:), old(:), path(:)

    n = size(parent)
    allocate (child(0:n), sibling(n), path(n + 1), source=0)
    allocate (new_number(0:n), old(n))
    new_number(0) = 0
    do i = n, 1, -1
      sibling(i) = child(parent(i))
      child(parent(i)) = i
    end do
    next = 0
    i = 0
    ! The tops of the branches are the children of row 0.
    do while (next < n)
      do while (child(i) > 0)
        path(child(i)) = i
        i = child(i)
      end do
      next = next + 1
      new_number(i) = next
      old(next) = i
      child(path(i)) = sibling(i)
      i = path(i)
    end do
    order = order(old)
    parent = new_number(parent(old))
    length = length(old)
  end subroutine number_in_postorder

  !> Find the fronts whose pivots have one pattern.
  pure subroutine find_fronts(self, parent, length)
    type(front_tree_t), intent(inout) :: self
    integer, intent(in) :: parent(:), length(:)

    integer :: i, n

    n = size(parent)
    allocate (self%first(n + 1))
    self%n_front = 0
    do i = 1, n
      if (i > 1) then
        if (parent(i - 1) == i .and. length(i - 1) == length(i) + 1) cycle
      end if
      self%n_front = self%n_front + 1
      self%first(self%n_front) = i
    end do
    self%first(self%n_front + 1) = n + 1
  end subroutine find_fronts

  !> Merge fronts with their parents where the parent follows and few zeros come in.
  pure subroutine amalgamate(self, parent, length)
    type(front_tree_t), intent(inout) :: self
    integer, intent(in) :: parent(:), length(:)

    integer :: f, kept, pivots, own, rows, last
    integer, allocatable :: first(:)
    ! Blocks that are zero in each front kept.
    real(wp), allocatable :: zero(:)
    real(wp) :: added, total

    allocate (first(self%n_front + 1), zero(self%n_front))
    kept = 0
    do f = 1, self%n_front
      kept = kept + 1
      first(kept) = self%first(f)
      zero(kept) = 0.0_wp
      last = self%first(f + 1) - 1
      do while (kept > 1)
        ! The front before ends at first(kept) - 1.
        if (parent(first(kept) - 1) == 0 .or. parent(first(kept) - 1) > last) exit
        own = first(kept) - first(kept - 1)
        pivots = last - first(kept) + 1
        rows = own + pivots + length(last)
        added = real(own, wp)*real(rows - own - length(first(kept) - 1), wp) &
            + zero(kept - 1) + zero(kept)
        total = real(own + pivots, wp)*real(rows, wp)
        if (.not. worth_merging(own + pivots, added/total)) exit
        kept = kept - 1
        zero(kept) = added
      end do
    end do
    first(kept + 1) = size(parent) + 1
    self%n_front = kept
    self%first = first(:kept + 1)
  end subroutine amalgamate

  !> Whether a front of so many pivots with a fraction of zeros is worth while.
  pure logical function worth_merging(pivots, fraction)
    integer, intent(in) :: pivots
    real(wp), intent(in) :: fraction

    worth_merging = any(pivots <= small .and. fraction <= zeros)
  end function worth_merging

  !> Find the parents of the fronts and the front of each row.
  pure subroutine connect(self, parent, front_of)
    type(front_tree_t), intent(inout) :: self
    integer, intent(in) :: parent(:)
    integer, allocatable, intent(out) :: front_of(:)

    integer :: f, above

    allocate (front_of(size(parent)), self%parent(self%n_front))
    allocate (self%last_child(self%n_front), self%previous(self%n_front), source=0)
    do f = 1, self%n_front
      front_of(self%first(f):self%first(f + 1) - 1) = f
    end do
    do f = 1, self%n_front
      above = parent(self%first(f + 1) - 1)
      self%parent(f) = 0
      if (above == 0) cycle
      self%parent(f) = front_of(above)
      self%previous(f) = self%last_child(front_of(above))
      self%last_child(front_of(above)) = f
    end do
  end subroutine connect

  !> List the borders and their places in the parents.
  subroutine find_borders(self, matrix, front_of)
    type(front_tree_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: front_of(:)

    integer, allocatable :: mark(:), new_number(:)
    integer :: f, i, k, child, last, n, start

    allocate (mark(matrix%n), source=0)
    allocate (new_number(matrix%n), self%border_start(self%n_front + 1))
    allocate (self%border(4*matrix%n))
    new_number(self%order) = [(i, i=1, matrix%n)]
    n = 0
    do f = 1, self%n_front
      self%border_start(f) = n + 1
      start = n + 1
      last = self%first(f + 1) - 1
      mark(self%first(f):last) = f
      do i = self%first(f), last
        do k = matrix%row_start(self%order(i)), matrix%row_start(self%order(i) + 1) - 1
          call add(new_number(matrix%column(k)))
        end do
      end do
      child = self%last_child(f)
      do while (child > 0)
        do k = self%border_start(child), self%border_start(child + 1) - 1
          call add(self%border(k))
        end do
        child = self%previous(child)
      end do
      call sort(self%border(start:n))
      self%border_start(f + 1) = n + 1
    end do
    self%border = self%border(:n)
    call find_places(self, size(front_of))

  contains

    !> Add a row that comes after the pivots, unless it is in the border already.
    subroutine add(row)
      integer, intent(in) :: row

      integer, allocatable :: longer(:)

      if (row <= last) return
      if (mark(row) == f) return
      mark(row) = f
      n = n + 1
      if (n > size(self%border)) then
        allocate (longer(2*size(self%border)))
        longer(:size(self%border)) = self%border
        call move_alloc(longer, self%border)
      end if
      self%border(n) = row
    end subroutine add

  end subroutine find_borders

  !> Find the place of each border row in the parent's front.
  pure subroutine find_places(self, n)
    type(front_tree_t), intent(inout) :: self
    integer, intent(in) :: n

    integer :: f, k, at, pivots

    allocate (self%place(size(self%border)), source=0)
    do f = 1, self%n_front
      if (self%parent(f) == 0) cycle
      associate (above => self%parent(f))
        pivots = self%first(above + 1) - self%first(above)
        at = self%border_start(above)
        do k = self%border_start(f), self%border_start(f + 1) - 1
          if (self%border(k) < self%first(above + 1)) then
            self%place(k) = self%border(k) - self%first(above) + 1
          else
            do while (self%border(at) < min(self%border(k), n))
              at = at + 1
            end do
            self%place(k) = pivots + at - self%border_start(above) + 1
          end if
        end do
      end associate
    end do
  end subroutine find_places

  !> Sort numbers in ascending order (heap sort: Williams 1964).
  pure subroutine sort(list)
    integer, intent(inout) :: list(:)

    integer :: i, last, moved

    do i = size(list)/2, 1, -1
      call sift(list, i)
    end do
    do last = size(list), 2, -1
      moved = list(last)
      list(last) = list(1)
      list(1) = moved
      call sift(list(:last - 1), 1)
    end do
  end subroutine sort

  !> Let an item sink in a heap whose largest item is the first.
  pure subroutine sift(heap, from)
    integer, intent(inout) :: heap(:)
    integer, intent(in) :: from

    integer :: i, child, moved

    i = from
    moved = heap(i)
    do while (2*i <= size(heap))
      child = 2*i
      if (child < size(heap)) then
        if (heap(child + 1) > heap(child)) child = child + 1
      end if
      if (heap(child) <= moved) exit
      heap(i) = heap(child)
      i = child
    end do
    heap(i) = moved
  end subroutine sift

end module dd3_linalg_front_tree
