! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: how far the sheet was formed to the tools at the end of a phase.
module dd3_run_file_closing
  use dd3_base_json, only : json_t
  use dd3_base_text, only : axis_name
  use dd3_model_model, only : model_t
  use dd3_output_closing, only : closing_t, pin_t, place_t, reached_t, support_t
  use dd3_report_attempt_report, only : tool_name
  implicit none
  private
  public :: add_closing

contains

  !> Add the measures; null if nothing was measured.
  subroutine add_closing(json, model, closing)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    type(closing_t), intent(in) :: closing

    integer :: i

    if (.not. allocated(closing%punch)) then
      call json%add_null("closing")
      return
    end if
    call json%begin_object("closing")
    call json%begin_array("punches")
    do i = 1, size(closing%punch)
      associate (punch => closing%punch(i))
        call json%begin_object("")
        call json%add("tool", tool_name(model, punch%tool))
        call add_place(json, model, "path_left", punch%bottom)
        call add_place(json, model, "off_tools", punch%floor)
        call add_place(json, model, "off_walls", punch%wall)
        call json%add("wall_space", punch%wall_space)
        call add_place(json, model, "slide", punch%slide)
        call json%add("slide_vector", punch%slide_vector)
        call json%end_object()
      end associate
    end do
    call json%end_array()
    call json%begin_array("holders")
    do i = 1, size(closing%holder)
      associate (holder => closing%holder(i))
        call json%begin_object("")
        call json%add("tool", tool_name(model, holder%tool))
        call add_place(json, model, "wave", holder%wave)
        call add_place(json, model, "lift", holder%lift)
        call add_place(json, model, "beyond", holder%beyond)
        call json%end_object()
      end associate
    end do
    call json%end_array()
    call add_support(json, model, closing%support)
    call add_pins(json, closing%pin)
    call add_reached(json, "fracture_damage", closing%damage)
    call add_reached(json, "forming_limit_ratio", closing%forming)
    call json%end_object()
  end subroutine add_closing

  !> Add the largest value of a limit; null if there is none.
  subroutine add_reached(json, name, reached)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    type(reached_t), intent(in) :: reached

    if (reached%element == 0) then
      call json%add_null(name)
      return
    end if
    call json%begin_object(name, flat=.true.)
    call json%add("value", reached%value)
    call json%add("element", reached%element)
    call json%add("position", reached%x)
    call json%end_object()
  end subroutine add_reached

  !> Add the locating pins.
  subroutine add_pins(json, pin)
    type(json_t), intent(inout) :: json
    type(pin_t), intent(in) :: pin(:)

    integer :: i

    call json%begin_array("pins")
    do i = 1, size(pin)
      call json%begin_object("", flat=.true.)
      call json%add("name", pin(i)%name)
      call json%add("diameter", pin(i)%diameter)
      call json%add("force", pin(i)%force)
      call json%add("thickness", pin(i)%thickness)
      call json%add("bearing_pressure", pin(i)%pressure())
      call json%add("yield_stress", pin(i)%flow_stress)
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_pins

  !> Add a place; null if there is none.
  subroutine add_place(json, model, name, place)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    character(len=*), intent(in) :: name
    type(place_t), intent(in) :: place

    if (place%node == 0) then
      call json%add_null(name)
      return
    end if
    call json%begin_object(name, flat=.true.)
    call json%add("distance", place%distance)
    call json%add("tool", tool_name(model, place%tool))
    call json%add("node", place%node)
    call json%add("position", place%x)
    call json%end_object()
  end subroutine add_place

  !> Add the support with the largest reaction; null if there is none.
  subroutine add_support(json, model, support)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    type(support_t), intent(in) :: support

    if (.not. allocated(support%name)) then
      call json%add_null("support")
      return
    end if
    call json%begin_object("support", flat=.true.)
    call json%add("name", support%name)
    call json%add("axis", axis_name(support%axis))
    call json%add("reaction", support%reaction)
    call json%add("tool", tool_name(model, support%tool))
    call json%add("tool_force", support%tool_force)
    call json%end_object()
  end subroutine add_support

end module dd3_run_file_closing
