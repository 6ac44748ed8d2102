! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of the elements of an `.inp` file: order of the nodes, shape, nodes at the same place,
!> neighbours, hanging nodes. Every error names the element and shows its line.
module dd3_mesh_inp_check
  use dd3_base_kinds, only : wp
  use dd3_base_near_points, only : near_pairs
  use dd3_base_text, only : to_text
  use dd3_mesh_hanging, only : find_hanging
  use dd3_mesh_hexahedra, only : corner_shape, edge_axis, edge_ends, neighbours_t
  use dd3_mesh_inp, only : inp_t
  use dd3_mesh_layers, only : layers_t, layers_ambiguous, layers_none
  implicit none
  private
  public :: check_shapes, check_places, check_neighbours, check_hanging, check_layers, check_roles

  !> Scaled Jacobian at or below which a corner has no volume.
  real(wp), parameter :: least_shape = 1.0e-6_wp
  !> Nodes nearer than this fraction of the shortest edge are at the same place.
  real(wp), parameter :: same_place = 1.0e-3_wp
  !> Distance of a bound node from the middle of an edge, over its length.
  real(wp), parameter :: middle = 0.02_wp
  !> Number of pairs of nodes at which the search for those at the same place ends.
  integer, parameter :: most_pairs = 100

  !> Defects of an element.
  integer, parameter :: sound = 0, mirrored = 1, by_rows = 2, inverted = 3, flat = 4
  !> Number of elements with the same defect that are named.
  integer, parameter :: most_named = 3

contains

  !> Report elements whose nodes are in a wrong order or that are inverted or flat; of many with
  !> the same defect the first ones.
  subroutine check_shapes(inp, corner)
    type(inp_t), intent(inout) :: inp
    !> Nodes at the corners, `(8, n_element)`.
    integer, intent(in) :: corner(:, :)

    character(len=:), allocatable :: others
    integer :: defect(size(corner, 2)), kind, e, n

    do e = 1, size(corner, 2)
      defect(e) = defect_of(inp%x(:, corner(:, e)), corner_shape(inp%x(:, corner(:, e))))
    end do
    do kind = mirrored, flat
      n = 0
      do e = 1, size(corner, 2)
        if (defect(e) /= kind) cycle
        n = n + 1
        others = ""
        if (n == most_named .and. count(defect == kind) > n) then
          others = "; the same holds for "//to_text(count(defect == kind) - n)//" others"
        end if
        call report_shape(inp, corner(:, e), e, kind, others)
        if (n == most_named) exit
      end do
    end do
  end subroutine check_shapes

  !> Return the defect of an element.
  pure integer function defect_of(x, shape) result(defect)
    !> Corners, mm, and their scaled Jacobians.
    real(wp), intent(in) :: x(3, 8), shape(8)

    integer, parameter :: by_rows_order(8) = [1, 2, 4, 3, 5, 6, 8, 7]
    real(wp) :: other(8)

    defect = sound
    if (all(shape > least_shape)) return
    other = corner_shape(x(:, by_rows_order))
    if (all(shape < -least_shape)) then
      defect = mirrored
    else if (all(other > least_shape) .or. all(other < -least_shape)) then
      defect = by_rows
    else
      defect = merge(inverted, flat, minval(shape) < -least_shape)
    end if
  end function defect_of

  !> Report the defect of an element.
  subroutine report_shape(inp, corner, e, defect, others)
    type(inp_t), intent(inout) :: inp
    integer, intent(in) :: corner(8), e, defect
    !> End of the sentence.
    character(len=*), intent(in) :: others

    character(len=*), parameter :: form = "nodes 1 to 4 around one face, counter-clockwise "// &
        "seen from nodes 5 to 8, and 5 to 8 on the opposite face, beside 1 to 4"
    real(wp) :: shape(8)
    integer :: worst

    select case (defect)
    case (mirrored)
      call report_element(inp, e, "is turned inside out: its nodes are in the order of a "// &
          "mirrored element"//others, form)
    case (by_rows)
      call report_element(inp, e, "has its nodes in a wrong order: row by row instead of "// &
          "around the faces"//others, form)
    case default
      shape = corner_shape(inp%x(:, corner))
      worst = minloc(shape, dim=1)
      call report_element(inp, e, trim(merge("is inverted at node", "is flat at node    ", &
          defect == inverted))//" "//to_text(inp%node_label(corner(worst)))// &
          ": its scaled Jacobian there is "//to_text(shape(worst), 3)//others, &
          "a hexahedron with eight convex corners")
    end select
  end subroutine report_shape

  !> Report an element.
  subroutine report_element(inp, e, message, expected)
    type(inp_t), intent(inout) :: inp
    integer, intent(in) :: e
    character(len=*), intent(in) :: message, expected

    call inp%report(inp%element_line(e), "element "//to_text(inp%element_label(e))//" "//message, &
        expected)
  end subroutine report_element

  !> Report nodes at the same place: the elements there are not connected.
  subroutine check_places(inp, corner)
    type(inp_t), intent(inout) :: inp
    !> Nodes at the corners, `(8, n_element)`.
    integer, intent(in) :: corner(:, :)

    real(wp) :: tolerance
    integer, allocatable :: pair(:, :)
    integer :: i

    tolerance = same_place*shortest_edge(inp%x, corner)
    call near_pairs(inp%x(:, :inp%n_node), tolerance, most_pairs, pair)
    do i = 1, size(pair, 2)
      if (norm2(inp%x(:, pair(2, i)) - inp%x(:, pair(1, i))) > tolerance) cycle
      call report_places(inp, corner, pair(1, i), pair(2, i))
    end do
  end subroutine check_places

  !> Report two nodes at the same place, with an element of the later one.
  subroutine report_places(inp, corner, first, second)
    type(inp_t), intent(inout) :: inp
    integer, intent(in) :: corner(:, :)
    integer, intent(in) :: first, second

    call inp%report(inp%node_line(second), node_of_element(inp, corner, second)// &
        " is at the place of node "//to_text(inp%node_label(first)), &
        "one node at each place, or the elements are not connected")
  end subroutine report_places

  !> Return a node and the first element that has it in words.
  function node_of_element(inp, corner, node) result(text)
    type(inp_t), intent(in) :: inp
    integer, intent(in) :: corner(:, :), node
    character(len=:), allocatable :: text

    integer :: e

    text = "node "//to_text(inp%node_label(node))
    do e = 1, size(corner, 2)
      if (all(corner(:, e) /= node)) cycle
      text = text//" of element "//to_text(inp%element_label(e))
      exit
    end do
  end function node_of_element

  !> Bind the nodes of *MPC and others that lie in the middle of an edge of an element to which they
  !> do not belong; report those that lie elsewhere on its edges and faces.
  subroutine check_hanging(inp, node, neighbours, axis, constraint, bound)
    type(inp_t), intent(inout) :: inp
    !> Nodes of the elements, their corners first.
    integer, intent(in) :: node(:, :)
    type(neighbours_t), intent(in) :: neighbours
    !> Natural axis from bottom to top of each element.
    integer, intent(in) :: axis(:)
    !> Bound nodes and the ends of their edges by *MPC, `(3, n)`.
    integer, intent(in) :: constraint(:, :)
    !> Bound nodes and the ends of their edges, `(3, n)`; not allocated if there are none.
    integer, allocatable, intent(out) :: bound(:, :)

    character(len=:), allocatable :: others
    integer, allocatable :: found(:, :), ends(:, :)
    integer :: i, k
    logical :: parent(inp%n_node), by_constraint(0:inp%n_node)

    call find_hanging(inp%x(:, :inp%n_node), node, neighbours, inp%n_node, found)
    by_constraint = .false.
    by_constraint(constraint(1, :)) = .true.
    found = found(:, pack([(i, i=1, size(found, 2))], .not. by_constraint(found(1, :))))
    allocate (ends(2, size(found, 2)))
    do i = 1, size(found, 2)
      ends(:, i) = edge_around(inp%x, node(:, found(2, i)), axis(found(2, i)), found(1, i))
    end do
    parent = .false.
    parent(pack(ends, ends > 0)) = .true.
    parent([constraint(2:, :)]) = .true.
    do i = 1, size(found, 2)
      if (parent(found(1, i)) .or. any(by_constraint(ends(:, i)))) ends(:, i) = 0
      if (size(node, 1) /= 8) ends(:, i) = 0
    end do
    associate (wrong => pack([(i, i=1, size(found, 2))], ends(1, :) == 0))
      do i = 1, min(most_named, size(wrong))
        k = wrong(i)
        others = ""
        if (i == most_named .and. size(wrong) > i) others = "; "//to_text(size(wrong) - i)// &
            " others do"
        associate (x => inp%x(:, found(1, k)))
          call inp%report(inp%node_line(found(1, k)), node_of_element(inp, node, found(1, k))// &
              " lies on an edge or a face of element "//to_text(inp%element_label(found(2, k)))// &
              ", which does not have it, at "//to_text(x(1))//" "//to_text(x(2))//" "// &
              to_text(x(3))//": the sheet would tear there"//others, "elements with whole "// &
              "faces in common, or a node in the middle of an edge in the plane of the sheet, "// &
              "whose ends are no such nodes")
        end associate
      end do
    end associate
    k = size(found, 2) + size(constraint, 2)
    if (k > 0) bound = reshape([(found(1, i), ends(:, i), i=1, size(found, 2)), constraint], [3, k])
  end subroutine check_hanging

  !> Return the ends of the edge across the thickness direction of an element with eight nodes in
  !> whose middle a node lies; 0 for none.
  pure function edge_around(x, node, axis, hanging) result(ends)
    real(wp), intent(in) :: x(:, :)
    !> Nodes of the element, its corners first.
    integer, intent(in) :: node(:)
    !> Natural axis from its bottom to its top, and the node.
    integer, intent(in) :: axis, hanging
    integer :: ends(2)

    integer :: i

    ends = 0
    do i = 1, 12
      if (edge_axis(i) == abs(axis)) cycle
      associate (a => x(:, node(edge_ends(1, i))), b => x(:, node(edge_ends(2, i))))
        if (norm2(x(:, hanging) - 0.5_wp*(a + b)) > middle*norm2(b - a)) cycle
      end associate
      ends = node(edge_ends(:, i))
    end do
  end function edge_around

  !> Report the first node that is at a corner of an element and between the corners of another.
  subroutine check_roles(inp, node)
    type(inp_t), intent(inout) :: inp
    !> Nodes of the elements, their corners first.
    integer, intent(in) :: node(:, :)

    integer :: with_corner(inp%n_node), e, a

    with_corner = 0
    do e = 1, size(node, 2)
      with_corner(node(:8, e)) = e
    end do
    do e = 1, size(node, 2)
      do a = 9, size(node, 1)
        associate (other => with_corner(node(a, e)))
          if (other == 0) cycle
          call report_element(inp, e, "has node "//to_text(inp%node_label(node(a, e)))// &
              " between its corners, and element "//to_text(inp%element_label(other))// &
              " at a corner: the sheet would tear there", "elements with whole faces in common")
        end associate
        return
      end do
    end do
  end subroutine check_roles

  !> Return the length of the shortest edge that is not zero, mm.
  pure real(wp) function shortest_edge(x, corner) result(shortest)
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: corner(:, :)

    real(wp) :: length
    integer :: e, i

    shortest = huge(1.0_wp)
    do e = 1, size(corner, 2)
      do i = 1, 12
        length = norm2(x(:, corner(edge_ends(1, i), e)) - x(:, corner(edge_ends(2, i), e)))
        if (length > 0.0_wp) shortest = min(shortest, length)
      end do
    end do
  end function shortest_edge

  !> Report faces of three elements, and elements with more than one face in common.
  subroutine check_neighbours(inp, neighbours)
    type(inp_t), intent(inout) :: inp
    type(neighbours_t), intent(in) :: neighbours

    integer :: e, f, i

    do i = 1, size(neighbours%branch, 2)
      associate (label => inp%element_label(neighbours%branch(:, i)))
        call report_element(inp, neighbours%branch(3, i), "has a face that elements "// &
            to_text(label(1))//" and "//to_text(label(2))//" have in common already", &
            "a face of one element, or of two")
      end associate
    end do
    do e = 1, size(neighbours%element, 2)
      do f = 2, 6
        associate (other => neighbours%element(f, e))
          if (other == 0 .or. other > e) cycle
          if (all(neighbours%element(:f - 1, e) /= other)) cycle
          call report_element(inp, e, "overlaps element "//to_text(inp%element_label(other))// &
              ": they have more than one face in common", "elements side by side")
        end associate
        exit
      end do
    end do
  end subroutine check_neighbours

  !> Report a mesh without two faces, or of which it cannot be told where they are.
  subroutine check_layers(inp, layers)
    type(inp_t), intent(inout) :: inp
    type(layers_t), intent(in) :: layers

    if (layers%outcome == layers_none) then
      call report_element(inp, layers%element, "cannot be in a sheet: the mesh is not extruded "// &
          "from one face to another, and no two faces are found", &
          "layers of hexahedra between two faces of the sheet")
    else if (layers%outcome == layers_ambiguous) then
      call report_element(inp, layers%element, "has an ambiguous thickness direction: the mesh "// &
          "is about as long in several directions, and the orders of the nodes differ", &
          "a sheet that is thin in one direction, or nodes 1 to 4 of all elements on the side "// &
          "of the same face")
    end if
  end subroutine check_layers

end module dd3_mesh_inp_check
