! SPDX-License-Identifier: GPL-3.0-or-later
!> Mesh of a sheet in which quadrilaterals are divided into four, without the positions of its
!> nodes. Nodes keep their numbers; new ones follow column by column from the bottom. Elements keep
!> their order, and the parts of a divided element are in its place; where the layers of a
!> quadrilateral follow one another, those of its quarters do too, quarter by quarter.
module dd3_sheet_divided_mesh
  use dd3_mesh_mesh, only : mesh_t
  use dd3_sheet_division, only : division_t
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_refinement, only : refinement_t
  implicit none
  private
  public :: new_divided_mesh

contains

  !> Make the mesh without its positions.
  pure subroutine new_divided_mesh(old, grid, division, mesh, node, origin)
    type(mesh_t), intent(in) :: old
    !> Grid of the old mesh.
    type(grid_t), intent(in) :: grid
    type(division_t), intent(in) :: division
    type(mesh_t), intent(out) :: mesh
    !> Nodes of all columns from the bottom, `(0:n_layer, n_column)`.
    integer, allocatable, intent(out) :: node(:, :)
    !> Gets the origins of nodes and elements.
    type(refinement_t), intent(inout) :: origin

    integer :: quad(old%n_element), q

    do q = 1, grid%n_quad
      quad(grid%element(:, q)) = q
    end do
    mesh%thickness = old%thickness
    mesh%placement = old%placement
    mesh%n_node = old%n_node + (grid%n_layer + 1)*(division%n_column - grid%n_column)
    if (allocated(old%node_label)) then
      mesh%node_label = [old%node_label, spread(0, 1, mesh%n_node - old%n_node)]
    end if
    call number_nodes(old%n_node, grid, division, node)
    call set_parents(mesh%n_node, node, division, origin)
    call list_elements(grid, quad, division%divided, origin)
    call make_elements(old, grid, quad, node, division, origin, mesh)
    call bind_nodes(node, division, mesh)
    call make_node_sets(old, origin, mesh)
    call make_element_sets(old, origin, mesh)
  end subroutine new_divided_mesh

  !> Number the nodes of the new columns after the old nodes.
  pure subroutine number_nodes(n_node, grid, division, node)
    !> Number of old nodes.
    integer, intent(in) :: n_node
    type(grid_t), intent(in) :: grid
    type(division_t), intent(in) :: division
    integer, allocatable, intent(out) :: node(:, :)

    integer :: c, k, n

    allocate (node(0:grid%n_layer, division%n_column))
    node(:, :grid%n_column) = grid%node
    n = n_node
    do c = grid%n_column + 1, division%n_column
      node(:, c) = [(n + k, k=1, grid%n_layer + 1)]
      n = n + grid%n_layer + 1
    end do
  end subroutine number_nodes

  !> Set the nodes between which the new ones lie.
  pure subroutine set_parents(n_node, node, division, origin)
    integer, intent(in) :: n_node
    integer, intent(in) :: node(0:, :)
    type(division_t), intent(in) :: division
    type(refinement_t), intent(inout) :: origin

    integer :: c, k, n

    allocate (origin%parent(4, n_node), source=0)
    do c = 1, division%n_column
      n = count(division%parent(:, c) > 0)
      do k = 0, merge(ubound(node, 1), -1, n > 0)
        origin%parent(:n, node(k, c)) = node(k, division%parent(:n, c))
      end do
    end do
  end subroutine set_parents

  !> List the old elements and their quarters in the order of the new elements.
  pure subroutine list_elements(grid, quad, divided, origin)
    type(grid_t), intent(in) :: grid
    !> Quadrilateral of each element, `(n_element)`.
    integer, intent(in) :: quad(:)
    !> `(n_quad)`.
    logical, intent(in) :: divided(:)
    type(refinement_t), intent(inout) :: origin

    integer :: e, n

    n = size(quad) + 3*grid%n_layer*count(divided)
    allocate (origin%element(n), origin%quadrant(n))
    n = 0
    do e = 1, size(quad)
      associate (layers => grid%element(:, quad(e)))
        if (.not. divided(quad(e))) then
          call append(origin, n, [e], 0, 0)
        else if (any(layers(2:) /= layers(:grid%n_layer - 1) + 1)) then
          call append(origin, n, [e], 1, 4)
        else if (e == layers(1)) then
          call append(origin, n, layers, 1, 4)
        end if
      end associate
    end do
  end subroutine list_elements

  !> Append parts of elements, each of all elements.
  pure subroutine append(origin, n, element, first, last)
    type(refinement_t), intent(inout) :: origin
    !> Number of elements so far.
    integer, intent(inout) :: n
    integer, intent(in) :: element(:)
    !> First and last quarter, or 0.
    integer, intent(in) :: first, last

    integer :: quadrant

    do quadrant = first, last
      origin%element(n + 1:n + size(element)) = element
      origin%quadrant(n + 1:n + size(element)) = quadrant
      n = n + size(element)
    end do
  end subroutine append

  !> Make the elements.
  pure subroutine make_elements(old, grid, quad, node, division, origin, mesh)
    type(mesh_t), intent(in) :: old
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: quad(:), node(0:, :)
    type(division_t), intent(in) :: division
    type(refinement_t), intent(in) :: origin
    type(mesh_t), intent(inout) :: mesh

    integer :: corner(4), e, k

    mesh%n_element = size(origin%element)
    mesh%n_element_node = 8
    allocate (mesh%connectivity(8, mesh%n_element))
    mesh%material = old%material(origin%element)
    mesh%level = merge(1, 0, origin%quadrant > 0)
    if (allocated(old%level)) mesh%level = mesh%level + old%level(origin%element)
    do e = 1, mesh%n_element
      associate (from => origin%element(e))
        if (origin%quadrant(e) == 0) then
          mesh%connectivity(:, e) = old%connectivity(:, from)
          cycle
        end if
        corner = division%corners(grid, quad(from), origin%quadrant(e))
        k = findloc(grid%element(:, quad(from)), from, dim=1)
        mesh%connectivity(:, e) = [node(k - 1, corner), node(k, corner)]
      end associate
    end do
  end subroutine make_elements

  !> List the bound nodes, column by column from the bottom.
  pure subroutine bind_nodes(node, division, mesh)
    integer, intent(in) :: node(0:, :)
    type(division_t), intent(in) :: division
    type(mesh_t), intent(inout) :: mesh

    integer :: c, k, n

    n = count(division%bound_to(1, :) > 0)
    if (n == 0) return
    allocate (mesh%bound(3, n*size(node, 1)))
    n = 0
    do c = 1, division%n_column
      if (division%bound_to(1, c) == 0) cycle
      do k = 0, ubound(node, 1)
        n = n + 1
        mesh%bound(:, n) = node(k, [c, division%bound_to(:, c)])
      end do
    end do
  end subroutine bind_nodes

  !> Make the node sets: a new node belongs to those of all nodes between which it lies.
  pure subroutine make_node_sets(old, origin, mesh)
    type(mesh_t), intent(in) :: old
    type(refinement_t), intent(in) :: origin
    type(mesh_t), intent(inout) :: mesh

    logical :: belongs(mesh%n_node)
    integer :: i, s

    if (.not. allocated(old%set)) return
    allocate (mesh%set(size(old%set)))
    do s = 1, size(old%set)
      belongs = .false.
      belongs(old%set(s)%node) = .true.
      do i = old%n_node + 1, mesh%n_node
        belongs(i) = all(belongs(pack(origin%parent(:, i), origin%parent(:, i) > 0)))
      end do
      mesh%set(s)%name = old%set(s)%name
      mesh%set(s)%node = pack([(i, i=1, mesh%n_node)], belongs)
    end do
  end subroutine make_node_sets

  !> Make the element sets: a part belongs to those of the whole.
  pure subroutine make_element_sets(old, origin, mesh)
    type(mesh_t), intent(in) :: old
    type(refinement_t), intent(in) :: origin
    type(mesh_t), intent(inout) :: mesh

    logical :: has(old%n_element)
    integer :: i, s

    if (.not. allocated(old%element_set)) return
    allocate (mesh%element_set(size(old%element_set)))
    do s = 1, size(old%element_set)
      has = .false.
      has(old%element_set(s)%element) = .true.
      mesh%element_set(s)%name = old%element_set(s)%name
      mesh%element_set(s)%element = pack([(i, i=1, mesh%n_element)], has(origin%element))
    end do
  end subroutine make_element_sets

end module dd3_sheet_divided_mesh
