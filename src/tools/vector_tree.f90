! SPDX-License-Identifier: GPL-3.0-or-later
!> Points of a surface with two vectors each, and the largest sum of their lengths within a distance
!> of a place. The points are sorted along the Z-order curve (Morton 1966); blocks of them are the
!> leaves of a balanced tree of boxes with the largest sum below each node, so that a search leaves
!> out all that is too far or too small.
module dd3_tools_vector_tree
  use dd3_base_kinds, only : i8, wp
  use dd3_base_sorting, only : ascending
  use dd3_tools_box_tree, only : box_distance
  implicit none
  private
  public :: facing_t, vector_tree_t, new_vector_tree, largest_within

  !> Points in a leaf.
  integer, parameter :: leaf_size = 8
  !> Bits of a coordinate in the place on the curve: three of them fit into a real number.
  integer, parameter :: n_bit = 17
  !> Component of a unit vector in a plane below which it has no direction there.
  real(wp), parameter :: upright = 1.0e-3_wp
  !> Largest number of nodes on the stack of a search.
  integer, parameter :: most_levels = 40

  !> Directions of normals: all within an angle of one.
  type :: facing_t
    real(wp) :: normal(3) = 0.0_wp
    !> Cosine of the angle.
    real(wp) :: least_cosine = -1.0_wp
  end type facing_t

  !> The tree: node i has the halves 2 i and 2 i + 1; the last `n_leaf` nodes are the leaves.
  type :: vector_tree_t
    integer :: n = 0, n_leaf = 0
    !> Positions in the order of the curve, mm, and unit normals of the surface there, `(3, n)`.
    real(wp), allocatable :: x(:, :), normal(:, :)
    !> Vectors, `(3, 2, n)`.
    real(wp), allocatable :: vector(:, :, :)
    !> Lower and upper corner of the box of each node, `(3, 2, 2*n_leaf - 1)`, mm, and the largest
    !> sum of the lengths of the vectors of a point in it.
    real(wp), allocatable :: box(:, :, :), largest(:)
  end type vector_tree_t

contains

  !> Make the tree.
  subroutine new_vector_tree(self, x, vector, normal)
    type(vector_tree_t), intent(out) :: self
    !> Positions, `(3, n)`, mm, vectors, `(3, 2, n)`, and unit normals of the surface, `(3, n)`.
    real(wp), intent(in) :: x(:, :), vector(:, :, :), normal(:, :)

    integer, allocatable :: order(:)
    integer :: i, first, last

    self%n = size(x, 2)
    if (self%n == 0) return
    order = ascending(places_on_curve(x))
    self%x = x(:, order)
    self%vector = vector(:, :, order)
    self%normal = normal(:, order)
    self%n_leaf = 1
    do while (self%n_leaf*leaf_size < self%n)
      self%n_leaf = 2*self%n_leaf
    end do
    allocate (self%box(3, 2, 2*self%n_leaf - 1), self%largest(2*self%n_leaf - 1))
    do i = 2*self%n_leaf - 1, 1, -1
      if (i >= self%n_leaf) then
        call leaf_range(self, i, first, last)
        ! Those behind the last point are empty.
        self%box(:, 1, i) = minval(self%x(:, first:last), dim=2)
        self%box(:, 2, i) = maxval(self%x(:, first:last), dim=2)
        self%largest(i) = maxval(sum(norm2(self%vector(:, :, first:last), dim=1), dim=1))
      else
        self%box(:, 1, i) = min(self%box(:, 1, 2*i), self%box(:, 1, 2*i + 1))
        self%box(:, 2, i) = max(self%box(:, 2, 2*i), self%box(:, 2, 2*i + 1))
        self%largest(i) = max(self%largest(2*i), self%largest(2*i + 1))
      end if
    end do
  end subroutine new_vector_tree

  !> Return the range of the points of a leaf; last < first if there is none.
  pure subroutine leaf_range(self, node, first, last)
    type(vector_tree_t), intent(in) :: self
    integer, intent(in) :: node
    integer, intent(out) :: first, last

    first = 1 + leaf_size*(node - self%n_leaf)
    last = min(first + leaf_size - 1, self%n)
    first = min(first, self%n + 1)
  end subroutine leaf_range

  !> Return the places of points on the curve.
  pure function places_on_curve(x) result(place)
    real(wp), intent(in) :: x(:, :)
    real(wp) :: place(size(x, 2))

    real(wp) :: lower(3), scale
    integer(i8) :: cell(3), code
    integer :: i, k, bit

    lower = minval(x, dim=2)
    scale = real(2**n_bit - 1, wp)/max(maxval(maxval(x, dim=2) - lower), tiny(1.0_wp)**0.5_wp)
    do i = 1, size(x, 2)
      cell = int(scale*(x(:, i) - lower), i8)
      code = 0
      do bit = n_bit - 1, 0, -1
        do k = 1, 3
          code = 2*code + ibits(cell(k), bit, 1)
        end do
      end do
      place(i) = real(code, wp)
    end do
  end function places_on_curve

  !> Return the largest sum of the lengths of the vectors of a point within a distance of a place,
  !> or of the lengths multiplied by a factor of their directions.
  pure real(wp) function largest_within(self, x, distance, resolution, facing, frame) &
      result(largest)
    type(vector_tree_t), intent(in) :: self
    real(wp), intent(in) :: x(3)
    !> mm.
    real(wp), intent(in) :: distance
    !> Difference from the largest sum that may be left out.
    real(wp), intent(in) :: resolution
    !> Normals of the points that count; all without.
    type(facing_t), intent(in), optional :: facing
    !> As for `factor_along`.
    real(wp), intent(in), optional :: frame(3, 3)

    real(wp) :: length(2)
    integer :: stack(most_levels), depth, node, first, last, i

    largest = 0.0_wp
    if (self%n == 0) return
    depth = 1
    stack(1) = 1
    do while (depth > 0)
      node = stack(depth)
      depth = depth - 1
      if (self%largest(node) <= largest + resolution) cycle
      if (box_distance(self%box(:, 1, node), self%box(:, 2, node), x) > distance) cycle
      if (node >= self%n_leaf) then
        call leaf_range(self, node, first, last)
        do i = first, last
          if (sum((self%x(:, i) - x)**2) > distance**2) cycle
          if (present(facing)) then
            if (dot_product(self%normal(:, i), facing%normal) < facing%least_cosine) cycle
          end if
          length = norm2(self%vector(:, :, i), dim=1)
          if (present(frame)) length = length*[factor_along(self%vector(:, 1, i), frame), &
              factor_along(self%vector(:, 2, i), frame)]
          largest = max(largest, sum(length))
        end do
        cycle
      end if
      ! The half with the larger value first.
      i = merge(0, 1, self%largest(2*node) < self%largest(2*node + 1))
      stack(depth + 1) = 2*node + i
      stack(depth + 2) = 2*node + 1 - i
      depth = depth + 2
    end do
  end function largest_within

  !> Return min(1, 1/max(|e.g_1|, |e.g_2|)), e being the direction of a vector in a plane; 1 for a
  !> vector at right angles to it.
  pure real(wp) function factor_along(vector, frame) result(factor)
    real(wp), intent(in) :: vector(3)
    !> Vectors g_1 and g_2 in the plane, and its unit normal.
    real(wp), intent(in) :: frame(3, 3)

    real(wp) :: component(3), length

    component = matmul(vector, frame)
    length = norm2(vector - component(3)*frame(:, 3))
    factor = 1.0_wp
    if (length > upright*norm2(vector)) then
      factor = length/max(length, abs(component(1)), abs(component(2)))
    end if
  end function factor_along

end module dd3_tools_vector_tree
