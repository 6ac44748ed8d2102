! SPDX-License-Identifier: GPL-3.0-or-later
!> The parts of the model that depend on the mesh, from the case and a sheet.
module dd3_setup_on_sheet
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_element_kinematics, only : element_gradients
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t, new_element_work
  use dd3_input_case, only : case_t
  use dd3_mesh_build, only : add_sets
  use dd3_mesh_mesh, only : mark_directions, mesh_t
  use dd3_model_bound_faces, only : remove_inner_faces
  use dd3_model_bound_nodes, only : follow_parents, set_bound_nodes
  use dd3_model_contact_data, only : contact_data_t
  use dd3_model_contact_points, only : set_contact_points
  use dd3_model_edge_length, only : undivided_length
  use dd3_model_fingerprint, only : tool_digest
  use dd3_model_model, only : model_t
  use dd3_model_part, only : new_part
  use dd3_model_rim, only : set_rim
  use dd3_model_sheet_faces, only : new_sheet_faces
  use dd3_model_thickness_columns, only : set_columns, set_thickness
  use dd3_model_tolerances, only : new_tolerances
  use dd3_setup_axes, only : set_axes
  use dd3_setup_drawbeads, only : new_drawbeads
  use dd3_setup_held_loads, only : check_loads
  use dd3_setup_phases, only : new_phases
  use dd3_setup_pins, only : check_pins
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: set_on_sheet

contains

  !> Set all that depends on the mesh: the mesh data, and of the process what is resolved on it
  !> (draw-beads, phases, node sets of history.csv). The model may have been built on another sheet
  !> before; materials with their axes, tools and element remain.
  subroutine set_on_sheet(model, case, sheet, displaced, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> With its mesh, which is taken away.
    type(sheet_t), intent(inout) :: sheet
    !> Whether it has left its initial positions.
    logical, intent(in) :: displaced
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(mesh_t) :: mesh
    logical :: rebuilt
    integer :: n_sheet_set

    rebuilt = allocated(model%phase)
    n_sheet_set = model%n_sheet_set
    call remove_sheet(model)
    if (displaced) model%x_start = sheet%x
    mesh = sheet%mesh
    sheet%mesh = mesh_t()
    model%n_sheet_set = n_sheet_set
    if (.not. rebuilt) then
      model%n_sheet_set = size(mesh%set)
      call add_sets(mesh, case, errors)
      if (errors%count > 0) return
    end if
    call set_mesh(model, case, mesh, errors)
    if (errors%count > 0) return
    if (displaced) call follow_parents(model, model%x_start)
    if (.not. rebuilt) then
      model%undivided_length = undivided_length(model)
      call set_axes(model, case, errors)
      call check_pins(model, case, mesh, errors)
    end if
    if (errors%count > 0) return
    call find_candidates(model, case, mesh, errors)
    if (errors%count > 0) return
    call set_fixed(model, case, mesh)
    call set_rim(model)
    call new_drawbeads(model, case, errors)
    if (errors%count > 0) return
    call new_phases(model, case, mesh, errors)
    if (allocated(mesh%bound)) call check_bound(mesh, case, errors)
    call free_bound_nodes(model)
    call check_loads(model, case, errors)
    call set_history(model, case, mesh)
  end subroutine set_on_sheet

  !> Remove the sheet on which a model has been built before.
  subroutine remove_sheet(model)
    !> Keeps its element.
    type(model_t), intent(inout) :: model

    type(contact_data_t) :: none
    type(element_t) :: element

    element = model%element
    model%contact_data_t = none
    model%element = element
    if (allocated(model%drawbead)) deallocate (model%drawbead)
    if (allocated(model%phase)) deallocate (model%phase)
    if (allocated(model%history)) deallocate (model%history)
  end subroutine remove_sheet

  !> Set nodes and elements and check that no element is inverted.
  subroutine set_mesh(model, case, mesh, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(element_work_t) :: work
    type(verdict_t) :: verdict
    type(location_t) :: at
    integer :: e, i

    model%n_node = mesh%n_node
    model%n_element = mesh%n_element
    model%x0 = mesh%x
    model%connectivity = mesh%connectivity
    model%placement = mesh%placement
    if (allocated(mesh%node_label)) model%node_label = mesh%node_label
    model%mesh_number = mesh%mesh_number
    model%n_first_node = merge(mesh%n_first_node, mesh%n_node, mesh%mesh_number > 0)
    allocate (model%set(size(mesh%set)))
    do i = 1, size(mesh%set)
      model%set(i)%name = mesh%set(i)%name
      model%set(i)%node = mesh%set(i)%node
    end do
    model%material_of = mesh%material
    call new_part(model%part, mesh%n_node, mesh%n_element)
    call set_columns(model)
    if (allocated(mesh%level)) model%level = mesh%level
    call set_bound_nodes(model, mesh%bound)
    ! Of a curved mesh from a file they lie near the places that the motion of their parents keeps.
    call follow_parents(model, model%x0)
    call new_sheet_faces(model%face, model%element, mesh%connectivity)
    call remove_inner_faces(model)
    if (model%element%n_enhanced > 0) then
      model%element%stacked = any([(all(model%column(:, i) /= i), i=1, model%n_node)])
    end if
    call set_thickness(model, mesh%thickness)
    model%tolerance = new_tolerances(model%thickness, mesh%x)
    associate (element => model%element)
      call new_element_work(work, element%n_node, element%n_point, element%n_group, &
          element%n_enhanced)
    end associate
    do e = 1, model%n_element
      call element_gradients(model%element, model%x0(:, model%connectivity(:, e)), work, verdict)
      if (verdict%outcome == verdict_converged) cycle
      if (size(case%blank) > 0) at = case%blank(1)%source%opened
      if (size(case%mesh) > 0) at = case%mesh(1)%source%opened
      if (size(case%start) > 0) at = case%start(1)%source%opened
      call errors%push_input(at, "element "//to_text(e)// &
          " has no volume", "a sheet whose node lines do not cross", code="E148")
      return
    end do
  end subroutine set_mesh

  !> Number the contact candidates, and the block rows of the tools that are pressed in some phase.
  subroutine find_candidates(model, case, mesh, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    logical :: pressed(model%n_tool)
    integer :: t, i, k, points

    allocate (model%member(model%n_tool, model%n_node), source=.false.)
    do t = 1, model%n_tool
      model%member(t, mesh%nodes_of(case%tool(t)%contact)) = .true.
    end do
    points = case%contact%points
    if (points > 1 .and. .not. is_one_layer(model)) call errors%push_input( &
        case%contact%points_at, "points between the nodes need a sheet of one layer of "// &
        "elements with eight nodes", "points = 1, or one element through the thickness", &
        code="E148")
    if (errors%count > 0) return
    call set_contact_points(model, points, &
        .not. all([(case%phase(i)%contact%mixed, i=1, size(case%phase))]))
    model%tool_digest = [(tool_digest(model, t), t=1, model%n_tool)]
    pressed = .false.
    do i = 1, size(case%phase)
      pressed(case%phase(i)%press%tool) = .true.
    end do
    allocate (model%tool_row(model%n_tool), source=0)
    k = model%n_node
    do t = 1, model%n_tool
      if (.not. pressed(t)) cycle
      k = k + 1
      model%tool_row(t) = k
    end do
  end subroutine find_candidates

  !> Whether the sheet is one layer of elements with eight nodes: all nodes are at its faces. In a
  !> layer that is not bounded by both faces the couples of the forces between the nodes would bend
  !> it.
  pure logical function is_one_layer(model)
    type(model_t), intent(in) :: model

    integer :: e

    is_one_layer = model%element%n_node == 8
    do e = 1, merge(model%n_element, 0, is_one_layer)
      is_one_layer = is_one_layer &
          .and. all(model%column(2, model%connectivity(:4, e)) == model%connectivity(5:, e))
    end do
  end function is_one_layer

  !> Set the degrees of freedom that *BOUNDARY fixes, and the number of its locating pins.
  subroutine set_fixed(model, case, mesh)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh

    integer :: i

    model%n_pin = count(case%boundary%pin > 0.0_wp)
    allocate (model%fixed(3, model%n_node), source=.false.)
    do i = 1, size(case%boundary)
      call mark_directions(model%fixed, mesh%nodes_of(case%boundary(i)%set), case%boundary(i)%fix)
    end do
  end subroutine set_fixed

  !> Report supports and displacements of sets that have bound nodes only, and act nowhere.
  subroutine check_bound(mesh, case, errors)
    type(mesh_t), intent(in) :: mesh
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: i, k

    do i = 1, size(case%boundary)
      call check_set(case%boundary(i)%set, case%boundary(i)%source%at("set"))
    end do
    do i = 1, size(case%phase)
      do k = 1, size(case%phase(i)%displace)
        call check_set(case%phase(i)%displace(k)%set, case%phase(i)%displace(k)%at)
      end do
      do k = 1, size(case%phase(i)%motion)
        call check_set(case%phase(i)%motion(k)%set, case%phase(i)%motion(k)%at)
      end do
    end do

  contains

    subroutine check_set(name, at)
      character(len=*), intent(in) :: name
      type(location_t), intent(in) :: at

      integer, allocatable :: node(:)
      integer :: j

      node = mesh%nodes_of(name)
      if (size(node) == 0) return
      if (.not. all([(any(mesh%bound(1, :) == node(j)), j=1, size(node))])) return
      call errors%push_input(at, "the set '"//name//"' has only nodes in the middle of edges "// &
          "of larger elements, which follow the ends of the edges and cannot be held", &
          "nodes at corners of all their elements", code="E148")
    end subroutine check_set

  end subroutine check_bound

  !> Leave the bound nodes, also those within supported areas, to their parents.
  pure subroutine free_bound_nodes(model)
    type(model_t), intent(inout) :: model

    integer :: i, k

    if (.not. allocated(model%phase)) return
    do k = 1, model%n_bound
      do i = 1, size(model%phase)
        model%phase(i)%prescribed(:, model%bound(1, k)) = .false.
      end do
    end do
  end subroutine free_bound_nodes

  !> Set the node sets of history.csv.
  subroutine set_history(model, case, mesh)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh

    integer :: h

    allocate (model%history(size(case%history)))
    do h = 1, size(case%history)
      model%history(h)%history_quantities_t = case%history(h)%history_quantities_t
      model%history(h)%name = case%history(h)%name
      model%history(h)%node = mesh%nodes_of(case%history(h)%set)
    end do
  end subroutine set_history

end module dd3_setup_on_sheet
