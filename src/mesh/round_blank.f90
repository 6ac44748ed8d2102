! SPDX-License-Identifier: GPL-3.0-or-later
!> Mesh generator of a round blank: an O-grid. Each quarter has a core with three edges, two along
!> the axes and one bulged, and a ring from it to the rim. The bulge makes three equal angles of 120
!> degrees where core and ring meet on the diagonal; a square core would leave 135 degrees to the
!> ring. The corners of the elements are symmetric about the diagonal of a quarter, bit for bit.
module dd3_mesh_round_blank
  use dd3_base_kinds, only : wp, pi
  use dd3_input_case, only : blank_spec_t
  use dd3_input_sheet_sets, only : n_quarters, round_sets, set_name_length
  use dd3_mesh_mesh, only : mesh_t, mesh_set_t
  implicit none
  private
  public :: new_round_mesh

  !> Least and largest size of the core over the radius.
  real(wp), parameter :: smallest_core = 0.3_wp, largest_core = 0.6_wp
  !> Angle of the outermost edge of the core from its axis, at the diagonal.
  real(wp), parameter :: tilt = pi/12.0_wp

  !> Plane grid of half an element's interval, of one quarter. Core point (i, j), 0 to 2*core;
  !> ring point (k, s): k = 1 to 2*ring from the core to the rim, s = 0 to 4*core from x to y.
  type :: quarter_t
    integer :: core = 0, ring = 0
    !> Coordinates, mm, `(2, 0:2*core, 0:2*core)` and `(2, 0:2*ring, 0:4*core)`.
    real(wp), allocatable :: core_x(:, :, :), ring_x(:, :, :)
  end type quarter_t

  !> The plane grid of the blank.
  type :: plane_t
    integer :: n_point = 0
    !> Coordinates, `x(:, 1:n_point)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Points of each quadrilateral and its middles, `(3, 3, n)`, counter-clockwise.
    integer, allocatable :: cell(:, :, :)
    !> Whether each point is on x = 0, y = 0, the rim, `(3, n_point)`.
    logical, allocatable :: on(:, :)
  end type plane_t

contains

  !> Build nodes, elements and node sets of a round blank. Nodes are numbered through the thickness
  !> first.
  subroutine new_round_mesh(mesh, blank, natural)
    type(mesh_t), intent(out) :: mesh
    type(blank_spec_t), intent(in) :: blank
    !> Natural coordinates of the element's nodes, each -1, 0 or 1, `(3, n_element_node)`.
    real(wp), intent(in) :: natural(:, :)

    type(quarter_t) :: quarter
    type(plane_t) :: plane

    call new_quarter(quarter, blank)
    call new_plane(plane, quarter, n_quarters(blank%portion))
    mesh%thickness = blank%size(3)
    call extrude(mesh, plane, blank, nint(natural))
    allocate (mesh%material(mesh%n_element), source=blank%material)
  end subroutine new_round_mesh

  !> Compute the grid of one quarter. Elements of core and ring have about the same length.
  pure subroutine new_quarter(self, blank)
    type(quarter_t), intent(out) :: self
    type(blank_spec_t), intent(in) :: blank

    integer :: n

    self%core = blank%divisions(1)
    self%ring = blank%divisions(2)
    n = 2*self%core
    allocate (self%core_x(2, 0:n, 0:n), self%ring_x(2, 0:2*self%ring, 0:2*n))
    call place_core(self%core_x, self%core, blank%radius*min(largest_core, max(smallest_core, &
        real(self%core, wp)/real(self%core + self%ring, wp))))
    call add_middles(self%core_x)
    self%ring_x(:, 0, :n) = self%core_x(:, n, :)
    self%ring_x(:, 0, n:) = self%core_x(:, n:0:-1, n)
    call place_ring(self%ring_x, n, blank%radius)
    call add_middles(self%ring_x)
    call round_rim(self%ring_x, n, blank%radius)
  end subroutine new_quarter

  !> Place the corners of the elements of the core by transfinite interpolation: below the diagonal,
  !> then mirrored.
  pure subroutine place_core(x, n_element, side)
    real(wp), intent(inout) :: x(:, 0:, 0:)
    !> Number of elements along a side.
    integer, intent(in) :: n_element
    !> Length of the sides along the axes, mm.
    real(wp), intent(in) :: side

    real(wp) :: angle, radius
    integer :: i, j, n

    n = 2*n_element
    ! Arc of the outer sides; its last chord is tilted by `tilt`.
    angle = tilt/(1.0_wp - 0.5_wp/real(n_element, wp))
    radius = side/(sin(angle) + 1.0_wp - cos(angle))
    do j = 0, n, 2
      do i = 0, j, 2
        x(:, j, i) = point(real(j, wp)/real(n, wp), real(i, wp)/real(n, wp))
        x(:, i, j) = x([2, 1], j, i)
      end do
      x(1, j, j) = x(2, j, j)
    end do

  contains

    !> Return a point of the core, a and b from 0 to 1 along x and y.
    pure function point(a, b)
      real(wp), intent(in) :: a, b
      real(wp) :: point(2)

      real(wp) :: right(2), upper(2)

      right = [side - radius*(1.0_wp - cos(angle*b)), radius*sin(angle*b)]
      upper = [radius*sin(angle*a), side - radius*(1.0_wp - cos(angle*a))]
      point = a*right + [0.0_wp, (1.0_wp - a)*b*side] + b*upper + [(1.0_wp - b)*a*side, 0.0_wp] &
          - [a*(1.0_wp - b)*side, (1.0_wp - a)*b*side] - a*b*radius*sin(angle)
    end function point

  end subroutine place_core

  !> Place the corners of the elements of the ring, on straight lines from the core to the rim.
  pure subroutine place_ring(x, n, radius)
    !> The points of the core are given.
    real(wp), intent(inout) :: x(:, 0:, 0:)
    !> Number of the point on the diagonal.
    integer, intent(in) :: n
    real(wp), intent(in) :: radius

    real(wp) :: angle, fraction
    integer :: i, j, last

    last = ubound(x, 2)
    do j = 0, n, 2
      angle = 0.25_wp*pi*real(j, wp)/real(n, wp)
      do i = 2, last, 2
        fraction = real(i, wp)/real(last, wp)
        x(:, i, j) = (1.0_wp - fraction)*x(:, 0, j) + fraction*radius*[cos(angle), sin(angle)]
        if (j == n) x(1, i, j) = x(2, i, j)
        x(:, i, 2*n - j) = x([2, 1], i, j)
      end do
    end do
  end subroutine place_ring

  !> Set the points between even ones to their means.
  pure subroutine add_middles(x)
    real(wp), intent(inout) :: x(:, 0:, 0:)

    integer :: i, j

    do j = 0, ubound(x, 3), 2
      do i = 1, ubound(x, 2), 2
        x(:, i, j) = 0.5_wp*(x(:, i - 1, j) + x(:, i + 1, j))
      end do
    end do
    do j = 1, ubound(x, 3), 2
      do i = 0, ubound(x, 2)
        x(:, i, j) = 0.5_wp*(x(:, i, j - 1) + x(:, i, j + 1))
      end do
    end do
  end subroutine add_middles

  !> Move the middles of the edges on the rim to the circle, and the centres of its elements half as
  !> far, as transfinite interpolation does.
  pure subroutine round_rim(x, n, radius)
    real(wp), intent(inout) :: x(:, 0:, 0:)
    !> Number of the point on the diagonal.
    integer, intent(in) :: n
    real(wp), intent(in) :: radius

    real(wp) :: angle, shift(2)
    integer :: j, last

    last = ubound(x, 2)
    do j = 1, n - 1, 2
      angle = 0.25_wp*pi*real(j, wp)/real(n, wp)
      shift = radius*[cos(angle), sin(angle)] - x(:, last, j)
      x(:, last, j) = x(:, last, j) + shift
      x(:, last - 1, j) = x(:, last - 1, j) + 0.5_wp*shift
      x(:, last - 1:last, 2*n - j) = x([2, 1], last - 1:last, j)
    end do
  end subroutine round_rim

  !> Join the quarters: each is turned by 90 degrees from the one before, and the last one closes a
  !> full circle.
  subroutine new_plane(self, quarter, n_quarter)
    type(plane_t), intent(out) :: self
    type(quarter_t), intent(in) :: quarter
    integer, intent(in) :: n_quarter

    integer, allocatable :: core(:, :, :), ring(:, :, :)
    integer :: q, i, j, n, m, n_cell

    n = 2*quarter%core
    m = 2*quarter%ring
    allocate (self%x(2, n_quarter*((n + 1)**2 + (m + 1)*(2*n + 1))))
    allocate (self%on(3, size(self%x, 2)), source=.false.)
    allocate (core(0:n, 0:n, n_quarter), ring(0:m, 0:2*n, n_quarter), source=0)
    allocate (self%cell(3, 3, n_quarter*(quarter%core**2 + 2*quarter%core*quarter%ring)))
    n_cell = 0
    do q = 1, n_quarter
      if (q > 1) core(:, 0, q) = core(0, :, q - 1)
      if (q > 1) ring(:, 0, q) = ring(:, 2*n, q - 1)
      if (q == 4) core(0, :, q) = core(:, 0, 1)
      if (q == 4) ring(:, 2*n, q) = ring(:, 0, 1)
      do j = 0, n
        do i = 0, n
          call add_point(self, quarter%core_x(:, i, j), turn(q), core(i, j, q))
        end do
      end do
      ring(0, :n, q) = core(n, :, q)
      ring(0, n:, q) = core(n:0:-1, n, q)
      do j = 0, 2*n
        do i = 0, m
          call add_point(self, quarter%ring_x(:, i, j), turn(q), ring(i, j, q))
        end do
      end do
      self%on(3, ring(m, :, q)) = .true.
      call add_cells(self%cell, n_cell, core(:, :, q))
      call add_cells(self%cell, n_cell, ring(:, :, q))
    end do
    self%on(1, :self%n_point) = abs(self%x(1, :self%n_point)) <= 0.0_wp
    self%on(2, :self%n_point) = abs(self%x(2, :self%n_point)) <= 0.0_wp

  contains

    !> Return the quadrant, 1 to 4, of a quarter; a half begins with the last one, so that x >= 0.
    pure integer function turn(q)
      integer, intent(in) :: q

      turn = q
      if (n_quarter == 2) turn = merge(4, 1, q == 1)
    end function turn

  end subroutine new_plane

  !> Append the quadrilaterals of a grid.
  pure subroutine add_cells(cell, n_cell, number)
    integer, intent(inout) :: cell(:, :, :), n_cell
    !> Points of the grid.
    integer, intent(in) :: number(0:, 0:)

    integer :: i, j

    do j = 0, ubound(number, 2) - 2, 2
      do i = 0, ubound(number, 1) - 2, 2
        n_cell = n_cell + 1
        cell(:, :, n_cell) = number(i:i + 2, j:j + 2)
      end do
    end do
  end subroutine add_cells

  !> Add a point of a quarter unless it has a number.
  pure subroutine add_point(self, x, quadrant, number)
    type(plane_t), intent(inout) :: self
    !> Coordinates in the first quarter, mm.
    real(wp), intent(in) :: x(2)
    integer, intent(in) :: quadrant
    integer, intent(inout) :: number

    if (number > 0) return
    self%n_point = self%n_point + 1
    number = self%n_point
    select case (quadrant)
    case (1)
      self%x(:, number) = x
    case (2)
      self%x(:, number) = [-x(2), x(1)]
    case (3)
      self%x(:, number) = -x
    case default
      self%x(:, number) = [x(2), -x(1)]
    end select
  end subroutine add_point

  !> Make nodes and elements of the layers.
  subroutine extrude(mesh, plane, blank, natural)
    type(mesh_t), intent(inout) :: mesh
    type(plane_t), intent(in) :: plane
    type(blank_spec_t), intent(in) :: blank
    !> Natural coordinates of the element's nodes, `(3, n_element_node)`.
    integer, intent(in) :: natural(:, :)

    !> Number of the node at a point and half layer, 0 for none.
    integer, allocatable :: number(:, :)
    real(wp) :: x(2)
    integer :: c, k, a, e, p, layers

    layers = blank%divisions(3)
    allocate (number(0:2*layers, plane%n_point), source=0)
    mesh%n_element_node = size(natural, 2)
    mesh%n_element = layers*size(plane%cell, 3)
    allocate (mesh%connectivity(mesh%n_element_node, mesh%n_element))
    do c = 1, size(plane%cell, 3)
      do k = 1, layers
        do a = 1, size(natural, 2)
          number(2*k - 1 + natural(3, a), point(c, a)) = 1
        end do
      end do
    end do
    do p = 1, plane%n_point
      do k = 0, 2*layers
        if (number(k, p) == 0) cycle
        mesh%n_node = mesh%n_node + 1
        number(k, p) = mesh%n_node
      end do
    end do
    e = 0
    do c = 1, size(plane%cell, 3)
      do k = 1, layers
        e = e + 1
        mesh%connectivity(:, e) = [(number(2*k - 1 + natural(3, a), point(c, a)), &
            a=1, size(natural, 2))]
      end do
    end do
    allocate (mesh%x(3, mesh%n_node))
    do p = 1, plane%n_point
      x = plane%x(:, p)
      do k = 0, 2*layers
        if (number(k, p) > 0) mesh%x(:, number(k, p)) = blank%origin &
            + [x, blank%size(3)*real(k, wp)/real(2*layers, wp)]
      end do
    end do
    call name_sets(mesh, plane, blank%portion, number)

  contains

    !> Return the point of a node of a cell.
    pure integer function point(c, a)
      integer, intent(in) :: c, a

      point = plane%cell(2 + natural(1, a), 2 + natural(2, a), c)
    end function point

  end subroutine extrude

  !> Make the node sets.
  subroutine name_sets(mesh, plane, portion, number)
    type(mesh_t), intent(inout) :: mesh
    type(plane_t), intent(in) :: plane
    character(len=*), intent(in) :: portion
    !> Number of the node at a half layer and point, 0 for none.
    integer, intent(in) :: number(0:, :)

    character(len=set_name_length), allocatable :: name(:)
    logical, allocatable :: member(:, :)
    type(mesh_set_t) :: set
    integer :: i

    name = round_sets(portion)
    allocate (mesh%set(0), member(0:ubound(number, 1), size(number, 2)))
    do i = 1, size(name)
      member = number > 0
      select case (name(i))
      case ("x_min")
        member = member .and. spread(plane%on(1, :plane%n_point), 1, size(number, 1))
      case ("y_min")
        member = member .and. spread(plane%on(2, :plane%n_point), 1, size(number, 1))
      case ("rim")
        member = member .and. spread(plane%on(3, :plane%n_point), 1, size(number, 1))
      case ("z_min")
        member(1:, :) = .false.
      case ("z_max")
        member(:ubound(number, 1) - 1, :) = .false.
      case default
        ! All nodes.
      end select
      set%name = trim(name(i))
      set%node = pack(number, member)
      call mesh%append_set(set)
    end do
  end subroutine name_sets

end module dd3_mesh_round_blank
