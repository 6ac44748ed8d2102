! SPDX-License-Identifier: GPL-3.0-or-later
!> The surface of a tool: its patches, their bounding box and their neighbours across edges.
module dd3_tools_surface
  use dd3_base_kinds, only : wp
  use dd3_base_near_points, only : near_pairs
  use dd3_tools_bezier, only : edge_points, normal_at, patch_t, position_at
  use dd3_tools_box_tree, only : box_tree_t, new_box_tree
  use dd3_tools_oriented_box, only : new_oriented_box, oriented_box_t
  implicit none
  private
  public :: surface_t, edge_t, border_edge_t, n_chord, new_surface, join_patches, edge_parameters, &
      edge_number, coincident

  !> Parameters at which two edges are compared.
  real(wp), parameter :: compared(5) = [0.0_wp, 0.25_wp, 0.5_wp, 0.75_wp, 1.0_wp]
  !> Number of pairs of edges whose middles coincide, per edge, at which the search for neighbours
  !> ends: only patches that lie on one another, dozens at a place, have more.
  integer, parameter :: most_pairs = 16
  !> Largest distance between coincident edges, relative to the surface's size.
  real(wp), parameter :: coincident = 1.0e-6_wp
  !> Largest sine of the angle between the normals across a smooth edge, 0.3 degrees: a contact
  !> force that turns by it changes by 0.52 %, about half the default tolerance of the corrector.
  !> Patches that interpolate a fillet have small kinks at all their edges; nodes at an edge with a
  !> crease follow the edge itself.
  real(wp), parameter :: smooth_sine = 5.236e-3_wp
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

  !> Number of chords of an edge of the border.
  integer, parameter :: n_chord = 16

  !> An edge of the border.
  type :: border_edge_t
    !> Patch, and number of the edge as in `edge_t`.
    integer :: patch = 0, edge = 0
    !> Bounding box of its control points, mm.
    real(wp) :: lower(3) = 0.0_wp, upper(3) = 0.0_wp
    !> Ends of chords at equal distances of the parameter, and length of the longest, mm.
    real(wp) :: point(3, 0:n_chord) = 0.0_wp, chord = 0.0_wp
  end type border_edge_t

  !> The surface of a tool.
  type :: surface_t
    type(patch_t), allocatable :: patch(:)
    !> Edges, `edge(4, n_patch)`.
    type(edge_t), allocatable :: edge(:, :)
    !> Edges without a neighbour, poles excluded.
    type(border_edge_t), allocatable :: border(:)
    !> Two patches at the place of most edges if the search for neighbours ended early, so that
    !> edges have no neighbour though there is one; 0 otherwise.
    integer :: crowded(2) = 0
    !> Bounding boxes of the patches.
    type(box_tree_t) :: tree
    !> Oriented bounding boxes of the patches, in the order of the tree.
    type(oriented_box_t), allocatable :: box(:)
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

    self%patch = patch
    call join_patches(self)
  end subroutine new_surface

  !> Set the bounding box and the edges of a surface.
  subroutine join_patches(self)
    !> With its patches, at least one.
    type(surface_t), intent(inout) :: self

    real(wp) :: lower(3, size(self%patch)), upper(3, size(self%patch))
    integer :: i, k

    allocate (self%edge(4, size(self%patch)), self%box(size(self%patch)))
    do i = 1, size(self%patch)
      lower(:, i) = self%patch(i)%lower
      upper(:, i) = self%patch(i)%upper
    end do
    call new_box_tree(self%tree, lower, upper)
    do i = 1, size(self%patch)
      call new_oriented_box(self%box(i), self%patch(self%tree%number(i)))
    end do
    self%lower = minval(lower, dim=2)
    self%upper = maxval(upper, dim=2)
    self%size = sqrt(sum((self%upper - self%lower)**2))
    do i = 1, size(self%patch)
      do k = 1, 4
        self%edge(k, i)%pole = edge_length(self%patch(i), k) <= coincident*self%size
      end do
    end do
    call find_neighbours(self)
    call set_bands(self)
    call set_border(self)
  end subroutine join_patches

  !> Return the length of edge k, mm.
  pure real(wp) function edge_length(patch, k)
    type(patch_t), intent(in) :: patch
    integer, intent(in) :: k

    edge_length = patch%length(merge(3, 1, mod(k, 2) == 0), merge(2, 1, k <= 2))
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

  !> Find the pairs of edges that coincide over their whole length, among those whose middles do.
  subroutine find_neighbours(self)
    type(surface_t), intent(inout) :: self

    real(wp), allocatable :: middle(:, :)
    !> Numbers k + 4*(i - 1) of the edges that are no poles.
    integer, allocatable :: edge(:), pair(:, :)
    real(wp) :: tolerance
    integer :: p, i(2), k(2)
    logical :: same, reversed

    tolerance = coincident*self%size
    edge = pack([(p, p=1, size(self%edge))], .not. reshape(self%edge%pole, [size(self%edge)]))
    allocate (middle(3, size(edge)))
    do p = 1, size(edge)
      middle(:, p:p) = edge_points(self%patch((edge(p) + 3)/4), modulo(edge(p) - 1, 4) + 1, &
          [0.5_wp])
    end do
    call near_pairs(middle, tolerance, most_pairs*size(edge), pair)
    if (size(pair, 2) > 0 .and. size(pair, 2) == most_pairs*size(edge)) then
      self%crowded = (edge(most_frequent(pair, size(edge))) + 3)/4
    end if
    do p = 1, size(pair, 2)
      i = (edge(pair(:, p)) + 3)/4
      k = modulo(edge(pair(:, p)) - 1, 4) + 1
      if (self%edge(k(1), i(1))%patch > 0 .or. self%edge(k(2), i(2))%patch > 0) cycle
      call compare_edges(edge_points(self%patch(i(1)), k(1), compared), &
          edge_points(self%patch(i(2)), k(2), compared), tolerance, same, reversed)
      if (same) call set_neighbours(self, i(1), k(1), i(2), k(2), reversed)
    end do
  end subroutine find_neighbours

  !> Return the pair of the number that occurs most often.
  pure function most_frequent(pair, largest_number)
    integer, intent(in) :: pair(:, :)
    !> Largest number that may occur.
    integer, intent(in) :: largest_number
    integer :: most_frequent(2)

    integer :: frequency(largest_number), p

    frequency = 0
    do p = 1, size(pair, 2)
      frequency(pair(:, p)) = frequency(pair(:, p)) + 1
    end do
    most_frequent = pair(:, maxloc(merge(1, 0, any(pair == maxloc(frequency, dim=1), dim=1)), &
        dim=1))
  end function most_frequent

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

    real(wp) :: a(2), b(2), normal_a(3), normal_b(3), cosine
    logical :: regular(2), smooth, opposite
    integer :: s

    smooth = .true.
    opposite = .true.
    do s = 1, size(compared)
      a = edge_parameters(k, compared(s))
      b = edge_parameters(l, merge(1.0_wp - compared(s), compared(s), reversed))
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
        length = self%patch(i)%length(2, (k + 1)/2)
        if (length > 0.0_wp) self%edge(k, i)%band = min(largest_band, width/length)
      end do
    end do
  end subroutine set_bands

  !> Set the edges of the border.
  subroutine set_border(self)
    type(surface_t), intent(inout) :: self

    real(wp), allocatable :: point(:, :)
    integer :: i, k, n

    allocate (self%border(count(self%edge%patch == 0 .and. .not. self%edge%pole)))
    n = 0
    do i = 1, size(self%patch)
      do k = 1, 4
        if (self%edge(k, i)%patch > 0 .or. self%edge(k, i)%pole) cycle
        point = edge_control(self%patch(i), k)
        n = n + 1
        self%border(n) = border_edge_t(i, k, minval(point, dim=2), maxval(point, dim=2))
        call set_chords(self%border(n), self%patch(i))
      end do
    end do
  end subroutine set_border

  !> Set the chords of an edge of the border.
  pure subroutine set_chords(self, patch)
    type(border_edge_t), intent(inout) :: self
    type(patch_t), intent(in) :: patch

    real(wp) :: uv(2)
    integer :: i

    do i = 0, n_chord
      uv = edge_parameters(self%edge, real(i, wp)/n_chord)
      self%point(:, i) = position_at(patch, uv(1), uv(2))
      if (i > 0) self%chord = max(self%chord, norm2(self%point(:, i) - self%point(:, i - 1)))
    end do
  end subroutine set_chords

  !> Return the control points of an edge, mm.
  pure function edge_control(patch, k) result(point)
    type(patch_t), intent(in) :: patch
    integer, intent(in) :: k
    real(wp), allocatable :: point(:, :)

    select case (k)
    case (1)
      point = patch%control(:, 0, :)
    case (2)
      point = patch%control(:, patch%degree(1), :)
    case (3)
      point = patch%control(:, :, 0)
    case default
      point = patch%control(:, :, patch%degree(2))
    end select
  end function edge_control

end module dd3_tools_surface
