! SPDX-License-Identifier: GPL-3.0-or-later
!> Joints of a tool's surface: how many edges are joined, and where they are not although they
!> nearly coincide. Open edges are compared pair by pair where their bounding boxes are near, by a
!> sweep along the longest axis of the surface.
module dd3_tools_joints
  use dd3_base_kinds, only : wp
  use dd3_base_sorting, only : ascending
  use dd3_tools_bezier, only : normal_at
  use dd3_tools_edge_curve, only : point_on, direction_at, closest_on
  use dd3_tools_surface, only : border_edge_t, coincident, edge_parameters, surface_t
  implicit none
  private
  public :: surface_report_t, near_miss_t, new_surface_report

  !> Points of an edge at which its distance from another one is measured, and how many of them must
  !> lie beside it.
  real(wp), parameter :: probe(5) = [0.1_wp, 0.3_wp, 0.5_wp, 0.7_wp, 0.9_wp]
  integer, parameter :: least_beside = 2
  !> Widest gap, relative to the shorter sides of both patches.
  real(wp), parameter :: widest_gap = 0.5_wp
  !> Least cosine of the angle between edges that run beside each other.
  real(wp), parameter :: parallel = 0.9_wp
  !> Distance in the parameter from the ends within which a point is no inner point of an edge.
  real(wp), parameter :: end_zone = 1.0e-3_wp

  !> Two open edges that nearly coincide.
  type :: near_miss_t
    integer :: patch(2) = 0
    !> Largest distance where they run beside each other, mm; if they coincide there at different
    !> parameters, the distance of their points of equal parameters.
    real(wp) :: gap = 0.0_wp
  end type near_miss_t

  !> Joints of a surface.
  type :: surface_report_t
    integer :: n_patch = 0
    !> Pairs of edges that are joined, edges without a neighbour, edges degenerate to a point.
    integer :: n_joined = 0, n_open = 0, n_pole = 0
    !> Joined edges across which the normal jumps, the largest angle of the jump (radian), and the
    !> patches there.
    integer :: n_kink = 0
    real(wp) :: largest_kink = 0.0_wp
    integer :: kink_patch(2) = 0
    !> Points where an open edge ends inside another one, `(3, n)`, mm, and the patches of both.
    real(wp), allocatable :: t_junction(:, :)
    integer, allocatable :: t_patch(:, :)
    type(near_miss_t), allocatable :: near_miss(:)
  end type surface_report_t

contains

  !> Report the joints of a surface.
  pure subroutine new_surface_report(self, surface, largest_gap)
    type(surface_report_t), intent(out) :: self
    type(surface_t), intent(in) :: surface
    !> Largest gap of edges that count as near, mm.
    real(wp), intent(in) :: largest_gap

    self%n_patch = size(surface%patch)
    self%n_pole = count(surface%edge%pole)
    self%n_joined = count(surface%edge%patch > 0)/2
    call find_kinks(self, surface)
    allocate (self%t_junction(3, 0), self%t_patch(2, 0), self%near_miss(0))
    self%n_open = size(surface%border)
    call compare_near_curves(self, surface, surface%border, largest_gap)
  end subroutine new_surface_report

  !> Count the joined edges across which the normal jumps, and find the largest jump.
  pure subroutine find_kinks(self, surface)
    type(surface_report_t), intent(inout) :: self
    type(surface_t), intent(in) :: surface

    real(wp) :: angle
    integer :: i, k

    do i = 1, size(surface%patch)
      do k = 1, 4
        associate (edge => surface%edge(k, i))
          if (edge%patch == 0 .or. edge%smooth) cycle
          if (edge%patch < i .or. (edge%patch == i .and. edge%edge < k)) cycle
          self%n_kink = self%n_kink + 1
          angle = angle_across(surface, i, k)
          if (angle <= self%largest_kink) cycle
          self%largest_kink = angle
          self%kink_patch = [i, edge%patch]
        end associate
      end do
    end do
  end subroutine find_kinks

  !> Return the largest angle between the normals on both sides of a joined edge, radian.
  pure real(wp) function angle_across(surface, i, k) result(angle)
    type(surface_t), intent(in) :: surface
    !> Patch and edge.
    integer, intent(in) :: i, k

    real(wp) :: a(2), b(2), normal_a(3), normal_b(3)
    logical :: regular(2)
    integer :: s

    angle = 0.0_wp
    associate (edge => surface%edge(k, i))
      do s = 1, size(probe)
        a = edge_parameters(k, probe(s))
        b = edge_parameters(edge%edge, merge(1.0_wp - probe(s), probe(s), edge%reversed))
        call normal_at(surface%patch(i), a(1), a(2), normal_a, regular(1))
        call normal_at(surface%patch(edge%patch), b(1), b(2), normal_b, regular(2))
        if (.not. all(regular)) cycle
        angle = max(angle, 2.0_wp*atan2(norm2(normal_a - normal_b), norm2(normal_a + normal_b)))
      end do
    end associate
  end function angle_across

  !> Compare all pairs of open edges whose bounding boxes are near.
  pure subroutine compare_near_curves(self, surface, curve, largest_gap)
    type(surface_report_t), intent(inout) :: self
    type(surface_t), intent(in) :: surface
    type(border_edge_t), intent(in) :: curve(:)
    real(wp), intent(in) :: largest_gap

    integer :: order(size(curve)), axis, a, b, i, j

    axis = maxloc(surface%upper - surface%lower, dim=1)
    order = ascending(curve%lower(axis))
    do i = 1, size(curve)
      a = order(i)
      do j = i + 1, size(curve)
        b = order(j)
        if (curve(b)%lower(axis) > curve(a)%upper(axis) + largest_gap) exit
        if (any(curve(a)%lower > curve(b)%upper + largest_gap)) cycle
        if (any(curve(b)%lower > curve(a)%upper + largest_gap)) cycle
        if (curve(a)%patch == curve(b)%patch) cycle
        call compare_curves(self, surface, curve(min(a, b)), curve(max(a, b)), largest_gap)
      end do
    end do
  end subroutine compare_near_curves

  !> Compare two open edges: do they nearly coincide, does one end inside the other?
  pure subroutine compare_curves(self, surface, a, b, largest_gap)
    type(surface_report_t), intent(inout) :: self
    type(surface_t), intent(in) :: surface
    type(border_edge_t), intent(in) :: a, b
    real(wp), intent(in) :: largest_gap

    real(wp) :: tolerance, limit, gap
    integer :: beside(2)

    tolerance = coincident*surface%size
    limit = min(largest_gap, widest_gap*min(surface%patch(a%patch)%shorter_side, &
        surface%patch(b%patch)%shorter_side))
    call find_t_junctions(self, surface, a, b, tolerance)
    call find_t_junctions(self, surface, b, a, tolerance)
    gap = 0.0_wp
    call measure_gap(surface, a, b, limit, beside(1), gap)
    call measure_gap(surface, b, a, limit, beside(2), gap)
    if (maxval(beside) < least_beside) return
    if (gap <= tolerance) gap = distance_at_equal_parameters(surface, a, b, limit)
    if (gap <= tolerance) return
    self%near_miss = [self%near_miss, near_miss_t([a%patch, b%patch], gap)]
  end subroutine compare_curves

  !> Count the probes of an edge that lie beside another one, and raise the gap to their largest
  !> distance.
  pure subroutine measure_gap(surface, a, b, limit, beside, gap)
    type(surface_t), intent(in) :: surface
    !> Edge of the probes, and the other one.
    type(border_edge_t), intent(in) :: a, b
    !> Largest distance of edges beside each other, mm.
    real(wp), intent(in) :: limit
    integer, intent(out) :: beside
    real(wp), intent(inout) :: gap

    real(wp) :: t, distance
    integer :: s

    beside = 0
    do s = 1, size(probe)
      call closest_on(surface, b, point_on(surface, a, probe(s)), limit, t, distance)
      if (distance > limit .or. t < end_zone .or. t > 1.0_wp - end_zone) cycle
      if (abs(dot_product(direction_at(surface, a, probe(s)), direction_at(surface, b, t))) &
          < parallel) cycle
      beside = beside + 1
      gap = max(gap, distance)
    end do
  end subroutine measure_gap

  !> Return the largest distance of the points of equal parameters of two edges with common ends,
  !> mm; 0 if their ends differ.
  pure real(wp) function distance_at_equal_parameters(surface, a, b, limit) result(distance)
    type(surface_t), intent(in) :: surface
    type(border_edge_t), intent(in) :: a, b
    !> Largest distance of common ends, mm.
    real(wp), intent(in) :: limit

    logical :: reversed
    integer :: s, n

    distance = 0.0_wp
    n = ubound(a%point, 2)
    reversed = norm2(a%point(:, 0) - b%point(:, 0)) > norm2(a%point(:, 0) - b%point(:, n))
    do s = 0, n, n
      if (norm2(a%point(:, s) - b%point(:, merge(n - s, s, reversed))) > &
          min(limit, coincident*surface%size)) return
    end do
    do s = 0, n
      distance = max(distance, norm2(a%point(:, s) - b%point(:, merge(n - s, s, reversed))))
    end do
  end function distance_at_equal_parameters

  !> Add the end points of one edge that lie inside another one.
  pure subroutine find_t_junctions(self, surface, a, b, tolerance)
    type(surface_report_t), intent(inout) :: self
    type(surface_t), intent(in) :: surface
    !> Edge of the end points, and the other one.
    type(border_edge_t), intent(in) :: a, b
    real(wp), intent(in) :: tolerance

    real(wp) :: t, distance
    integer :: s, n

    n = ubound(a%point, 2)
    do s = 0, n, n
      associate (x => a%point(:, s))
        if (any(x < b%lower - b%chord .or. x > b%upper + b%chord)) cycle
        if (min(norm2(x - b%point(:, 0)), norm2(x - b%point(:, n))) <= tolerance) cycle
        call closest_on(surface, b, x, tolerance, t, distance)
        if (distance > tolerance) cycle
        if (any(norm2(self%t_junction - spread(x, 2, size(self%t_patch, 2)), dim=1) &
            <= tolerance)) cycle
        self%t_junction = reshape([self%t_junction, x], [3, size(self%t_patch, 2) + 1])
        self%t_patch = reshape([self%t_patch, a%patch, b%patch], [2, size(self%t_patch, 2) + 1])
      end associate
    end do
  end subroutine find_t_junctions

end module dd3_tools_joints
