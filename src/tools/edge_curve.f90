! SPDX-License-Identifier: GPL-3.0-or-later
!> Open edges of a surface as curves: their points, directions and the closest point to a point.
module dd3_tools_edge_curve
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : position_at
  use dd3_tools_surface, only : border_edge_t, edge_parameters, n_chord, surface_t
  implicit none
  private
  public :: point_on, direction_at, closest_on

  !> Number of golden sections: the interval shrinks to 1e-8 of a chord.
  integer, parameter :: n_section = 38
  !> Step of the parameter for directions.
  real(wp), parameter :: step = 1.0e-3_wp

contains

  !> Return a point of the curve, mm.
  pure function point_on(surface, curve, t) result(point)
    type(surface_t), intent(in) :: surface
    type(border_edge_t), intent(in) :: curve
    !> Parameter, 0 to 1.
    real(wp), intent(in) :: t
    real(wp) :: point(3)

    real(wp) :: uv(2)

    uv = edge_parameters(curve%edge, t)
    point = position_at(surface%patch(curve%patch), uv(1), uv(2))
  end function point_on

  !> Return the unit tangent by a difference; zero where the curve stands still.
  pure function direction_at(surface, curve, t) result(direction)
    type(surface_t), intent(in) :: surface
    type(border_edge_t), intent(in) :: curve
    real(wp), intent(in) :: t
    real(wp) :: direction(3)

    direction = point_on(surface, curve, min(1.0_wp, t + step)) &
        - point_on(surface, curve, max(0.0_wp, t - step))
    direction = direction/max(norm2(direction), tiny(1.0_wp))
  end function direction_at

  !> Find the closest point of the curve: the nearest end of a chord, improved by golden sections.
  pure subroutine closest_on(surface, curve, x, search_distance, t, distance)
    type(surface_t), intent(in) :: surface
    type(border_edge_t), intent(in) :: curve
    !> mm.
    real(wp), intent(in) :: x(3)
    !> Distances beyond it are not needed, mm.
    real(wp), intent(in) :: search_distance
    !> Parameter of the closest point.
    real(wp), intent(out) :: t
    !> mm; a huge value beyond `search_distance`.
    real(wp), intent(out) :: distance

    real(wp), parameter :: ratio = 0.5_wp*(sqrt(5.0_wp) - 1.0_wp)
    real(wp) :: lower, upper, a, b, value_a, value_b
    integer :: i, nearest

    distance = huge(1.0_wp)
    nearest = minloc(sum((curve%point - spread(x, 2, n_chord + 1))**2, dim=1), dim=1) - 1
    t = real(nearest, wp)/n_chord
    if (norm2(curve%point(:, nearest) - x) > search_distance + curve%chord) return
    lower = max(0.0_wp, t - 1.0_wp/n_chord)
    upper = min(1.0_wp, t + 1.0_wp/n_chord)
    a = upper - ratio*(upper - lower)
    b = lower + ratio*(upper - lower)
    value_a = norm2(point_on(surface, curve, a) - x)
    value_b = norm2(point_on(surface, curve, b) - x)
    do i = 1, n_section
      if (value_a < value_b) then
        upper = b
        b = a
        value_b = value_a
        a = upper - ratio*(upper - lower)
        value_a = norm2(point_on(surface, curve, a) - x)
      else
        lower = a
        a = b
        value_a = value_b
        b = lower + ratio*(upper - lower)
        value_b = norm2(point_on(surface, curve, b) - x)
      end if
    end do
    t = 0.5_wp*(lower + upper)
    distance = min(value_a, value_b)
  end subroutine closest_on

end module dd3_tools_edge_curve
