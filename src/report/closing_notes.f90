! SPDX-License-Identifier: GPL-3.0-or-later
!> Notes and warnings on a sheet that is formed to the tools or not, and on one beyond a holder.
module dd3_report_closing_notes
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : to_text
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_closing, only : closing_t, place_t, punch_t
  implicit none
  private
  public :: add_closing_notes

  !> Path that is left, and distance from the tools, from which on the sheet is not formed, and
  !> distance beyond a holder that is reported, in thicknesses. Tools made by `dd3 tool` leave 0.1.
  real(wp), parameter :: open_path = 0.2_wp, off_tools = 0.1_wp, notable_beyond = 1.0_wp
  !> Least slide of the sheet under a punch that is reported, in thicknesses.
  real(wp), parameter :: notable_slide = 0.5_wp

contains

  !> Add what the measures say: a note on a formed sheet, warnings on one that is not formed, and on
  !> one that lies beyond a holder, once.
  subroutine add_closing_notes(model, state, closing, before, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(closing_t), intent(in) :: closing
    !> Those of the phases before.
    type(closing_t), intent(in) :: before(:)
    type(message_list_t), intent(inout) :: notes

    real(wp) :: beyond_holder
    integer :: i, k

    beyond_holder = notable_beyond*model%thickness
    do i = 1, size(closing%punch)
      if (closing%punch(i)%floor%node > 0) then
        call add_punch_note(model, state, closing%punch(i), notes)
      end if
      call add_slide(model, state, closing%punch(i), before, notes)
    end do
    do i = 1, size(closing%holder)
      associate (beyond => closing%holder(i)%beyond, tool => closing%holder(i)%tool)
        if (beyond%distance <= beyond_holder) cycle
        if (any([(lay_beyond(before(k), tool, beyond_holder), k=1, size(before))])) cycle
        call notes%add_new("W120", "in phase '"//model%phase(state%phase)%name//"' the rim of "// &
            "the sheet lies up to "//to_text(beyond%distance, 3)//" mm beyond holder '"// &
            model%tool(tool)%name//"', at "//name_of(beyond)//": nothing holds it down there")
      end associate
    end do
  end subroutine add_closing_notes

  !> Whether the sheet lay farther beyond a holder than a distance, mm.
  pure logical function lay_beyond(closing, tool, distance)
    type(closing_t), intent(in) :: closing
    integer, intent(in) :: tool
    real(wp), intent(in) :: distance

    lay_beyond = .false.
    if (.not. allocated(closing%holder)) return
    lay_beyond = any(closing%holder%tool == tool .and. closing%holder%beyond%distance > distance)
  end function lay_beyond

  !> Add a note or a warning on the sheet under a punch.
  subroutine add_punch_note(model, state, punch, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(punch_t), intent(in) :: punch
    type(message_list_t), intent(inout) :: notes

    character(len=:), allocatable :: text
    logical :: is_open, is_off

    associate (name => model%tool(punch%tool)%name, phase => model%phase(state%phase)%name)
      is_open = punch%bottom%distance > open_path*model%thickness
      is_off = punch%floor%distance > off_tools*model%thickness
      if (.not. (is_open .or. is_off)) then
        text = "phase '"//phase//"': the sheet is formed to '"//name// &
            "' and the tools across within "//to_text(punch%floor%distance, 2)//" mm"
        if (punch%bottom%node > 0) text = text//"; the path left of '"//name//"' is "// &
            to_text(punch%bottom%distance, 2)//" mm"
        call notes%add_new("N107", text)
        return
      end if
      text = "at the end of phase '"//phase//"' the sheet is not formed:"
      if (is_open) text = text//" tool '"//name//"' stops "//to_text(punch%bottom%distance, 3)// &
          " mm before it pinches the sheet against '"//model%tool(punch%bottom%tool)%name// &
          "', nearest at "//name_of(punch%bottom)
      if (is_open .and. is_off) text = text//";"
      if (is_off) text = text//" it lies off all tools by up to "// &
          to_text(punch%floor%distance, 3)//" mm, at "//name_of(punch%floor)
      call notes%add_new("W119", text)
    end associate
  end subroutine add_punch_note

  !> Add a warning on a sheet that has slid under a punch, unless it had at the end of a phase
  !> before.
  subroutine add_slide(model, state, punch, before, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(punch_t), intent(in) :: punch
    type(closing_t), intent(in) :: before(:)
    type(message_list_t), intent(inout) :: notes

    integer :: k

    associate (vector => punch%slide_vector, least => notable_slide*model%thickness)
      if (punch%slide%distance <= least) return
      if (any([(had_slid(before(k), punch%tool, least), k=1, size(before))])) return
      call notes%add_new("W124", "in phase '"//model%phase(state%phase)%name//"' the sheet has "// &
          "slid under '"//model%tool(punch%tool)%name//"' by "//to_text(punch%slide%distance, 3)// &
          " mm or more everywhere, least at "//name_of(punch%slide)//": displacement across "// &
          "the path "//to_text(vector(1), 3)//" "//to_text(vector(2), 3)//" "// &
          to_text(vector(3), 3)//" mm")
    end associate
  end subroutine add_slide

  !> Whether the sheet had slid under a punch by more than a distance, mm.
  pure logical function had_slid(closing, tool, distance)
    type(closing_t), intent(in) :: closing
    integer, intent(in) :: tool
    real(wp), intent(in) :: distance

    had_slid = .false.
    if (.not. allocated(closing%punch)) return
    had_slid = any(closing%punch%tool == tool .and. closing%punch%slide%distance > distance)
  end function had_slid

  !> Return the node of a place with its position as text.
  pure function name_of(place) result(text)
    type(place_t), intent(in) :: place
    character(len=:), allocatable :: text

    text = "node "//to_text(place%node)//" at "//to_text(place%x(1), 4)//" "// &
        to_text(place%x(2), 4)//" "//to_text(place%x(3), 4)
  end function name_of

end module dd3_report_closing_notes
