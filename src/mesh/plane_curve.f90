! SPDX-License-Identifier: GPL-3.0-or-later
!> Polygons in a plane: which points lie inside, the closest point, crossings, corners.
module dd3_mesh_plane_curve
  use dd3_base_kinds, only : pi, wp
  implicit none
  private
  public :: loop_t, new_loop, is_inside, crossing_segments

  !> Least angle between two segments at a corner of a curve, rad.
  real(wp), parameter :: corner_angle = pi/6.0_wp

  !> A polygon, closed by a side from its last vertex to its first unless it is open.
  type :: loop_t
    !> Vertices, `(2, n)`, mm.
    real(wp), allocatable :: point(:, :)
    logical :: closed = .true.
    !> Arc length at the vertices, that of the first one again at the end, `(n + 1)`, mm; an open
    !> polygon does not use that one.
    real(wp), allocatable :: arc(:)
    !> Arc lengths of the corners.
    real(wp), allocatable :: corner(:)
  contains
    procedure :: length
    procedure :: n_side
    procedure :: closest
    procedure :: at
  end type loop_t

contains

  !> Make a loop of its vertices; those that coincide with the one before are left out.
  pure subroutine new_loop(self, point)
    type(loop_t), intent(out) :: self
    !> `(2, n)`, mm.
    real(wp), intent(in) :: point(:, :)

    logical :: kept(size(point, 2))
    real(wp) :: before(2), after(2), turn
    integer :: i, k, n, last

    last = size(point, 2)
    do i = 1, size(point, 2)
      kept(i) = norm2(point(:, i) - point(:, last)) > 0.0_wp
      if (kept(i)) last = i
    end do
    n = count(kept)
    self%point = point(:, pack([(i, i=1, size(kept))], kept))
    allocate (self%arc(n + 1), self%corner(0))
    self%arc(1) = 0.0_wp
    do i = 1, n
      self%arc(i + 1) = self%arc(i) + norm2(self%point(:, mod(i, n) + 1) - self%point(:, i))
    end do
    do i = 1, n
      k = mod(i - 2 + n, n) + 1
      before = self%point(:, i) - self%point(:, k)
      after = self%point(:, mod(i, n) + 1) - self%point(:, i)
      turn = atan2(before(1)*after(2) - before(2)*after(1), dot_product(before, after))
      if (abs(turn) > corner_angle) self%corner = [self%corner, self%arc(i)]
    end do
  end subroutine new_loop

  !> Return the length of a polygon, mm.
  pure real(wp) function length(self)
    class(loop_t), intent(in) :: self

    length = self%arc(self%n_side() + 1)
  end function length

  !> Return the number of its sides.
  pure integer function n_side(self)
    class(loop_t), intent(in) :: self

    n_side = size(self%point, 2) - merge(0, 1, self%closed)
  end function n_side

  !> Find the closest point of a polygon.
  pure subroutine closest(self, point, arc, distance)
    class(loop_t), intent(in) :: self
    real(wp), intent(in) :: point(2)
    !> Arc length and distance, mm.
    real(wp), intent(out) :: arc, distance

    real(wp) :: side(2), from(2), t, d
    integer :: i, n

    n = size(self%point, 2)
    distance = huge(1.0_wp)
    arc = 0.0_wp
    do i = 1, self%n_side()
      from = point - self%point(:, i)
      side = self%point(:, mod(i, n) + 1) - self%point(:, i)
      t = min(1.0_wp, max(0.0_wp, dot_product(from, side)/max(tiny(1.0_wp), &
          dot_product(side, side))))
      d = norm2(from - t*side)
      if (d >= distance) cycle
      distance = d
      arc = self%arc(i) + t*(self%arc(i + 1) - self%arc(i))
    end do
  end subroutine closest

  !> Return the point at an arc length; a closed polygon goes on after its end.
  pure function at(self, arc) result(point)
    class(loop_t), intent(in) :: self
    !> mm.
    real(wp), intent(in) :: arc
    real(wp) :: point(2)

    real(wp) :: s
    integer :: i, j, k, n

    n = size(self%point, 2)
    s = min(self%length(), max(0.0_wp, arc))
    if (self%closed) s = modulo(arc, self%length())
    i = 1
    j = self%n_side() + 1
    do while (j - i > 1)
      k = (i + j)/2
      if (self%arc(k) <= s) then
        i = k
      else
        j = k
      end if
    end do
    s = (s - self%arc(i))/max(tiny(1.0_wp), self%arc(i + 1) - self%arc(i))
    point = self%point(:, i) + s*(self%point(:, mod(i, n) + 1) - self%point(:, i))
  end function at

  !> Intersect two segments.
  pure subroutine intersect(a, b, c, d, s, t, meets)
    !> Ends of the first and of the second one.
    real(wp), intent(in) :: a(2), b(2), c(2), d(2)
    !> Place of the intersection on each, 0 to 1.
    real(wp), intent(out) :: s, t
    logical, intent(out) :: meets

    real(wp) :: u(2), v(2), w(2), cross

    u = b - a
    v = d - c
    w = c - a
    cross = u(1)*v(2) - u(2)*v(1)
    s = 0.0_wp
    t = 0.0_wp
    meets = abs(cross) > 0.0_wp
    if (.not. meets) return
    s = (w(1)*v(2) - w(2)*v(1))/cross
    t = (w(1)*u(2) - w(2)*u(1))/cross
    meets = s >= 0.0_wp .and. s <= 1.0_wp .and. t >= 0.0_wp .and. t <= 1.0_wp
  end subroutine intersect

  !> Whether a point lies inside an odd number of loops.
  pure logical function is_inside(loop, point)
    type(loop_t), intent(in) :: loop(:)
    real(wp), intent(in) :: point(2)

    integer :: i, k, n

    is_inside = .false.
    do k = 1, size(loop)
      n = size(loop(k)%point, 2)
      do i = 1, n
        associate (a => loop(k)%point(:, i), b => loop(k)%point(:, mod(i, n) + 1))
          if ((a(2) > point(2)) .eqv. (b(2) > point(2))) cycle
          if (point(1) < a(1) + (point(2) - a(2))/(b(2) - a(2))*(b(1) - a(1))) then
            is_inside = .not. is_inside
          end if
        end associate
      end do
    end do
  end function is_inside

  !> Find two segments of loops that cross: loop and segment of each; 0 if none do.
  pure function crossing_segments(loop) result(place)
    type(loop_t), intent(in) :: loop(:)
    integer :: place(2, 2)

    real(wp) :: s, t
    logical :: meets
    integer :: i, j, k, l, n, m

    do k = 1, size(loop)
      n = size(loop(k)%point, 2)
      do i = 1, n
        associate (a => loop(k)%point(:, i), b => loop(k)%point(:, mod(i, n) + 1))
          do l = k, size(loop)
            m = size(loop(l)%point, 2)
            do j = merge(i + 2, 1, l == k), m
              if (l == k .and. mod(j, m) + 1 == i) cycle
              associate (c => loop(l)%point(:, j), d => loop(l)%point(:, mod(j, m) + 1))
                if (any(max(a, b) < min(c, d)) .or. any(max(c, d) < min(a, b))) cycle
                call intersect(a, b, c, d, s, t, meets)
              end associate
              place = reshape([k, i, l, j], [2, 2])
              if (meets) return
            end do
          end do
        end associate
      end do
    end do
    place = 0
  end function crossing_segments

end module dd3_mesh_plane_curve
