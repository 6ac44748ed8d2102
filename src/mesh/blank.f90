!> Mesh generator of a structured blank: a box of hexahedra, graded and skewed.
module dd3_mesh_blank
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : blank_spec_t, blank_sets
  use dd3_mesh_mesh, only : mesh_t, mesh_set_t
  implicit none
  private
  public :: new_blank_mesh

  !> Nodes of a hexahedron in the order of VTK, as steps along x, y and z from its first corner.
  integer, parameter :: hex8_step(3, 8) = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, &
                                                   0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])

contains

  !> Build nodes, elements and node sets of a blank.
  subroutine new_blank_mesh(mesh, blank)
    type(mesh_t), intent(out) :: mesh
    type(blank_spec_t), intent(in) :: blank

    mesh%element = blank%element
    mesh%thickness = blank%size(3)
    call place_nodes(mesh, blank)
    call connect(mesh, blank%divisions, hex8_step)
    allocate (mesh%material(mesh%n_element), source=blank%material)
    call name_faces(mesh, blank%divisions)
  end subroutine new_blank_mesh

  !> Return the number of the node at grid position (i, j, k), each from 0; z runs fastest, then y,
  !> then x.
  pure integer function node_number(divisions, i, j, k)
    !> Number of elements along x, y, z.
    integer, intent(in) :: divisions(3)
    integer, intent(in) :: i, j, k

    node_number = 1 + k + (divisions(3) + 1)*(j + (divisions(2) + 1)*i)
  end function node_number

  !> Compute the coordinates of the nodes.
  subroutine place_nodes(mesh, blank)
    type(mesh_t), intent(inout) :: mesh
    type(blank_spec_t), intent(in) :: blank

    real(wp) :: shift
    integer :: i, j, k

    associate (n => blank%divisions, x => blank%grading_x, y => blank%grading_y, &
        z => blank%grading_z)
      mesh%n_node = product(n + 1)
      allocate (mesh%x(3, mesh%n_node))
      do i = 0, n(1)
        do j = 0, n(2)
          shift = 0.0_wp
          if (i > 0 .and. i < n(1)) then
            shift = blank%skew*(blank%size(1)/real(n(1), wp))*(y(j) - 0.5_wp)
          end if
          do k = 0, n(3)
            mesh%x(:, node_number(n, i, j, k)) = blank%origin + blank%size*[x(i), y(j), z(k)] &
                                                 + [shift, 0.0_wp, 0.0_wp]
          end do
        end do
      end do
    end associate
  end subroutine place_nodes

  !> Set the connectivity; elements are numbered like the nodes.
  subroutine connect(mesh, divisions, step)
    type(mesh_t), intent(inout) :: mesh
    !> Number of elements along x, y, z.
    integer, intent(in) :: divisions(3)
    !> Steps from an element's first corner to its nodes, in intervals of the node grid,
    !> `(3, n_element_node)`.
    integer, intent(in) :: step(:, :)

    integer :: i, j, k, a, element

    mesh%n_element = product(divisions)
    mesh%n_element_node = size(step, 2)
    allocate (mesh%connectivity(mesh%n_element_node, mesh%n_element))
    element = 0
    do i = 0, divisions(1) - 1
      do j = 0, divisions(2) - 1
        do k = 0, divisions(3) - 1
          element = element + 1
          do a = 1, size(step, 2)
            mesh%connectivity(a, element) = node_number(divisions, i + step(1, a), j + step(2, a), &
                k + step(3, a))
          end do
        end do
      end do
    end do
  end subroutine connect

  !> Make the sets of the faces and of all nodes, by position in the grid.
  subroutine name_faces(mesh, divisions)
    type(mesh_t), intent(inout) :: mesh
    !> Number of elements along x, y, z.
    integer, intent(in) :: divisions(3)

    integer :: lower(3), upper(3), s, axis

    allocate (mesh%set(size(blank_sets)))
    do s = 1, size(blank_sets)
      lower = 0
      upper = divisions
      ! Two faces for each axis; the set after them holds all nodes.
      axis = (s + 1)/2
      if (axis <= 3) then
        if (mod(s, 2) == 1) upper(axis) = 0
        if (mod(s, 2) == 0) lower(axis) = divisions(axis)
      end if
      mesh%set(s) = grid_set(trim(blank_sets(s)), divisions, lower, upper)
    end do
  end subroutine name_faces

  !> Return the set of the nodes in a part of the grid.
  pure function grid_set(name, divisions, lower, upper) result(set)
    character(len=*), intent(in) :: name
    !> Number of elements along x, y, z.
    integer, intent(in) :: divisions(3)
    !> First and last grid position along each axis.
    integer, intent(in) :: lower(3), upper(3)
    type(mesh_set_t) :: set

    integer :: i, j, k

    set%name = name
    set%node = [(((node_number(divisions, i, j, k), k=lower(3), upper(3)), j=lower(2), upper(2)), &
        i=lower(1), upper(1))]
  end function grid_set

end module dd3_mesh_blank
