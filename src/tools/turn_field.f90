! SPDX-License-Identifier: GPL-3.0-or-later
!> Turn of the normal of a tool's surface over lengths, such as those of elements that may come to
!> lie on it. At a point of the surface it is the largest angle between the normals at two points
!> in the ball around it whose diameter is the length a: 2 asin(a/(2 R)), the angle over the chord
!> a, on a cylinder or a sphere of radius R, the angle of a kink whatever the length, and the whole
!> angle of a fillet that is shorter than a. Where the surface is curved to the same side at right
!> angles too, the turn in that direction is added: the bilinear patch of a square element with the
!> edge a deviates from a surface with the curvatures k_1 and k_2 by (k_1 + k_2) a^2/8, whatever the
!> direction of its edges. Where it is curved to the other side, nothing is taken off.
!>
!> Points of the surface are spaced (surface_samples.f90), and the two outermost in the ball are
!> less than a apart. Pairs at a distance d > a count too, up to a spacing outside the ball, with
!> |n_1 - n_2| a/d, which is exact on an arc.
!>
!> Pairs count by their distance, not by a path on the surface: patches of other programs are not
!> joined everywhere. Normals that differ by more than 120 degrees do not count, as those on the two
!> sides of a lip, of a rib or of a narrow groove: they are opposite, and can differ by less only
!> where the sides turn by 60 degrees within the ball, which the turn of a side shows, or where they
!> form a wedge. The edge of one that is sharper than 60 degrees does not count; rims, without a
!> surface beside them, do not either.
module dd3_tools_turn_field
  use dd3_base_kinds, only : i8, wp
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_tools_surface, only : surface_t
  use dd3_tools_surface_samples, only : close_spacing, new_surface_samples, surface_samples_t
  use dd3_tools_vector_tree, only : facing_t, largest_within, new_vector_tree, vector_tree_t
  implicit none
  private
  public :: turn_field_t, new_turn_field, turn_over

  !> Squares of |n_1 - n_2| of normals at an angle of 120 degrees, and of 90 degrees, the largest
  !> angle of a pair that is farther apart than the length.
  real(wp), parameter :: largest_square = 3.0_wp, largest_outside = 2.0_wp
  !> Turn below which points are not stored, and the accuracy of the queries, rad.
  real(wp), parameter :: resolution = 1.0e-3_wp
  !> Points up to this distance over the length from the centre of a ball form pairs.
  real(wp), parameter :: range = 0.5_wp + close_spacing
  !> Difference of normals at right angles to the largest one up to which the surface is straight
  !> there.
  real(wp), parameter :: straight = 1.0e-6_wp
  !> Distance of points at the ends of the diameter that is round-off, relative.
  real(wp), parameter :: round_off = 1.0e-9_wp

  !> Turn field of a surface.
  type :: turn_field_t
    !> Lengths, ascending, mm.
    real(wp), allocatable :: length(:)
    !> Points of the surface with the turn over each length, rad, along the difference of the
    !> normals, and that at right angles; those without a turn left out.
    type(vector_tree_t), allocatable :: level(:)
  end type turn_field_t

  !> Points in cells, by a hash table of the cells.
  type :: cells_t
    real(wp) :: size = 0.0_wp
    !> First point of each place of the table, and the next point at the same place; 0 for none.
    integer, allocatable :: first(:), next(:)
  end type cells_t

contains

  !> Make the turn field of a surface.
  subroutine new_turn_field(self, surface, length)
    type(turn_field_t), intent(out) :: self
    type(surface_t), intent(in) :: surface
    !> Lengths, ascending, mm.
    real(wp), intent(in) :: length(:)

    type(surface_samples_t) :: sample
    real(wp), allocatable :: turn(:, :, :)
    integer :: l, i

    self%length = length
    allocate (self%level(size(length)))
    do l = 1, size(length)
      call new_surface_samples(sample, surface, length(l))
      allocate (turn(3, 2, sample%n))
      call find_turns(sample, length(l), turn)
      associate (turned => pack([(i, i=1, sample%n)], norm2(turn(:, 1, :), dim=1) > resolution))
        call new_vector_tree(self%level(l), sample%x(:, turned), turn(:, :, turned), &
            sample%normal(:, turned))
      end associate
      deallocate (turn)
    end do
  end subroutine new_turn_field

  !> Find the turn in the ball around each point.
  subroutine find_turns(sample, length, turn)
    type(surface_samples_t), intent(in) :: sample
    real(wp), intent(in) :: length
    !> Along the difference of the normals, and at right angles, `(3, 2, n)`, rad.
    real(wp), intent(out) :: turn(:, :, :)

    type(cells_t) :: cells
    integer, allocatable :: near(:)
    integer :: i, n

    call new_cells(cells, sample%x, range*length)
    !$omp parallel num_threads(threads_for(sample%n, least_nodes)) private(near, i, n)
    allocate (near(64))
    !$omp do schedule(dynamic, 64)
    do i = 1, sample%n
      call find_near(cells, sample%x, i, near, n)
      turn(:, :, i) = turn_of_pairs(sample%x(:, near(:n)), sample%normal(:, near(:n)), &
          sample%x(:, i), length)
    end do
    !$omp end do
    !$omp end parallel
  end subroutine find_turns

  !> Return the largest angle between normals of points, rad, along the difference of the normals,
  !> and the angle at right angles by which the surface turns to the same side.
  pure function turn_of_pairs(x, normal, centre, length) result(turn)
    !> Points up to a spacing outside the ball, `(3, n)`, mm, and their normals.
    real(wp), intent(in) :: x(:, :), normal(:, :)
    !> Centre and diameter of the ball, mm.
    real(wp), intent(in) :: centre(3), length
    real(wp) :: turn(3, 2)

    logical :: inside(size(x, 2))
    real(wp), dimension(size(x, 2)) :: distance, away
    real(wp) :: largest, square, axis(3), side, least, most
    integer :: i, j, pair(2)

    do i = 1, size(x, 2)
      distance(i) = sum((x(:, i) - centre)**2)
    end do
    inside = distance <= (0.5_wp*length*(1.0_wp + round_off))**2
    j = minloc(distance, dim=1)
    do i = 1, size(x, 2)
      away(i) = norm2(normal(:, i) - normal(:, j))
    end do
    turn = 0.0_wp
    most = maxval(away)
    if (2.0_wp*most <= resolution) return
    largest = least_of_pairs()
    least = sqrt(largest)
    pair = 1
    do j = 2, size(x, 2)
      if (away(j) + most <= least) cycle
      do i = 1, j - 1
        if (away(i) + away(j) <= least) cycle
        square = (normal(1, i) - normal(1, j))**2 + (normal(2, i) - normal(2, j))**2 &
            + (normal(3, i) - normal(3, j))**2
        if (square <= largest) cycle
        square = square*factor_of_pair(square, sum((x(:, i) - x(:, j))**2), length, &
            inside(i) .and. inside(j))
        if (square <= largest) cycle
        largest = square
        least = (1.0_wp - round_off)*sqrt(largest)
        pair = [i, j]
      end do
    end do
    if (largest <= resolution**2) return
    associate (along => normal(:, pair(1)) - normal(:, pair(2)), &
        upright => normal(:, pair(1)) + normal(:, pair(2)))
      turn(:, 1) = 2.0_wp*asin(0.5_wp*sqrt(largest))*along/norm2(along)
      axis = along([2, 3, 1])*upright([3, 1, 2]) - along([3, 1, 2])*upright([2, 3, 1])
      axis = axis/norm2(axis)
      side = sign(1.0_wp, dot_product(along, x(:, pair(1)) - x(:, pair(2))))
    end associate
    turn(:, 2) = 2.0_wp*asin(0.5_wp*largest_along_axis(x, side*normal, inside, axis, length))*axis

  contains

    !> Return a square just below that of one pair, of the normal that differs most from that in the
    !> middle and the one that differs most from it: smaller differences need not be searched.
    pure real(wp) function least_of_pairs() result(least)
      real(wp) :: other(size(x, 2))
      integer :: i, j, k

      k = maxloc(away, dim=1)
      do i = 1, size(x, 2)
        other(i) = sum((normal(:, i) - normal(:, k))**2)
      end do
      j = maxloc(other, dim=1)
      least = (1.0_wp - round_off)*other(j)*factor_of_pair(other(j), &
          sum((x(:, j) - x(:, k))**2), length, inside(j) .and. inside(k))
    end function least_of_pairs

  end function turn_of_pairs

  !> Return the largest difference of normals along an axis, of pairs that lie rather along it than
  !> across it and turn to the side to which the normals point.
  pure real(wp) function largest_along_axis(x, normal, inside, axis, length) result(largest)
    !> Points up to a spacing outside the ball, `(3, n)`, mm, their normals, and whether they are in
    !> it.
    real(wp), intent(in) :: x(:, :), normal(:, :)
    logical, intent(in) :: inside(:)
    !> Unit vector, and diameter of the ball, mm.
    real(wp), intent(in) :: axis(3), length

    real(wp) :: place(size(x, 2)), component(size(x, 2)), low, high, bound, along
    integer :: chosen(size(x, 2)), i, j, n

    place = matmul(axis, x)
    component = matmul(axis, normal)
    low = minval(component)
    high = maxval(component)
    ! Differences below that of the two ends, if it counts, need not be searched.
    largest = of_pair(minloc(component, dim=1), maxloc(component, dim=1), 0.0_wp)
    do j = 2, size(x, 2)
      bound = max(largest, straight)
      if (max(component(j) - low, high - component(j)) <= bound) cycle
      ! Most pairs do not count: a loop without branches finds the others.
      n = 0
      do i = 1, j - 1
        along = place(i) - place(j)
        chosen(n + 1) = i
        if ((component(i) - component(j))*along > bound*abs(along)) n = n + 1
      end do
      do i = 1, n
        largest = of_pair(chosen(i), j, largest)
      end do
    end do

  contains

    !> Return the difference of two normals along the axis if the pair counts and if it is larger
    !> than a value, else this.
    pure real(wp) function of_pair(i, j, least) result(value)
      integer, intent(in) :: i, j
      real(wp), intent(in) :: least

      real(wp) :: product, square

      value = least
      product = (component(i) - component(j))*(place(i) - place(j))
      if (product <= 0.0_wp) return
      square = sum((x(:, i) - x(:, j))**2)
      if (2.0_wp*(place(i) - place(j))**2 < square) return
      if (product**2 <= least**2*square) return
      value = max(least, product*sqrt(factor_of_pair(sum((normal(:, i) - normal(:, j))**2), &
          square, length, inside(i) .and. inside(j))/square))
    end function of_pair

  end function largest_along_axis

  !> Return the factor with which the square of the difference of two normals counts; 0 for a pair
  !> that does not.
  pure real(wp) function factor_of_pair(square, distance, length, inside) result(factor)
    !> Square of the difference, and that of the distance of the points, mm2.
    real(wp), intent(in) :: square, distance
    !> Diameter of the ball, mm, and whether both points are in it.
    real(wp), intent(in) :: length
    logical, intent(in) :: inside

    factor = 0.0_wp
    if (square > largest_square) return
    if (distance > length**2) then
      if (square <= largest_outside) factor = length**2/distance
    else if (inside) then
      factor = 1.0_wp
    end if
  end function factor_of_pair

  !> Sort points into cells.
  subroutine new_cells(self, x, size_of)
    type(cells_t), intent(out) :: self
    real(wp), intent(in) :: x(:, :)
    !> Size of the cells, mm.
    real(wp), intent(in) :: size_of

    integer :: i, k

    self%size = size_of
    allocate (self%first(max(16, 2*size(x, 2))), self%next(size(x, 2)), source=0)
    do i = size(x, 2), 1, -1
      k = place_of(self, cell_of(self, x(:, i)))
      self%next(i) = self%first(k)
      self%first(k) = i
    end do
  end subroutine new_cells

  !> Return the cell of a point.
  pure function cell_of(self, x) result(cell)
    type(cells_t), intent(in) :: self
    real(wp), intent(in) :: x(3)
    integer(i8) :: cell(3)

    cell = floor(x/self%size, i8)
  end function cell_of

  !> Return the place of a cell in the table.
  pure integer function place_of(self, cell) result(place)
    type(cells_t), intent(in) :: self
    integer(i8), intent(in) :: cell(3)

    integer(i8), parameter :: factor(3) = [73856093_i8, 19349663_i8, 83492791_i8]

    place = 1 + int(modulo(sum(factor*cell), size(self%first, kind=i8)))
  end function place_of

  !> Find the points within the size of a cell from a point, itself among them.
  subroutine find_near(self, x, i, near, n)
    type(cells_t), intent(in) :: self
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: i
    !> Numbers of the `n` points.
    integer, allocatable, intent(inout) :: near(:)
    integer, intent(out) :: n

    integer(i8) :: cell(3)
    integer :: place(27), d, k

    cell = cell_of(self, x(:, i))
    n = 0
    do d = 0, 26
      place(d + 1) = place_of(self, cell + int([modulo(d, 3), modulo(d/3, 3), d/9] - 1, &
          i8))
      ! Two cells can have the same place.
      if (any(place(:d) == place(d + 1))) cycle
      k = self%first(place(d + 1))
      do while (k > 0)
        if (sum((x(:, k) - x(:, i))**2) <= self%size**2) then
          if (n == size(near)) near = [near, near]
          n = n + 1
          near(n) = k
        end if
        k = self%next(k)
      end do
    end do
  end subroutine find_near

  !> Return the largest turn over a length at the points of the surface within a distance, rad, at
  !> most `resolution` too small; 0 if there is none. It is linear between the lengths of the field,
  !> as on an arc and at a kink, and beyond them that over the shortest or the longest one.
  pure real(wp) function turn_over(self, x, reach, length, facing, frame) result(turn)
    type(turn_field_t), intent(in) :: self
    !> Place in the frame of the tool, and the distance from it, mm.
    real(wp), intent(in) :: x(3), reach
    !> mm.
    real(wp), intent(in) :: length
    !> Normals of the points that count; all without.
    type(facing_t), intent(in), optional :: facing
    !> Vectors g_1 and g_2 in the plane of an element, and its unit normal: each turn, along e in
    !> this plane, counts times min(1, 1/max(|e.g_1|, |e.g_2|)).
    real(wp), intent(in), optional :: frame(3, 3)

    real(wp) :: shorter, longer
    integer :: l

    l = count(self%length <= (1.0_wp + round_off)*length)
    shorter = largest_within(self%level(max(l, 1)), x, reach, resolution, facing, frame)
    turn = shorter
    if (l == 0 .or. l == size(self%length)) return
    associate (from => self%length(l), to => self%length(l + 1))
      if (length - from <= round_off*length) return
      longer = largest_within(self%level(l + 1), x, reach, resolution, facing, frame)
      turn = shorter + (length - from)/(to - from)*(longer - shorter)
    end associate
  end function turn_over

end module dd3_tools_turn_field
