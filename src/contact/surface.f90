!> The surface of a tool: its patches, their boxes, and which patch follows behind which edge.
module dd3_contact_surface
  use dd3_base_kinds, only : wp
  use dd3_contact_bezier, only : patch_t, position_at, normal_at, curve_length
  implicit none
  private
  public :: surface_t, edge_t, new_surface, edge_parameters, edge_of

  !> Points at which two edges are compared.
  integer, parameter :: n_compared = 5
  !> Two edges are the same where they are nearer to each other than this share of the surface's
  !> size.
  real(wp), parameter :: same_place = 1.0e-6_wp
  !> A surface is smooth across an edge where the sine of the angle between its normals is below
  !> this.
  real(wp), parameter :: smooth_sine = 1.0e-3_wp
  !> Width of the band beyond a smooth edge, as a share of the shortest patch, in which a node
  !> keeps its patch.
  real(wp), parameter :: band_width = 1.0e-5_wp

  !> What lies behind an edge of a patch. The edges are 1: u = 0, 2: u = 1, 3: v = 0, 4: v = 1.
  type :: edge_t
    !> The patch behind it; 0 on the outer border and at a pole.
    integer :: patch = 0
    !> Its edge there.
    integer :: edge = 0
    !> Whether the two edges run in opposite directions.
    logical :: reversed = .false.
    !> Whether the normals agree across it.
    logical :: smooth = .false.
    !> Whether the normals across it point to opposite sides.
    logical :: opposite = .false.
    !> Whether it is no longer than a point.
    logical :: pole = .false.
    !> How far the parameter may run beyond it before the neighbour takes over.
    real(wp) :: band = 0.0_wp
  end type edge_t

  !> The surface of a tool.
  type :: surface_t
    !> Its patches.
    type(patch_t), allocatable :: patch(:)
    !> Their edges, `(4, number of patches)`.
    type(edge_t), allocatable :: edge(:, :)
    !> Box that holds all patches, mm.
    real(wp) :: lower(3) = 0.0_wp, upper(3) = 0.0_wp
    !> Diagonal of that box, mm.
    real(wp) :: size = 0.0_wp
  end type surface_t

contains

  !> Makes a surface of its patches.
  subroutine new_surface(self, patch)
    !> The surface made.
    type(surface_t), intent(out) :: self
    !> Its patches, at least one.
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
        self%edge(k, i)%pole = edge_length(patch(i), k) <= same_place*self%size
      end do
    end do
    call find_neighbours(self)
    call set_bands(self)
  end subroutine new_surface

  !> Length of an edge, mm.
  pure real(wp) function edge_length(patch, k)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The edge.
    integer, intent(in) :: k

    edge_length = curve_length(patch, merge(2, 1, k <= 2), real(mod(k + 1, 2), wp))
  end function edge_length

  !> Parameters of a point on an edge.
  pure function edge_parameters(k, t) result(at)
    !> The edge.
    integer, intent(in) :: k
    !> Place along it, 0 to 1.
    real(wp), intent(in) :: t
    real(wp) :: at(2)

    at = t
    at((k + 1)/2) = real(mod(k + 1, 2), wp)
  end function edge_parameters

  !> The edge at an end of a parameter's range.
  pure integer function edge_of(direction, upper)
    !> 1 for u, 2 for v.
    integer, intent(in) :: direction
    !> Whether the upper end is meant.
    logical, intent(in) :: upper

    edge_of = 2*direction - merge(0, 1, upper)
  end function edge_of

  !> Finds the pairs of edges that lie on each other from end to end.
  subroutine find_neighbours(self)
    !> The surface.
    type(surface_t), intent(inout) :: self

    real(wp) :: points(3, n_compared, 4, size(self%patch)), tolerance, at(2)
    integer :: i, j, k, l, s
    logical :: same, reversed

    tolerance = same_place*self%size
    do i = 1, size(self%patch)
      do k = 1, 4
        do s = 1, n_compared
          at = edge_parameters(k, real(s - 1, wp)/(n_compared - 1))
          points(:, s, k, i) = position_at(self%patch(i), at(1), at(2))
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
            call compare(points(:, :, k, i), points(:, :, l, j), tolerance, same, reversed)
            if (same) call join(self, i, k, j, l, reversed)
          end do
        end do
      end do
    end do
  end subroutine find_neighbours

  !> Compares two rows of points, forwards and backwards.
  pure subroutine compare(a, b, tolerance, same, reversed)
    !> The rows of points, mm.
    real(wp), intent(in) :: a(:, :), b(:, :)
    !> Largest distance between points that are the same, mm.
    real(wp), intent(in) :: tolerance
    !> Whether the rows are the same.
    logical, intent(out) :: same
    !> Whether they run in opposite directions.
    logical, intent(out) :: reversed

    same = all(abs(a - b) <= tolerance)
    reversed = .false.
    if (same) return
    reversed = all(abs(a - b(:, size(b, 2):1:-1)) <= tolerance)
    same = reversed
  end subroutine compare

  !> Notes that two edges lie on each other.
  subroutine join(self, i, k, j, l, reversed)
    !> The surface.
    type(surface_t), intent(inout) :: self
    !> Patch and edge on one side.
    integer, intent(in) :: i, k
    !> Patch and edge on the other.
    integer, intent(in) :: j, l
    !> Whether the edges run in opposite directions.
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
      opposite = opposite .and. cosine < -0.99_wp
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
  end subroutine join

  !> Gives the smooth inner edges their bands.
  subroutine set_bands(self)
    !> The surface.
    type(surface_t), intent(inout) :: self

    real(wp) :: width, across
    integer :: i, k

    width = band_width*minval(self%patch%reach)
    do i = 1, size(self%patch)
      do k = 1, 4
        if (.not. self%edge(k, i)%smooth) cycle
        across = curve_length(self%patch(i), (k + 1)/2, 0.5_wp)
        if (across > 0.0_wp) self%edge(k, i)%band = min(1.0e-3_wp, width/across)
      end do
    end do
  end subroutine set_bands

end module dd3_contact_surface
