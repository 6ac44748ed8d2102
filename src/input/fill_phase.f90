!> Fills the phases of the case, and the settings a phase may change.
module dd3_input_fill_phase
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : same_name
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t, phase_spec_t, contact_spec_t, limits_spec_t, limit_spec_t, &
      newton_spec_t, tool_name_t, tool_vector_t, displace_spec_t, load_spec_t, until_spec_t, &
      until_displacement, until_force
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
    phase%control = tool_position(case, block%word("control"))
    if (block%has("trial")) phase%trial = block%number("trial")
    call fill_tool_names(phase%hold, case, block, "hold")
    call fill_tool_names(phase%release, case, block, "release")
    call fill_tool_vectors(phase%move, case, block, "move")
    call fill_tool_vectors(phase%press, case, block, "press")
    call fill_displacements(phase%displace, block)
    call fill_loads(phase%load, block)
    call fill_until(phase%until, case, block)
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

  !> Positions of the valid entries with a key.
  pure function entries(block, key) result(position)
    !> The block.
    type(block_t), intent(in) :: block
    !> The key.
    character(len=*), intent(in) :: key
    integer, allocatable :: position(:)

    integer :: i

    allocate (position(0))
    do i = 1, block%n_entry
      if (block%entry(i)%key == key .and. block%entry(i)%valid) position = [position, i]
    end do
  end function entries

  !> Fills the tools that one key names.
  subroutine fill_tool_names(list, case, block, key)
    !> The tools.
    type(tool_name_t), allocatable, intent(out) :: list(:)
    !> The case, its tools filled.
    type(case_t), intent(in) :: case
    !> The phase's block.
    type(block_t), intent(in) :: block
    !> The key.
    character(len=*), intent(in) :: key

    integer, allocatable :: position(:)
    integer :: i

    position = entries(block, key)
    allocate (list(size(position)))
    do i = 1, size(position)
      associate (word => block%entry(position(i))%value(1))
        list(i)%tool = tool_position(case, word%text)
        list(i)%at = word%at
      end associate
    end do
  end subroutine fill_tool_names

  !> Fills the tools and vectors that one key names.
  subroutine fill_tool_vectors(list, case, block, key)
    !> The tools and their vectors.
    type(tool_vector_t), allocatable, intent(out) :: list(:)
    !> The case, its tools filled.
    type(case_t), intent(in) :: case
    !> The phase's block.
    type(block_t), intent(in) :: block
    !> The key.
    character(len=*), intent(in) :: key

    integer, allocatable :: position(:)
    integer :: i

    position = entries(block, key)
    allocate (list(size(position)))
    do i = 1, size(position)
      associate (entry => block%entry(position(i)))
        list(i)%tool = tool_position(case, entry%value(1)%text)
        list(i)%vector = entry%number(:3)
        list(i)%at = entry%value(1)%at
      end associate
    end do
  end subroutine fill_tool_vectors

  !> Fills the prescribed displacements.
  subroutine fill_displacements(list, block)
    !> The displacements.
    type(displace_spec_t), allocatable, intent(out) :: list(:)
    !> The phase's block.
    type(block_t), intent(in) :: block

    integer, allocatable :: position(:)
    integer :: i

    position = entries(block, "displace")
    allocate (list(size(position)))
    do i = 1, size(position)
      associate (entry => block%entry(position(i)))
        list(i)%set = entry%value(1)%text
        list(i)%axis = nint(entry%number(1))
        list(i)%value = entry%number(2)
        list(i)%at = entry%value(1)%at
      end associate
    end do
  end subroutine fill_displacements

  !> Fills the forces on nodes.
  subroutine fill_loads(list, block)
    !> The forces.
    type(load_spec_t), allocatable, intent(out) :: list(:)
    !> The phase's block.
    type(block_t), intent(in) :: block

    integer, allocatable :: position(:)
    integer :: i

    position = entries(block, "load")
    allocate (list(size(position)))
    do i = 1, size(position)
      associate (entry => block%entry(position(i)))
        list(i)%set = entry%value(1)%text
        list(i)%force = entry%number(:3)
        list(i)%at = entry%value(1)%at
      end associate
    end do
  end subroutine fill_loads

  !> Fills what ends the phase early.
  subroutine fill_until(until, case, block)
    !> The end.
    type(until_spec_t), intent(inout) :: until
    !> The case, its tools filled.
    type(case_t), intent(in) :: case
    !> The phase's block.
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

  !> Takes over the limits a block gives.
  subroutine fill_limits(limits, block)
    !> The limits.
    type(limits_spec_t), intent(inout) :: limits
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
    type(limit_spec_t), intent(inout) :: limit
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
    allocate (number, source=block%numbers(key))
    limit%value = number(component)
  end subroutine fill_limit

  !> Takes over the corrector's settings a block gives.
  subroutine fill_newton(newton, block)
    !> The settings.
    type(newton_spec_t), intent(inout) :: newton
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
    type(contact_spec_t), intent(inout) :: contact
    !> The block.
    type(block_t), intent(in) :: block

    if (block%has("penalty")) contact%penalty = block%number("penalty")
    if (block%has("search_distance")) contact%search_distance = block%number("search_distance")
  end subroutine fill_contact

end module dd3_input_fill_phase
