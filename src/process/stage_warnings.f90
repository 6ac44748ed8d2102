!> What the user is told at the start and at the end of a phase: a pressed tool that does not meet
!> the sheet, a sheet that nothing holds, yielding in a release.
module dd3_process_stage_warnings
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_contact_closest, only : find_contact, hint_t, hit_t
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_rigid_motion, only : new_rigid_motion, rigid_motion_t
  use dd3_model_state, only : state_t
  use dd3_process_stage, only : along, look_along, reach
  use dd3_system_contact, only : touch
  implicit none
  private
  public :: press_warning, release_warning, support_warning

  !> Plastic strain in a release that is more than a little yielding backwards.
  real(wp), parameter :: notable_strain = 1.0e-3_wp
  !> The axes.
  real(wp), parameter :: axis(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
      0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

  !> What the user is told where a pressed tool does not come to touch: its force has the wrong
  !> sign, or nothing lies ahead of it. Empty elsewhere.
  function press_warning(model, phase, state) result(text)
    !> The model.
    type(model_t), intent(in) :: model
    !> The phase, begun.
    type(phase_t), intent(in) :: phase
    !> The state at its start.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: smallest, facing
    integer :: tool

    text = ""
    do tool = 1, model%n_tool
      if (.not. (phase%pressed(tool) .and. phase%active(tool))) cycle
      if (any(state%contact_tool == tool .and. state%status /= status_gap)) cycle
      call look_along(model, phase, tool, state, smallest, facing)
      if (facing > along .and. smallest <= touch) cycle
      text = "warning: in phase '"//phase%name//"' the pressed tool '"//model%tool(tool)%name// &
        "' does not meet the sheet along its force"
      if (smallest <= reach .and. facing < -along) text = "warning: in phase '"//phase%name// &
        "' the force on tool '"//model%tool(tool)%name//"' points away from the sheet; is its "// &
        "sign wrong?"
      return
    end do
  end function press_warning

  !> What the user is told where neither supports nor tools that touch hold the sheet at the start
  !> of a phase. Empty elsewhere.
  function support_warning(model, phase, state) result(text)
    !> The model.
    type(model_t), intent(in) :: model
    !> The phase, begun.
    type(phase_t), intent(in) :: phase
    !> The state at its start.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    type(rigid_motion_t) :: body
    integer :: tool

    call new_rigid_motion(body, state%x)
    call body%hold_prescribed(state%x, phase%prescribed)
    text = body%free_motion()
    if (len(text) == 0) return
    do tool = 1, model%n_tool
      if (phase%active(tool)) call hold_touched(body, model, phase, state, tool)
    end do
    text = body%free_motion()
    if (len(text) > 0) text = "warning: at the start of phase '"//phase%name// &
      "' nothing holds the sheet: it is free to "//text//"; supports are missing, or a tool that" &
      //" touches from the start"
  end function support_warning

  !> Holds the body where a tool touches it, along the normal and, with friction, across it too; one
  !> that is pressed gives way along its line.
  subroutine hold_touched(body, model, phase, state, tool)
    !> The body.
    type(rigid_motion_t), intent(inout) :: body
    !> The model.
    type(model_t), intent(in) :: model
    !> The phase.
    type(phase_t), intent(in) :: phase
    !> The state.
    type(state_t), intent(in) :: state
    !> The tool.
    integer, intent(in) :: tool

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: direction(3)
    integer :: c, d

    do c = 1, model%n_contact
      if (.not. model%candidate(tool, c)) cycle
      associate (x => state%x(:, model%contact_node(c)))
        hint = hint_t()
        call find_contact(model%tool(tool)%surface, x - state%tool_displacement(:, tool), hint, &
            touch, model%contact_depth, hit)
        if (.not. hit%found) cycle
        do d = 0, 3
          direction = hit%normal
          if (d > 0) direction = model%tool(tool)%friction*axis(:, d)
          if (phase%pressed(tool)) direction = direction &
            - dot_product(direction, phase%direction(:, tool))*phase%direction(:, tool)
          call body%hold(x, direction)
        end do
      end associate
    end do
  end subroutine hold_touched

  !> What the user is told where the sheet yields while the forces of released tools fade: as loads
  !> of fixed direction they may lead it on where withdrawn tools would not. Empty elsewhere.
  function release_warning(phase, strain_before, state) result(text)
    !> The phase.
    type(phase_t), intent(in) :: phase
    !> Equivalent plastic strains at its start, `(n_point, n_element)`.
    real(wp), intent(in) :: strain_before(:, :)
    !> The state at its end.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    integer :: place(2)

    text = ""
    if (all(abs(phase%fading) <= 0.0_wp)) return
    place = maxloc(state%internal(1, :, :) - strain_before)
    associate (growth => state%internal(1, place(1), place(2)) - strain_before(place(1), place(2)))
      if (growth > notable_strain) text = "warning: in phase '"//phase%name &
        //"' the plastic strain of element "//to_text(place(2))//" grew by "//to_text(growth, 3) &
        //" while the forces of released tools faded; compare with tools withdrawn by `move`"
    end associate
  end function release_warning

end module dd3_process_stage_warnings
