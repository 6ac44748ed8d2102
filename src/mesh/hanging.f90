! SPDX-License-Identifier: GPL-3.0-or-later
!> Hanging nodes of a mesh of hexahedra: nodes on an edge or a face of an element to which they do
!> not belong, where the sheet would tear. The nodes on the boundary are sorted into the cells of a
!> grid, as large as the faces there, and each face is compared with the nodes in the cells that it
!> touches: the time grows with the number of faces.
module dd3_mesh_hanging
  use dd3_base_kinds, only : i8, wp
  use dd3_mesh_hexahedra, only : face_corner, neighbours_t
  implicit none
  private
  public :: find_hanging

  !> Distance of a node from a face on which it lies, and of nodes at the same place, over the
  !> shortest edge of the face.
  real(wp), parameter :: tolerance = 1.0e-3_wp
  !> Iterations of the search for the nearest point of a face, which is nearly flat.
  integer, parameter :: n_iteration = 8

  !> Points in the cells of a grid, by a hash table of the cells.
  type :: grid_t
    !> Lower corner and size of the cells, mm.
    real(wp) :: origin(3), size
    !> First point of each place of the table, and the next point at the same place; 0 for none.
    integer, allocatable :: first(:), next(:)
    !> All points.
    integer, allocatable :: point(:)
  end type grid_t

contains

  !> Find the hanging nodes, each with the first element on which it lies; ascending by elements.
  subroutine find_hanging(x, node, neighbours, most, found)
    !> Coordinates, mm, `(3, n_node)`.
    real(wp), intent(in) :: x(:, :)
    !> Nodes of the elements, their corners first, `(n_element_node, n_element)`.
    integer, intent(in) :: node(:, :)
    type(neighbours_t), intent(in) :: neighbours
    !> Number at which the search ends.
    integer, intent(in) :: most
    !> Node and element, `(2, n)`.
    integer, allocatable, intent(out) :: found(:, :)

    type(grid_t) :: grid
    logical :: hangs(size(x, 2))
    integer :: e, f, n

    allocate (found(2, most))
    call new_grid(grid, x, node, neighbours)
    hangs = .false.
    n = 0
    elements: do e = 1, size(node, 2)
      do f = 1, 6
        if (neighbours%element(f, e) > 0) cycle
        call search_face(grid, x, node(:, e), face_corner(:, f), hangs, n, found, e)
        if (n == most) exit elements
      end do
    end do elements
    found = found(:, :n)
  end subroutine find_hanging

  !> Sort the nodes on the boundary into cells as large as the mean face.
  pure subroutine new_grid(grid, x, node, neighbours)
    type(grid_t), intent(out) :: grid
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: node(:, :)
    type(neighbours_t), intent(in) :: neighbours

    logical :: outer(size(x, 2))
    real(wp) :: total
    integer :: e, f, i, n, k

    outer = .false.
    total = 0.0_wp
    n = 0
    do e = 1, size(node, 2)
      do f = 1, 6
        if (neighbours%element(f, e) > 0) cycle
        associate (corner => node(face_corner(:, f), e))
          outer(corner) = .true.
          total = total + maxval(maxval(x(:, corner), dim=2) - minval(x(:, corner), dim=2))
          n = n + 1
        end associate
      end do
    end do
    grid%origin = minval(x, dim=2)
    ! Not so small that the numbers of the cells overflow.
    grid%size = max(total/real(max(1, n), wp), 1.0e-6_wp*maxval(maxval(x, dim=2) - grid%origin), &
        tiny(1.0_wp))
    grid%point = pack([(i, i=1, size(x, 2))], outer)
    allocate (grid%first(max(16, 2*size(grid%point))), grid%next(size(x, 2)), source=0)
    do i = 1, size(grid%point)
      k = place_of(grid, cell_of(grid, x(:, grid%point(i))))
      grid%next(grid%point(i)) = grid%first(k)
      grid%first(k) = grid%point(i)
    end do
  end subroutine new_grid

  !> Return the cell of a point.
  pure function cell_of(grid, x) result(cell)
    type(grid_t), intent(in) :: grid
    real(wp), intent(in) :: x(3)
    integer :: cell(3)

    cell = floor((x - grid%origin)/grid%size)
  end function cell_of

  !> Return the place of a cell in the table.
  pure integer function place_of(grid, cell) result(place)
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: cell(3)

    integer(i8), parameter :: factor(3) = [73856093_i8, 19349663_i8, 83492791_i8]

    place = 1 + int(modulo(sum(factor*int(cell, i8)), size(grid%first, kind=i8)))
  end function place_of

  !> Add the nodes on a face that do not belong to its element.
  subroutine search_face(grid, x, node, local, hangs, n, found, e)
    type(grid_t), intent(in) :: grid
    real(wp), intent(in) :: x(:, :)
    !> All nodes of the element, and the numbers of the corners of the face among them.
    integer, intent(in) :: node(:), local(4)
    !> Nodes found before.
    logical, intent(inout) :: hangs(:)
    !> Number of pairs so far.
    integer, intent(inout) :: n
    integer, intent(inout) :: found(:, :)
    !> Number of the element.
    integer, intent(in) :: e

    real(wp) :: corner(3, 4), near, lower(3), upper(3)
    integer :: first(3), last(3), i, j, k, m

    corner = x(:, node(local))
    near = tolerance*minval([(norm2(corner(:, modulo(i, 4) + 1) - corner(:, i)), i=1, 4)])
    lower = minval(corner, dim=2) - near
    upper = maxval(corner, dim=2) + near
    first = cell_of(grid, lower)
    last = cell_of(grid, upper)
    if (product(real(last - first + 1, wp)) > real(size(grid%point), wp)) then
      do i = 1, size(grid%point)
        call try(grid%point(i))
      end do
      return
    end if
    do k = first(3), last(3)
      do j = first(2), last(2)
        do i = first(1), last(1)
          m = grid%first(place_of(grid, [i, j, k]))
          do while (m > 0)
            call try(m)
            m = grid%next(m)
          end do
        end do
      end do
    end do

  contains

    !> Add a node if it lies on the face and is not known yet.
    subroutine try(m)
      integer, intent(in) :: m

      if (hangs(m) .or. n == size(found, 2)) return
      if (any(x(:, m) < lower) .or. any(x(:, m) > upper)) return
      if (any(node == m)) return
      if (.not. is_on(x(:, m), corner, near)) return
      n = n + 1
      found(:, n) = [m, e]
      hangs(m) = .true.
    end subroutine try

  end subroutine search_face

  !> Whether a point lies on a bilinear face, and at none of its corners.
  pure logical function is_on(x, corner, near)
    real(wp), intent(in) :: x(3), corner(3, 4)
    !> Tolerance, mm.
    real(wp), intent(in) :: near

    real(wp), parameter :: sign(2, 4) = reshape([real(wp) :: -1, -1, 1, -1, 1, 1, -1, 1], [2, 4])
    real(wp) :: at(2), tangent(3, 2), gap(3), metric(3), right(2), area
    integer :: i

    is_on = all([(norm2(x - corner(:, i)) > near, i=1, 4)])
    if (.not. is_on) return
    at = 0.0_wp
    do i = 1, n_iteration
      gap = x - matmul(corner, 0.25_wp*(1 + at(1)*sign(1, :))*(1 + at(2)*sign(2, :)))
      tangent(:, 1) = matmul(corner, 0.25_wp*sign(1, :)*(1 + at(2)*sign(2, :)))
      tangent(:, 2) = matmul(corner, 0.25_wp*sign(2, :)*(1 + at(1)*sign(1, :)))
      metric = [dot_product(tangent(:, 1), tangent(:, 1)), dot_product(tangent(:, 1), &
          tangent(:, 2)), dot_product(tangent(:, 2), tangent(:, 2))]
      right = matmul(gap, tangent)
      area = max(metric(1)*metric(3) - metric(2)**2, tiny(1.0_wp))
      at = at + [metric(3)*right(1) - metric(2)*right(2), metric(1)*right(2) &
          - metric(2)*right(1)]/area
      at = min(1.0_wp, max(-1.0_wp, at))
    end do
    gap = x - matmul(corner, 0.25_wp*(1 + at(1)*sign(1, :))*(1 + at(2)*sign(2, :)))
    is_on = norm2(gap) <= near
  end function is_on

end module dd3_mesh_hanging
