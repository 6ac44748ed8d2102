! SPDX-License-Identifier: GPL-3.0-or-later
!> Rounding of kinks: joined edges of a surface across which its normal jumps. A node that slides
!> over one would have a step in its contact force; at the bottom of a kink, where both sides push
!> the node to it, the force that balances it lies between those of the sides, and there would be no
!> equilibrium.
!>
!> Both sides are continued by an arc of the radius R that is tangent to them. With the gaps d_i of
!> the sides i, their normals n_i, c = n_1.n_2, and s = 1 at a ridge, -1 in a groove,
!>     a_i = d_i + s R,    p_1 = s (a_1 - c a_2)/(1 - c^2),    p_2 = s (a_2 - c a_1)/(1 - c^2),
!>     m = p_1 n_1 + p_2 n_2,    d = s (|m| - R),    n = m/|m|,
!> where p_1 and p_2 are positive; elsewhere gap and normal are those of the surface. Where the
!> closest point of a side is on the edge, the side is continued by its tangent plane. With the
!> tangent t of the edge and e at right angles to t and n,
!>     dn/dx = s e e^T/|m| + t.(p_1 N_1 + p_2 N_2) t/|m| t t^T,
!> exact for plane sides.
module dd3_tools_kink
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : normal_at
  use dd3_tools_hit, only : border_t, hit_t, new_hit
  use dd3_tools_project, only : project
  use dd3_tools_projection, only : projection_t
  use dd3_tools_surface, only : edge_parameters, surface_t
  implicit none
  private
  public :: round_kink

  !> Largest distance between kink and arc over the gap below which there is contact, and largest
  !> distance of the arc's ends from the kink over the shorter sides of the patches.
  real(wp), parameter :: largest_offset = 0.5_wp, largest_part = 0.25_wp
  !> Least |m| over R; below it the node is near the centre of the arc.
  real(wp), parameter :: least_length = 1.0e-3_wp

  !> Side of a kink: gap, mm, normal, gradient of the normal, 1/mm, and the direction from the edge
  !> into the patch.
  type :: side_t
    real(wp) :: distance, normal(3), dnormal(3, 3), inward(3)
    !> Whether there is a normal.
    logical :: found
  end type side_t

contains

  !> Round a hit near a kink.
  pure subroutine round_kink(hit, surface, x, border)
    !> On a patch or at a sharp edge.
    type(hit_t), intent(inout) :: hit
    type(surface_t), intent(in) :: surface
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    !> Radius of the border, also the largest of a kink, and gap below which there is contact.
    type(border_t), intent(in) :: border

    type(side_t) :: side(2)
    real(wp) :: start(2), across
    integer :: e
    logical :: rounded

    start = [hit%u, hit%v]
    do e = 1, 4
      associate (edge => surface%edge(e, hit%patch), patch => surface%patch(hit%patch))
        if (edge%patch == 0 .or. edge%smooth .or. edge%opposite .or. edge%pole) cycle
        across = abs(start((e + 1)/2) - real(mod(e + 1, 2), wp))*patch%length(2, (e + 1)/2)
        if (across > border%radius) cycle
        call evaluate_side(surface, hit%patch, e, x, start, side(1))
        call evaluate_side(surface, edge%patch, edge%edge, x, &
            beside(edge%edge, start(3 - (e + 1)/2), edge%reversed), side(2))
        if (.not. all(side%found)) cycle
        call set_arc(hit, side, border, min(patch%shorter_side, &
            surface%patch(edge%patch)%shorter_side), rounded)
        if (rounded) return
      end associate
    end do
  end subroutine round_kink

  !> Return the parameters on an edge of the point with the parameter t on the edge joined with it.
  pure function beside(edge, t, reversed) result(uv)
    integer, intent(in) :: edge
    real(wp), intent(in) :: t
    logical, intent(in) :: reversed
    real(wp) :: uv(2)

    uv = edge_parameters(edge, merge(1.0_wp - t, t, reversed))
  end function beside

  !> Evaluate a side of a kink.
  pure subroutine evaluate_side(surface, k, e, x, start, side)
    type(surface_t), intent(in) :: surface
    !> Number of its patch and of the edge.
    integer, intent(in) :: k, e
    !> Position of the node, mm, and parameters of a point near the closest one.
    real(wp), intent(in) :: x(3), start(2)
    type(side_t), intent(out) :: side

    type(projection_t) :: projection
    type(hit_t) :: hit

    projection%uv = start
    associate (patch => surface%patch(k), edge => surface%edge(:, k))
      call project(patch, x, -edge([1, 3])%band, 1.0_wp + edge([2, 4])%band, projection)
      if (all(projection%active == 0)) then
        call new_hit(hit, surface, k, x, projection, 0.0_wp)
        side%normal = hit%normal
        side%dnormal = hit%dnormal
        side%found = hit%found
      else
        call normal_at(patch, projection%uv(1), projection%uv(2), side%normal, side%found)
        side%dnormal = 0.0_wp
      end if
      side%distance = -dot_product(projection%offset, side%normal)
      side%inward = projection%first(:, (e + 1)/2)
      if (mod(e, 2) == 0) side%inward = -side%inward
    end associate
  end subroutine evaluate_side

  !> Set gap and normal of a hit to those of the arc, if it is there.
  pure subroutine set_arc(hit, side, border, shorter_side, rounded)
    type(hit_t), intent(inout) :: hit
    type(side_t), intent(in) :: side(2)
    type(border_t), intent(in) :: border
    !> Of the patches, mm.
    real(wp), intent(in) :: shorter_side
    logical, intent(out) :: rounded

    real(wp) :: square, half, radius, s, less, a(2), p(2), m(3), length, t(3), e(3)
    integer :: i

    rounded = .false.
    t = cross(side(1)%normal, side(2)%normal)
    square = dot_product(t, t)
    if (square <= epsilon(1.0_wp)) return
    ! 1 - c of nearly equal normals without cancellation.
    less = 0.5_wp*sum((side(1)%normal - side(2)%normal)**2)
    half = sqrt(max(1.0_wp - 0.5_wp*less, tiny(1.0_wp)))
    radius = min(border%radius, largest_offset*border%reach*half*(1.0_wp + half)/(0.5_wp*less), &
        largest_part*shorter_side*half/sqrt(0.5_wp*less))
    s = sign(1.0_wp, -dot_product(side(1)%inward, side(2)%normal))
    a = side%distance + s*radius
    p = side%distance - side([2, 1])%distance + less*a([2, 1])
    p = s*p/square
    if (any(p <= 0.0_wp)) return
    m = p(1)*side(1)%normal + p(2)*side(2)%normal
    length = norm2(m)
    if (length <= least_length*radius) return
    rounded = .true.
    hit%distance = s*(length - radius)
    hit%normal = m/length
    t = t/sqrt(square)
    e = cross(t, hit%normal)
    m = matmul(p(1)*side(1)%dnormal + p(2)*side(2)%dnormal, t)
    do i = 1, 3
      hit%dnormal(:, i) = (s*e*e(i) + dot_product(t, m)*t*t(i))/length
    end do
  end subroutine set_arc

  !> Return the cross product a x b.
  pure function cross(a, b)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: cross(3)

    cross = a([2, 3, 1])*b([3, 1, 2]) - a([3, 1, 2])*b([2, 3, 1])
  end function cross

end module dd3_tools_kink
