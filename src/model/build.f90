!> Builds the model from the checked case: every name becomes a number, and what only the model can
!> tell is checked, all errors of the input together.
module dd3_model_build
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, error_t
  use dd3_base_text, only : to_text
  use dd3_contact_closest, only : find_contact, hint_t, hit_t
  use dd3_element_kinematics, only : element_gradients
  use dd3_element_registry, only : element_count, element_name, new_element
  use dd3_element_work, only : element_work_t, new_element_work
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_input_case, only : case_t, fields_at, fields_every, fields_increments
  use dd3_input_known_name, only : check_known_name
  use dd3_mesh_build, only : new_mesh
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_materials, only : new_materials
  use dd3_model_model, only : model_t
  use dd3_model_phases, only : new_phases
  use dd3_model_points, only : new_points
  use dd3_model_rigid_motion, only : new_rigid_motion, rigid_motion_t
  use dd3_model_tool_surface, only : read_tool_surface
  implicit none
  private
  public :: new_model

  !> How deep inside the sheet a tool may start, mm.
  real(wp), parameter :: start_depth = 1.0e-3_wp
  !> How deep a start inside the sheet is looked for, in thicknesses: farther behind a surface a
  !> node may well lie beyond its border.
  real(wp), parameter :: reach = 10.0_wp
  !> How far a tool is looked for that turns away from the sheet, mm.
  real(wp), parameter :: far = 1.0e4_wp

contains

  !> Builds the model; it may be used where the list holds no error. Of a case with errors only the
  !> laws and the tools' files are checked, so that what is wrong with them is reported with the
  !> rest.
  subroutine new_model(model, case, errors)
    !> The model made.
    type(model_t), intent(out) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> Receives what is wrong.
    type(error_list_t), intent(inout) :: errors

    type(mesh_t) :: mesh

    call take_title(model, case)
    call check_element(case, errors)
    call new_materials(model, case, errors)
    call read_tools(model, case, errors)
    if (errors%count > 0) return
    call new_points(model, case)
    if (size(model%point) > 0) return
    call new_mesh(mesh, case, errors)
    if (errors%count > 0) return
    call take_mesh(model, case, mesh, errors)
    if (errors%count > 0) return
    call find_candidates(model, case, mesh)
    call take_supports(model, case, mesh)
    call new_phases(model, case, mesh)
    call take_output(model, case, mesh)
    call check_start(model, case, errors)
    call check_supports(model, case, errors)
  end subroutine new_model

  !> Report an element type that is not in the registry.
  subroutine check_element(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    character(len=len(element_name(1))) :: known(element_count)
    integer :: b, i, position

    known = [(element_name(i), i=1, element_count)]
    do b = 1, size(case%blank)
      if (.not. case%blank(b)%source%has("element")) cycle
      call check_known_name(case%blank(b)%element, case%blank(b)%source%at("element"), &
          "element type", known, position, errors)
    end do
  end subroutine check_element

  !> Joins the lines of the title.
  subroutine take_title(model, case)
    !> The model.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case

    integer :: i

    model%title = ""
    do i = 1, size(case%title)
      if (i > 1) model%title = model%title//" "
      model%title = model%title//trim(adjustl(case%title(i)%s))
    end do
  end subroutine take_title

  !> Reads the tools' surfaces.
  subroutine read_tools(model, case, errors)
    !> The model.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> Receives what is wrong with the files.
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
  end subroutine read_tools

  !> Takes nodes and elements over and checks that no element is inside out.
  subroutine take_mesh(model, case, mesh, errors)
    !> The model.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Receives what is wrong.
    type(error_list_t), intent(inout) :: errors

    type(element_work_t) :: work
    type(error_t), allocatable :: error
    type(verdict_t) :: verdict
    integer :: e

    call new_element(model%element, mesh%element, error)
    if (allocated(error)) then
      call errors%push_input(case%blank(1)%source%at("element"), error%message)
      return
    end if
    model%n_node = mesh%n_node
    model%n_element = mesh%n_element
    model%x0 = mesh%x
    model%connectivity = mesh%connectivity
    model%material_of = mesh%material
    model%thickness = mesh%thickness
    model%contact_depth = 0.5_wp*mesh%thickness
    call new_element_work(work, model%element)
    do e = 1, model%n_element
      call element_gradients(model%element, model%x0(:, model%connectivity(:, e)), work, verdict)
      if (verdict%outcome == verdict_converged) cycle
      call errors%push_input(case%blank(1)%source%opened, "element "//to_text(e)// &
          " has no volume", "a blank whose node lines do not cross")
      return
    end do
  end subroutine take_mesh

  !> Numbers the nodes that may touch a tool, and the block rows of the tools that are pressed in
  !> some phase.
  subroutine find_candidates(model, case, mesh)
    !> The model.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> The mesh.
    type(mesh_t), intent(in) :: mesh

    logical, allocatable :: member(:, :)
    integer :: t, i, k

    allocate (member(model%n_tool, model%n_node), source=.false.)
    do t = 1, model%n_tool
      member(t, mesh%nodes_of(case%tool(t)%contact)) = .true.
    end do
    model%contact_node = pack([(i, i=1, model%n_node)], any(member, dim=1))
    model%n_contact = size(model%contact_node)
    model%candidate = member(:, model%contact_node)
    allocate (model%candidate_of(model%n_node), source=0)
    model%candidate_of(model%contact_node) = [(i, i=1, model%n_contact)]
    allocate (model%tool_block(model%n_tool), source=0)
    k = model%n_node
    do t = 1, model%n_tool
      if (.not. is_pressed(case, t)) cycle
      k = k + 1
      model%tool_block(t) = k
    end do
  end subroutine find_candidates

  !> Whether a force is put on the tool in some phase.
  pure logical function is_pressed(case, tool)
    !> The case.
    type(case_t), intent(in) :: case
    !> The tool.
    integer, intent(in) :: tool

    integer :: i

    is_pressed = .false.
    do i = 1, size(case%phase)
      is_pressed = is_pressed .or. any(case%phase(i)%press%tool == tool)
    end do
  end function is_pressed

  !> Takes the supports that hold in every phase.
  subroutine take_supports(model, case, mesh)
    !> The model.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> The mesh.
    type(mesh_t), intent(in) :: mesh

    integer, allocatable :: node(:)
    integer :: b, i

    allocate (model%fixed(3, model%n_node), source=.false.)
    do b = 1, size(case%boundary)
      node = mesh%nodes_of(case%boundary(b)%set)
      do i = 1, 3
        if (case%boundary(b)%fix(i)) model%fixed(i, node) = .true.
      end do
    end do
  end subroutine take_supports

  !> Takes the output settings and the node sets of the history table.
  subroutine take_output(model, case, mesh)
    !> The model.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> The mesh.
    type(mesh_t), intent(in) :: mesh

    integer :: h

    model%output%history_every = case%output%history
    select case (case%output%fields)
    case (fields_every)
      model%output%fields_every = case%output%fields_value(1)
    case (fields_at)
      model%output%fields_at = case%output%fields_value
    case (fields_increments)
      model%output%fields_increments = nint(case%output%fields_value(1))
    end select
    allocate (model%history(size(case%history)))
    do h = 1, size(case%history)
      model%history(h)%name = case%history(h)%name
      model%history(h)%node = mesh%nodes_of(case%history(h)%set)
      model%history(h)%displacement = case%history(h)%displacement
      model%history(h)%reaction = case%history(h)%reaction
      model%history(h)%position = case%history(h)%position
    end do
  end subroutine take_output

  !> Refuses a tool that starts inside the sheet, and one whose normals all turn away from it.
  subroutine check_start(model, case, errors)
    !> The model.
    type(model_t), intent(in) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> Receives what is wrong.
    type(error_list_t), intent(inout) :: errors

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: deepest, nearest
    integer :: c, t, node, worst

    do t = 1, model%n_tool
      deepest = -start_depth
      nearest = far
      worst = 0
      do c = 1, model%n_contact
        if (.not. model%candidate(t, c)) cycle
        node = model%contact_node(c)
        hint = hint_t()
        call find_contact(model%tool(t)%surface, model%x0(:, node) - model%tool(t)%position, hint, &
                          far, far, hit)
        if (.not. hit%found) cycle
        if (abs(hit%distance) < abs(nearest)) nearest = hit%distance
        if (hit%distance >= deepest .or. hit%distance < -reach*model%thickness) cycle
        deepest = hit%distance
        worst = node
      end do
      if (worst == 0 .and. nearest < -start_depth) then
        call errors%push_input(case%tool(t)%source%opened, "tool '" &
            //case%tool(t)%source%called()//"' turns away from the sheet, "// &
            to_text(-nearest, 4)//" mm off", &
            "patches whose normals (the cross product of their u and v) point to the sheet")
      end if
      if (worst == 0) cycle
      call errors%push_input(case%tool(t)%source%opened, "tool '"//case%tool(t)%source%called()// &
          "' starts inside the sheet: node "//to_text(worst)//" is "//to_text(-deepest, 4)// &
          " mm deep in it", &
          "a start no deeper than 0.001 mm (see position), normals that point to the sheet")
    end do
  end subroutine check_start

  !> Refuses the first phase in which the sheet is free to move as a rigid body and no tool is there
  !> to hold it.
  subroutine check_supports(model, case, errors)
    !> The model.
    type(model_t), intent(in) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> Receives what is wrong.
    type(error_list_t), intent(inout) :: errors

    type(rigid_motion_t) :: body
    character(len=:), allocatable :: motion
    integer :: i

    do i = 1, size(model%phase)
      if (any(model%phase(i)%active)) cycle
      call new_rigid_motion(body, model%x0)
      call body%hold_prescribed(model%x0, model%phase(i)%prescribed)
      motion = body%free_motion()
      if (len(motion) == 0) cycle
      call errors%push_input(case%phase(i)%source%opened, "nothing holds the sheet in phase '"// &
          case%phase(i)%source%called()//"': it is free to "//motion, &
          "supports by *BOUNDARY or displace, or a tool that is not released")
      return
    end do
  end subroutine check_supports

end module dd3_model_build
