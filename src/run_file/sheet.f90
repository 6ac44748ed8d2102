! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: the sheet, its node sets and its refinements.
module dd3_run_file_sheet
  use dd3_base_json, only : json_t
  use dd3_base_kinds, only : wp
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t
  use dd3_model_mesh_change, only : mesh_change_t
  use dd3_model_model, only : model_t
  use dd3_run_file_input, only : add_location
  use dd3_settings_output, only : fields_at, fields_every, fields_increments, output_spec_t
  implicit none
  private
  public :: add_refinements, add_sheet, add_sets

contains

  !> Add the sheet; null for single points.
  subroutine add_sheet(json, case, model)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model

    if (model%n_element == 0) then
      call json%add_null("sheet")
      return
    end if
    call json%begin_object("sheet")
    if (size(case%mesh) > 0) then
      call add_origin(json, "mesh", case%mesh(1)%name, case%mesh(1)%file, case%mesh(1)%source)
    else if (size(case%start) > 0) then
      call add_origin(json, "start", "", case%start(1)%from, case%start(1)%source)
    else if (case%blank(1)%radius > 0.0_wp) then
      call add_origin(json, "round", case%blank(1)%name, "", case%blank(1)%source)
    else
      call add_origin(json, "box", case%blank(1)%name, "", case%blank(1)%source)
    end if
    call json%add("element", trim(model%element%name))
    call json%add("elements", model%n_element)
    call json%add("nodes", model%n_node)
    call json%add("integration_points", model%element%n_point)
    call json%add("thickness", [model%thickness, model%largest_thickness()])
    call json%begin_array("box", flat=.true.)
    call json%add("", minval(model%x0, dim=2))
    call json%add("", maxval(model%x0, dim=2))
    call json%end_array()
    call json%add("contact_points", model%part%n_point)
    call json%end_object()
  end subroutine add_sheet

  !> Add where a sheet comes from.
  subroutine add_origin(json, kind, name, file, source)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: kind, name
    !> Mesh file; empty for a blank.
    character(len=*), intent(in) :: file
    type(block_t), intent(in) :: source

    call json%add("kind", kind)
    call json%add("name", name)
    call json%add_optional("file", file)
    call add_location(json, "at", source%opened)
  end subroutine add_origin

  !> Add the node sets.
  subroutine add_sets(json, model)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model

    integer :: i

    call json%begin_array("sets")
    if (allocated(model%set)) then
      do i = 1, size(model%set)
        call json%begin_object("", flat=.true.)
        call json%add("name", model%set(i)%name)
        call json%add("nodes", size(model%set(i)%node))
        call json%end_object()
      end do
    end if
    call json%end_array()
  end subroutine add_sets

  !> Add the refinements since the start of the job.
  subroutine add_refinements(json, model)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model

    integer :: i

    call json%begin_array("refinements")
    if (allocated(model%change)) then
      do i = 1, size(model%change)
        call add_refinement(json, model%change(i), model%phase(model%change(i)%phase)%name)
      end do
    end if
    call json%end_array()
  end subroutine add_refinements

  !> Add a refinement.
  subroutine add_refinement(json, change, phase)
    type(json_t), intent(inout) :: json
    type(mesh_change_t), intent(in) :: change
    !> Name of its phase.
    character(len=*), intent(in) :: phase

    call json%begin_object("", flat=.true.)
    call json%add("phase", phase)
    call json%add("increment", change%increment)
    call json%add("progress", change%progress)
    call json%add("travel", change%travel)
    call json%add("elements_before", change%before)
    call json%add("elements", change%after)
    call json%add("elements_of_level", change%of_level(:change%top_level()))
    call json%add("imbalance", change%imbalance)
    call json%add("repeated", change%repeats)
    call json%end_object()
  end subroutine add_refinement

end module dd3_run_file_sheet
