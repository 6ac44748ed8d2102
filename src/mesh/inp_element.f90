! SPDX-License-Identifier: GPL-3.0-or-later
!> Element types of `.inp` files, with the order of their nodes.
!> Source: Abaqus Analysis User's Guide, "Three-dimensional solid element library".
module dd3_mesh_inp_element
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: inp_type_names, nodes_of_type, node_order

  !> Types that are read; the last digits are the number of nodes.
  character(len=5), parameter :: inp_type_names(3) = ["C3D8 ", "C3D20", "C3D27"]
  integer, parameter :: n_nodes(3) = [8, 20, 27]

  !> Natural coordinates of the nodes in the order of the file: corners, edges, centre, faces.
  integer, parameter :: natural_order(3, 27) = reshape([ &
      -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1, &
      0, -1, -1, 1, 0, -1, 0, 1, -1, -1, 0, -1, 0, -1, 1, 1, 0, 1, 0, 1, 1, -1, 0, 1, &
      -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, &
      0, 0, 0, 0, 0, -1, 0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0], [3, 27])

contains

  !> Return the number of nodes of a type; 0 if it is not known.
  pure integer function nodes_of_type(name)
    !> In upper case.
    character(len=*), intent(in) :: name

    integer :: i

    nodes_of_type = 0
    do i = 1, size(inp_type_names)
      if (inp_type_names(i) == name) nodes_of_type = n_nodes(i)
    end do
  end function nodes_of_type

  !> Return the place in the file of each of our nodes, for an element turned by a matrix of
  !> `natural' = turn natural`; 0 for nodes that the file does not have.
  pure function node_order(natural, turn) result(place)
    !> Natural coordinates of our nodes, `(3, n_element_node)`.
    real(wp), intent(in) :: natural(:, :)
    !> Rotation of the natural axes: -1, 0 and 1.
    integer, intent(in) :: turn(3, 3)
    integer :: place(size(natural, 2))

    integer :: a, b

    place = 0
    do a = 1, size(natural, 2)
      do b = 1, size(natural, 2)
        if (all(matmul(turn, natural_order(:, b)) == nint(natural(:, a)))) place(a) = b
      end do
    end do
  end function node_order

end module dd3_mesh_inp_element
