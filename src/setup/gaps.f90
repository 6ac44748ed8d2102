! SPDX-License-Identifier: GPL-3.0-or-later
!> Gaps between tools at the end of a phase.
module dd3_setup_gaps
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_progress_table, only : table_value
  use dd3_settings_until, only : until_never
  use dd3_tools_separation, only : offset_at_gap
  implicit none
  private
  public :: check_place, offset_of_gap, set_gaps

contains

  !> Set the displacements at which tools have the gaps of the input.
  subroutine set_gaps(model, case, errors)
    !> With its tools and phases.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: gap
    logical :: found
    integer :: i, k, before

    do i = 1, size(case%phase)
      do k = 1, size(case%phase(i)%gap)
        associate (spec => case%phase(i)%gap(k))
          gap = spec%value
          if (spec%in_thicknesses) gap = gap*model%largest_thickness()
          before = errors%count
          call check_place(model, i, spec%tool, "gap", spec%at, errors)
          call check_place(model, i, spec%other, "gap", spec%at, errors)
          if (errors%count > before) cycle
          associate (tool => model%tool(spec%tool), other => model%tool(spec%other))
            call offset_of_gap(model, i, spec%tool, spec%other, gap, &
                model%phase(i)%gap_offset(spec%tool), found)
            if (.not. found) call errors%push_input(spec%at, "no displacement along z gives "// &
                "this gap between '"//tool%name//"' and '"//other%name//"'", &
                "two tools whose surfaces face each other along z", code="E144")
          end associate
        end associate
      end do
    end do
  end subroutine set_gaps

  !> Report a gap or a spacer of a tool whose place along x and y is not known beforehand.
  subroutine check_place(model, phase, tool, what, at, errors)
    type(model_t), intent(in) :: model
    !> Number of the phase, and of the tool.
    integer, intent(in) :: phase, tool
    !> What is placed, and where the input says so.
    character(len=*), intent(in) :: what
    type(location_t), intent(in) :: at
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: cause
    integer :: i

    do i = 1, phase
      associate (earlier => model%phase(i))
        cause = ""
        if (earlier%pressed(tool)) then
          if (any(abs(earlier%direction(:2, tool)) > 0.0_wp)) cause = "presses"
        else if (i < phase .and. earlier%until%kind /= until_never) then
          if (any(abs(earlier%move(:2, tool)) > 0.0_wp)) cause = "may end early (until) and moves"
        end if
        if (cause == "") cycle
        call errors%push_input(at, "the "//what//" is not known beforehand, as phase '"// &
            earlier%name//"' "//cause//" tool '"//model%tool(tool)%name//"' along x or y", &
            "moves along x and y that end as given", code="E144")
        return
      end associate
    end do
  end subroutine check_place

  !> Find z of the displacement of a tool relative to another one at which their gap has a value at
  !> the end of a phase, mm.
  subroutine offset_of_gap(model, phase, tool, other, gap, offset, found)
    type(model_t), intent(in) :: model
    !> Number of the phase, and of the tools.
    integer, intent(in) :: phase, tool, other
    real(wp), intent(in) :: gap
    real(wp), intent(out) :: offset
    !> False if the surfaces do not face each other along z.
    logical, intent(out) :: found

    real(wp) :: start(3)

    start = model%tool(tool)%position - model%tool(other)%position
    start(:2) = start(:2) + aside(model, phase, tool) - aside(model, phase, other)
    call offset_at_gap(model%tool(tool)%surface, model%tool(other)%surface, start, gap, offset, &
        found)
  end subroutine offset_of_gap

  !> Return how far `move` has moved a tool along x and y at the end of a phase, at the factor 1 of
  !> its table, mm.
  pure function aside(model, phase, tool)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: phase
    integer, intent(in) :: tool
    real(wp) :: aside(2)

    integer :: i

    aside = model%phase(phase)%move(:2, tool)
    do i = 1, phase - 1
      ! A tool that the program withdraws is put back.
      if (model%phase(i)%goes_back(tool)) cycle
      aside = aside + table_value(model%phase(i)%move_table, 1.0_wp) &
          *model%phase(i)%move(:2, tool)
    end do
  end function aside

end module dd3_setup_gaps
