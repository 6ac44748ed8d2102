! SPDX-License-Identifier: GPL-3.0-or-later
!> Mesh from an `.inp` file: labels become numbers, elements are turned so that their first face is
!> the bottom of the sheet, sets and materials are assigned.
module dd3_mesh_inp_mesh
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_number_index, only : new_number_index, number_index_t
  use dd3_base_text, only : to_text
  use dd3_input_bezier_file, only : push_file_errors
  use dd3_input_case, only : mesh_spec_t
  use dd3_mesh_hexahedra, only : find_neighbours, neighbours_t
  use dd3_mesh_inp, only : inp_t
  use dd3_mesh_inp_check, only : check_hanging, check_layers, check_neighbours, &
      check_places, check_roles, check_shapes
  use dd3_mesh_inp_constraint, only : check_constraints, resolve_constraints
  use dd3_mesh_inp_element, only : node_order
  use dd3_mesh_inp_file, only : read_inp
  use dd3_mesh_inp_sets, only : resolve_sets
  use dd3_mesh_layers, only : find_layers, layers_t, turn_of
  use dd3_mesh_mesh, only : mesh_t, mesh_set_t
  implicit none
  private
  public :: new_inp_mesh

contains

  !> Read the mesh of a file. It is complete only if no error was added.
  subroutine new_inp_mesh(mesh, spec, natural, errors)
    type(mesh_t), intent(out) :: mesh
    type(mesh_spec_t), intent(in) :: spec
    !> Natural coordinates of the element's nodes, `(3, n_element_node)`.
    real(wp), intent(in) :: natural(:, :)
    type(error_list_t), intent(inout) :: errors

    type(inp_t) :: inp
    type(layers_t) :: layers
    integer, allocatable :: node(:, :), constraint(:, :)
    integer :: before

    before = errors%count
    call read_inp(inp, spec%file, spec%source%at("file"), errors)
    if (errors%count > before) return
    if (inp%errors%count == 0 .and. inp%n_element_node /= size(natural, 2)) then
      call errors%push_input(spec%source%at("element"), "the elements of '"//spec%file// &
          "' are of type "//trim(inp%element_type)//" and have "//to_text(inp%n_element_node)// &
          " nodes; "//element_of(spec)//" has "//to_text(size(natural, 2)), &
          "an element with "//to_text(inp%n_element_node)//" nodes", code="E147")
      return
    end if
    if (inp%errors%count == 0) call resolve(mesh, inp, node, constraint)
    if (inp%errors%count == 0) call check_geometry(inp, node, constraint, layers, mesh%bound)
    call push_file_errors(errors, inp%errors, spec%source%at("file"))
    if (inp%errors%count > 0) return
    mesh%x = inp%x(:, :inp%n_node)
    call connect(mesh, node, layers%axis, natural)
    call add_faces(mesh, spec, natural, errors)
    if (spec%source%valid) call set_materials(mesh, inp, spec, errors)
  end subroutine new_inp_mesh

  !> Return the element of a mesh in words.
  function element_of(spec) result(text)
    type(mesh_spec_t), intent(in) :: spec
    character(len=:), allocatable :: text

    text = "the default of `element`"
    if (spec%element /= "") text = "element = "//spec%element
  end function element_of

  !> Replace the labels by numbers in the order of the file, in elements, sets and
  !> constraints.
  subroutine resolve(mesh, inp, node, constraint)
    type(mesh_t), intent(inout) :: mesh
    type(inp_t), intent(inout) :: inp
    !> Nodes of the elements in the file's order, `(n_element_node, n_element)`.
    integer, allocatable, intent(out) :: node(:, :)
    !> Bound nodes and the ends of their edges by *MPC, `(3, n)`.
    integer, allocatable, intent(out) :: constraint(:, :)

    type(number_index_t) :: nodes, elements

    mesh%n_node = inp%n_node
    mesh%n_element = inp%n_element
    mesh%n_element_node = inp%n_element_node
    inp%node_label = inp%node_label(:inp%n_node)
    inp%element_label = inp%element_label(:inp%n_element)
    call index_labels(nodes, inp, "node", inp%node_label, inp%node_line)
    call index_labels(elements, inp, "element", inp%element_label, inp%element_line)
    call resolve_elements(inp, nodes, node)
    if (inp%errors%count == 0) call report_unused(inp, node)
    call resolve_sets(mesh, inp, nodes, elements, node)
    call resolve_constraints(inp, nodes, constraint)
    mesh%node_label = inp%node_label
  end subroutine resolve

  !> Index the labels of nodes or elements; report those that are given twice.
  subroutine index_labels(numbers, inp, what, label, line)
    type(number_index_t), intent(out) :: numbers
    type(inp_t), intent(inout) :: inp
    !> "node" or "element".
    character(len=*), intent(in) :: what
    integer, intent(in) :: label(:), line(:)

    integer :: i, earlier

    call new_number_index(numbers, size(label))
    do i = 1, size(label)
      call numbers%add(label(i), i, earlier)
      if (earlier > 0) call inp%report(line(i), what//" "//to_text(label(i))// &
          " is given twice, first in line "//to_text(line(earlier)), &
          "one line for each "//what)
    end do
  end subroutine index_labels

  !> Replace the labels of the nodes in the elements.
  subroutine resolve_elements(inp, nodes, node)
    type(inp_t), intent(inout) :: inp
    type(number_index_t), intent(in) :: nodes
    integer, allocatable, intent(out) :: node(:, :)

    integer :: e, a

    allocate (node(inp%n_element_node, inp%n_element))
    do e = 1, inp%n_element
      do a = 1, inp%n_element_node
        node(a, e) = nodes%find(inp%corner(a, e))
        if (node(a, e) == 0) then
          call report("names node "//to_text(inp%corner(a, e))// &
              ", which the file does not have", "labels of nodes")
        else if (any(node(:a - 1, e) == node(a, e))) then
          call report("is degenerate: it names node "//to_text(inp%corner(a, e))//" twice", &
              "different nodes; wedges and pyramids are not read")
        end if
      end do
    end do

  contains

    subroutine report(message, expected)
      character(len=*), intent(in) :: message, expected

      call inp%report(inp%element_line(e), "element "//to_text(inp%element_label(e))//" "// &
          message, expected)
    end subroutine report

  end subroutine resolve_elements

  !> Report nodes that belong to no element.
  subroutine report_unused(inp, node)
    type(inp_t), intent(inout) :: inp
    integer, intent(in) :: node(:, :)

    character(len=:), allocatable :: others
    logical :: used(inp%n_node)
    integer :: e, i

    used = .false.
    do e = 1, size(node, 2)
      used(node(:, e)) = .true.
    end do
    if (all(used)) return
    i = findloc(used, .false., dim=1)
    others = ""
    if (count(.not. used) > 1) others = "; of all nodes "//to_text(count(.not. used))//" do not"
    call inp%report(inp%node_line(i), "node "//to_text(inp%node_label(i))// &
        " belongs to no element"//others, "nodes of elements only")
  end subroutine report_unused

  !> Check shapes and neighbours, find the thickness direction and bind hanging nodes.
  subroutine check_geometry(inp, node, constraint, layers, bound)
    type(inp_t), intent(inout) :: inp
    !> Nodes of the elements, their corners first, `(n_element_node, n_element)`.
    integer, intent(in) :: node(:, :)
    !> Bound nodes and the ends of their edges by *MPC.
    integer, intent(in) :: constraint(:, :)
    type(layers_t), intent(out) :: layers
    !> Bound nodes and the ends of their edges; not allocated if there are none.
    integer, allocatable, intent(out) :: bound(:, :)

    type(neighbours_t) :: neighbours

    associate (corner => node(:8, :))
      call check_shapes(inp, corner)
      call check_places(inp, corner)
      call find_neighbours(neighbours, corner, inp%n_node)
      call check_neighbours(inp, neighbours)
      if (inp%errors%count > 0) return
      call check_roles(inp, node)
      if (inp%errors%count > 0) return
      call find_layers(layers, neighbours, corner, inp%x)
    end associate
    call check_layers(inp, layers)
    if (inp%errors%count == 0) call check_constraints(inp, node, layers%axis, constraint)
    if (inp%errors%count == 0) call check_hanging(inp, node, neighbours, layers%axis, constraint, &
        bound)
  end subroutine check_geometry

  !> Set the connectivity in our order of the nodes, with the thickness as third axis.
  pure subroutine connect(mesh, node, axis, natural)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: node(:, :)
    !> Natural axis from bottom to top of each element.
    integer, intent(in) :: axis(:)
    real(wp), intent(in) :: natural(:, :)

    integer :: order(size(natural, 2), -3:3)
    integer :: d, e

    do d = -3, 3
      if (d /= 0) order(:, d) = node_order(natural, turn_of(d))
    end do
    allocate (mesh%connectivity(size(node, 1), size(node, 2)))
    do e = 1, size(node, 2)
      mesh%connectivity(:, e) = node(order(:, axis(e)), e)
    end do
  end subroutine connect

  !> Add the sets of the two faces of the sheet and of all nodes. Sets of the file with these names
  !> must hold the same nodes.
  subroutine add_faces(mesh, spec, natural, errors)
    type(mesh_t), intent(inout) :: mesh
    type(mesh_spec_t), intent(in) :: spec
    real(wp), intent(in) :: natural(:, :)
    type(error_list_t), intent(inout) :: errors

    integer :: count_of(mesh%n_node, -1:1), e, a, i

    count_of = 0
    do e = 1, mesh%n_element
      do a = 1, size(natural, 2)
        associate (uses => count_of(mesh%connectivity(a, e), nint(natural(3, a))))
          uses = uses + 1
        end associate
      end do
    end do
    ! A node at the top of some element and at the bottom of none is on the upper face.
    call add("z_min", pack([(i, i=1, mesh%n_node)], count_of(:, -1) > 0 .and. &
        count_of(:, 1) == 0))
    call add("z_max", pack([(i, i=1, mesh%n_node)], count_of(:, 1) > 0 .and. &
        count_of(:, -1) == 0))
    call add("all", [(i, i=1, mesh%n_node)])

  contains

    subroutine add(name, node)
      character(len=*), intent(in) :: name
      integer, intent(in) :: node(:)

      type(mesh_set_t) :: set
      integer :: k
      logical :: same

      k = mesh%find_set(name)
      if (k == 0) then
        set%name = name
        set%node = node
        call mesh%append_set(set)
        return
      end if
      same = size(mesh%set(k)%node) == size(node)
      if (same) same = all(mesh%set(k)%node == node)
      if (same) return
      call errors%push_input(spec%source%at("file"), "the set '"//name//"' of '"//spec%file// &
          "' has other nodes than "//meaning(name), "another name: "//name//" is found by the "// &
          "program", code="E123")
    end subroutine add

  end subroutine add_faces

  !> Return what a set found by the program holds.
  pure function meaning(name) result(text)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: text

    select case (name)
    case ("z_min")
      text = "the lower face of the sheet"
    case ("z_max")
      text = "the upper face of the sheet"
    case default
      text = "the whole mesh"
    end select
  end function meaning

  !> Set the material of all elements, and make the sets of elements sets of nodes.
  subroutine set_materials(mesh, inp, spec, errors)
    type(mesh_t), intent(inout) :: mesh
    type(inp_t), intent(in) :: inp
    type(mesh_spec_t), intent(in) :: spec
    type(error_list_t), intent(inout) :: errors

    integer :: i, k, e

    allocate (mesh%material(mesh%n_element), source=0)
    do i = 1, size(spec%material_of)
      associate (this => spec%material_of(i))
        k = mesh%find_element_set(this%set)
        if (k == 0) then
          call errors%push_input(this%at, "there is no element set '"//this%set//"' in '"// &
              spec%file//"'", known_element_sets(mesh), code="E113")
          cycle
        end if
        associate (element => mesh%element_set(k)%element)
          e = findloc(mesh%material(element) > 0 .and. mesh%material(element) /= this%material, &
              .true., dim=1)
          if (e > 0) call errors%push_input(this%at, "element "// &
              to_text(inp%element_label(element(e)))//" gets two materials", &
              "one material for each element", code="E122")
          mesh%material(element) = this%material
        end associate
      end associate
    end do
    where (mesh%material == 0) mesh%material = spec%material
    e = findloc(mesh%material, 0, dim=1)
    if (e > 0) call errors%push_input(spec%source%opened, "element "// &
        to_text(inp%element_label(e))//" has no material (elements without: "// &
        to_text(count(mesh%material == 0))//")", &
        "material = name, or material_of = set name for the set of each element", code="E121")
    do k = 1, size(mesh%element_set)
      call add_nodes_of(mesh, k)
    end do
  end subroutine set_materials

  !> Return the names of the element sets as an expectation.
  pure function known_element_sets(mesh) result(text)
    type(mesh_t), intent(in) :: mesh
    character(len=:), allocatable :: text

    integer :: i

    text = "a set of *ELSET or of *ELEMENT, ELSET=; the file has none"
    if (size(mesh%element_set) > 0) text = "one of:"
    do i = 1, min(20, size(mesh%element_set))
      text = text//" "//mesh%element_set(i)%name
    end do
    if (size(mesh%element_set) > 20) text = text//" ..."
  end function known_element_sets

  !> Make a set of elements a set of nodes, unless there is one with its name.
  subroutine add_nodes_of(mesh, k)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: k

    type(mesh_set_t) :: set
    logical :: named(mesh%n_node)
    integer :: i

    if (mesh%find_set(mesh%element_set(k)%name) > 0) return
    named = .false.
    associate (element => mesh%element_set(k)%element)
      do i = 1, size(element)
        named(mesh%connectivity(:, element(i))) = .true.
      end do
    end associate
    set%name = mesh%element_set(k)%name
    set%node = pack([(i, i=1, mesh%n_node)], named)
    call mesh%append_set(set)
  end subroutine add_nodes_of

end module dd3_mesh_inp_mesh
