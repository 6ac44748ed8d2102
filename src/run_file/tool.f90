! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: tools and draw-beads.
module dd3_run_file_tool
  use dd3_base_json, only : json_t
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_terms_drawbead, only : drawbead_t
  use dd3_report_settings_report, only : initial_bead_lengths
  use dd3_run_file_input, only : add_location
  use dd3_setup_tool_report, only : near_gap
  use dd3_tools_joints, only : new_surface_report, surface_report_t
  implicit none
  private
  public :: add_tools, add_drawbeads

contains

  !> Add the tools.
  subroutine add_tools(json, case, model)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model

    integer :: t

    call json%begin_array("tools")
    do t = 1, model%n_tool
      associate (tool => case%tool(t))
        call json%begin_object("")
        call json%add("name", tool%name)
        call json%add("patches", tool%patches)
        call json%add("n_patch", size(model%tool(t)%surface%patch))
        call json%add("friction", tool%friction)
        call json%add("contact", tool%contact)
        call json%add("candidates", model%n_candidate(t))
        call json%add("position", tool%position)
        call add_edges(json, model, t)
        call add_location(json, "at", tool%source%opened)
        call json%end_object()
      end associate
    end do
    call json%end_array()
  end subroutine add_tools

  !> Add the joints of a tool's patches.
  subroutine add_edges(json, model, tool)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool

    type(surface_report_t) :: report

    call new_surface_report(report, model%tool(tool)%surface, near_gap*model%thickness)
    call json%begin_object("edges", flat=.true.)
    call json%add("joined", report%n_joined)
    call json%add("open", report%n_open)
    call json%add("near_misses", size(report%near_miss))
    call json%add("t_junctions", size(report%t_junction, 2))
    call json%add("kinks", report%n_kink)
    call json%add("poles", report%n_pole)
    call json%end_object()
  end subroutine add_edges

  !> Add the draw-beads.
  subroutine add_drawbeads(json, case, model)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model

    real(wp), allocatable :: length(:)
    integer :: b

    length = initial_bead_lengths(model)
    call json%begin_array("drawbeads")
    do b = 1, size(length)
      associate (bead => model%drawbead(b), spec => case%drawbead(b))
        call json%begin_object("")
        call json%add("name", bead%name)
        call add_line(json, bead)
        call json%add("force", spec%force)
        call json%add("normal", spec%normal)
        call add_pairs(json, "table", reshape(spec%table, [2, size(spec%table)/2]))
        if (spec%tool > 0) then
          call json%add("tool", case%tool(spec%tool)%name)
        else
          call json%add_null("tool")
        end if
        call json%add("length", bead%length())
        call json%add("length_on_sheet", length(b))
        call add_location(json, "at", spec%source%opened)
        call json%end_object()
      end associate
    end do
    call json%end_array()
  end subroutine add_drawbeads

  !> Add the vertices of a bead: the ends of its intervals where its direction changes.
  subroutine add_line(json, bead)
    type(json_t), intent(inout) :: json
    type(drawbead_t), intent(in) :: bead

    !> Sine of the angle between parallel intervals.
    real(wp), parameter :: straight = 1.0e-9_wp
    real(wp) :: before(2), here(2)
    integer :: i, n

    n = size(bead%line, 3)
    call json%begin_array("points", flat=.true.)
    call json%add("", bead%line(:, 1, 1))
    do i = 2, n
      before = bead%line(:, 2, i - 1) - bead%line(:, 1, i - 1)
      here = bead%line(:, 2, i) - bead%line(:, 1, i)
      if (abs(before(1)*here(2) - before(2)*here(1)) <= straight*norm2(before)*norm2(here) &
          .and. dot_product(before, here) > 0.0_wp) cycle
      call json%add("", bead%line(:, 1, i))
    end do
    call json%add("", bead%line(:, 2, n))
    call json%end_array()
  end subroutine add_line

  !> Add the columns of an array.
  subroutine add_pairs(json, name, pair)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    !> `(2, n)`.
    real(wp), intent(in) :: pair(:, :)

    integer :: i

    call json%begin_array(name, flat=.true.)
    do i = 1, size(pair, 2)
      call json%add("", pair(:, i))
    end do
    call json%end_array()
  end subroutine add_pairs

end module dd3_run_file_tool
