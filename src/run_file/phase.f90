! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: the phases as resolved, and what happened in them. Motions and loads of nodes
!> are in its `input` only.
module dd3_run_file_phase
  use dd3_base_json, only : json_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : axis_name
  use dd3_input_case, only : case_t, phase_spec_t, tool_gap_t, tool_turn_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_tilt, only : tilt_t
  use dd3_output_run_summary, only : phase_summary_t
  use dd3_report_attempt_report, only : tool_name
  use dd3_run_file_closing, only : add_closing
  use dd3_run_file_input, only : add_location
  use dd3_settings_limits, only : limit_spec_t, limits_spec_t
  use dd3_settings_newton, only : newton_spec_t
  use dd3_settings_until, only : until_force
  implicit none
  private
  public :: add_phases

contains

  !> Add the phases.
  subroutine add_phases(json, case, model, summary)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> What happened in each of them.
    type(phase_summary_t), intent(in) :: summary(:)

    integer :: i

    call json%begin_array("phases")
    do i = 1, size(summary)
      call json%begin_object("")
      call json%add("number", i)
      call add_phase(json, case, model, i)
      call add_result(json, model, summary(i))
      call add_location(json, "at", case%phase(i)%source%opened)
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_phases

  !> Add what a phase does.
  subroutine add_phase(json, case, model, number)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    integer, intent(in) :: number

    associate (phase => model%phase(number), spec => case%phase(number))
      call json%add("name", phase%name)
      call json%add_optional("control", tool_name(model, phase%control))
      call json%add("trial", spec%trial)
      call json%add("length", phase%length)
      call json%add("unload", spec%unload)
      call json%add("at_once", spec%at_once)
      call add_tool_motions(json, model, phase, spec)
      call add_supports(json, phase)
      call add_until(json, model, phase)
      call add_limits(json, phase%limits)
      call add_newton(json, phase%newton)
      call add_contact(json, model, phase)
    end associate
  end subroutine add_phase

  !> Add how the tools move.
  subroutine add_tool_motions(json, model, phase, spec)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(phase_spec_t), intent(in) :: spec

    character(len=9) :: motion
    integer :: t

    call json%begin_array("tools")
    do t = 1, model%n_tool
      motion = "held"
      if (norm2(phase%move(:, t)) > 0.0_wp .or. phase%gap_other(t) > 0) motion = "moved"
      if (phase%pressed(t)) motion = "pressed"
      if (phase%withdrawn(t)) motion = "withdrawn"
      call json%begin_object("", flat=.true.)
      call json%add("name", model%tool(t)%name)
      call json%add("motion", trim(motion))
      call json%add("active", phase%acts(t))
      call add_vector(json, "displacement", phase%move(:, t), .not. phase%pressed(t))
      call add_turn(json, pack(spec%turn, spec%turn%tool == t))
      call add_tilt(json, phase%tilt(t), phase%tilts(t))
      call add_gap(json, model, pack(spec%gap, spec%gap%tool == t))
      call add_vector(json, "force", phase%tool_load_end(:, t), phase%pressed(t) .and. &
          .not. phase%keeps_tool_load(t))
      call add_vector(json, "direction", phase%direction(:, t), motion /= "held")
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_tool_motions

  !> Add a vector, or null if it is not given.
  subroutine add_vector(json, name, vector, given)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: vector(3)
    logical, intent(in) :: given

    if (given) then
      call json%add(name, vector)
    else
      call json%add_null(name)
    end if
  end subroutine add_vector

  !> Add the turn of a tool; null without one.
  subroutine add_turn(json, turn)
    type(json_t), intent(inout) :: json
    !> At most one.
    type(tool_turn_t), intent(in) :: turn(:)

    if (size(turn) == 0) then
      call json%add_null("turn")
      return
    end if
    call json%begin_object("turn")
    call json%add("point", turn(1)%value(:3))
    call json%add("axis", turn(1)%value(4:6))
    call json%add("angle", turn(1)%value(7))
    call json%end_object()
  end subroutine add_turn

  !> Add the tilt of a tool; null without one.
  subroutine add_tilt(json, tilt, given)
    type(json_t), intent(inout) :: json
    type(tilt_t), intent(in) :: tilt
    logical, intent(in) :: given

    if (.not. given) then
      call json%add_null("tilt")
      return
    end if
    call json%begin_object("tilt")
    call json%add("pivot", tilt%pivot)
    call json%add("stiffness", tilt%stiffness)
    call json%end_object()
  end subroutine add_tilt

  !> Add the gap of a tool at the end of the phase; null without one.
  subroutine add_gap(json, model, gap)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    !> At most one.
    type(tool_gap_t), intent(in) :: gap(:)

    if (size(gap) == 0) then
      call json%add_null("gap")
      return
    end if
    call json%begin_object("gap")
    call json%add("from", model%tool(gap(1)%other)%name)
    call json%add("value", gap(1)%value)
    call json%add("unit", trim(merge("thicknesses", "mm         ", gap(1)%in_thicknesses)))
    call json%end_object()
  end subroutine add_gap

  !> Add the supports that the program chose.
  subroutine add_supports(json, phase)
    type(json_t), intent(inout) :: json
    type(phase_t), intent(in) :: phase

    integer :: k

    call json%begin_array("supports", flat=.true.)
    do k = 1, size(phase%support, 2)
      call json%begin_object("")
      call json%add("node", phase%support(1, k))
      call json%add("axis", axis_name(phase%support(2, k)))
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_supports

  !> Add the early end; null without one.
  subroutine add_until(json, model, phase)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    if (phase%until%tool == 0) then
      call json%add_null("until")
      return
    end if
    call json%begin_object("until", flat=.true.)
    call json%add("quantity", trim(merge("force       ", "displacement", &
        phase%until%kind == until_force)))
    call json%add("tool", tool_name(model, phase%until%tool))
    call json%add("value", phase%until%value)
    call json%end_object()
  end subroutine add_until

  !> Add the limits of the predictor.
  subroutine add_limits(json, limits)
    type(json_t), intent(inout) :: json
    type(limits_spec_t), intent(in) :: limits

    call json%begin_object("limits", flat=.true.)
    call json%add("accuracy", trim(limits%accuracy))
    call add_limit(json, "strain", limits%strain)
    call add_limit(json, "rotation", limits%rotation)
    call add_limit(json, "stress_tangential", limits%stress_tangential)
    call add_limit(json, "stress_normal", limits%stress_normal)
    call add_vector(json, "force", limits%force%value, limits%force(1)%active)
    call json%add("force_floor", limits%force_floor%value)
    call add_limit(json, "depth", limits%depth)
    call add_limit(json, "unloading", limits%unloading)
    call json%add("r_min", limits%r_min%value)
    call add_limit(json, "r_max", limits%r_max)
    call json%end_object()
  end subroutine add_limits

  !> Add a limit; null if it is off.
  subroutine add_limit(json, name, limit)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    type(limit_spec_t), intent(in) :: limit

    if (limit%active) then
      call json%add(name, limit%value)
    else
      call json%add_null(name)
    end if
  end subroutine add_limit

  !> Add the settings of the corrector.
  subroutine add_newton(json, newton)
    type(json_t), intent(inout) :: json
    type(newton_spec_t), intent(in) :: newton

    call json%begin_object("newton", flat=.true.)
    call json%add("tolerance", newton%tolerance)
    call json%add("iterations", newton%iterations)
    call json%add("cutback", newton%cutback)
    call json%add("line_search", newton%line_search)
    call json%add("elimination", newton%elimination)
    call json%end_object()
  end subroutine add_newton

  !> Add the settings of the contact; null without tools.
  subroutine add_contact(json, model, phase)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase

    if (model%n_tool == 0) then
      call json%add_null("contact")
      return
    end if
    call json%begin_object("contact", flat=.true.)
    call json%add("formulation", trim(merge("mixed    ", "compliant", phase%mixed)))
    call add_limit(json, "layer", limit_spec_t(.not. phase%mixed, phase%layer*model%thickness))
    call add_limit(json, "penalty", limit_spec_t(phase%mixed .and. phase%penalty > 0.0_wp, &
        phase%penalty))
    call json%add("search_distance", phase%search_distance)
    call json%end_object()
  end subroutine add_contact

  !> Add what happened.
  subroutine add_result(json, model, summary)
    type(json_t), intent(inout) :: json
    type(model_t), intent(in) :: model
    type(phase_summary_t), intent(in) :: summary

    integer :: i

    call json%begin_object("result")
    call json%add("state", trim(summary%state))
    if (summary%state == "ended") then
      call json%add("ended_by", trim(merge("until   ", "progress", summary%is_early())))
    else
      call json%add_null("ended_by")
    end if
    if (summary%state == "earlier" .or. summary%state == "pending") then
      call json%add_null("progress")
      call json%add_null("travel")
      call json%add_null("last_increment")
    else
      call json%add("progress", summary%progress)
      call json%add("travel", summary%travel)
      call json%add("last_increment", summary%last_increment)
    end if
    call json%add("increments", summary%increments)
    call json%add("attempts", summary%attempts)
    call json%add("cutbacks", summary%retries)
    call json%add("iterations", summary%iterations)
    call json%add("solver_iterations", summary%solver_iterations)
    call json%begin_object("limiters", flat=.true.)
    do i = 1, size(summary%limited)
      call json%add(trim(summary%limited(i)%limiter), summary%limited(i)%count)
    end do
    call json%end_object()
    call json%add("seconds", summary%seconds)
    call add_closing(json, model, summary%closing)
    call json%end_object()
  end subroutine add_result

end module dd3_run_file_phase
