! SPDX-License-Identifier: GPL-3.0-or-later
!> Mesh generator of a structured blank: a box of hexahedra, graded and skewed. The nodes lie on a
!> grid of half an element's interval, of which the element uses a part: the corners only, or also
!> the middle of edges, of faces and of the element.
module dd3_mesh_blank
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : blank_spec_t, blank_sets
  use dd3_mesh_mesh, only : mesh_t
  use dd3_mesh_weld_line, only : follow_lines, weld_line_t
  implicit none
  private
  public :: new_blank_mesh

contains

  !> Build nodes, elements and node sets of a blank.
  subroutine new_blank_mesh(mesh, blank, natural, line)
    type(mesh_t), intent(out) :: mesh
    type(blank_spec_t), intent(in) :: blank
    !> Natural coordinates of the element's nodes, each -1, 0 or 1, `(3, n_element_node)`; x, y, z
    !> of the blank are their axes.
    real(wp), intent(in) :: natural(:, :)
    !> Weld lines, onto which the nearest node lines are moved; get these.
    type(weld_line_t), intent(inout), optional :: line(:)

    integer, allocatable :: number(:, :, :)

    mesh%thickness = blank%size(3)
    call number_nodes(number, mesh%n_node, blank%divisions, nint(natural))
    call place_nodes(mesh, blank, line, number)
    call connect(mesh, blank%divisions, nint(natural), number)
    allocate (mesh%material(mesh%n_element), source=blank%material)
    call name_faces(mesh, number)
  end subroutine new_blank_mesh

  !> Number the grid points that are nodes; z runs fastest, then y, then x.
  subroutine number_nodes(number, n_node, divisions, natural)
    !> Number of the node at a grid point, 0 for none: `(0:2*n_z, 0:2*n_y, 0:2*n_x)`.
    integer, allocatable, intent(out) :: number(:, :, :)
    integer, intent(out) :: n_node
    !> Number of elements along x, y, z.
    integer, intent(in) :: divisions(3)
    !> Natural coordinates of the element's nodes, `(3, n_element_node)`.
    integer, intent(in) :: natural(:, :)

    integer :: a, i, j, k, last(3), lower(3), upper(3)

    last = 2*divisions
    allocate (number(0:last(3), 0:last(2), 0:last(1)), source=0)
    do a = 1, size(natural, 2)
      lower = 1 + natural(:, a)
      upper = last - 1 + natural(:, a)
      number(lower(3):upper(3):2, lower(2):upper(2):2, lower(1):upper(1):2) = 1
    end do
    n_node = 0
    do i = 0, last(1)
      do j = 0, last(2)
        do k = 0, last(3)
          if (number(k, j, i) == 0) cycle
          n_node = n_node + 1
          number(k, j, i) = n_node
        end do
      end do
    end do
  end subroutine number_nodes

  !> Compute the coordinates of the nodes.
  subroutine place_nodes(mesh, blank, line, number)
    type(mesh_t), intent(inout) :: mesh
    type(blank_spec_t), intent(in) :: blank
    type(weld_line_t), intent(inout), optional :: line(:)
    !> Number of the node at a grid point, 0 for none.
    integer, intent(in) :: number(0:, 0:, 0:)

    real(wp), allocatable :: plane(:, :, :), z(:)
    integer :: i, j, k

    call place_in_plan(plane, blank, line)
    z = with_middles(blank%grading_z)
    allocate (mesh%x(3, mesh%n_node))
    do i = 0, ubound(number, 3)
      do j = 0, ubound(number, 2)
        do k = 0, ubound(number, 1)
          if (number(k, j, i) == 0) cycle
          mesh%x(:, number(k, j, i)) = [plane(:, i, j), blank%origin(3) + blank%size(3)*z(k + 1)]
        end do
      end do
    end do
  end subroutine place_nodes

  !> Compute the grid in plan: skewed, then with node lines on the weld lines.
  subroutine place_in_plan(plane, blank, line)
    !> `(2, 0:2*n_x, 0:2*n_y)`, mm.
    real(wp), allocatable, intent(out) :: plane(:, :, :)
    type(blank_spec_t), intent(in) :: blank
    type(weld_line_t), intent(inout), optional :: line(:)

    real(wp) :: x(0:blank%divisions(1)), y(0:blank%divisions(2)), skew(0:blank%divisions(1))
    integer :: i, j

    x = blank%grading_x
    y = blank%grading_y
    skew = skew_of_lines(blank)
    associate (n => blank%divisions)
      allocate (plane(2, 0:2*n(1), 0:2*n(2)))
      do j = 0, n(2)
        do i = 0, n(1)
          plane(:, 2*i, 2*j) = blank%origin(:2) + blank%size(:2)*[x(i), y(j)] &
              + [skew(i)*(y(j) - 0.5_wp), 0.0_wp]
        end do
      end do
      if (present(line)) call follow_lines(line, plane(:, ::2, ::2))
      plane(:, ::2, 1::2) = 0.5_wp*(plane(:, ::2, :2*n(2) - 2:2) + plane(:, ::2, 2::2))
      plane(:, 1::2, :) = 0.5_wp*(plane(:, :2*n(1) - 2:2, :) + plane(:, 2::2, :))
    end associate
  end subroutine place_in_plan

  !> Return the shift of the node lines along y at x(0:n): the difference in x between their ends,
  !> mm. The ends of the blank stay straight.
  pure function skew_of_lines(blank) result(skew)
    type(blank_spec_t), intent(in) :: blank
    real(wp) :: skew(blank%divisions(1) + 1)

    associate (n => blank%divisions(1))
      skew = blank%skew*(blank%size(1)/real(n, wp))
      skew([1, n + 1]) = 0.0_wp
    end associate
  end function skew_of_lines

  !> Return values at n + 1 corners with the means between them, `(2*n + 1)`.
  pure function with_middles(corner) result(value)
    real(wp), intent(in) :: corner(:)
    real(wp) :: value(2*size(corner) - 1)

    value(1::2) = corner
    value(2::2) = 0.5_wp*(corner(:size(corner) - 1) + corner(2:))
  end function with_middles

  !> Set the connectivity; elements are numbered like the nodes.
  subroutine connect(mesh, divisions, natural, number)
    type(mesh_t), intent(inout) :: mesh
    !> Number of elements along x, y, z.
    integer, intent(in) :: divisions(3)
    !> Natural coordinates of the element's nodes, `(3, n_element_node)`.
    integer, intent(in) :: natural(:, :)
    !> Number of the node at a grid point, 0 for none.
    integer, intent(in) :: number(0:, 0:, 0:)

    integer :: i, j, k, a, element, point(3)

    mesh%n_element = product(divisions)
    mesh%n_element_node = size(natural, 2)
    allocate (mesh%connectivity(mesh%n_element_node, mesh%n_element))
    element = 0
    do i = 0, divisions(1) - 1
      do j = 0, divisions(2) - 1
        do k = 0, divisions(3) - 1
          element = element + 1
          do a = 1, size(natural, 2)
            point = 2*[i, j, k] + 1 + natural(:, a)
            mesh%connectivity(a, element) = number(point(3), point(2), point(1))
          end do
        end do
      end do
    end do
  end subroutine connect

  !> Make the sets of the faces and of all nodes, by position in the grid.
  subroutine name_faces(mesh, number)
    type(mesh_t), intent(inout) :: mesh
    !> Number of the node at a grid point, 0 for none.
    integer, intent(in) :: number(0:, 0:, 0:)

    integer :: lower(3), upper(3), s, axis

    allocate (mesh%set(size(blank_sets)))
    do s = 1, size(blank_sets)
      lower = 0
      upper = [ubound(number, 3), ubound(number, 2), ubound(number, 1)]
      ! Two faces for each axis; the set after them holds all nodes.
      axis = (s + 1)/2
      if (axis <= 3) then
        if (mod(s, 2) == 1) upper(axis) = 0
        if (mod(s, 2) == 0) lower(axis) = upper(axis)
      end if
      mesh%set(s)%name = trim(blank_sets(s))
      associate (part => number(lower(3):upper(3), lower(2):upper(2), lower(1):upper(1)))
        mesh%set(s)%node = pack(part, part > 0)
      end associate
    end do
  end subroutine name_faces

end module dd3_mesh_blank
