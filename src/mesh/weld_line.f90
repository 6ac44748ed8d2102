! SPDX-License-Identifier: GPL-3.0-or-later
!> Weld line of a tailored blank: the border of a region, and the node line of a grid that is put on
!> it. The line goes on straight beyond its ends; a region beside it is closed by a circle round the
!> blank.
module dd3_mesh_weld_line
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_kinds, only : pi, wp
  use dd3_base_text, only : to_text
  use dd3_input_case, only : region_spec_t
  use dd3_input_point_file, only : read_points
  use dd3_mesh_plane_curve, only : is_inside, loop_t, new_loop
  implicit none
  private
  public :: weld_line_t, new_weld_line, follow_lines

  !> Radius of the circle over the size of the blank, and number of its vertices.
  real(wp), parameter :: far = 10.0_wp
  integer, parameter :: n_arc = 24
  !> Rounds of moves of the node lines along x and y: the place on a line depends on both.
  integer, parameter :: n_round = 20
  !> Least length of an interval over that before its node line is moved.
  real(wp), parameter :: least_stretch = 0.2_wp
  !> Distance at which a node lies on a line, over the size of the blank.
  real(wp), parameter :: on_line = 1.0e-12_wp

  !> A weld line.
  type :: weld_line_t
    !> Border of the region.
    type(loop_t) :: border(1)
    !> Vertices of the line with its continuations, `(2, n)`, mm; not of an outline.
    real(wp), allocatable :: point(:, :)
    !> Axis along which its node line is moved, 1 or 2; 0 if there is none on it.
    integer :: axis = 0
    !> Number of this node line from 0, and the largest path by which it was moved, mm.
    integer :: number = 0
    real(wp) :: moved = 0.0_wp
    !> Coordinates of the line along and across the node line, the first one increasing, mm.
    real(wp), allocatable :: along(:), across(:)
  contains
    procedure :: holds
    procedure :: place
  end type weld_line_t

contains

  !> Make the line of a region; without vertices if there was an error.
  subroutine new_weld_line(self, spec, centre, size_of_blank, errors)
    type(weld_line_t), intent(out) :: self
    type(region_spec_t), intent(in) :: spec
    !> Of the blank, and its size, mm.
    real(wp), intent(in) :: centre(2), size_of_blank
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: number(:), point(:, :)
    type(location_t) :: at
    integer :: before, least

    before = errors%count
    number = spec%point
    at = spec%source%at("points")
    if (len(spec%file) > 0) then
      at = spec%source%at("file")
      call read_points(number, spec%file, at, errors)
    end if
    if (errors%count > before) return
    point = reshape(number, [2, size(number)/2])
    least = merge(3, 2, spec%side == "inside")
    if (size(point, 2) >= least) call new_loop(self%border(1), point)
    if (allocated(self%border(1)%point)) point = self%border(1)%point
    if (size(point, 2) < least) then
      call errors%push_input(at, "too few different points", &
          to_text(least)//" or more", code="E132")
    else if (spec%side /= "inside") then
      call close_side(self, point, spec%side == "left", centre, far*size_of_blank)
    end if
  end subroutine new_weld_line

  !> Extend a line beyond its ends, and close one side of it by a circle.
  subroutine close_side(self, point, left, centre, radius)
    type(weld_line_t), intent(inout) :: self
    real(wp), intent(in) :: point(:, :)
    logical, intent(in) :: left
    real(wp), intent(in) :: centre(2), radius

    real(wp) :: arc(2, n_arc - 1), first, last, angle, ends(2, 2)
    integer :: n, i

    n = size(point, 2)
    ends(:, 1) = beyond(point(:, 2), point(:, 1))
    ends(:, 2) = beyond(point(:, n - 1), point(:, n))
    self%point = reshape([ends(:, 1), pack(point, .true.), ends(:, 2)], [2, n + 2])
    first = atan2(ends(2, 2) - centre(2), ends(1, 2) - centre(1))
    last = atan2(ends(2, 1) - centre(2), ends(1, 1) - centre(1))
    angle = modulo(last - first, 2.0_wp*pi)
    if (.not. left) angle = angle - 2.0_wp*pi
    do i = 1, n_arc - 1
      associate (a => first + angle*real(i, wp)/real(n_arc, wp))
        arc(:, i) = centre + radius*[cos(a), sin(a)]
      end associate
    end do
    call new_loop(self%border(1), reshape([self%point, arc], [2, n + 1 + n_arc]))

  contains

    !> Return the point on the circle to which the line goes on from a point through the next one.
    pure function beyond(from, to) result(there)
      real(wp), intent(in) :: from(2), to(2)
      real(wp) :: there(2)

      real(wp) :: direction(2), way

      direction = (to - from)/norm2(to - from)
      way = dot_product(direction, to - centre)
      there = to + direction*(sqrt(max(0.0_wp, way**2 - dot_product(to - centre, to - centre) &
          + radius**2)) - way)
    end function beyond

  end subroutine close_side

  !> Whether a point lies in the region.
  pure logical function holds(self, point)
    class(weld_line_t), intent(in) :: self
    real(wp), intent(in) :: point(2)

    holds = is_inside(self%border, point)
  end function holds

  !> Return the coordinate of the line across its node line at a coordinate along it, mm.
  pure real(wp) function place(self, along)
    class(weld_line_t), intent(in) :: self
    real(wp), intent(in) :: along

    integer :: i

    do i = 1, size(self%along) - 2
      if (along < self%along(i + 1)) exit
    end do
    place = self%across(i) + (self%across(i + 1) - self%across(i)) &
        *((along - self%along(i))/(self%along(i + 1) - self%along(i)))
  end function place

  !> Move the nearest node line of a grid onto each weld line that crosses it from side to side; the
  !> lines between follow in proportion. A weld line that cannot be followed keeps the axis 0.
  subroutine follow_lines(line, x)
    type(weld_line_t), intent(inout) :: line(:)
    !> Nodes of the grid in plan, `(2, 0:n_x, 0:n_y)`, mm.
    real(wp), intent(inout) :: x(:, 0:, 0:)

    real(wp), allocatable :: first(:, :, :)
    integer :: round, i

    first = x
    do i = 1, size(line)
      if (allocated(line(i)%point)) call choose_node_line(line, i, x)
    end do
    do round = 2, n_round
      do i = 1, size(line)
        if (line(i)%axis > 0) call follow(line, i, x)
      end do
    end do
    do i = 1, size(line)
      associate (axis => line(i)%axis, k => line(i)%number)
        if (axis == 1) line(i)%moved = maxval(abs(x(1, k, :) - first(1, k, :)))
        if (axis == 2) line(i)%moved = maxval(abs(x(2, :, k) - first(2, :, k)))
      end associate
    end do
  end subroutine follow_lines

  !> Choose the node line for a weld line, and move it there.
  subroutine choose_node_line(line, i, x)
    type(weld_line_t), intent(inout) :: line(:)
    integer, intent(in) :: i
    real(wp), intent(inout) :: x(:, 0:, 0:)

    real(wp) :: extent(2)
    integer :: axis, k

    extent = abs(line(i)%point(:, size(line(i)%point, 2)) - line(i)%point(:, 1))
    axis = merge(1, 2, extent(2) >= extent(1))
    associate (self => line(i), n => size(line(i)%point, 2))
      self%along = self%point(3 - axis, :)
      self%across = self%point(axis, :)
      if (self%along(n) < self%along(1)) then
        self%along = self%along(n:1:-1)
        self%across = self%across(n:1:-1)
      end if
      if (any(self%along(2:) <= self%along(:n - 1))) return
    end associate
    do k = 1, size(x, axis + 1) - 2
      if (k == 1) line(i)%number = k
      if (distance(k) < distance(line(i)%number)) line(i)%number = k
    end do
    if (line(i)%number == 0) return
    line(i)%axis = axis
    call follow(line, i, x)

  contains

    !> Return the mean distance of a node line from the weld line, mm.
    pure real(wp) function distance(k)
      integer, intent(in) :: k

      distance = sum(abs(offsets(line(i), axis, k, x)))
    end function distance

  end subroutine choose_node_line

  !> Return the distances of the nodes of a node line from a weld line, across it, mm.
  pure function offsets(self, axis, k, x) result(offset)
    type(weld_line_t), intent(in) :: self
    integer, intent(in) :: axis, k
    real(wp), intent(in) :: x(:, 0:, 0:)
    real(wp), allocatable :: offset(:)

    real(wp), allocatable :: node(:, :)
    integer :: j

    if (axis == 1) node = x(:, k, :)
    if (axis == 2) node = x(:, :, k)
    offset = [(self%place(node(3 - axis, j)) - node(axis, j), j=1, size(node, 2))]
  end function offsets

  !> Move the node line of a weld line onto it, between the node lines of others; give it up where
  !> the intervals beside it would become too short, or another weld line has it.
  subroutine follow(line, i, x)
    type(weld_line_t), intent(inout) :: line(:)
    integer, intent(in) :: i
    real(wp), intent(inout) :: x(:, 0:, 0:)

    real(wp), allocatable :: offset(:), from(:), to(:)
    integer :: lower, upper, k, m

    k = line(i)%number
    associate (axis => line(i)%axis)
      offset = offsets(line(i), axis, k, x)
      if (maxval(abs(offset)) <= on_line*maxval(abs(x))) return
      lower = 0
      upper = size(x, axis + 1) - 1
      do m = 1, size(line)
        if (m == i .or. line(m)%axis /= axis) cycle
        if (line(m)%number == k) then
          axis = 0
          return
        end if
        if (line(m)%number < k) lower = max(lower, line(m)%number)
        if (line(m)%number > k) upper = min(upper, line(m)%number)
      end do
      from = coordinates(k) - coordinates(lower)
      to = coordinates(upper) - coordinates(k)
      if (any(from + offset < least_stretch*from .or. to - offset < least_stretch*to)) then
        axis = 0
        return
      end if
      do m = lower + 1, upper - 1
        if (m < k) call shift(m, offset*(coordinates(m) - coordinates(lower))/from)
      end do
      do m = upper - 1, k + 1, -1
        call shift(m, offset*(coordinates(upper) - coordinates(m))/to)
      end do
      call shift(k, offset)
    end associate

  contains

    !> Return the coordinates of a node line across it, mm.
    pure function coordinates(m) result(value)
      integer, intent(in) :: m
      real(wp), allocatable :: value(:)

      if (line(i)%axis == 1) value = x(1, m, :)
      if (line(i)%axis == 2) value = x(2, :, m)
    end function coordinates

    !> Shift a node line across it.
    subroutine shift(m, by)
      integer, intent(in) :: m
      real(wp), intent(in) :: by(:)

      if (line(i)%axis == 1) x(1, m, :) = x(1, m, :) + by
      if (line(i)%axis == 2) x(2, :, m) = x(2, :, m) + by
    end subroutine shift

  end subroutine follow

end module dd3_mesh_weld_line
