! SPDX-License-Identifier: GPL-3.0-or-later
!> Gap, normal and gradient of the normal at the closest point.
!>
!> Inside a patch, with a_ab = y_,a . y_,b, b_ab = y_,ab . n and A = a - d b:
!>     dn/dx = - y_,c (a^-1 b A^-1)^cd y_,d^T,
!> which is P/(R + d) on a sphere. On a sharp inner edge, with t the edge's tangent and r = x - y,
!> n = +- r/|r| and
!>     dn/dx = (I - n n^T - t t^T / (t.t - r.y_,tt)) / d.
!> At the border the surface is rounded: with the unit normal m of the patch at the closest point y
!> of the border and the radius R,
!>     c = y - R m,    d = |x - c| - R,    n = (x - c)/|x - c|,
!>     dn/dx = (I - n n^T - (1 + R m.y_,tt/t.t) t t^T / (t.t - r.y_,tt)) / |x - c|.
!> Gap and normal are those of the patch where the node passes the border, and the derivatives are
!> exact where m does not turn about the border. A node beside the border farther than a given gap
!> has no contact.
!> Source: Wriggers, Computational Contact Mechanics, 2nd ed. (2006), chapter 4; Konyukhov and
!> Schweizerhof, Comput. Mech. 35 (2005) 190-213; for signs at edges Baerentzen and Aanaes, IEEE
!> Trans. Vis. Comput. Graph. 11 (2005) 243-253.
module dd3_tools_hit
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : patch_t, evaluate, evaluate_tangents, normal_at, unit_normal
  use dd3_tools_projection, only : projection_t
  use dd3_tools_surface, only : surface_t, edge_number, edge_parameters
  implicit none
  private
  public :: border_t, hit_t, new_hit, on_border, projection_location

  !> Location of a closest point: inside its patch or at a smooth edge; on a sharp inner edge or the
  !> outer border, with the node beside the patch.
  integer, parameter :: on_patch = 0, on_sharp_edge = 1, on_border = 2

  !> A node is beside the border or a sharp edge from this tangential distance on, relative to the
  !> surface's size.
  real(wp), parameter :: beside_border = 1.0e-6_wp, beside_sharp_edge = 1.0e-9_wp
  !> Distance from a pole, in the parameter that leads to it, below which it is the closest point.
  real(wp), parameter :: at_pole = 1.0e-8_wp
  !> Smallest det A, relative to det a; below it the node is near the centre of curvature.
  real(wp), parameter :: smallest_determinant = 1.0e-8_wp

  !> Contact beside the border of a surface.
  type :: border_t
    !> Radius of the border, mm.
    real(wp) :: radius = 0.0_wp
    !> Gap below which there is contact, mm; none by default.
    real(wp) :: reach = 0.0_wp
    !> Largest angle by which the normal turns from that of the surface; no limit by default.
    real(wp) :: turn = huge(1.0_wp)
  end type border_t

  !> Closest point of a surface to a node.
  type :: hit_t
    !> True if the node can touch the surface there.
    logical :: found = .false.
    !> True if the node is beside the surface, its closest point on the border.
    logical :: border = .false.
    !> Patch of the closest point, or 0.
    integer :: patch = 0
    !> Parameters of the closest point.
    real(wp) :: u = 0.0_wp, v = 0.0_wp
    !> Gap, negative inside the tool, mm.
    real(wp) :: distance = huge(1.0_wp)
    !> Closest point, mm.
    real(wp) :: point(3) = 0.0_wp
    !> Outward unit normal: the direction of the force without friction.
    real(wp) :: normal(3) = 0.0_wp
    !> Gradient of the gap: the normal, but where the turn of the normal beside the border is
    !> limited.
    real(wp) :: gap_gradient(3) = 0.0_wp
    !> Angle between the normals of the rounded border and of the surface.
    real(wp) :: turn = 0.0_wp
    !> Gradient of the normal, dn/dx, symmetric, 1/mm.
    real(wp) :: dnormal(3, 3) = 0.0_wp
  end type hit_t

contains

  !> Make a hit from a projection.
  pure subroutine new_hit(hit, surface, k, x, projection, radius)
    !> `found` whatever its distance.
    type(hit_t), intent(inout) :: hit
    type(surface_t), intent(in) :: surface
    !> Number of the patch.
    integer, intent(in) :: k
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    type(projection_t), intent(in) :: projection
    !> Radius of the border, mm.
    real(wp), intent(in) :: radius

    real(wp) :: normal(3), first(3, 2), second(3, 3)
    integer :: location
    logical :: regular

    location = on_patch
    if (any(projection%active /= 0)) location = projection_location(surface, k, projection)
    hit%patch = k
    hit%u = projection%uv(1)
    hit%v = projection%uv(2)
    hit%point = x + projection%offset
    hit%border = location == on_border
    hit%found = .true.
    select case (location)
    case (on_border)
      call set_border_hit(hit, surface%patch(k), projection, radius)
    case (on_sharp_edge)
      call set_edge_hit(hit, surface, k, projection)
    case default
      call unit_normal(surface%patch(k), projection%first, normal, regular)
      if (regular) then
        call set_patch_hit(hit, surface%patch(k)%flat, normal, projection%offset, &
            projection%first, projection%second)
      else
        call evaluate_near_pole(surface%patch(k), projection%uv, normal, first, second, hit%found)
        call set_patch_hit(hit, .false., normal, projection%offset, first, second)
      end if
    end select
  end subroutine new_hit

  !> Return the location of a projection with active bounds.
  pure integer function projection_location(surface, k, projection) result(location)
    type(surface_t), intent(in) :: surface
    !> Number of the patch.
    integer, intent(in) :: k
    type(projection_t), intent(in) :: projection

    real(wp) :: tangential
    integer :: a, e

    location = on_patch
    do e = 1, 4
      if (.not. is_at_pole(surface, k, e, projection)) cycle
      if (beside_pole(surface, k, e, projection)) location = on_border
      return
    end do
    do a = 1, 2
      if (projection%active(a) == 0) cycle
      e = edge_number(a, projection%active(a) > 0)
      tangential = abs(dot_product(projection%offset, projection%first(:, a))) &
          /max(sqrt(dot_product(projection%first(:, a), projection%first(:, a))), tiny(1.0_wp))
      if (surface%edge(e, k)%patch == 0) then
        if (tangential > beside_border*surface%size) location = on_border
      else if (.not. surface%edge(e, k)%smooth) then
        if (tangential > beside_sharp_edge*surface%size) location = max(location, on_sharp_edge)
      end if
    end do
  end function projection_location

  !> Return whether an edge of a patch is a pole that is the closest point.
  pure logical function is_at_pole(surface, k, e, projection)
    type(surface_t), intent(in) :: surface
    !> Numbers of the patch and of the edge.
    integer, intent(in) :: k, e
    type(projection_t), intent(in) :: projection

    real(wp) :: uv(2)
    integer :: a

    a = merge(1, 2, e <= 2)
    uv = edge_parameters(e, 0.0_wp)
    is_at_pole = surface%edge(e, k)%pole .and. abs(projection%uv(a) - uv(a)) <= at_pole
  end function is_at_pole

  !> Return whether a node whose closest point is a pole is beside the surface: off its normal
  !> there, where an open edge ends at the pole. The parameter along the pole and the directions of
  !> the edges that end there are undetermined; the normal is that of two lines that lead to it.
  pure logical function beside_pole(surface, k, pole, projection)
    type(surface_t), intent(in) :: surface
    !> Numbers of the patch and of its edge that is the pole.
    integer, intent(in) :: k, pole
    type(projection_t), intent(in) :: projection

    integer, parameter :: ending(2, 4) = reshape([3, 4, 3, 4, 1, 2, 1, 2], [2, 4])
    real(wp) :: uv(2), first(3, 2), line(3, 2), normal(3), lateral(3)
    logical :: regular
    integer :: i

    beside_pole = .false.
    if (all(surface%edge(ending(:, pole), k)%patch > 0)) return
    do i = 1, 2
      uv = edge_parameters(pole, real(i - 1, wp)/3.0_wp)
      call evaluate_tangents(surface%patch(k), uv(1), uv(2), first)
      line(:, i) = first(:, merge(1, 2, pole <= 2))
    end do
    call unit_normal(surface%patch(k), line, normal, regular)
    if (.not. regular) return
    lateral = projection%offset - dot_product(projection%offset, normal)*normal
    beside_pole = norm2(lateral) > beside_border*surface%size
  end function beside_pole

  !> Set gap, normal and its gradient on a smooth patch.
  pure subroutine set_patch_hit(hit, flat, normal, offset, first, second)
    type(hit_t), intent(inout) :: hit
    !> True if the patch has no curvature.
    logical, intent(in) :: flat
    !> Unit normal.
    real(wp), intent(in) :: normal(3)
    !> Vector from the node to the closest point, mm.
    real(wp), intent(in) :: offset(3)
    !> S_u, S_v, mm.
    real(wp), intent(in) :: first(3, 2)
    !> S_uu, S_vv, S_uv, mm.
    real(wp), intent(in) :: second(3, 3)

    real(wp) :: a(3), b(3), c(3), m(2, 2), determinant(2)
    integer :: i

    hit%normal = normal
    hit%distance = -dot_product(offset, normal)
    hit%dnormal = 0.0_wp
    if (flat) return
    a(1) = dot_product(first(:, 1), first(:, 1))
    a(2) = dot_product(first(:, 2), first(:, 2))
    a(3) = dot_product(first(:, 1), first(:, 2))
    do i = 1, 3
      b(i) = dot_product(second(:, i), normal)
    end do
    c = a - hit%distance*b
    determinant(1) = a(1)*a(2) - a(3)**2
    determinant(2) = c(1)*c(2) - c(3)**2
    if (min(c(1), c(2)) <= 0.0_wp .or. determinant(2) <= smallest_determinant*determinant(1)) then
      c = a
      determinant(2) = determinant(1)
    end if
    if (determinant(1) <= tiny(1.0_wp)) return
    m(1, 1) = a(2)*b(1) - a(3)*b(3)
    m(1, 2) = a(2)*b(3) - a(3)*b(2)
    m(2, 1) = a(1)*b(3) - a(3)*b(1)
    m(2, 2) = a(1)*b(2) - a(3)*b(3)
    m = matmul(m, reshape([c(2), -c(3), -c(3), c(1)], [2, 2]))/(determinant(1)*determinant(2))
    m(1, 2) = 0.5_wp*(m(1, 2) + m(2, 1))
    do i = 1, 3
      hit%dnormal(:, i) = -(m(1, 1)*first(i, 1) + m(1, 2)*first(i, 2))*first(:, 1) &
          - (m(1, 2)*first(i, 1) + m(2, 2)*first(i, 2))*first(:, 2)
    end do
  end subroutine set_patch_hit

  !> Evaluate normal and derivatives at a point near a pole.
  pure subroutine evaluate_near_pole(patch, uv, normal, first, second, regular)
    type(patch_t), intent(in) :: patch
    !> Parameters of the pole.
    real(wp), intent(in) :: uv(2)
    !> Unit normal.
    real(wp), intent(out) :: normal(3)
    !> S_u, S_v near the pole, mm.
    real(wp), intent(out) :: first(3, 2)
    !> S_uu, S_vv, S_uv near the pole, mm.
    real(wp), intent(out) :: second(3, 3)
    !> False if there is no normal.
    logical, intent(out) :: regular

    real(wp), parameter :: step = 1.0e-3_wp
    real(wp) :: point(3), near(2)

    call normal_at(patch, uv(1), uv(2), normal, regular)
    near = uv + step*(0.5_wp - uv)
    call evaluate(patch, near(1), near(2), point, first, second)
  end subroutine evaluate_near_pole

  !> Set gap, normal and its gradient at a sharp inner edge or corner.
  pure subroutine set_edge_hit(hit, surface, k, projection)
    type(hit_t), intent(inout) :: hit
    type(surface_t), intent(in) :: surface
    !> Number of the patch.
    integer, intent(in) :: k
    type(projection_t), intent(in) :: projection

    real(wp) :: mean(3)

    mean = mean_normal(surface, k, projection)
    hit%distance = sign(projection%distance, -dot_product(projection%offset, mean))
    hit%normal = -projection%offset/hit%distance
    call set_normal_gradient(hit, projection, hit%distance, [0.0_wp, 0.0_wp, 0.0_wp])
  end subroutine set_edge_hit

  !> Set gap, normal and its gradient beside the border.
  pure subroutine set_border_hit(hit, patch, projection, radius)
    type(hit_t), intent(inout) :: hit
    type(patch_t), intent(in) :: patch
    type(projection_t), intent(in) :: projection
    !> Radius of the border, mm.
    real(wp), intent(in) :: radius

    real(wp) :: normal(3), distance

    call normal_at(patch, projection%uv(1), projection%uv(2), normal, hit%found)
    hit%normal = radius*normal - projection%offset
    distance = norm2(hit%normal)
    hit%found = hit%found .and. distance > smallest_determinant*radius
    if (.not. hit%found) return
    hit%normal = hit%normal/distance
    hit%distance = distance - radius
    call set_normal_gradient(hit, projection, distance, radius*normal)
  end subroutine set_border_hit

  !> Set the gradient of the normal at an edge or corner.
  pure subroutine set_normal_gradient(hit, projection, distance, radius)
    !> Has its normal.
    type(hit_t), intent(inout) :: hit
    type(projection_t), intent(in) :: projection
    !> Distance of the node from the centre of the rounded edge, negative inside the tool, and
    !> vector from the centre to the edge, mm.
    real(wp), intent(in) :: distance, radius(3)

    real(wp) :: tangent(3), square, stretch, along
    integer :: a, i

    hit%dnormal = 0.0_wp
    do i = 1, 3
      hit%dnormal(i, i) = 1.0_wp/distance
      hit%dnormal(:, i) = hit%dnormal(:, i) - hit%normal*hit%normal(i)/distance
    end do
    do a = 1, 2
      if (projection%active(a) /= 0) cycle
      tangent = projection%first(:, a)
      square = dot_product(tangent, tangent)
      if (square <= epsilon(square)*maxval(sum(projection%first**2, dim=1))) cycle ! along a pole
      stretch = max(square + dot_product(projection%offset, projection%second(:, a)), &
          smallest_determinant*square)
      along = max(0.0_wp, 1.0_wp + dot_product(radius, projection%second(:, a))/square)
      do i = 1, 3
        hit%dnormal(:, i) = hit%dnormal(:, i) - along*tangent*tangent(i)/(stretch*distance)
      end do
    end do
  end subroutine set_normal_gradient

  !> Return a vector on the outer side of a surface at a sharp edge or corner: the sum of the
  !> normals of the two patches at the edge, of all patches at the corner weighted by their angles
  !> there (Baerentzen and Aanaes 2005), whose sign is right for every point that is closest to it.
  pure function mean_normal(surface, k, projection) result(mean)
    type(surface_t), intent(in) :: surface
    !> Number of the patch.
    integer, intent(in) :: k
    type(projection_t), intent(in) :: projection
    real(wp) :: mean(3)

    real(wp) :: uv(2)
    integer :: a, edge, start
    logical :: closed

    uv = projection%uv
    if (all(projection%active /= 0)) uv = merge(1.0_wp, 0.0_wp, projection%active > 0)
    mean = corner_part(surface%patch(k), uv, all(projection%active /= 0))
    do a = 1, 2
      if (projection%active(a) == 0) cycle
      edge = edge_number(a, projection%active(a) > 0)
      if (any(projection%active == 0)) then
        call add_neighbour(surface, k, edge, uv, .false., mean)
        cycle
      end if
      start = edge_number(3 - a, projection%active(3 - a) > 0)
      call add_around(surface, k, edge, start, uv, mean, closed)
      if (closed) return
    end do
  end function mean_normal

  !> Add the parts of the patches around a corner of a patch, across one edge after the other until
  !> the border, or the edge at the other side of the patch, is reached.
  pure subroutine add_around(surface, k, first, last, corner, mean, closed)
    type(surface_t), intent(in) :: surface
    !> Patch, and numbers of its two edges at the corner.
    integer, intent(in) :: k, first, last
    !> Parameters of the corner.
    real(wp), intent(in) :: corner(2)
    real(wp), intent(inout) :: mean(3)
    !> False if the border was reached.
    logical, intent(out) :: closed

    !> Most patches at a corner.
    integer, parameter :: most = 64
    real(wp) :: uv(2)
    integer :: i, patch, edge, direction

    patch = k
    edge = first
    uv = corner
    closed = .false.
    do i = 1, most
      associate (neighbour => surface%edge(edge, patch))
        closed = neighbour%patch == k .and. neighbour%edge == last
        if (neighbour%patch == 0 .or. closed) return
      end associate
      call add_neighbour(surface, patch, edge, uv, .true., mean)
      direction = 3 - (surface%edge(edge, patch)%edge + 1)/2
      uv = parameters_across(surface, patch, edge, uv)
      associate (neighbour => surface%edge(edge, patch))
        patch = neighbour%patch
        edge = edge_number(direction, uv(direction) > 0.5_wp)
      end associate
    end do
  end subroutine add_around

  !> Add the part of the neighbour across an edge, if there is one.
  pure subroutine add_neighbour(surface, k, e, uv, at_corner, mean)
    type(surface_t), intent(in) :: surface
    !> Patch, and number of its edge.
    integer, intent(in) :: k, e
    !> Parameters of the point on the edge.
    real(wp), intent(in) :: uv(2)
    !> Whether the point is a corner.
    logical, intent(in) :: at_corner
    real(wp), intent(inout) :: mean(3)

    associate (neighbour => surface%edge(e, k)%patch)
      if (neighbour == 0) return
      mean = mean + corner_part(surface%patch(neighbour), parameters_across(surface, k, e, uv), &
          at_corner)
    end associate
  end subroutine add_neighbour

  !> Return the parameters of a point on an edge in the neighbouring patch.
  pure function parameters_across(surface, k, e, uv) result(other)
    type(surface_t), intent(in) :: surface
    !> Patch, and number of its edge.
    integer, intent(in) :: k, e
    real(wp), intent(in) :: uv(2)
    real(wp) :: other(2)

    real(wp) :: t

    t = uv(3 - (e + 1)/2)
    associate (edge => surface%edge(e, k))
      other = edge_parameters(edge%edge, merge(1.0_wp - t, t, edge%reversed))
    end associate
  end function parameters_across

  !> Return the normal of a patch at a point of its border; at a corner its product with the angle
  !> of the patch.
  pure function corner_part(patch, uv, at_corner) result(part)
    type(patch_t), intent(in) :: patch
    real(wp), intent(in) :: uv(2)
    logical, intent(in) :: at_corner
    real(wp) :: part(3)

    real(wp) :: point(3), first(3, 2), second(3, 3), cosine
    logical :: regular

    call normal_at(patch, uv(1), uv(2), part, regular)
    if (.not. at_corner) return
    call evaluate(patch, uv(1), uv(2), point, first, second)
    cosine = (1.0_wp - 2.0_wp*uv(1))*(1.0_wp - 2.0_wp*uv(2))*dot_product(first(:, 1), first(:, 2)) &
        /max(norm2(first(:, 1))*norm2(first(:, 2)), tiny(1.0_wp))
    part = part*acos(min(max(cosine, -1.0_wp), 1.0_wp))
  end function corner_part

end module dd3_tools_hit
