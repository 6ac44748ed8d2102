!> Fills the phases of the case, and the settings a phase may change.
module dd3_input_fill_phase
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : same_name
  use dd3_input_block, only : block_t, entry_t
  use dd3_input_case, only : case_t, phase_t, contact_t, limits_t, limit_t, newton_t, tool_name_t, &
      tool_vector_t, &
                             displace_t, load_t, until_displacement, until_force
  implicit none
  private
  public :: fill_phase, fill_limits, fill_newton, fill_contact

contains

  !> Fills a phase; its limits, corrector and contact begin as those of the phase before.
  subroutine fill_phase(case, i, block)
    !> The case, its tools and earlier phases filled.
    type(case_t), intent(inout) :: case
    !> Number of the phase.
    integer, intent(in) :: i
    !> The block.
    type(block_t), intent(in) :: block

    type(phase_t) :: phase
    integer :: k

    phase%name = block%name
    phase%source = block
    phase%limits = case%limits
    phase%newton = case%newton
    phase%contact = case%contact
    if (i > 1) then
      phase%limits = case%phase(i - 1)%limits
      phase%newton = case%phase(i - 1)%newton
      phase%contact = case%phase(i - 1)%contact
    end if
    call fill_limits(phase%limits, block)
    call fill_newton(phase%newton, block)
    call fill_contact(phase%contact, block)
    phase%control = tool_position(case, block%word("control"))
    if (block%has("trial")) phase%trial = block%number("trial")
    allocate (phase%hold(0), phase%release(0), phase%move(0), phase%press(0), phase%displace(0), &
        phase%load(0))
    do k = 1, block%n_entry
      if (block%entry(k)%valid) call fill_action(phase, case, block%entry(k))
    end do
    case%phase(i) = phase
  end subroutine fill_phase

  !> Position of a tool; 0 if there is none of this name.
  pure integer function tool_position(case, name)
    !> The case.
    type(case_t), intent(in) :: case
    !> Name of the tool.
    character(len=*), intent(in) :: name

    do tool_position = 1, size(case%tool)
      if (same_name(case%tool(tool_position)%name, name)) return
    end do
    tool_position = 0
  end function tool_position

  !> Adds what one entry asks for.
  subroutine fill_action(phase, case, entry)
    !> The phase.
    type(phase_t), intent(inout) :: phase
    !> The case.
    type(case_t), intent(in) :: case
    !> The entry.
    type(entry_t), intent(in) :: entry

    integer :: tool

    select case (entry%key)
    case ("hold")
      tool = tool_position(case, entry%value(1)%text)
      phase%hold = [phase%hold, tool_name_t(tool, entry%value(1)%at)]
    case ("release")
      tool = tool_position(case, entry%value(1)%text)
      phase%release = [phase%release, tool_name_t(tool, entry%value(1)%at)]
    case ("move")
      tool = tool_position(case, entry%value(1)%text)
      phase%move = [phase%move, tool_vector_t(tool, entry%number(:3), entry%value(1)%at)]
    case ("press")
      tool = tool_position(case, entry%value(1)%text)
      phase%press = [phase%press, tool_vector_t(tool, entry%number(:3), entry%value(1)%at)]
    case ("displace")
      phase%displace = [phase%displace, displace_t(entry%value(1)%text, nint(entry%number(1)), &
          entry%number(2), &
                                                   entry%value(1)%at)]
    case ("load")
      phase%load = [phase%load, load_t(entry%value(1)%text, entry%number(:3), entry%value(1)%at)]
    case ("until")
      phase%until%kind = merge(until_force, until_displacement, same_name(entry%value(1)%text, &
          "force"))
      phase%until%tool = tool_position(case, entry%value(2)%text)
      phase%until%value = entry%number(1)
      phase%until%at = entry%value(1)%at
    end select
  end subroutine fill_action

  !> Takes over the limits a block gives.
  subroutine fill_limits(limits, block)
    !> The limits.
    type(limits_t), intent(inout) :: limits
    !> The block.
    type(block_t), intent(in) :: block

    call fill_limit(limits%strain, block, "strain", 1, huge(1.0_wp))
    call fill_limit(limits%rotation, block, "rotation", 1, huge(1.0_wp))
    call fill_limit(limits%stress_tangential, block, "stress_tangential", 1, huge(1.0_wp))
    call fill_limit(limits%stress_normal, block, "stress_normal", 1, huge(1.0_wp))
    call fill_limit(limits%force(1), block, "force", 1, huge(1.0_wp))
    call fill_limit(limits%force(2), block, "force", 2, huge(1.0_wp))
    call fill_limit(limits%force(3), block, "force", 3, huge(1.0_wp))
    call fill_limit(limits%force_floor, block, "force_floor", 1, 0.0_wp)
    call fill_limit(limits%r_min, block, "r_min", 1, 0.0_wp)
    call fill_limit(limits%r_max, block, "r_max", 1, huge(1.0_wp))
  end subroutine fill_limits

  !> Takes over one limit if the block gives it.
  subroutine fill_limit(limit, block, key, component, without)
    !> The limit.
    type(limit_t), intent(inout) :: limit
    !> The block.
    type(block_t), intent(in) :: block
    !> The key.
    character(len=*), intent(in) :: key
    !> Which of the key's numbers.
    integer, intent(in) :: component
    !> The value where the limit is off.
    real(wp), intent(in) :: without

    real(wp), allocatable :: number(:)

    if (.not. block%has(key)) return
    limit%active = .not. block%entry(block%find(key))%is_off
    limit%value = without
    if (.not. limit%active) return
    number = block%numbers(key)
    limit%value = number(component)
  end subroutine fill_limit

  !> Takes over the corrector's settings a block gives.
  subroutine fill_newton(newton, block)
    !> The settings.
    type(newton_t), intent(inout) :: newton
    !> The block.
    type(block_t), intent(in) :: block

    if (block%has("tolerance")) newton%tolerance = block%number("tolerance")
    if (block%has("iterations")) newton%iterations = nint(block%number("iterations"))
    if (block%has("cutback")) newton%cutback = block%number("cutback") > 0.5_wp
    if (block%has("cutback_factor")) newton%cutback_factor = block%number("cutback_factor")
    if (block%has("cutback_min")) newton%cutback_min = block%number("cutback_min")
  end subroutine fill_newton

  !> Takes over the contact's settings a block gives.
  subroutine fill_contact(contact, block)
    !> The settings.
    type(contact_t), intent(inout) :: contact
    !> The block.
    type(block_t), intent(in) :: block

    if (block%has("penalty")) contact%penalty = block%number("penalty")
    if (block%has("search_distance")) contact%search_distance = block%number("search_distance")
  end subroutine fill_contact

end module dd3_input_fill_phase
