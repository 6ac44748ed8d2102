! SPDX-License-Identifier: GPL-3.0-or-later
!> Fills the phases of the case, and the settings that a phase may change.
module dd3_input_fill_phase
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : same_name
  use dd3_settings_accuracy, only : set_by_accuracy
  use dd3_input_block, only : block_t, entry_t
  use dd3_input_case, only : case_t, phase_spec_t, contact_spec_t, tool_name_t, &
      tool_pin_t, tool_spacer_t, tool_tilt_t, tool_vector_t
  use dd3_settings_limits, only : limits_spec_t, limit_spec_t
  use dd3_settings_newton, only : newton_spec_t
  use dd3_settings_until, only : until_spec_t, until_displacement, until_force
  implicit none
  private
  public :: fill_phase, fill_limits, fill_newton, fill_contact

contains

  !> Fill phase i. It inherits limits, corrector and contact from the phase before.
  subroutine fill_phase(case, i, block)
    !> Its tools and earlier phases must be filled.
    type(case_t), intent(inout) :: case
    integer, intent(in) :: i
    type(block_t), intent(in) :: block

    type(phase_spec_t) :: phase

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
    call set_by_accuracy(phase%limits, phase%contact%mixed)
    phase%control = tool_position(case, block%word("control"))
    if (block%has("trial")) phase%trial = block%number("trial")
    phase%unload = block%word("unload") /= "off"
    phase%at_once = block%word("unload") == "at_once"
    phase%keep = block%number("keep") > 0.5_wp
    if (block%has("duration")) phase%duration = block%number("duration")
    if (block%has("speed")) phase%speed = block%number("speed")
    call fill_entries(phase, case, block)
    phase%has_gravity = block%has("gravity")
    if (phase%has_gravity) phase%gravity = block%numbers("gravity")
    phase%table = block%numbers("table")
    phase%move_table = block%numbers("move_table")
    phase%turn_table = block%numbers("turn_table")
    phase%press_table = block%numbers("press_table")
    call fill_until(phase%until, case, block)
    case%phase(i) = phase
  end subroutine fill_phase

  !> Return the position of a tool; 0 if not found.
  pure integer function tool_position(case, name)
    type(case_t), intent(in) :: case
    character(len=*), intent(in) :: name

    do tool_position = 1, size(case%tool)
      if (same_name(case%tool(tool_position)%name, name)) return
    end do
    tool_position = 0
  end function tool_position

  !> Fill what a phase may have several of: an entry each.
  subroutine fill_entries(phase, case, block)
    type(phase_spec_t), intent(inout) :: phase
    !> Its tools must be filled.
    type(case_t), intent(in) :: case
    type(block_t), intent(in) :: block

    integer :: e, i

    allocate (phase%hold(n_valid("hold")), phase%release(n_valid("release")))
    allocate (phase%move(n_valid("move")), phase%press(n_valid("press")))
    allocate (phase%gap(n_valid("gap")), phase%turn(n_valid("turn")), phase%tilt(n_valid("tilt")))
    allocate (phase%pin(n_valid("pin")), phase%stroke(n_valid("stroke_table")))
    allocate (phase%spacer(n_valid("spacer")))
    allocate (phase%displace(n_valid("displace") + n_valid("place")), phase%free(n_valid("free")))
    allocate (phase%load(n_valid("load")), phase%pressure(n_valid("pressure")))
    allocate (phase%motion(n_valid("rotate") + n_valid("bend")))
    do e = 1, block%n_entry
      associate (entry => block%entry(e))
        if (.not. entry%valid .or. size(entry%value) == 0) cycle
        i = n_valid(entry%key, e)
        ! The places follow the displacements, the bends the rotations.
        if (entry%key == "place") i = i + n_valid("displace")
        if (entry%key == "bend") i = i + n_valid("rotate")
        call fill_tool_entry(phase, case, entry, i)
        call fill_set_entry(phase, entry, i)
      end associate
    end do
    do i = 1, size(case%tool)
      if (any(phase%pin%tool == i)) phase%tilt = [phase%tilt, tilt_on_pins(pack(phase%pin, &
          phase%pin%tool == i))]
    end do

  contains

    !> Return the tilt of a tool on its pins, about the point where their forces act.
    pure type(tool_tilt_t) function tilt_on_pins(pin) result(tilt)
      type(tool_pin_t), intent(in) :: pin(:)

      integer :: k

      tilt%tool = pin(1)%tool
      tilt%at = pin(1)%at
      ! Other shares are refused by the check of the phase.
      if (sum(pin%share) > 0.0_wp) tilt%pivot = [(sum(pin%share*pin%place(k)), k=1, 3)] &
          /sum(pin%share)
    end function tilt_on_pins

    !> Return the number of valid entries with a key, up to entry `last` if given.
    pure integer function n_valid(key, last)
      character(len=*), intent(in) :: key
      integer, intent(in), optional :: last

      integer :: k, n

      n = block%n_entry
      if (present(last)) n = last
      n_valid = count([(block%entry(k)%key == key .and. block%entry(k)%valid, k=1, n)])
    end function n_valid

  end subroutine fill_entries

  !> Fill entry i of a key that names a tool.
  subroutine fill_tool_entry(phase, case, entry, i)
    type(phase_spec_t), intent(inout) :: phase
    type(case_t), intent(in) :: case
    type(entry_t), intent(in) :: entry
    integer, intent(in) :: i

    integer :: tool

    tool = tool_position(case, entry%value(1)%text)
    associate (at => entry%value(1)%at, number => entry%number)
      select case (entry%key)
      case ("hold")
        phase%hold(i) = tool_name_t(tool, at)
      case ("release")
        phase%release(i) = tool_name_t(tool, at)
      case ("move")
        phase%move(i) = tool_vector_t(tool, number(:3), at)
      case ("press")
        phase%press(i) = tool_vector_t(tool, number(:3), at)
      case ("gap")
        phase%gap(i)%tool = tool
        phase%gap(i)%other = tool_position(case, entry%value(2)%text)
        phase%gap(i)%value = number(1)
        phase%gap(i)%in_thicknesses = size(entry%value) > 3
        phase%gap(i)%at = at
      case ("turn")
        phase%turn(i)%tool = tool
        phase%turn(i)%value = number(:7)
        phase%turn(i)%at = at
      case ("tilt")
        phase%tilt(i)%tool = tool
        phase%tilt(i)%pivot = number(:3)
        phase%tilt(i)%stiffness = number(4)
        phase%tilt(i)%at = at
      case ("pin")
        phase%pin(i) = tool_pin_t(tool, number(:3), number(4), at)
      case ("stroke_table")
        phase%stroke(i)%tool = tool
        phase%stroke(i)%table = number(:entry%n_number)
        phase%stroke(i)%at = at
      case ("spacer")
        phase%spacer(i) = tool_spacer_t(tool, tool_position(case, entry%value(2)%text), &
            number(1), number(2), number(3:4), at)
      case default
        ! Other keys are filled by the other procedures.
      end select
    end associate
  end subroutine fill_tool_entry

  !> Fill entry i of a key that names a set.
  subroutine fill_set_entry(phase, entry, i)
    type(phase_spec_t), intent(inout) :: phase
    type(entry_t), intent(in) :: entry
    integer, intent(in) :: i

    associate (name => entry%value(1)%text, at => entry%value(1)%at, number => entry%number)
      select case (entry%key)
      case ("displace", "place")
        phase%displace(i)%is_coordinate = entry%key == "place"
        phase%displace(i)%set = name
        phase%displace(i)%axis = nint(number(1))
        phase%displace(i)%value = number(2)
        phase%displace(i)%at = at
      case ("free")
        phase%free(i)%set = name
        phase%free(i)%direction(nint(number)) = .true.
        phase%free(i)%at = at
      case ("load")
        phase%load(i)%set = name
        phase%load(i)%force = number(:3)
        phase%load(i)%at = at
      case ("pressure")
        phase%pressure(i)%set = name
        phase%pressure(i)%value = number(1)
        phase%pressure(i)%at = at
      case ("rotate", "bend")
        phase%motion(i)%set = name
        phase%motion(i)%bends = entry%key == "bend"
        phase%motion(i)%value = number(:7)
        phase%motion(i)%at = at
      case default
        ! Other keys are filled by the other procedures.
      end select
    end associate
  end subroutine fill_set_entry

  subroutine fill_until(until, case, block)
    type(until_spec_t), intent(inout) :: until
    !> Its tools must be filled.
    type(case_t), intent(in) :: case
    type(block_t), intent(in) :: block

    if (.not. block%has("until")) return
    associate (entry => block%entry(block%find("until")))
      until%kind = until_displacement
      if (same_name(entry%value(1)%text, "force")) until%kind = until_force
      until%tool = tool_position(case, entry%value(2)%text)
      until%value = entry%number(1)
      until%at = entry%value(1)%at
    end associate
  end subroutine fill_until

  !> Set the limits that a block gives.
  subroutine fill_limits(limits, block)
    type(limits_spec_t), intent(inout) :: limits
    type(block_t), intent(in) :: block

    type(limits_spec_t) :: off
    integer :: i

    if (block%has("accuracy")) limits%accuracy = block%word("accuracy")
    call fill_limit(limits%strain, off%strain, block, "strain")
    call fill_limit(limits%rotation, off%rotation, block, "rotation")
    call fill_limit(limits%stress_tangential, off%stress_tangential, block, "stress_tangential")
    call fill_limit(limits%stress_normal, off%stress_normal, block, "stress_normal")
    do i = 1, size(limits%force)
      call fill_limit(limits%force(i), off%force(i), block, "force", i)
    end do
    call fill_limit(limits%force_floor, off%force_floor, block, "force_floor")
    call fill_limit(limits%depth, off%depth, block, "depth")
    call fill_limit(limits%unloading, off%unloading, block, "unloading")
    call fill_limit(limits%r_min, off%r_min, block, "r_min")
    call fill_limit(limits%r_max, off%r_max, block, "r_max")
  end subroutine fill_limits

  !> Set a limit if the block gives it.
  subroutine fill_limit(limit, off, block, key, component)
    type(limit_spec_t), intent(inout) :: limit
    !> The limit when off.
    type(limit_spec_t), intent(in) :: off
    type(block_t), intent(in) :: block
    character(len=*), intent(in) :: key
    !> Position among the key's numbers; the first if not given.
    integer, intent(in), optional :: component

    integer :: i

    if (.not. block%has(key)) return
    limit = off
    limit%given = block%given(key)
    i = 1
    if (present(component)) i = component
    associate (entry => block%entry(block%find(key)))
      if (.not. entry%is_off) limit = limit_spec_t(.true., entry%number(i), block%given(key))
    end associate
  end subroutine fill_limit

  !> Set the corrector's settings that a block gives.
  subroutine fill_newton(newton, block)
    type(newton_spec_t), intent(inout) :: newton
    type(block_t), intent(in) :: block

    if (block%has("tolerance")) newton%tolerance = block%number("tolerance")
    if (block%has("iterations")) newton%iterations = nint(block%number("iterations"))
    if (block%has("cutback")) newton%cutback = block%number("cutback") > 0.5_wp
    if (block%has("line_search")) newton%line_search = block%number("line_search") > 0.5_wp
    if (block%has("elimination")) newton%elimination = block%number("elimination") > 0.5_wp
  end subroutine fill_newton

  !> Set the contact's settings that a block gives. A penalty belongs to the mixed formulation.
  subroutine fill_contact(contact, block)
    type(contact_spec_t), intent(inout) :: contact
    type(block_t), intent(in) :: block

    if (block%has("penalty")) contact%mixed = .true.
    if (block%has("formulation")) contact%mixed = block%word("formulation") == "mixed"
    if (block%has("layer")) contact%layer = block%number("layer")
    if (block%has("points")) then
      contact%points = nint(block%number("points"))
      contact%points_at = block%at("points")
    end if
    if (block%has("penalty")) contact%penalty = block%number("penalty")
    if (block%has("search_distance")) contact%search_distance = block%number("search_distance")
  end subroutine fill_contact

end module dd3_input_fill_phase
