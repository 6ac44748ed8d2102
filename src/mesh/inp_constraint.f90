! SPDX-License-Identifier: GPL-3.0-or-later
!> Multi-point constraints of an `.inp` file: *MPC with lines `LINEAR, p, a, b`, as in Abaqus, which
!> bind node p to the mean of a and b. Here p must lie near the middle of an edge from a to b in the
!> plane of the sheet, of an element to which it does not belong: the sheet may be curved, so that a
!> bound node need not lie on the chord.
module dd3_mesh_inp_constraint
  use dd3_base_kinds, only : wp
  use dd3_base_number_index, only : number_index_t
  use dd3_base_text, only : to_text
  use dd3_mesh_hexahedra, only : edge_axis, edge_ends
  use dd3_mesh_inp, only : inp_t
  use dd3_mesh_inp_line, only : fields_t, split_fields
  implicit none
  private
  public :: resolve_constraints, check_constraints

  !> Largest distance of a bound node from the middle of its edge, over the length of the edge.
  real(wp), parameter :: largest_distance = 0.1_wp

contains

  !> Replace the labels by the numbers of the nodes; report those that the file does not have.
  subroutine resolve_constraints(inp, nodes, bound)
    type(inp_t), intent(inout) :: inp
    type(number_index_t), intent(in) :: nodes
    !> Bound nodes and the ends of their edges, `(3, n)`; 0 for one that is not there.
    integer, allocatable, intent(out) :: bound(:, :)

    integer :: i, k

    allocate (bound(3, inp%n_constraint))
    do i = 1, inp%n_constraint
      do k = 1, 3
        bound(k, i) = nodes%find(inp%constraint(k, i))
        if (bound(k, i) == 0) call report_at(inp, i, k, "the constraint names node "// &
            to_text(inp%constraint(k, i))//", which the file does not have", "labels of nodes")
      end do
    end do
  end subroutine resolve_constraints

  !> Report constraints that are no bound nodes in the middle of edges.
  subroutine check_constraints(inp, node, axis, bound)
    type(inp_t), intent(inout) :: inp
    !> Nodes of the elements, their corners first.
    integer, intent(in) :: node(:, :)
    !> Natural axis from bottom to top of each element.
    integer, intent(in) :: axis(:)
    integer, intent(in) :: bound(:, :)

    logical :: has_edge(size(bound, 2))
    integer :: binding(inp%n_node), i, k

    if (size(bound, 2) == 0) return
    if (size(node, 1) /= 8) then
      call inp%report(inp%constraint_line(1), "constraints bind nodes of elements with 8 nodes "// &
          "only", "TYPE=C3D8")
      return
    end if
    call find_edges(node, axis, bound, inp%n_node, has_edge)
    binding = 0
    do i = 1, size(bound, 2)
      if (binding(bound(1, i)) > 0) call report_at(inp, i, 1, "node "// &
          to_text(inp%constraint(1, i))//" is bound twice, first in line "// &
          to_text(inp%constraint_line(binding(bound(1, i)))), "one edge for each node")
      binding(bound(1, i)) = i
    end do
    do i = 1, size(bound, 2)
      k = findloc(binding(bound(2:, i)) > 0, .true., dim=1)
      if (k > 0) then
        call report_at(inp, i, k + 1, "node "//to_text(inp%constraint(k + 1, i))// &
            ", to which another is bound, is bound itself", "nodes that are not bound")
      else if (.not. has_edge(i)) then
        call report_at(inp, i, 2, "there is no edge between nodes "// &
            to_text(inp%constraint(2, i))//" and "//to_text(inp%constraint(3, i))// &
            " in the plane of the sheet of an element without node "// &
            to_text(inp%constraint(1, i)), "the ends of an edge in whose middle the node lies")
      else
        call check_place(inp, i, bound(:, i))
      end if
    end do
  end subroutine check_constraints

  !> Report a node that is not near the middle of its edge.
  subroutine check_place(inp, i, bound)
    type(inp_t), intent(inout) :: inp
    integer, intent(in) :: i
    integer, intent(in) :: bound(3)

    real(wp) :: distance, length

    length = norm2(inp%x(:, bound(3)) - inp%x(:, bound(2)))
    distance = norm2(inp%x(:, bound(1)) - 0.5_wp*(inp%x(:, bound(2)) + inp%x(:, bound(3))))
    if (distance <= largest_distance*length) return
    call report_at(inp, i, 1, "node "//to_text(inp%constraint(1, i))//" lies "// &
        to_text(distance, 3)//" mm from the middle of its edge, which is "//to_text(length, 3)// &
        " mm long", "a node within "//to_text(largest_distance*length, 3)//" mm of the middle")
  end subroutine check_place

  !> Find which constraints have an edge in the plane of the sheet, of an element without the node.
  pure subroutine find_edges(node, axis, bound, n_node, has_edge)
    integer, intent(in) :: node(:, :), axis(:), bound(:, :), n_node
    logical, intent(out) :: has_edge(:)

    integer :: first(n_node), next(size(bound, 2)), e, i, k

    ! Constraints by the smaller number of the ends of their edges.
    first = 0
    do i = 1, size(bound, 2)
      k = minval(bound(2:, i))
      next(i) = first(k)
      first(k) = i
    end do
    has_edge = .false.
    do e = 1, size(node, 2)
      do k = 1, size(edge_axis)
        if (edge_axis(k) == abs(axis(e))) cycle
        associate (ends => node(edge_ends(:, k), e))
          i = first(minval(ends))
          do while (i > 0)
            if (maxval(ends) == maxval(bound(2:, i)) .and. all(node(:, e) /= bound(1, i))) then
              has_edge(i) = .true.
            end if
            i = next(i)
          end do
        end associate
      end do
    end do
  end subroutine find_edges

  !> Add an error at a node of a constraint.
  subroutine report_at(inp, i, k, message, expected)
    type(inp_t), intent(inout) :: inp
    !> Constraint, and which of its nodes.
    integer, intent(in) :: i, k
    character(len=*), intent(in) :: message, expected

    type(fields_t) :: fields
    integer :: number

    number = inp%constraint_line(i)
    call split_fields(inp%line(number)%s, fields)
    call inp%report(number, message, expected, fields%first(k + 1), fields%last(k + 1))
  end subroutine report_at

end module dd3_mesh_inp_constraint
