! SPDX-License-Identifier: GPL-3.0-or-later
!> Where the nodes and elements of a refined sheet come from, and what they take over: nodal values
!> by linear interpolation, and values at integration points by the transfer of dd3_sheet_transfer
!> at constant height, from the points of the divided quadrilateral and of those that have a column
!> in common with it. Places are those of the middle of the initial sheet, in the tangent plane of
!> the divided quadrilateral. At the border of the sheet the outermost points lie beyond those that
!> they take their values from, whose range limits them.
module dd3_sheet_refinement
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_linalg_tensor, only : cross
  use dd3_mesh_mesh, only : mesh_t
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_location, only : bilinear, corner_sign
  use dd3_sheet_transfer, only : axes_at, bounded_mean, linear_weights, mean_axes, quads_alike, &
      values_at
  implicit none
  private
  public :: refinement_t, find_sources

  !> Coordinate of integration points up to which two are the same.
  real(wp), parameter :: same = 1.0e-9_wp

  !> Points from which those of a divided quadrilateral take their values.
  type :: source_t
    !> Elements of the quadrilateral and of those around it, `(n_layer, n)`.
    integer, allocatable :: element(:, :)
    !> Weights of the points at one height, a point of each column, then the next element, at each
    !> such point of the quarters, `(n_column*n, n_column, 4)`.
    real(wp), allocatable :: weight(:, :, :)
  end type source_t

  !> Origin of the nodes and elements of a refined sheet.
  type :: refinement_t
    !> Nodes at the same height between which each node is new, and then 0; 0 for an old node, whose
    !> number is the same as before, `(4, n_node)`.
    integer, allocatable :: parent(:, :)
    !> Old element that each element is (part of), `(n_element)`.
    integer, allocatable :: element(:)
    !> Quarter of it, at the corner of the same number; 0 for the whole, `(n_element)`.
    integer, allocatable :: quadrant(:)
    !> Sources of the divided quadrilaterals; that of each old element, 0 for an undivided one, and
    !> its layer, `(n_old_element)`.
    type(source_t), allocatable, private :: source(:)
    integer, allocatable, private :: source_of(:), layer(:)
    !> Integration points across the thickness of an element: those of column j from the bottom,
    !> `point(:, j)`.
    integer, allocatable, private :: point(:, :)
  contains
    procedure :: interpolate_nodal
    procedure :: carry_points
    procedure :: carry_axes
    procedure, private :: donors
  end type refinement_t

contains

  !> Interpolate values at the old nodes linearly to the new ones.
  pure function interpolate_nodal(self, old) result(new)
    class(refinement_t), intent(in) :: self
    !> `(m, n_old_node)`.
    real(wp), intent(in) :: old(:, :)
    !> `(m, n_node)`.
    real(wp), allocatable :: new(:, :)

    integer :: i, n

    allocate (new(size(old, 1), size(self%parent, 2)))
    do i = 1, size(new, 2)
      n = count(self%parent(:, i) > 0)
      if (n == 0) then
        new(:, i) = old(:, i)
      else
        new(:, i) = sum(old(:, self%parent(:n, i)), dim=2)/real(n, wp)
      end if
    end do
  end function interpolate_nodal

  !> Carry values at the integration points of the old elements to those of the new ones. Undivided
  !> elements keep theirs.
  pure subroutine carry_points(self, old, new)
    class(refinement_t), intent(in) :: self
    !> `(m, n_point, n_old_element)`.
    real(wp), intent(in) :: old(:, :, :)
    !> `(m, n_point, n_element)`.
    real(wp), allocatable, intent(out) :: new(:, :, :)

    real(wp), allocatable :: value(:, :)
    integer :: e, j, k, p

    allocate (new(size(old, 1), size(old, 2), size(self%element)))
    do e = 1, size(self%element)
      associate (from => self%element(e), quadrant => self%quadrant(e))
        if (quadrant == 0) then
          new(:, :, e) = old(:, :, from)
          cycle
        end if
        do k = 1, size(self%point, 1)
          value = values_at(old, self%donors(from, k))
          do j = 1, size(self%point, 2)
            p = self%point(k, j)
            new(:, p, e) = bounded_mean(value, &
                self%source(self%source_of(from))%weight(:, j, quadrant))
          end do
        end do
      end associate
    end do
  end subroutine carry_points

  !> Do the same with axes, which are made orthonormal.
  pure subroutine carry_axes(self, old, new)
    class(refinement_t), intent(in) :: self
    !> Axes as columns, `(3, 3, n_point, n_old_element)`.
    real(wp), intent(in) :: old(:, :, :, :)
    !> `(3, 3, n_point, n_element)`.
    real(wp), allocatable, intent(out) :: new(:, :, :, :)

    real(wp), allocatable :: axes(:, :, :)
    integer :: e, j, k, p

    allocate (new(3, 3, size(old, 3), size(self%element)))
    do e = 1, size(self%element)
      associate (from => self%element(e), quadrant => self%quadrant(e))
        if (quadrant == 0) then
          new(:, :, :, e) = old(:, :, :, from)
          cycle
        end if
        do k = 1, size(self%point, 1)
          axes = axes_at(old, self%donors(from, k))
          do j = 1, size(self%point, 2)
            p = self%point(k, j)
            new(:, :, p, e) = mean_axes(axes, &
                self%source(self%source_of(from))%weight(:, j, quadrant))
          end do
        end do
      end associate
    end do
  end subroutine carry_axes

  !> Return the points from which those of a divided element at one height take their values: point
  !> and element of each, `(2, n)`.
  pure function donors(self, element, height) result(donor)
    class(refinement_t), intent(in) :: self
    !> Old element, and the height of the points, counted from the bottom.
    integer, intent(in) :: element, height
    integer, allocatable :: donor(:, :)

    integer :: i, j, n_column

    n_column = size(self%point, 2)
    associate (around => self%source(self%source_of(element))%element(self%layer(element), :))
      allocate (donor(2, n_column*size(around)))
      do i = 1, size(around)
        do j = 1, n_column
          donor(:, j + n_column*(i - 1)) = [self%point(height, j), around(i)]
        end do
      end do
    end associate
  end function donors

  !> Find from which points the quarters of divided quadrilaterals take their values.
  pure subroutine find_sources(self, grid, mesh, element, divided)
    type(refinement_t), intent(inout) :: self
    type(grid_t), intent(in) :: grid
    !> Before the division.
    type(mesh_t), intent(in) :: mesh
    type(element_t), intent(in) :: element
    !> Whether each quadrilateral is divided, `(n_quad)`.
    logical, intent(in) :: divided(:)

    real(wp), allocatable :: natural(:, :)
    integer :: k, n, q

    self%point = point_columns(element)
    natural = element%point(:2, self%point(1, :))
    allocate (self%source(count(divided)))
    allocate (self%source_of(grid%n_layer*grid%n_quad), self%layer(grid%n_layer*grid%n_quad))
    n = 0
    do q = 1, grid%n_quad
      self%layer(grid%element(:, q)) = [(k, k=1, grid%n_layer)]
      self%source_of(grid%element(:, q)) = 0
      if (.not. divided(q)) cycle
      n = n + 1
      self%source_of(grid%element(:, q)) = n
      call new_source(self%source(n), grid, mesh, natural, q)
    end do
  end subroutine find_sources

  !> Return the columns of integration points across the thickness of an element: those of column j
  !> from the bottom, `point(:, j)`. All columns have points at the same heights.
  pure function point_columns(element) result(point)
    type(element_t), intent(in) :: element
    integer, allocatable :: point(:, :)

    integer :: first(element%n_point), column(element%n_point), height(element%n_point), i, n, p

    n = 0
    do p = 1, element%n_point
      do i = 1, n
        if (all(abs(element%point(:2, p) - element%point(:2, first(i))) < same)) exit
      end do
      if (i > n) first(i) = p
      n = max(n, i)
      column(p) = i
    end do
    do p = 1, element%n_point
      height(p) = 1 + count(column == column(p) .and. &
          element%point(3, :) < element%point(3, p) - same)
    end do
    allocate (point(maxval(height), n))
    do p = 1, element%n_point
      point(height(p), column(p)) = p
    end do
  end function point_columns

  !> Find from which points the quarters of a quadrilateral take their values: those around them in
  !> elements of the same materials.
  pure subroutine new_source(self, grid, mesh, natural, quad)
    type(source_t), intent(out) :: self
    type(grid_t), intent(in) :: grid
    type(mesh_t), intent(in) :: mesh
    !> Natural coordinates of the columns of integration points, `(2, n_column)`.
    real(wp), intent(in) :: natural(:, :)
    integer, intent(in) :: quad

    integer, allocatable :: around(:)
    real(wp), allocatable :: plane(:, :, :), donor(:, :)
    real(wp) :: place(2)
    integer :: i, j, n, quadrant

    around = quads_alike(grid, quad, mesh%material, mesh%material(grid%element(:, quad)))
    plane = in_tangent_plane(grid, mesh%x, around)
    n = size(natural, 2)
    allocate (donor(2, n*size(around)), self%weight(n*size(around), n, 4))
    self%element = grid%element(:, around)
    do i = 1, size(around)
      do j = 1, n
        donor(:, j + n*(i - 1)) = matmul(plane(:, :, i), bilinear(natural(:, j)))
      end do
    end do
    do quadrant = 1, 4
      do j = 1, n
        place = matmul(plane(:, :, 1), &
            bilinear(0.5_wp*(corner_sign(:, quadrant) + natural(:, j))))
        self%weight(:, j, quadrant) = linear_weights(donor - spread(place, 2, size(donor, 2)))
      end do
    end do
  end subroutine new_source

  !> Return the corners of quadrilaterals in the middle of the sheet, in the tangent plane of the
  !> first, `(2, 4, n)`, mm.
  pure function in_tangent_plane(grid, x, quad) result(plane)
    type(grid_t), intent(in) :: grid
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: quad(:)
    real(wp) :: plane(2, 4, size(quad))

    real(wp) :: corner(3, 4), axis(3, 2), centre(3), normal(3)
    integer :: i

    do i = 1, size(quad)
      associate (c => grid%corner(:, quad(i)))
        corner = 0.5_wp*(x(:, grid%node(0, c)) + x(:, grid%node(grid%n_layer, c)))
      end associate
      if (i == 1) then
        centre = 0.25_wp*sum(corner, dim=2)
        axis(:, 1) = corner(:, 3) - corner(:, 1)
        normal = cross(axis(:, 1), corner(:, 4) - corner(:, 2))
        axis(:, 1) = axis(:, 1)/norm2(axis(:, 1))
        axis(:, 2) = cross(normal/norm2(normal), axis(:, 1))
      end if
      plane(:, :, i) = matmul(transpose(axis), corner - spread(centre, 2, 4))
    end do
  end function in_tangent_plane

end module dd3_sheet_refinement
