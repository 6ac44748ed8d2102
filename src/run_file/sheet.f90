! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: the sheet, its node sets and supports, what is recorded.
module dd3_run_file_sheet
  use dd3_base_json, only : json_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : axis_name
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t
  use dd3_model_model, only : fields_at, fields_every, fields_increments, history_set_t, &
      model_t, output_spec_t
  use dd3_run_file_input, only : add_location
  implicit none
  private
  public :: add_sheet, add_sets, add_boundaries, add_histories, add_output, add_axes

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

  !> Add the supports of the input.
  subroutine add_boundaries(json, case)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case

    integer :: i

    call json%begin_array("boundaries")
    do i = 1, size(case%boundary)
      call json%begin_object("", flat=.true.)
      call json%add("name", case%boundary(i)%name)
      call json%add("set", case%boundary(i)%set)
      call add_axes(json, "fix", case%boundary(i)%fix)
      call add_location(json, "at", case%boundary(i)%source%opened)
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_boundaries

  !> Add the names of some axes.
  subroutine add_axes(json, name, chosen)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    logical, intent(in) :: chosen(3)

    integer :: axis

    call json%begin_array(name, flat=.true.)
    do axis = 1, 3
      if (chosen(axis)) call json%add("", axis_name(axis))
    end do
    call json%end_array()
  end subroutine add_axes

  !> Add the additional columns of history.csv.
  subroutine add_histories(json, case, model)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model

    integer :: i

    call json%begin_array("histories")
    if (allocated(model%history)) then
      do i = 1, size(model%history)
        call json%begin_object("", flat=.true.)
        call json%add("name", model%history(i)%name)
        call json%add("set", case%history(i)%set)
        call add_quantities(json, model%history(i))
        call add_location(json, "at", case%history(i)%source%opened)
        call json%end_object()
      end do
    end if
    call json%end_array()
  end subroutine add_histories

  subroutine add_quantities(json, history)
    type(json_t), intent(inout) :: json
    type(history_set_t), intent(in) :: history

    call json%begin_array("quantities", flat=.true.)
    if (history%displacement) call json%add("", "displacement")
    if (history%reaction) call json%add("", "reaction")
    if (history%position) call json%add("", "position")
    if (history%moment) call json%add("", "moment")
    if (history%draw_in) call json%add("", "draw_in")
    call json%end_array()
  end subroutine add_quantities

  !> Add what is written, and when.
  subroutine add_output(json, output)
    type(json_t), intent(inout) :: json
    type(output_spec_t), intent(in) :: output

    real(wp) :: none(0)

    call json%begin_object("output", flat=.true.)
    call json%add("history", output%history)
    if (output%fields == fields_every) then
      call json%add("fields_every", output%fields_value(1))
    else
      call json%add_null("fields_every")
    end if
    if (output%fields == fields_at) then
      call json%add("fields_at", output%fields_value)
    else
      call json%add("fields_at", none)
    end if
    if (output%fields == fields_increments) then
      call json%add("fields_increments", nint(output%fields_value(1)))
    else
      call json%add_null("fields_increments")
    end if
    call json%add("restart", output%restart)
    if (output%restart_every > 0) then
      call json%add("restart_every", output%restart_every)
    else
      call json%add_null("restart_every")
    end if
    call json%end_object()
  end subroutine add_output

end module dd3_run_file_sheet
