! SPDX-License-Identifier: GPL-3.0-or-later
!> Build of the model from the checked case: names become numbers, and what needs the mesh or the
!> tools is checked. All errors of the input are collected.
module dd3_setup_model
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : text_buffer_t
  use dd3_input_case, only : case_t
  use dd3_mesh_inp_mesh, only : new_inp_mesh
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_fingerprint, only : sheet_digests
  use dd3_model_internal_variables, only : new_variables
  use dd3_model_model, only : model_t
  use dd3_model_redistribution, only : divide_model
  use dd3_setup_checks, only : check_solver, check_start, check_supports
  use dd3_setup_element, only : set_element
  use dd3_setup_friction, only : set_friction
  use dd3_setup_materials, only : new_materials
  use dd3_setup_on_sheet, only : set_on_sheet
  use dd3_setup_sheet, only : new_sheet
  use dd3_setup_tool_surface, only : read_tool_surface
  use dd3_sheet_curves, only : curve_t, read_curves
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: new_model, rebuild_model

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

  !> Build a model anew on another sheet, at any state of a run, not divided among the ranks. It may
  !> be used if the list holds no error. The sheet has its positions at the start of the job, and
  !> all node sets of the model, those of the sheet itself first.
  subroutine rebuild_model(model, case, sheet, errors)
    !> Built from the same case.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> The sheet; on return without its mesh.
    type(sheet_t), intent(inout) :: sheet
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    if (.not. allocated(model%first_digest)) model%first_digest = sheet_digests(model)
    call set_on_sheet(model, case, sheet, size(case%start) > 0, errors)
  end subroutine rebuild_model

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
    model%output = case%output
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
      if (case%mesh(1)%source%has("file")) then
        call new_inp_mesh(mesh, case%mesh(1), model%element%node, errors)
      end if
      return
    end if
    call new_variables(model%internal_variable, model%material)
    if (size(case%point) > 0) return
    call new_sheet(sheet, model, case, errors)
    if (errors%count > 0) return
    model%cut_warnings = sheet%warnings
    call set_on_sheet(model, case, sheet, size(case%start) > 0, errors)
    ! Set last; errors in the phases do not prevent the checks below.
    if (.not. allocated(model%history)) return
    call check_start(model, case, errors)
    call check_supports(model, case, errors)
    call divide_model(model)
  end subroutine build

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
      call set_friction(model%tool(t)%friction, case%tool(t), errors)
      model%tool(t)%compliance = case%tool(t)%compliance
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

end module dd3_setup_model
