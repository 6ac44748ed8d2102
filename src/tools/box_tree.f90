! SPDX-License-Identifier: GPL-3.0-or-later
!> Tree of the bounding boxes of patches (bounding volume hierarchy). The boxes are halved at the
!> median of their centres along the longest side of their common box until few are left. The halves
!> of a node are side by side, followed by all nodes below the first half, then those below the
!> second: a walk near a point reads few places of a large tree.
module dd3_tools_box_tree
  use, intrinsic :: iso_fortran_env, only : real32
  use dd3_base_kinds, only : wp
  use dd3_base_sorting, only : ascending
  implicit none
  private
  public :: box_tree_t, box_walk_t, new_box_tree, box_distance, start_walk, next_leaf, &
      nearest_beyond, overlapping, leaf_size

  !> Largest number of boxes in a leaf.
  integer, parameter :: leaf_size = 4
  !> Largest number of nodes on the stack of a walk: one for each level.
  integer, parameter :: most_levels = 32

  !> A node of the tree.
  type :: node_t
    !> Lower and upper corner of the common box, rounded outwards, mm.
    real(real32) :: box(3, 2)
    !> First of its halves; 0 for a leaf.
    integer :: half = 0
  end type node_t

  !> The tree.
  type :: box_tree_t
    !> Number of the box at each place.
    integer, allocatable :: number(:)
    !> Lower and upper corner of the box at each place, `(3, 2, n)`, mm.
    real(wp), allocatable :: box(:, :, :)
    type(node_t), allocatable :: node(:)
  end type box_tree_t

  !> A node with its places.
  type :: range_t
    integer :: node, first, last
    !> Distance of its box from the point of the walk, mm.
    real(wp) :: distance
  end type range_t

  !> Walk through the leaves near a point, the nearer half first.
  type :: box_walk_t
    real(wp) :: x(3)
    integer :: depth
    type(range_t) :: stack(most_levels)
  end type box_walk_t

contains

  !> Build the tree of some boxes.
  subroutine new_box_tree(self, lower, upper)
    type(box_tree_t), intent(out) :: self
    !> Corners, `(3, n)`, n > 0, mm.
    real(wp), intent(in) :: lower(:, :), upper(:, :)

    integer :: i, n, n_node

    n = size(lower, 2)
    n_node = 1
    i = n
    do while (i > leaf_size)
      i = (i + 1)/2
      n_node = 2*n_node + 1
    end do
    self%number = [(i, i=1, n)]
    allocate (self%node(n_node), self%box(3, 2, n))
    n_node = 1
    call divide(self, lower, upper, 1, 1, n, n_node)
    self%node = self%node(:n_node)
    self%box(:, 1, :) = lower(:, self%number)
    self%box(:, 2, :) = upper(:, self%number)
  end subroutine new_box_tree

  !> Set the box of a node, and divide its places.
  recursive subroutine divide(self, lower, upper, node, first, last, n_node)
    type(box_tree_t), intent(inout) :: self
    real(wp), intent(in) :: lower(:, :), upper(:, :)
    integer, intent(in) :: node, first, last
    !> Number of nodes so far.
    integer, intent(inout) :: n_node

    real(wp) :: low(3), high(3)
    integer :: axis, half, middle

    associate (number => self%number(first:last))
      low = minval(lower(:, number), dim=2)
      high = maxval(upper(:, number), dim=2)
      self%node(node)%box(:, 1) = rounded(low, -1.0_real32)
      self%node(node)%box(:, 2) = rounded(high, 1.0_real32)
      if (last - first < leaf_size) return
      axis = maxloc(high - low, dim=1)
      number = number(ascending(lower(axis, number) + upper(axis, number)))
    end associate
    middle = (first + last)/2
    half = n_node + 1
    n_node = n_node + 2
    self%node(node)%half = half
    call divide(self, lower, upper, half, first, middle, n_node)
    call divide(self, lower, upper, half + 1, middle + 1, last, n_node)
  end subroutine divide

  !> Return a number of single precision that is not larger (direction -1) or not less (1); its
  !> bound for numbers beyond it.
  elemental real(real32) function rounded(x, direction)
    real(wp), intent(in) :: x
    real(real32), intent(in) :: direction

    real(wp), parameter :: bound = real(huge(1.0_real32), wp)

    rounded = real(min(max(x, -bound), bound), real32)
    if (abs(x) >= bound) return
    if (direction < 0.0_real32 .and. real(rounded, wp) > x .or. &
        direction > 0.0_real32 .and. real(rounded, wp) < x) rounded = nearest(rounded, direction)
  end function rounded

  !> Return the distance of a point from a box, mm; not larger for a box that contains another one,
  !> in floating-point numbers too.
  pure real(wp) function box_distance(lower, upper, x)
    !> Corners, and the point, mm.
    real(wp), intent(in) :: lower(3), upper(3), x(3)

    real(wp) :: outside(3)

    outside = max(lower - x, x - upper, 0.0_wp)
    box_distance = sqrt(dot_product(outside, outside))
  end function box_distance

  !> Return the distance of a point from the common box of a node, mm.
  pure real(wp) function node_distance(box, x)
    !> Corners, mm.
    real(real32), intent(in) :: box(3, 2)
    real(wp), intent(in) :: x(3)

    real(wp) :: outside, square
    integer :: i

    square = 0.0_wp
    do i = 1, 3
      outside = max(real(box(i, 1), wp) - x(i), x(i) - real(box(i, 2), wp), 0.0_wp)
      square = square + outside**2
    end do
    node_distance = sqrt(square)
  end function node_distance

  !> Start a walk at the root.
  pure subroutine start_walk(walk, tree, x)
    type(box_walk_t), intent(out) :: walk
    type(box_tree_t), intent(in) :: tree
    !> mm.
    real(wp), intent(in) :: x(3)

    walk%x = x
    walk%depth = 1
    walk%stack(1) = range_t(1, 1, size(tree%number), node_distance(tree%node(1)%box, x))
  end subroutine start_walk

  !> Go to the next leaf whose box is within a distance, which may shrink during the walk.
  pure subroutine next_leaf(walk, tree, limit, first, last)
    type(box_walk_t), intent(inout) :: walk
    type(box_tree_t), intent(in) :: tree
    !> mm.
    real(wp), intent(in) :: limit
    !> Places of the leaf; last < first at the end.
    integer, intent(out) :: first, last

    type(range_t) :: now, half(2)
    integer :: child, middle, nearer

    first = 1
    last = 0
    do while (walk%depth > 0)
      now = walk%stack(walk%depth)
      walk%depth = walk%depth - 1
      if (now%distance > limit) cycle
      if (now%last - now%first < leaf_size) then
        first = now%first
        last = now%last
        return
      end if
      middle = (now%first + now%last)/2
      child = tree%node(now%node)%half
      half(1) = range_t(child, now%first, middle, node_distance(tree%node(child)%box, walk%x))
      half(2) = range_t(child + 1, middle + 1, now%last, &
          node_distance(tree%node(child + 1)%box, walk%x))
      nearer = merge(1, 2, half(1)%distance < half(2)%distance)
      if (abs(half(1)%distance - half(2)%distance) <= 0.0_wp) then
        nearer = nearer_centre(tree, child, walk%x)
      end if
      walk%stack(walk%depth + 1) = half(3 - nearer)
      walk%stack(walk%depth + 2) = half(nearer)
      walk%depth = walk%depth + 2
    end do
  end subroutine next_leaf

  !> Return 1 or 2 for the one of two sibling nodes whose centre is nearer to a point.
  pure integer function nearer_centre(tree, first, x) result(nearer)
    type(box_tree_t), intent(in) :: tree
    !> First of the siblings.
    integer, intent(in) :: first
    real(wp), intent(in) :: x(3)

    real(wp) :: square(2)
    integer :: i

    do i = 1, 2
      associate (box => tree%node(first + i - 1)%box)
        square(i) = sum((real(box(:, 1), wp) + real(box(:, 2), wp) - 2.0_wp*x)**2)
      end associate
    end do
    nearer = merge(1, 2, square(1) <= square(2))
  end function nearer_centre

  !> Return a lower bound, at most a tenth too small, of the distance of a point from all boxes that
  !> are farther than a limit, mm; a huge value if there is none. The exact distance takes ten times
  !> as long where many boxes are at nearly the same one.
  pure real(wp) function nearest_beyond(tree, x, limit) result(nearest)
    type(box_tree_t), intent(in) :: tree
    real(wp), intent(in) :: x(3), limit

    real(wp), parameter :: slack = 0.9_wp
    type(box_walk_t) :: walk
    real(wp) :: distance
    integer :: i, first, last

    nearest = huge(1.0_wp)
    call start_walk(walk, tree, x)
    do
      call next_leaf(walk, tree, slack*nearest, first, last)
      if (last < first) exit
      do i = first, last
        distance = box_distance(tree%box(:, 1, i), tree%box(:, 2, i), x)
        if (distance > limit) nearest = min(nearest, distance)
      end do
    end do
    if (nearest < huge(1.0_wp)) nearest = max(limit, slack*nearest)
  end function nearest_beyond

  !> Return the numbers of the boxes that overlap a box, ascending.
  pure function overlapping(tree, lower, upper) result(number)
    type(box_tree_t), intent(in) :: tree
    !> Corners, mm.
    real(wp), intent(in) :: lower(3), upper(3)
    integer, allocatable :: number(:)

    integer :: stack(3, most_levels), found(64), depth, n, node, first, last, middle, i

    allocate (number(0))
    n = 0
    depth = 1
    stack(:, 1) = [1, 1, size(tree%number)]
    do while (depth > 0)
      node = stack(1, depth)
      first = stack(2, depth)
      last = stack(3, depth)
      depth = depth - 1
      associate (box => tree%node(node)%box)
        if (is_apart(real(box(:, 1), wp), real(box(:, 2), wp))) cycle
      end associate
      if (last - first >= leaf_size) then
        middle = (first + last)/2
        stack(:, depth + 1) = [tree%node(node)%half, first, middle]
        stack(:, depth + 2) = [tree%node(node)%half + 1, middle + 1, last]
        depth = depth + 2
        cycle
      end if
      do i = first, last
        if (is_apart(tree%box(:, 1, i), tree%box(:, 2, i))) cycle
        if (n == size(found)) number = [number, found]
        if (n == size(found)) n = 0
        n = n + 1
        found(n) = tree%number(i)
      end do
    end do
    number = [number, found(:n)]
    number = number(ascending(real(number, wp)))

  contains

    pure logical function is_apart(box_lower, box_upper)
      real(wp), intent(in) :: box_lower(3), box_upper(3)

      is_apart = any(box_lower > upper .or. box_upper < lower)
    end function is_apart

  end function overlapping

end module dd3_tools_box_tree
