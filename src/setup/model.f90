! SPDX-License-Identifier: GPL-3.0-or-later
!> Build of the model from the checked case: names become numbers, and what needs the mesh or the
!> tools is checked. All errors of the input are collected.
module dd3_setup_model
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : n_ranks
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_text, only : same_name, text_buffer_t, to_text
  use dd3_element_kinematics, only : element_gradients
  use dd3_element_work, only : element_work_t, new_element_work
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_input_case, only : case_t
  use dd3_input_known_name, only : check_known_name
  use dd3_linalg_solver_registry, only : missing_package, solver_names
  use dd3_mesh_build, only : add_sets, new_mesh
  use dd3_mesh_inp_mesh, only : new_inp_mesh
  use dd3_mesh_mesh, only : mark_directions, mesh_t
  use dd3_model_contact_points, only : keep_own_points, set_contact_points
  use dd3_model_contact_results, only : candidate_hits
  use dd3_setup_drawbeads, only : new_drawbeads
  use dd3_model_fingerprint, only : tool_digest
  use dd3_setup_held_loads, only : check_loads
  use dd3_model_internal_variables, only : new_variables
  use dd3_setup_materials, only : new_materials
  use dd3_model_model, only : model_t
  use dd3_model_part, only : new_part
  use dd3_setup_phases, only : new_phases
  use dd3_model_rigid_motion, only : new_supported_part, part_name, parts_of_nodes, &
      rigid_motion_t
  use dd3_model_rim, only : set_rim
  use dd3_setup_element, only : set_element, set_element_of_mesh
  use dd3_model_sheet_faces, only : new_sheet_faces
  use dd3_setup_axes, only : set_axes
  use dd3_model_thickness_columns, only : set_columns, set_thickness
  use dd3_model_tolerances, only : new_tolerances, start_depth, wrong_side_depth
  use dd3_setup_tool_surface, only : read_tool_surface
  use dd3_sheet_curves, only : curve_t, read_curves
  use dd3_sheet_sheet, only : new_flat_sheet, sheet_t
  use dd3_sheet_trim, only : trim_sheet
  use dd3_tools_closest, only : hit_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: new_model

contains

  !> Build the model. It may be used if the list holds no error. Of a case with errors only the laws
  !> and the tool files are checked, to report their errors with the others. A case of material
  !> points has no mesh; its model holds the materials.
  subroutine new_model(model, case, errors, start)
    type(model_t), intent(out) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors
    !> The sheet of another run where the case starts from one; on return that of the model, without
    !> its mesh.
    type(sheet_t), intent(inout), optional :: start

    type(sheet_t) :: sheet

    if (present(start)) then
      call build(model, case, start, errors)
    else
      call build(model, case, sheet, errors)
    end if
  end subroutine new_model

  !> Build the model; see `new_model`.
  subroutine build(model, case, sheet, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> The sheet of another run on entry, if the case starts from one; that of the model on return.
    type(sheet_t), intent(inout) :: sheet
    type(error_list_t), intent(inout) :: errors

    type(mesh_t) :: mesh
    type(curve_t), allocatable :: curve(:)
    integer :: i

    call set_title(model, case)
    call set_element(model, case, sheet, errors)
    call check_solver(case, errors)
    call new_materials(model, case, errors)
    call read_tools(model, case, errors)
    if (errors%count > 0) then
      ! The files of curves and the mesh file of an input with errors are read to report their
      ! errors with the others.
      do i = 1, size(case%trim)
        if (case%trim(i)%source%valid) call read_curves(curve, case%trim(i), errors)
      end do
      if (model%element%n_node == 0 .or. size(case%mesh) /= 1) return
      if (case%mesh(1)%source%has("file")) &
          call new_inp_mesh(mesh, case%mesh(1), model%element%node, errors)
      return
    end if
    call new_variables(model%internal_variable, model%material)
    if (size(case%point) > 0) return
    call new_sheet(sheet, model, case, errors)
    if (errors%count > 0) return
    if (size(case%start) > 0) model%x_start = sheet%x
    mesh = sheet%mesh
    sheet%mesh = mesh_t()
    model%n_sheet_set = size(mesh%set)
    call add_sets(mesh, case, errors)
    if (errors%count > 0) return
    call set_mesh(model, case, mesh, errors)
    if (errors%count > 0) return
    call set_axes(model, case, errors)
    if (errors%count > 0) return
    call find_candidates(model, case, mesh, errors)
    if (errors%count > 0) return
    allocate (model%fixed(3, model%n_node), source=.false.)
    do i = 1, size(case%boundary)
      call mark_directions(model%fixed, mesh%nodes_of(case%boundary(i)%set), case%boundary(i)%fix)
    end do
    call set_rim(model)
    call new_drawbeads(model, case, errors)
    if (errors%count > 0) return
    call new_phases(model, case, mesh, errors)
    call check_loads(model, case, errors)
    call set_output(model, case, mesh)
    call check_start(model, case, errors)
    call check_supports(model, case, errors)
    call keep_own_points(model)
  end subroutine build

  !> Make the sheet, that of the blank, of the mesh file or of another run, and cut it.
  subroutine new_sheet(sheet, model, case, errors)
    !> The sheet of another run on entry, if the case starts from one.
    type(sheet_t), intent(inout) :: sheet
    !> With its materials and, but for the default of a mesh from a file, its element.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(mesh_t) :: mesh
    integer :: i

    if (size(case%start) > 0) then
      call match_materials(sheet, model, case, errors)
    else
      call new_mesh(mesh, case, model%element%node, errors)
      if (errors%count == 0) call set_element_of_mesh(model, case, mesh, errors)
      if (errors%count == 0) call new_flat_sheet(sheet, mesh)
    end if
    do i = 1, size(case%trim)
      if (errors%count == 0) call trim_sheet(sheet, case%trim(i), model%element, errors)
    end do
  end subroutine new_sheet

  !> Find the materials of the sheet of another run among those of the case, by their names; they
  !> must have the same laws.
  subroutine match_materials(sheet, model, case, errors)
    !> Its elements get the positions in `case%material`.
    type(sheet_t), intent(inout) :: sheet
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: position(size(sheet%material)), i, m

    ! A sheet of another program has no check sums.
    position = 0
    do i = 1, size(position)
      if (.not. any(sheet%mesh%material == i)) cycle
      associate (name => sheet%material(i)%s)
        do m = size(model%material), 1, -1
          if (same_name(trim(model%material_name(m)), name)) exit
        end do
        position(i) = m
        if (m == 0) then
          call errors%push_input(case%start(1)%source%at("from"), "the sheet is of material '"// &
              name//"', which this input does not define", "*MATERIAL "//name// &
              " as in the input of that run", code="E152")
        else if (all(sheet%digest(i) /= [0, model%material_digest(m)])) then
          call errors%push_input(case%material(m)%source%opened, "material '"//name// &
              "' differs from that of the sheet, of '"//case%start(1)%from//"'", &
              "*MATERIAL "//name//" as in the input of that run", code="E152")
        end if
      end associate
    end do
    if (errors%count == 0) sheet%mesh%material = position(sheet%mesh%material)
  end subroutine match_materials

  !> Report a linear solver that is not in the registry or not in this build, and one that cannot
  !> keep its factors on the disk.
  subroutine check_solver(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: package
    integer :: position, ranks

    if (case%solver%method == "") return
    call check_known_name(case%solver%method, case%solver%method_at, "linear solver", &
        solver_names(), position, errors)
    package = missing_package(case%solver%method)
    if (package /= "") call errors%push_input(case%solver%method_at, "the program was built "// &
        "without the linear solver '"//case%solver%method//"'", "another one, or a program "// &
        "built with the package "//package, code="E116")
    if (case%solver%factors /= "disk" .or. index(case%solver%method, "mumps") > 0) return
    ranks = n_ranks()
    ! On several ranks this is petsc_mumps.
    if (ranks > 1 .and. case%solver%method == "auto") return
    call errors%push_input(case%solver%factors_at, "the linear solver '"//case%solver%method// &
        "' keeps its factors in the memory", "method = mumps or petsc_mumps", code="E148")
  end subroutine check_solver

  !> Join the lines of the title.
  subroutine set_title(model, case)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case

    type(text_buffer_t) :: buffer
    integer :: i

    do i = 1, size(case%title)
      if (i > 1) call buffer%add(" ")
      call buffer%add(trim(adjustl(case%title(i)%s)))
    end do
    model%title = buffer%text()
  end subroutine set_title

  !> Read the surfaces of the tools; report them if the element's faces cannot be in contact.
  subroutine read_tools(model, case, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: t

    model%n_tool = size(case%tool)
    allocate (model%tool(model%n_tool))
    do t = 1, model%n_tool
      if (.not. (case%tool(t)%source%valid .and. case%tool(t)%source%has("patches"))) cycle
      model%tool(t)%name = case%tool(t)%name
      model%tool(t)%friction = case%tool(t)%friction
      model%tool(t)%position = case%tool(t)%position
      call read_tool_surface(model%tool(t)%surface, case%tool(t)%patches, &
          case%tool(t)%source%at("patches"), errors)
    end do
    if (model%element%n_node == 0) return
    if (all(model%element%face_weight > 0.0_wp)) return
    do t = 1, model%n_tool
      if (.not. case%tool(t)%source%has("contact")) cycle
      call errors%push_input(case%tool(t)%source%at("contact"), "the element "// &
          trim(model%element%name)//" cannot be in contact: pressure on its faces pulls at the "// &
          "corners", "no tools, or an element whose nodes all push: hex8, hex27 or solid_shell", &
          code="E148")
    end do
  end subroutine read_tools

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
    allocate (model%set(size(mesh%set)))
    do i = 1, size(mesh%set)
      model%set(i)%name = mesh%set(i)%name
      model%set(i)%node = mesh%set(i)%node
    end do
    call new_sheet_faces(model%face, model%element, mesh%connectivity)
    model%material_of = mesh%material
    call new_part(model%part, mesh%n_node, mesh%connectivity)
    call set_columns(model)
    if (model%element%n_enhanced > 0) &
        model%element%stacked = any([(all(model%column(:, i) /= i), i=1, model%n_node)])
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

  !> Set the outputs and the node sets of history.csv.
  subroutine set_output(model, case, mesh)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh

    integer :: h

    model%output = case%output
    allocate (model%history(size(case%history)))
    do h = 1, size(case%history)
      model%history(h)%history_quantities_t = case%history(h)%history_quantities_t
      model%history(h)%name = case%history(h)%name
      model%history(h)%node = mesh%nodes_of(case%history(h)%set)
    end do
  end subroutine set_output

  !> Report a tool that starts inside the sheet, and one whose normals all point away from it.
  subroutine check_start(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(hit_t), allocatable :: hit(:)
    integer :: c, t, nearest, worst

    do t = 1, model%n_tool
      associate (distance => model%tolerance%start_search)
        hit = candidate_hits(model, t, placement_t(translation=model%tool(t)%position), &
            model%start_positions(), &
            distance, distance)
      end associate
      nearest = minloc(abs(hit%distance), dim=1, mask=hit%found)
      worst = minloc(hit%distance, dim=1, mask=hit%found .and. hit%distance < -start_depth &
          .and. hit%distance >= [(-wrong_side_depth*model%thickness_at(model%contact_node(c)), &
          c=1, model%n_contact)])
      if (worst == 0) then
        if (nearest == 0) cycle
        if (hit(nearest)%distance >= -start_depth) cycle
        call errors%push_input(case%tool(t)%source%opened, "tool '" &
            //case%tool(t)%source%called()//"' turns away from the sheet, "// &
            to_text(-hit(nearest)%distance, 4)//" mm off", &
            "patches whose normals (the cross product of their u and v) point to the sheet", &
            code="E142")
        cycle
      end if
      call errors%push_input(case%tool(t)%source%opened, "tool '"//case%tool(t)%source%called()// &
          "' starts inside the sheet: node "//to_text(model%contact_node(worst))//" is "// &
          to_text(-hit(worst)%distance, 4)//" mm deep in it", &
          "a start no deeper than 0.001 mm (see position), normals that point to the sheet", &
          code="E142")
    end do
  end subroutine check_start

  !> Report the first phase in which the sheet, or a part of it, is free to move as a rigid body and
  !> no tool is active.
  subroutine check_supports(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(rigid_motion_t) :: body
    character(len=:), allocatable :: motion
    integer :: part(model%n_node), i, k

    part = parts_of_nodes(model%connectivity, model%n_node)
    do i = 1, size(model%phase)
      if (any(model%phase(i)%active .and. .not. model%phase(i)%withdrawn)) cycle
      do k = 1, maxval(part)
        call new_supported_part(body, model%start_positions(), model%phase(i)%held(), part == k)
        motion = body%free_motion()
        if (len(motion) == 0) cycle
        call errors%push_input(case%phase(i)%source%opened, "nothing holds "// &
            part_name(part, k)//" in phase '"//case%phase(i)%source%called()// &
            "': it is free to "//motion, &
            "supports by *BOUNDARY or displace, a tool that is not released, or unload = on", &
            code="E143")
        return
      end do
    end do
  end subroutine check_supports

end module dd3_setup_model
