! SPDX-License-Identifier: GPL-3.0-or-later
!> Surfaces and random numbers for the contact tests.
module contact_examples
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : patch_t, new_patch, position_at
  use dd3_tools_surface, only : surface_t, new_surface
  implicit none
  private
  public :: random_t, plane_patch, arc_patch, cubic_fillet, octant, random_patch, wave_surface
  public :: strip_surface, roof_surface, rib_surface, dome_surface, brute_distance

  !> cos 45 degrees.
  real(wp), parameter :: c45 = sqrt(0.5_wp)

  !> A portable generator of random numbers (Park and Miller 1988).
  type :: random_t
    integer(kind=selected_int_kind(15)) :: state = 20250
  contains
    procedure :: next
    procedure :: vector
  end type random_t

contains

  !> Return a random number between -1 and 1.
  real(wp) function next(self)
    class(random_t), intent(inout) :: self

    self%state = mod(16807*self%state, int(2147483647, kind(self%state)))
    next = 2.0_wp*real(self%state, wp)/2147483647.0_wp - 1.0_wp
  end function next

  !> Return a vector of n random numbers between -1 and 1.
  function vector(self, n) result(v)
    class(random_t), intent(inout) :: self
    integer, intent(in) :: n
    real(wp) :: v(n)

    integer :: i

    do i = 1, n
      v(i) = self%next()
    end do
  end function vector

  !> Make a parallelogram.
  function plane_patch(origin, a, b) result(patch)
    !> Corner and the two sides from it, mm.
    real(wp), intent(in) :: origin(3), a(3), b(3)
    type(patch_t) :: patch

    real(wp) :: p(3, 2, 2)

    p(:, 1, 1) = origin
    p(:, 2, 1) = origin + a
    p(:, 1, 2) = origin + b
    p(:, 2, 2) = origin + a + b
    call new_patch(patch, p)
  end function plane_patch

  !> Make an exact quarter of a cylinder from `start` to `finish`, extruded by b.
  function arc_patch(start, corner, finish, b) result(patch)
    !> End points, intersection of their tangents, and extrusion, mm.
    real(wp), intent(in) :: start(3), corner(3), finish(3), b(3)
    type(patch_t) :: patch

    real(wp) :: p(3, 3, 2)

    p(:, :, 1) = reshape([start, corner, finish], [3, 3])
    p(:, :, 2) = p(:, :, 1) + spread(b, 2, 3)
    call new_patch(patch, p, reshape([1.0_wp, c45, 1.0_wp, 1.0_wp, c45, 1.0_wp], [3, 2]))
  end function arc_patch

  !> Make a cubic quarter circle around the y axis, from +x to +z, normal outwards.
  function cubic_fillet(radius, width) result(patch)
    !> mm.
    real(wp), intent(in) :: radius, width
    type(patch_t) :: patch

    real(wp), parameter :: k = 0.5522847498_wp
    real(wp) :: p(3, 4, 2)

    p(:, :, 1) = radius*reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, k, k, 0.0_wp, 1.0_wp, &
        0.0_wp, 0.0_wp, 1.0_wp], [3, 4])
    p(:, :, 2) = p(:, :, 1)
    p(2, :, 1) = width
    call new_patch(patch, p)
  end function cubic_fillet

  !> Make an exact octant of a sphere around the origin: rational biquadratic, pole at v = 1.
  function octant(radius, quarter, rotation) result(patch)
    !> mm.
    real(wp), intent(in) :: radius
    !> Number of quarter turns around z.
    integer, intent(in) :: quarter
    !> That follows these.
    real(wp), intent(in), optional :: rotation(3, 3)
    type(patch_t) :: patch

    real(wp) :: p(3, 3, 3), w(3, 3), around(2, 3), up(2, 3), weight(3), turn(2, 2), xy(2)
    integer :: i, j

    turn = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
    do i = 1, quarter
      turn = matmul(reshape([0.0_wp, 1.0_wp, -1.0_wp, 0.0_wp], [2, 2]), turn)
    end do
    around = reshape([1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 3])
    up = around
    weight = [1.0_wp, c45, 1.0_wp]
    do j = 1, 3
      do i = 1, 3
        xy = matmul(turn, around(:, i))*up(1, j)
        p(:, i, j) = radius*[xy(1), xy(2), up(2, j)]
        if (present(rotation)) p(:, i, j) = matmul(rotation, p(:, i, j))
        w(i, j) = weight(i)*weight(j)
      end do
    end do
    call new_patch(patch, p, w)
  end function octant

  !> Make a random patch over the unit square.
  function random_patch(random, m, n, height, rational) result(patch)
    type(random_t), intent(inout) :: random
    !> Degrees.
    integer, intent(in) :: m, n
    !> Amplitude of the random part, mm.
    real(wp), intent(in) :: height
    !> True for random weights.
    logical, intent(in) :: rational
    type(patch_t) :: patch

    real(wp) :: p(3, 0:m, 0:n), w(0:m, 0:n)
    integer :: i, j

    do j = 0, n
      do i = 0, m
        p(:, i, j) = [real(i, wp)/m, real(j, wp)/n, 0.0_wp] + height*random%vector(3)
        w(i, j) = 1.0_wp + 0.7_wp*random%next()
      end do
    end do
    if (rational) then
      call new_patch(patch, p, w)
    else
      call new_patch(patch, p)
    end if
  end function random_patch

  !> Make two bicubic waves with a smooth common edge; the second runs backwards.
  function wave_surface() result(surface)
    type(surface_t) :: surface

    type(patch_t) :: patch(2)
    real(wp) :: p(3, 0:3, 0:3), q(3, 0:3, 0:3)
    integer :: i, j

    do j = 0, 3
      do i = 0, 3
        p(:, i, j) = [real(i, wp), real(j, wp), 0.8_wp*sin(2.0_wp*i) + 0.5_wp*cos(1.5_wp*j)]
        q(:, 3 - i, 3 - j) = [3.0_wp + i, real(j, wp), 0.6_wp*cos(1.0_wp*i + 0.3_wp*j)]
      end do
    end do
    q(:, 3, :) = p(:, 3, 3:0:-1)
    q(:, 2, :) = 2.0_wp*p(:, 3, 3:0:-1) - p(:, 2, 3:0:-1)
    call new_patch(patch(1), p)
    call new_patch(patch(2), q)
    call new_surface(surface, patch)
  end function wave_surface

  !> Make a punch: bottom, exact fillet of radius 5, wall; normals down and outwards.
  function strip_surface() result(surface)
    type(surface_t) :: surface

    type(patch_t) :: patch(3)
    real(wp), parameter :: b(3) = [0.0_wp, -20.0_wp, 0.0_wp]

    patch(1) = plane_patch([0.0_wp, 10.0_wp, 0.0_wp], [20.0_wp, 0.0_wp, 0.0_wp], b)
    patch(2) = arc_patch([20.0_wp, 10.0_wp, 0.0_wp], [25.0_wp, 10.0_wp, 0.0_wp], &
        [25.0_wp, 10.0_wp, 5.0_wp], b)
    patch(3) = plane_patch([25.0_wp, 10.0_wp, 5.0_wp], [0.0_wp, 0.0_wp, 30.0_wp], b)
    call new_surface(surface, patch)
  end function strip_surface

  !> Make two planes, inclined by 45 degrees, that meet in a ridge (or valley) along y at x = 0;
  !> normals upwards.
  function roof_surface(valley) result(surface)
    logical, intent(in) :: valley
    type(surface_t) :: surface

    type(patch_t) :: patch(2)
    real(wp) :: h

    h = merge(-4.0_wp, 4.0_wp, valley)
    patch(1) = plane_patch([-4.0_wp, -5.0_wp, -h], [4.0_wp, 0.0_wp, h], [0.0_wp, 10.0_wp, 0.0_wp])
    patch(2) = plane_patch([0.0_wp, -5.0_wp, 0.0_wp], [4.0_wp, 0.0_wp, -h], &
        [0.0_wp, 10.0_wp, 0.0_wp])
    call new_surface(surface, patch)
  end function roof_surface

  !> Make the walls of a rib, 1 mm thick, at x = 0 and x = 1; normals away from each other.
  function rib_surface() result(surface)
    type(surface_t) :: surface

    type(patch_t) :: patch(2)
    real(wp), parameter :: y(3) = [0.0_wp, 10.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 10.0_wp]

    patch(1) = plane_patch([0.0_wp, -5.0_wp, -5.0_wp], z, y)
    patch(2) = plane_patch([1.0_wp, -5.0_wp, -5.0_wp], y, z)
    call new_surface(surface, patch)
  end function rib_surface

  !> Make a hemisphere of four octants, its pole on top.
  function dome_surface(radius) result(surface)
    !> mm.
    real(wp), intent(in) :: radius
    type(surface_t) :: surface

    type(patch_t) :: patch(4)
    integer :: k

    do k = 1, 4
      patch(k) = octant(radius, k - 1)
    end do
    call new_surface(surface, patch)
  end function dome_surface

  !> Return the distance of a point from a surface, by grids refined around the closest point.
  real(wp) function brute_distance(surface, x) result(best)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: x(3)

    integer, parameter :: n = 40
    real(wp) :: centre(2), width, uv(2), closest(2), distance, square
    integer :: k, i, j, level

    best = huge(1.0_wp)
    do k = 1, size(surface%patch)
      centre = 0.5_wp
      width = 0.5_wp
      distance = huge(1.0_wp)
      do level = 1, 8
        closest = centre
        do j = -n, n
          do i = -n, n
            uv = min(max(centre + width*real([i, j], wp)/n, 0.0_wp), 1.0_wp)
            square = sum((position_at(surface%patch(k), uv(1), uv(2)) - x)**2)
            if (square >= distance) cycle
            distance = square
            closest = uv
          end do
        end do
        centre = closest
        width = width*merge(0.05_wp, 0.1_wp, level == 1)
      end do
      best = min(best, sqrt(distance))
    end do
  end function brute_distance

end module contact_examples
