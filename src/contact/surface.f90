!> The surface of a tool: its patches, their bounding box and their neighbours across edges.
module dd3_contact_surface
  use dd3_base_kinds, only : wp
  use dd3_contact_bezier, only : patch_t, position_at, normal_at, curve_length
  implicit none
  private
  public :: surface_t, edge_t, new_surface, edge_parameters, edge_number, coincident

  !> Number of points at which two edges are compared.
  integer, parameter :: n_compared = 5
  !> Largest distance between coincident edges, relative to the surface's size.
  real(wp), parameter :: coincident = 1.0e-6_wp
  !> Largest sine of the angle between the normals across a smooth edge.
  real(wp), parameter :: smooth_sine = 1.0e-3_wp
  !> Largest cosine of the angle between opposite normals.
  real(wp), parameter :: opposite_cosine = -0.99_wp
  !> Width of the band beyond a smooth edge, relative to the shortest patch, in which a node keeps
  !> its patch.
  real(wp), parameter :: band_width = 1.0e-5_wp
  !> Largest band in terms of the parameter.
  real(wp), parameter :: largest_band = 1.0e-3_wp

  !> An edge of a patch. The edges are 1: u = 0, 2: u = 1, 3: v = 0, 4: v = 1.
  type :: edge_t
    !> Neighbouring patch; 0 on the outer border and at a pole.
    integer :: patch = 0
    !> Number of the edge in the neighbouring patch.
    integer :: edge = 0
    !> True if the two edges run in opposite directions.
    logical :: reversed = .false.
    !> True if the normals agree across the edge.
    logical :: smooth = .false.
    !> True if the normals across the edge are opposite.
    logical :: opposite = .false.
    !> True if the edge is degenerate to a point.
    logical :: pole = .false.
    !> Distance in the parameter by which a patch is extended beyond the edge.
    real(wp) :: band = 0.0_wp
  end type edge_t

  !> The surface of a tool.
  type :: surface_t
    type(patch_t), allocatable :: patch(:)
    !> Edges, `edge(4, n_patch)`.
    type(edge_t), allocatable :: edge(:, :)
    !> Bounding box, mm.
    real(wp) :: lower(3) = 0.0_wp, upper(3) = 0.0_wp
    !> Diagonal of the bounding box, mm.
    real(wp) :: size = 0.0_wp
  end type surface_t

contains

  !> Make a surface from its patches.
  subroutine new_surface(self, patch)
    type(surface_t), intent(out) :: self
    !> At least one patch.
    type(patch_t), intent(in) :: patch(:)

    integer :: i, k

    self%patch = patch
    allocate (self%edge(4, size(patch)))
    self%lower = patch(1)%lower
    self%upper = patch(1)%upper
    do i = 2, size(patch)
      self%lower = min(self%lower, patch(i)%lower)
      self%upper = max(self%upper, patch(i)%upper)
    end do
    self%size = sqrt(sum((self%upper - self%lower)**2))
    do i = 1, size(patch)
      do k = 1, 4
        self%edge(k, i)%pole = edge_length(patch(i), k) <= coincident*self%size
      end do
    end do
    call find_neighbours(self)
    call set_bands(self)
  end subroutine new_surface

  !> Return the length of edge k, mm.
  pure real(wp) function edge_length(patch, k)
    type(patch_t), intent(in) :: patch
    integer, intent(in) :: k

    edge_length = curve_length(patch, merge(2, 1, k <= 2), real(mod(k + 1, 2), wp))
  end function edge_length

  !> Return the parameters u, v of a point on edge k.
  pure function edge_parameters(k, t) result(uv)
    integer, intent(in) :: k
    !> Parameter along the edge, 0 to 1.
    real(wp), intent(in) :: t
    real(wp) :: uv(2)

    uv = t
    uv((k + 1)/2) = real(mod(k + 1, 2), wp)
  end function edge_parameters

  !> Return the number of the edge at the lower or upper bound of a parameter.
  pure integer function edge_number(direction, upper)
    !> 1 for u, 2 for v.
    integer, intent(in) :: direction
    logical, intent(in) :: upper

    edge_number = 2*direction - merge(0, 1, upper)
  end function edge_number

  !> Find the pairs of edges that coincide over their whole length.
  subroutine find_neighbours(self)
    type(surface_t), intent(inout) :: self

    real(wp) :: points(3, n_compared, 4, size(self%patch)), tolerance, uv(2)
    integer :: i, j, k, l, s
    logical :: same, reversed

    tolerance = coincident*self%size
    do i = 1, size(self%patch)
      do k = 1, 4
        do s = 1, n_compared
          uv = edge_parameters(k, real(s - 1, wp)/(n_compared - 1))
          points(:, s, k, i) = position_at(self%patch(i), uv(1), uv(2))
        end do
      end do
    end do
    do i = 1, size(self%patch)
      do j = i, size(self%patch)
        if (any(self%patch(i)%lower > self%patch(j)%upper + tolerance) .or. &
            any(self%patch(j)%lower > self%patch(i)%upper + tolerance)) cycle
        do k = 1, 4
          do l = 1, 4
            if (i == j .and. l <= k) cycle
            if (self%edge(k, i)%pole .or. self%edge(l, j)%pole) cycle
            if (self%edge(k, i)%patch > 0 .or. self%edge(l, j)%patch > 0) cycle
            call compare_edges(points(:, :, k, i), points(:, :, l, j), tolerance, same, reversed)
            if (same) call set_neighbours(self, i, k, j, l, reversed)
          end do
        end do
      end do
    end do
  end subroutine find_neighbours

  !> Compare the points of two edges, forwards and backwards.
  pure subroutine compare_edges(a, b, tolerance, same, reversed)
    !> Points of the edges, mm.
    real(wp), intent(in) :: a(:, :), b(:, :)
    !> Largest distance between coincident points, mm.
    real(wp), intent(in) :: tolerance
    !> True if the edges coincide.
    logical, intent(out) :: same
    !> True if they run in opposite directions.
    logical, intent(out) :: reversed

    same = all(abs(a - b) <= tolerance)
    reversed = .false.
    if (same) return
    reversed = all(abs(a - b(:, size(b, 2):1:-1)) <= tolerance)
    same = reversed
  end subroutine compare_edges

  !> Record that edge k of patch i and edge l of patch j coincide.
  subroutine set_neighbours(self, i, k, j, l, reversed)
    type(surface_t), intent(inout) :: self
    integer, intent(in) :: i, k, j, l
    !> True if the edges run in opposite directions.
    logical, intent(in) :: reversed

    real(wp) :: a(2), b(2), t, normal_a(3), normal_b(3), cosine
    logical :: regular(2), smooth, opposite
    integer :: s

    smooth = .true.
    opposite = .true.
    do s = 1, n_compared
      t = real(s - 1, wp)/(n_compared - 1)
      a = edge_parameters(k, t)
      b = edge_parameters(l, merge(1.0_wp - t, t, reversed))
      call normal_at(self%patch(i), a(1), a(2), normal_a, regular(1))
      call normal_at(self%patch(j), b(1), b(2), normal_b, regular(2))
      cosine = dot_product(normal_a, normal_b)
      smooth = smooth .and. all(regular) .and. cosine > 0.0_wp &
          .and. sum((normal_a - cosine*normal_b)**2) < smooth_sine**2
      opposite = opposite .and. cosine < opposite_cosine
    end do
    self%edge(k, i)%patch = j
    self%edge(k, i)%edge = l
    self%edge(l, j)%patch = i
    self%edge(l, j)%edge = k
    self%edge(k, i)%reversed = reversed
    self%edge(l, j)%reversed = reversed
    self%edge(k, i)%smooth = smooth
    self%edge(l, j)%smooth = smooth
    self%edge(k, i)%opposite = opposite
    self%edge(l, j)%opposite = opposite
  end subroutine set_neighbours

  !> Set the bands of the smooth inner edges.
  subroutine set_bands(self)
    type(surface_t), intent(inout) :: self

    real(wp) :: width, length
    integer :: i, k

    width = band_width*minval(self%patch%shorter_side)
    do i = 1, size(self%patch)
      do k = 1, 4
        if (.not. self%edge(k, i)%smooth) cycle
        length = curve_length(self%patch(i), (k + 1)/2, 0.5_wp)
        if (length > 0.0_wp) self%edge(k, i)%band = min(largest_band, width/length)
      end do
    end do
  end subroutine set_bands

end module dd3_contact_surface
