! SPDX-License-Identifier: GPL-3.0-or-later
!> Last step of a cut: the sheet on its new grid. What did not move keeps its nodes, elements and
!> state; the columns that moved or are new have the positions of the old sheet at their places on
!> the initial sheet, then as well as now, so that thickness and strains go on without a break.
module dd3_sheet_rebuild
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_linalg_tensor, only : cross
  use dd3_mesh_mesh, only : mesh_set_t, mesh_t
  use dd3_sheet_core, only : chain_t
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_location, only : bilinear, locate, place_t
  use dd3_sheet_sheet, only : sheet_t
  use dd3_sheet_smoothing, only : patch_t
  use dd3_sheet_transfer, only : transfer_point
  implicit none
  private
  public :: cut_t, rebuild, least_sine_at

  !> Weight of a corner below which a place lies on the edge across.
  real(wp), parameter :: on_edge = 1.0e-6_wp

  !> The parts of a cut: the old grid, and what becomes of it.
  type :: cut_t
    type(grid_t) :: grid
    !> Positions of the old columns on the initial sheet, `(2, n_column)`, mm.
    real(wp), allocatable :: plane(:, :)
    !> Quadrilaterals that stay, `(n_quad)`.
    logical, allocatable :: kept(:)
    type(chain_t), allocatable :: chain(:)
    !> Quadrilaterals after the cut, those that stay first; the new columns follow the old ones.
    type(patch_t) :: patch
    !> Old column from which each column of the patch comes, `(n_column)`.
    integer, allocatable :: source(:)
  end type cut_t

contains

  !> Replace a sheet by what is left of it.
  pure subroutine rebuild(sheet, cut, element, name)
    type(sheet_t), intent(inout) :: sheet
    type(cut_t), intent(in) :: cut
    type(element_t), intent(in) :: element
    !> Name of the set of the nodes on the cut.
    character(len=*), intent(in) :: name

    type(sheet_t) :: new
    type(place_t), allocatable :: place(:)
    integer, allocatable :: node(:, :)
    logical, allocatable :: moved(:)

    call find_places(cut, place, moved)
    call number_nodes(sheet, cut, node, new%mesh%n_node)
    new%element = sheet%element
    new%thickness_points = sheet%thickness_points
    new%material = sheet%material
    new%digest = sheet%digest
    new%has_state = sheet%has_state
    new%report = sheet%report
    new%warnings = sheet%warnings
    new%mesh%thickness = sheet%mesh%thickness
    new%mesh%placement = sheet%mesh%placement
    new%mesh%mesh_number = sheet%mesh%mesh_number
    if (allocated(sheet%mesh%node_label)) then
      new%mesh%node_label = labels(sheet%mesh%node_label, cut, node, new%mesh%n_node)
    end if
    call move_nodes(sheet%mesh%x, cut, place, moved, node, new%mesh%n_node, new%mesh%x)
    call move_nodes(sheet%x, cut, place, moved, node, new%mesh%n_node, new%x)
    call make_elements(sheet, cut, node, new%mesh)
    if (allocated(sheet%mesh%bound)) call carry_bound(sheet%mesh, cut%grid, node, new%mesh)
    call make_sets(sheet%mesh, cut, place, node, name, new%mesh)
    if (sheet%has_state) call make_state(sheet, cut, element, moved, new)
    sheet = new
  end subroutine rebuild

  !> Find the places of the columns that moved or are new on the old grid.
  pure subroutine find_places(cut, place, moved)
    type(cut_t), intent(in) :: cut
    type(place_t), allocatable, intent(out) :: place(:)
    logical, allocatable, intent(out) :: moved(:)

    integer :: c, n

    n = size(cut%source)
    allocate (place(n), moved(n))
    do c = 1, n
      moved(c) = c > cut%grid%n_column
      if (.not. moved(c)) moved(c) = any(abs(cut%patch%plane(:, c) - cut%plane(:, c)) > 0.0_wp)
      if (.not. moved(c)) cycle
      place(c) = locate(cut%grid, cut%plane, cut%patch%plane(:, c), &
          cut%grid%quad_at(cut%grid%first(cut%source(c))))
      place(c)%natural = max(-1.0_wp, min(1.0_wp, place(c)%natural))
    end do
  end subroutine find_places

  !> Number the nodes of the columns in use: those that stay in their old order, then the new ones.
  pure subroutine number_nodes(sheet, cut, node, n_node)
    type(sheet_t), intent(in) :: sheet
    type(cut_t), intent(in) :: cut
    !> Nodes of the columns from the bottom, `(0:n_layer, n_column)`; 0 for one that goes.
    integer, allocatable, intent(out) :: node(:, :)
    integer, intent(out) :: n_node

    integer :: number(sheet%mesh%n_node), c, i, k, q

    associate (grid => cut%grid)
      number = 0
      do q = 1, size(cut%patch%corner, 2)
        do i = 1, 4
          c = cut%patch%corner(i, q)
          if (c <= grid%n_column) number(grid%node(:, c)) = 1
        end do
      end do
      n_node = 0
      do i = 1, size(number)
        if (number(i) == 0) cycle
        n_node = n_node + 1
        number(i) = n_node
      end do
      allocate (node(0:grid%n_layer, size(cut%source)))
      do c = 1, grid%n_column
        node(:, c) = number(grid%node(:, c))
      end do
      do c = grid%n_column + 1, size(cut%source)
        do k = 0, grid%n_layer
          n_node = n_node + 1
          node(k, c) = n_node
        end do
      end do
    end associate
  end subroutine number_nodes

  !> Return the labels of the nodes after the cut, 0 of new ones.
  pure function labels(before, cut, node, n_node) result(label)
    integer, intent(in) :: before(:)
    type(cut_t), intent(in) :: cut
    integer, intent(in) :: node(0:, :), n_node
    integer :: label(n_node)

    integer :: c, k

    label = 0
    do c = 1, cut%grid%n_column
      do k = 0, ubound(node, 1)
        if (node(k, c) > 0) label(node(k, c)) = before(cut%grid%node(k, c))
      end do
    end do
  end function labels

  !> Set the positions of the nodes after the cut.
  pure subroutine move_nodes(x, cut, place, moved, node, n_node, new)
    !> Positions before the cut, `(3, n)`, mm.
    real(wp), intent(in) :: x(:, :)
    type(cut_t), intent(in) :: cut
    type(place_t), intent(in) :: place(:)
    logical, intent(in) :: moved(:)
    integer, intent(in) :: node(0:, :), n_node
    real(wp), allocatable, intent(out) :: new(:, :)

    integer :: c, k

    allocate (new(3, n_node))
    do c = 1, size(moved)
      if (node(0, c) == 0) cycle
      do k = 0, cut%grid%n_layer
        if (moved(c)) then
          new(:, node(k, c)) = matmul(x(:, cut%grid%node(k, cut%grid%corner(:, place(c)%quad))), &
              bilinear(place(c)%natural))
        else
          new(:, node(k, c)) = x(:, cut%grid%node(k, c))
        end if
      end do
    end do
  end subroutine move_nodes

  !> Make the elements: those that stay in their old order, then the new ones.
  pure subroutine make_elements(sheet, cut, node, mesh)
    type(sheet_t), intent(in) :: sheet
    type(cut_t), intent(in) :: cut
    integer, intent(in) :: node(0:, :)
    !> With its number of nodes.
    type(mesh_t), intent(inout) :: mesh

    type(place_t) :: centre
    integer, allocatable :: kept(:)
    integer :: e, k, q

    associate (grid => cut%grid, corner => cut%patch%corner)
      kept = pack([(q, q=1, grid%n_quad)], cut%kept)
      mesh%n_element_node = 8
      mesh%n_element = grid%n_layer*size(corner, 2)
      allocate (mesh%connectivity(8, mesh%n_element), mesh%material(mesh%n_element))
      if (allocated(sheet%mesh%level)) allocate (mesh%level(mesh%n_element))
      do q = 1, size(corner, 2)
        ! The way of `locate` ends at edges with a bound column: those that stay are known.
        if (q <= size(kept)) then
          centre%quad = kept(q)
        else
          centre = locate(grid, cut%plane, 0.25_wp*sum(cut%patch%plane(:, corner(:, q)), dim=2), &
              grid%quad_at(grid%first(cut%source(corner(1, q)))))
        end if
        do k = 1, grid%n_layer
          e = element_number(cut, q, k)
          mesh%connectivity(:, e) = [node(k - 1, corner(:, q)), node(k, corner(:, q))]
          mesh%material(e) = sheet%mesh%material(grid%element(k, centre%quad))
          if (allocated(mesh%level)) mesh%level(e) = sheet%mesh%level(grid%element(k, centre%quad))
        end do
      end do
    end associate
  end subroutine make_elements

  !> Keep the bound nodes that stay. Near the cut there are none.
  pure subroutine carry_bound(old, grid, node, mesh)
    type(mesh_t), intent(in) :: old
    !> Grid of the old mesh.
    type(grid_t), intent(in) :: grid
    !> Nodes of the columns, first of the old ones; 0 for one that goes.
    integer, intent(in) :: node(0:, :)
    type(mesh_t), intent(inout) :: mesh

    integer :: number(old%n_node), bound(3, size(old%bound, 2)), c, i, n

    do c = 1, grid%n_column
      number(grid%node(:, c)) = node(:, c)
    end do
    n = 0
    do i = 1, size(bound, 2)
      if (any(number(old%bound(:, i)) == 0)) cycle
      n = n + 1
      bound(:, n) = number(old%bound(:, i))
    end do
    if (n > 0) mesh%bound = bound(:, :n)
  end subroutine carry_bound

  !> Return the number of an element after the cut.
  pure integer function element_number(cut, quad, layer)
    type(cut_t), intent(in) :: cut
    integer, intent(in) :: quad, layer

    element_number = layer + cut%grid%n_layer*(quad - 1)
  end function element_number

  !> Make the node sets: members that stay, new nodes on edges or faces within a set, and the set of
  !> the cut.
  pure subroutine make_sets(old, cut, place, node, name, mesh)
    type(mesh_t), intent(in) :: old
    type(cut_t), intent(in) :: cut
    type(place_t), intent(in) :: place(:)
    integer, intent(in) :: node(0:, :)
    character(len=*), intent(in) :: name
    type(mesh_t), intent(inout) :: mesh

    logical :: member(old%n_node), belongs(mesh%n_node)
    integer :: c, i, k, s

    allocate (mesh%set(size(old%set) + 1))
    do s = 1, size(old%set)
      member = .false.
      member(old%set(s)%node) = .true.
      belongs = .false.
      do c = 1, size(cut%source)
        if (node(0, c) == 0) cycle
        do k = 0, cut%grid%n_layer
          if (c <= cut%grid%n_column) then
            belongs(node(k, c)) = member(cut%grid%node(k, c))
          else
            belongs(node(k, c)) = all(member(cut%grid%node(k, &
                cut%grid%corner(:, place(c)%quad))) .or. bilinear(place(c)%natural) < on_edge)
          end if
        end do
      end do
      mesh%set(s)%name = old%set(s)%name
      mesh%set(s)%node = pack([(i, i=1, mesh%n_node)], belongs)
    end do
    mesh%set(s)%name = name
    mesh%set(s)%node = [node(:, cut%grid%n_column + 1:)]
  end subroutine make_sets

  !> Set stresses, internal variables and axes.
  pure subroutine make_state(sheet, cut, element, moved, new)
    type(sheet_t), intent(in) :: sheet
    type(cut_t), intent(in) :: cut
    type(element_t), intent(in) :: element
    logical, intent(in) :: moved(:)
    !> With its mesh.
    type(sheet_t), intent(inout) :: new

    type(place_t) :: place
    integer, allocatable :: kept(:)
    integer :: e, i, k, p, q, start

    associate (grid => cut%grid, corner => cut%patch%corner, n => new%mesh%n_element)
      allocate (new%stress(6, element%n_point, n))
      allocate (new%internal_variables(size(sheet%internal_variables, 1), element%n_point, n))
      allocate (new%orientation(3, 3, element%n_point, n))
      kept = pack([(q, q=1, grid%n_quad)], cut%kept)
      do q = 1, size(corner, 2)
        start = grid%quad_at(grid%first(cut%source(corner(1, q))))
        do k = 1, grid%n_layer
          e = element_number(cut, q, k)
          if (.not. any(moved(corner(:, q)))) then
            associate (old => grid%element(k, kept(q)))
              new%stress(:, :, e) = sheet%stress(:, :, old)
              new%internal_variables(:, :, e) = sheet%internal_variables(:, :, old)
              new%orientation(:, :, :, e) = sheet%orientation(:, :, :, old)
            end associate
            cycle
          end if
          do p = 1, element%n_point
            place = locate(grid, cut%plane, matmul(cut%patch%plane(:, corner(:, q)), &
                bilinear(element%point(:2, p))), start)
            call transfer_point(sheet, grid, cut%plane, element, k, p, place, &
                new%mesh%material([(element_number(cut, q, i), i=1, grid%n_layer)]), &
                new%stress(:, p, e), new%internal_variables(:, p, e), new%orientation(:, :, p, e))
          end do
        end do
      end do
    end associate
  end subroutine make_state

  !> Return the least sine of the angles of an element in the middle of its thickness, negative for
  !> one that is turned inside out.
  pure real(wp) function least_sine_at(x, connectivity) result(sine)
    !> Positions of the nodes, `(3, n_node)`, mm, and the nodes of the element.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: connectivity(8)

    real(wp) :: corner(3, 4), normal(3), u(3), v(3)
    integer :: i

    corner = 0.5_wp*(x(:, connectivity(:4)) + x(:, connectivity(5:)))
    normal = cross(corner(:, 3) - corner(:, 1), corner(:, 4) - corner(:, 2))
    normal = normal/max(tiny(1.0_wp), norm2(normal))
    sine = 1.0_wp
    do i = 1, 4
      u = corner(:, mod(i, 4) + 1) - corner(:, i)
      v = corner(:, mod(i + 2, 4) + 1) - corner(:, i)
      sine = min(sine, dot_product(cross(u, v), normal)/max(tiny(1.0_wp), norm2(u)*norm2(v)))
    end do
  end function least_sine_at

end module dd3_sheet_rebuild
