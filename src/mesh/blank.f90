!> Generates the mesh of a structured blank: a box of hexahedra, graded and skewed.
module dd3_mesh_blank
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : blank_spec_t
  use dd3_mesh_mesh, only : mesh_t, mesh_set_t
  implicit none
  private
  public :: new_blank_mesh

  !> Nodes of a hexahedron in the order of VTK, as steps of an element along x, y and z from its
  !> first corner.
  integer, parameter :: hex8_step(3, 8) = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, &
                                                   0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])

contains

  !> Builds nodes, elements and the seven sets of a blank.
  subroutine new_blank_mesh(mesh, blank)
    !> The mesh.
    type(mesh_t), intent(out) :: mesh
    !> The blank.
    type(blank_spec_t), intent(in) :: blank

    mesh%element = blank%element
    mesh%thickness = blank%size(3)
    call place_nodes(mesh, blank)
    call connect(mesh, blank%divisions, hex8_step)
    allocate (mesh%material(mesh%n_element), source=blank%material)
    call name_faces(mesh, blank%divisions)
  end subroutine new_blank_mesh

  !> Number of the node at grid position (i, j, k), each from 0: thickness fastest, then width,
  !> then length.
  pure integer function node_number(divisions, i, j, k)
    !> Elements along x, y, z.
    integer, intent(in) :: divisions(3)
    !> Grid position.
    integer, intent(in) :: i, j, k

    node_number = 1 + k + (divisions(3) + 1)*(j + (divisions(2) + 1)*i)
  end function node_number

  !> Places the nodes.
  subroutine place_nodes(mesh, blank)
    !> The mesh.
    type(mesh_t), intent(inout) :: mesh
    !> The blank.
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
          if (i > 0 .and. i < n(1)) shift = blank%skew*(blank%size(1)/real(n(1), &
              wp))*(y(j) - 0.5_wp)
          do k = 0, n(3)
            mesh%x(:, node_number(n, i, j, k)) = blank%origin + blank%size*[x(i), y(j), &
                z(k)] + [shift, 0.0_wp, 0.0_wp]
          end do
        end do
      end do
    end associate
  end subroutine place_nodes

  !> Lists the nodes of each element; elements are numbered like the nodes.
  subroutine connect(mesh, divisions, step)
    !> The mesh.
    type(mesh_t), intent(inout) :: mesh
    !> Elements along x, y, z.
    integer, intent(in) :: divisions(3)
    !> Steps from an element's first corner to its nodes, in intervals of the node grid.
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

  !> Makes the sets of the six faces and of all nodes, by position in the grid.
  subroutine name_faces(mesh, divisions)
    !> The mesh.
    type(mesh_t), intent(inout) :: mesh
    !> Elements along x, y, z.
    integer, intent(in) :: divisions(3)

    character(len=5), parameter :: names(6) = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]
    integer :: lower(3), upper(3), s, axis

    allocate (mesh%set(7))
    do s = 1, 6
      axis = (s + 1)/2
      lower = 0
      upper = divisions
      if (mod(s, 2) == 1) upper(axis) = 0
      if (mod(s, 2) == 0) lower(axis) = divisions(axis)
      mesh%set(s) = grid_set(names(s), divisions, lower, upper)
    end do
    mesh%set(7) = grid_set("all", divisions, [0, 0, 0], divisions)
  end subroutine name_faces

  !> The set of the nodes in a part of the grid.
  pure function grid_set(name, divisions, lower, upper) result(set)
    !> Its name.
    character(len=*), intent(in) :: name
    !> Elements along x, y, z.
    integer, intent(in) :: divisions(3)
    !> First and last grid positions.
    integer, intent(in) :: lower(3), upper(3)
    type(mesh_set_t) :: set

    integer :: i, j, k

    set%name = name
    set%node = [(((node_number(divisions, i, j, k), k=lower(3), upper(3)), j=lower(2), upper(2)), &
        i=lower(1), upper(1))]
  end function grid_set

end module dd3_mesh_blank
