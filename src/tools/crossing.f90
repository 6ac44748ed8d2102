! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact of an edge of the sheet's mesh with the border of a surface that it crosses.
!>
!> The border is rounded as for nodes: with its point y(t), the unit normal m of the surface there
!> and the radius R, it is a tube about c = y - R m. The edge is x(xi) = x_1 + xi L with L = x_2 -
!> x_1. At the closest points of edge and tube, with r = x - c,
!>     (x - y).y' = 0,    r.L = 0,    d = |r| - R,    n = r/|r|,
!> the first where m does not twist about the border, and at an end of a border only the second.
!> There is contact where xi is inside the edge; at its ends the nodes have theirs, with the same
!> gap and normal. With p the displacement of the sheet's point, that of the tool deducted, and l
!> that of L, both conditions give dxi and dt,
!>     dd = n.p,    dr = p + L dxi - k y' dt,    dn = (I - n n^T) dr/|r|,    k = 1 + R m.y''/|y'|^2.
!> The contact fades where it passes to the nodes: with the smooth step s(x) = x^2 (3 - 2 x) between
!> 0 and 1, the distance b of the point from the nearer end of the edge, and the direction q in the
!> surface that leaves it at right angles to the border, its area has the weight
!>     w = s(b/R) s(1 + n.q/s_0).
!> Source: Wriggers and Zavarise, Commun. Numer. Methods Eng. 13 (1997) 429-438 (contact of beams).
module dd3_tools_crossing
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : evaluate, unit_normal
  use dd3_tools_hit, only : border_t
  use dd3_tools_surface, only : border_edge_t, edge_parameters, n_chord, surface_t
  implicit none
  private
  public :: crossing_t, find_crossing, near_border

  !> Largest number of iterations, and change of the parameters that ends them.
  integer, parameter :: iterations = 20
  real(wp), parameter :: converged = 1.0e-13_wp
  !> Largest squared cosine of the angle between edge and border: at smaller angles the crossing is
  !> ill-conditioned, and the other edges of the faces cross the border.
  real(wp), parameter :: parallel = 0.7_wp
  !> Least cosine of the angle by which the normal turns, and s_0: where it turns to the surface,
  !> the tube is inside the tool.
  real(wp), parameter :: least_cosine = 0.1_wp, inward_sine = 0.1_wp
  !> Weight below which there is none.
  real(wp), parameter :: least_weight = 1.0e-6_wp

  !> Closest points of an edge of the mesh and of a border.
  type :: crossing_t
    logical :: found = .false.
    !> xi, and gap, mm.
    real(wp) :: place = 0.5_wp, distance = huge(1.0_wp)
    !> Outward unit normal.
    real(wp) :: normal(3) = 0.0_wp
    !> Gradients of xi in p and l, 1/mm.
    real(wp) :: by_point(3) = 0.0_wp, by_edge(3) = 0.0_wp
    !> w, and its gradients, 1/mm.
    real(wp) :: weight = 0.0_wp, weight_by_point(3) = 0.0_wp, weight_by_edge(3) = 0.0_wp
    !> dn/dp, 1/mm; dn = -along n.l.
    real(wp) :: dnormal(3, 3) = 0.0_wp, along(3) = 0.0_wp
  end type crossing_t

  !> Point of a border.
  type :: border_point_t
    !> y, y', y'', mm, and m.
    real(wp) :: y(3), first(3), second(3), normal(3)
    !> q.
    real(wp) :: leaving(3)
    !> k.
    real(wp) :: stretch
    logical :: regular
  end type border_point_t

contains

  !> Whether a box comes near the border of a surface.
  pure logical function near_border(surface, lower, upper)
    type(surface_t), intent(in) :: surface
    !> Of the box, mm.
    real(wp), intent(in) :: lower(3), upper(3)

    integer :: b

    near_border = .false.
    if (any(lower > surface%upper .or. upper < surface%lower)) return
    do b = 1, size(surface%border)
      near_border = all(lower <= surface%border(b)%upper .and. upper >= surface%border(b)%lower)
      if (near_border) return
    end do
  end function near_border

  !> Find the closest points of an edge of the mesh and of the border of a surface.
  pure subroutine find_crossing(surface, ends, outward, border, largest_gap, crossing)
    type(surface_t), intent(in) :: surface
    !> Ends of the edge in the surface's frame, mm.
    real(wp), intent(in) :: ends(3, 2)
    !> Outward normal of the sheet: the tool's must be opposite.
    real(wp), intent(in) :: outward(3)
    type(border_t), intent(in) :: border
    !> Largest gap, mm.
    real(wp), intent(in) :: largest_gap
    type(crossing_t), intent(out) :: crossing

    type(crossing_t) :: candidate
    real(wp) :: lower(3), upper(3), reach, t, distance
    integer :: b

    reach = border%radius + largest_gap
    lower = minval(ends, dim=2) - reach
    upper = maxval(ends, dim=2) + reach
    if (any(lower > surface%upper .or. upper < surface%lower)) return
    do b = 1, size(surface%border)
      associate (edge => surface%border(b))
        if (any(lower > edge%upper .or. upper < edge%lower)) cycle
        call find_nearest_end(edge, ends, t, distance)
        if (distance > reach + border%radius + edge%chord) cycle
        call cross_edge(surface, edge%patch, edge%edge, ends, border%radius, t, candidate)
      end associate
      if (.not. candidate%found .or. candidate%distance >= crossing%distance) cycle
      if (dot_product(candidate%normal, outward) > 0.0_wp) cycle
      crossing = candidate
    end do
    crossing%found = crossing%distance <= largest_gap
  end subroutine find_crossing

  !> Find the closest points of an edge of the mesh and of one of a patch.
  pure subroutine cross_edge(surface, k, e, ends, radius, start, crossing)
    type(surface_t), intent(in) :: surface
    !> Patch, and number of its edge.
    integer, intent(in) :: k, e
    !> Parameter at which the iterations start.
    real(wp), intent(in) :: ends(3, 2), radius, start
    !> Not found if the closest point of the edge is one of its ends.
    type(crossing_t), intent(out) :: crossing

    type(border_point_t) :: at
    real(wp) :: line(3), t, step(2), matrix(2, 2), offset(3)
    integer :: i
    logical :: ended

    line = ends(:, 2) - ends(:, 1)
    t = start
    do i = 1, iterations
      at = border_point(surface, k, e, t, radius)
      if (.not. at%regular) return
      ! The point of the edge for this t.
      crossing%place = -dot_product(ends(:, 1) - at%y + radius*at%normal, line) &
          /dot_product(line, line)
      offset = ends(:, 1) + crossing%place*line - at%y
      matrix = conditions(at, line, offset)
      step = solution(matrix, [dot_product(offset, at%first), 0.0_wp])
      ended = t + step(2) < 0.0_wp .or. t + step(2) > 1.0_wp
      step(2) = min(max(t + step(2), 0.0_wp), 1.0_wp) - t
      t = t + step(2)
      if (abs(step(2)) <= converged) exit
    end do
    if (i > iterations) return
    if (crossing%place <= 0.0_wp .or. crossing%place >= 1.0_wp) return
    if (dot_product(line, at%first)**2 > parallel*dot_product(line, line) &
        *dot_product(at%first, at%first)) return
    call set_contact(crossing, at, line, offset + radius*at%normal, radius, ended)
  end subroutine cross_edge

  !> Find the end of a chord of the border that is nearest to an edge of the mesh.
  pure subroutine find_nearest_end(border, ends, t, distance)
    type(border_edge_t), intent(in) :: border
    real(wp), intent(in) :: ends(3, 2)
    !> Its parameter.
    real(wp), intent(out) :: t
    !> mm.
    real(wp), intent(out) :: distance

    real(wp) :: line(3), offset(3), square, nearest, length
    integer :: i

    line = ends(:, 2) - ends(:, 1)
    length = dot_product(line, line)
    nearest = huge(1.0_wp)
    do i = 0, n_chord
      offset = border%point(:, i) - ends(:, 1)
      offset = offset - line*min(max(dot_product(offset, line)/length, 0.0_wp), 1.0_wp)
      square = dot_product(offset, offset)
      if (square >= nearest) cycle
      nearest = square
      t = real(i, wp)/n_chord
    end do
    distance = sqrt(nearest)
  end subroutine find_nearest_end

  !> Return the point of a border at a parameter.
  pure type(border_point_t) function border_point(surface, k, e, t, radius) result(at)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: k, e
    real(wp), intent(in) :: t, radius

    real(wp) :: uv(2), first(3, 2), second(3, 3)
    integer :: i

    uv = edge_parameters(e, t)
    call evaluate(surface%patch(k), uv(1), uv(2), at%y, first, second)
    call unit_normal(surface%patch(k), first, at%normal, at%regular)
    i = merge(2, 1, e <= 2)
    at%first = first(:, i)
    at%second = second(:, i)
    at%leaving = at%normal([2, 3, 1])*at%first([3, 1, 2]) - at%normal([3, 1, 2])*at%first([2, 3, 1])
    at%leaving = at%leaving/max(norm2(at%leaving), tiny(1.0_wp))
    if (dot_product(at%leaving, first(:, 3 - i)) > 0.0_wp .neqv. mod(e, 2) == 0) then
      at%leaving = -at%leaving
    end if
    at%stretch = max(0.0_wp, 1.0_wp + radius*dot_product(at%normal, at%second) &
        /max(dot_product(at%first, at%first), tiny(1.0_wp)))
  end function border_point

  !> Return the derivatives of both conditions in xi and t.
  pure function conditions(at, line, offset) result(matrix)
    type(border_point_t), intent(in) :: at
    !> L and x - y, mm.
    real(wp), intent(in) :: line(3), offset(3)
    real(wp) :: matrix(2, 2)

    matrix(1, 1) = dot_product(line, at%first)
    matrix(1, 2) = dot_product(offset, at%second) - dot_product(at%first, at%first)
    matrix(2, 1) = dot_product(line, line)
    matrix(2, 2) = -at%stretch*dot_product(at%first, line)
  end function conditions

  !> Return the changes of xi and t that cancel two residuals.
  pure function solution(matrix, residual)
    real(wp), intent(in) :: matrix(2, 2), residual(2)
    real(wp) :: solution(2)

    real(wp) :: determinant

    determinant = matrix(1, 1)*matrix(2, 2) - matrix(1, 2)*matrix(2, 1)
    solution = 0.0_wp
    if (abs(determinant) <= tiny(1.0_wp)) return
    solution(1) = -(matrix(2, 2)*residual(1) - matrix(1, 2)*residual(2))/determinant
    solution(2) = -(matrix(1, 1)*residual(2) - matrix(2, 1)*residual(1))/determinant
  end function solution

  !> Set gap, normal and gradients at the closest points.
  pure subroutine set_contact(crossing, at, line, r, radius, ended)
    type(crossing_t), intent(inout) :: crossing
    type(border_point_t), intent(in) :: at
    !> L, r and R, mm.
    real(wp), intent(in) :: line(3), r(3), radius
    !> Whether the border's closest point is an end.
    logical, intent(in) :: ended

    real(wp) :: matrix(2, 2), change(2), motion(3), length
    integer :: j

    length = norm2(r)
    crossing%normal = r/length
    crossing%distance = length - radius
    crossing%found = dot_product(crossing%normal, at%normal) >= least_cosine
    if (.not. crossing%found) return
    matrix = conditions(at, line, r - radius*at%normal)
    if (ended) matrix(1, :) = [0.0_wp, 1.0_wp]
    do j = 1, 3
      change = solution(matrix, [merge(0.0_wp, at%first(j), ended), line(j)])
      crossing%by_point(j) = change(1)
      motion = line*change(1) - at%stretch*at%first*change(2)
      motion(j) = motion(j) + 1.0_wp
      crossing%dnormal(:, j) = across(motion)
      change = solution(matrix, [0.0_wp, r(j)])
      crossing%by_edge(j) = change(1)
    end do
    ! The change by l is that by r.l = |r| n.l.
    change = solution(matrix, [0.0_wp, length])
    crossing%along = -across(line*change(1) - at%stretch*at%first*change(2))
    call set_weight(crossing, at%leaving, norm2(line)/radius)

  contains

    !> Return the change of the normal by one of r.
    pure function across(motion)
      real(wp), intent(in) :: motion(3)
      real(wp) :: across(3)

      across = (motion - dot_product(crossing%normal, motion)*crossing%normal)/length
    end function across

  end subroutine set_contact

  !> Set the weight and its gradients.
  pure subroutine set_weight(crossing, leaving, length)
    type(crossing_t), intent(inout) :: crossing
    !> q, and |L|/R.
    real(wp), intent(in) :: leaving(3), length

    real(wp) :: part(2), slope(2)

    call smooth_step(length*min(crossing%place, 1.0_wp - crossing%place), part(1), slope(1))
    call smooth_step(1.0_wp + dot_product(leaving, crossing%normal)/inward_sine, part(2), slope(2))
    slope(1) = slope(1)*part(2)*sign(length, 0.5_wp - crossing%place)
    slope(2) = slope(2)*part(1)/inward_sine
    crossing%weight = part(1)*part(2)
    crossing%weight_by_point = slope(1)*crossing%by_point &
        + slope(2)*matmul(leaving, crossing%dnormal)
    crossing%weight_by_edge = slope(1)*crossing%by_edge &
        - slope(2)*dot_product(leaving, crossing%along)*crossing%normal
    crossing%found = crossing%weight >= least_weight
  end subroutine set_weight

  !> Evaluate the smooth step and its slope.
  pure subroutine smooth_step(x, step, slope)
    real(wp), intent(in) :: x
    real(wp), intent(out) :: step, slope

    real(wp) :: y

    y = min(max(x, 0.0_wp), 1.0_wp)
    step = y**2*(3.0_wp - 2.0_wp*y)
    slope = 6.0_wp*y*(1.0_wp - y)
  end subroutine smooth_step

end module dd3_tools_crossing
