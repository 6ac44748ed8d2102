! SPDX-License-Identifier: GPL-3.0-or-later
!> Phases of the case with all names resolved. What a phase does not name stays unchanged: tools are
!> held, forces and loads kept.
module dd3_setup_phases
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t, phase_spec_t
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_cushion, only : cushion_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_rigid_supports, only : choose_supports
  use dd3_model_tilt, only : new_tilt, tilt_t
  use dd3_model_turn, only : new_turn, turn_t
  use dd3_settings_until, only : until_never
  use dd3_setup_cushions, only : place_spacers, set_cushions
  use dd3_setup_displacements, only : set_displacements
  use dd3_setup_gaps, only : set_gaps
  use dd3_setup_loads, only : check_density, new_load_sets, new_pressure_sets, set_loads
  use dd3_setup_withdrawal, only : withdrawal
  implicit none
  private
  public :: new_phases

  !> Default height of the contact layer over the thickness.
  real(wp), parameter :: default_layer = 0.02_wp
  !> Progress of an unloading at which the tools begin to open: loads and draw-beads end before, as
  !> they would bend a sheet that no tool holds.
  real(wp), parameter :: opening = 0.1_wp

contains

  !> Resolve all phases of the case.
  subroutine new_phases(model, case, mesh, errors)
    !> The model with its tools, candidates and supports.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(phase_t) :: before
    logical :: led(3, model%n_node), unloaded
    integer :: i

    call check_density(model, case, errors)
    call new_load_sets(model, case, mesh)
    call new_pressure_sets(model, case, mesh)
    call new_idle_phase(before, model)
    led = model%fixed
    unloaded = .false.
    allocate (model%phase(size(case%phase)))
    do i = 1, size(case%phase)
      call new_phase_after(before, model%phase(i))
      call set_settings(model, case%phase(i), model%phase(i))
      call set_tools(model, case%phase(i), model%phase(i))
      call set_cushions(case%phase(i), model%phase(i))
      call set_turns(case%phase(i), model%phase(i))
      call set_displacements(case, i, mesh, model%fixed, led, model%phase(i))
      unloaded = (unloaded .or. case%phase(i)%unload) .and. &
          .not. any(model%phase(i)%active .and. .not. model%phase(i)%withdrawn)
      model%phase(i)%unloaded = unloaded
      model%phase(i)%has_gravity = case%phase(i)%has_gravity
      call set_supports(model, unloaded, led, model%phase(i))
      call set_drawbeads(model, i, any(case%phase(:i)%unload), before, model%phase(i))
      call set_loads(case%phase(i), model, model%phase(i))
      before = model%phase(i)
    end do
    call set_gaps(model, case, errors)
    call place_spacers(model, case, errors)
    call check_times(model, case, errors)
  end subroutine new_phases

  !> Report phases without a time, if the flow stress of an element depends on the strain rate, or
  !> the friction of a tool that acts on the speed.
  subroutine check_times(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: reason
    integer :: i, m, t

    do i = 1, size(model%phase)
      if (model%phase(i)%duration > 0.0_wp) cycle
      reason = ""
      do t = 1, model%n_tool
        if (model%phase(i)%active(t) .and. model%tool(t)%friction%needs_time()) reason = &
            "the friction of tool '"//model%tool(t)%name//"' depends on the speed"
      end do
      do m = 1, size(model%material)
        if (model%material(m)%laws%viscous .and. any(model%material_of == m)) reason = &
            "material '"//case%material(m)%source%called()//"' has a law of the strain rate"
      end do
      if (reason /= "") call errors%push_input(case%phase(i)%source%opened, &
          "the phase has no time, but "//reason, &
          "duration = seconds, or speed = mm/s of the controlling tool", code="E163")
    end do
  end subroutine check_times

  !> Make the phase before the first one: no motion, no load.
  subroutine new_idle_phase(phase, model)
    type(phase_t), intent(out) :: phase
    type(model_t), intent(in) :: model

    integer :: n_tool, n_node, n_load

    n_tool = model%n_tool
    n_node = model%n_node
    n_load = size(model%load_set)
    phase%name = ""
    allocate (phase%move(3, n_tool), phase%direction(3, n_tool), source=0.0_wp)
    allocate (phase%tool_load_end(3, n_tool), phase%loads%final(3, n_load), source=0.0_wp)
    allocate (phase%turn(n_tool), phase%tilt(n_tool), phase%cushion(n_tool), phase%spacer(0))
    allocate (phase%gap_other(n_tool), source=0)
    allocate (phase%gap_offset(n_tool), source=0.0_wp)
    allocate (phase%pressed(n_tool), phase%withdrawn(n_tool), phase%goes_back(n_tool), &
        source=.false.)
    allocate (phase%active(n_tool), phase%keeps_tool_load(n_tool), source=.true.)
    allocate (phase%loads%keeps(n_load), source=.true.)
    allocate (phase%displacement(3, n_node), source=0.0_wp)
    allocate (phase%motion(0))
    allocate (phase%pressures%final(size(model%pressure_set)), source=0.0_wp)
    allocate (phase%pressures%keeps(size(model%pressure_set)), source=.true.)
    allocate (phase%beads%active(size(model%drawbead)), source=.false.)
    phase%beads%new = phase%beads%active
    phase%beads%leaves = phase%beads%active
    phase%prescribed = model%fixed
  end subroutine new_idle_phase

  !> Make a phase that keeps everything as the phase before it left it.
  subroutine new_phase_after(before, phase)
    type(phase_t), intent(in) :: before
    type(phase_t), intent(out) :: phase

    phase = before
    phase%active = before%active .and. .not. before%withdrawn
    phase%withdrawn = .false.
    phase%goes_back = .false.
    phase%opening = 0.0_wp
    phase%move = 0.0_wp
    phase%turn = turn_t()
    phase%gap_other = 0
    phase%displacement = 0.0_wp
    phase%keeps_tool_load = .true.
    phase%loads%keeps = .true.
    phase%pressures%keeps = .true.
    phase%motion = phase%motion(:0)
    if (allocated(phase%table)) deallocate (phase%table)
    if (allocated(phase%move_table)) deallocate (phase%move_table)
    if (allocated(phase%turn_table)) deallocate (phase%turn_table)
    if (allocated(phase%press_table)) deallocate (phase%press_table)
  end subroutine new_phase_after

  !> Set name, control, limits and end.
  subroutine set_settings(model, spec, phase)
    type(model_t), intent(in) :: model
    type(phase_spec_t), intent(in) :: spec
    type(phase_t), intent(inout) :: phase

    phase%name = spec%name
    phase%control = spec%control
    phase%keep = spec%keep
    phase%limits = spec%limits
    phase%newton = spec%newton
    phase%until = spec%until
    call set_table(spec%table, phase%table)
    call set_table(spec%move_table, phase%move_table)
    call set_table(spec%turn_table, phase%turn_table)
    if (size(spec%press_table) > 0) then
      ! The force of the start is the first point.
      allocate (phase%press_table(3, size(spec%press_table)/2 + 1), source=0.0_wp)
      phase%press_table(2, 1) = 1.0_wp
      phase%press_table(1, 2:) = spec%press_table(1::2)
      phase%press_table(3, 2:) = spec%press_table(2::2)
    end if
    if (spec%until%kind == until_never) phase%until%tool = 0
    phase%mixed = spec%contact%mixed
    phase%layer = spec%contact%layer
    if (phase%layer <= 0.0_wp) phase%layer = default_layer
    if (phase%mixed) phase%layer = 0.0_wp
    phase%penalty = spec%contact%penalty
    phase%search_distance = spec%contact%search_distance
    if (phase%search_distance <= 0.0_wp) phase%search_distance = model%largest_thickness()
  end subroutine set_settings

  !> Set a table from its pairs, if there are any.
  pure subroutine set_table(pairs, table)
    real(wp), intent(in) :: pairs(:)
    real(wp), allocatable, intent(inout) :: table(:, :)

    if (size(pairs) > 0) table = reshape(pairs, [2, size(pairs)/2])
  end subroutine set_table

  !> Set the turns of the tools.
  pure subroutine set_turns(spec, phase)
    type(phase_spec_t), intent(in) :: spec
    type(phase_t), intent(inout) :: phase

    integer :: i

    do i = 1, size(spec%turn)
      phase%turn(spec%turn(i)%tool) = new_turn(spec%turn(i)%value)
    end do
  end subroutine set_turns

  !> Set the motion and load of the tools, and the trial increment as a fraction of the phase. A
  !> tool that is released is withdrawn; one that is named after that has contact again.
  subroutine set_tools(model, spec, phase)
    type(model_t), intent(in) :: model
    type(phase_spec_t), intent(in) :: spec
    type(phase_t), intent(inout) :: phase

    !> Part of the phase in which the controlling tool moves.
    real(wp) :: moving
    integer :: i, t

    do i = 1, size(spec%hold)
      call stop_pressing(phase, spec%hold(i)%tool, .true.)
    end do
    do i = 1, size(spec%move)
      t = spec%move(i)%tool
      call stop_pressing(phase, t, .true.)
      phase%move(:, t) = spec%move(i)%vector
      call set_line(phase, t, spec%move(i)%vector)
    end do
    do i = 1, size(spec%gap)
      t = spec%gap(i)%tool
      call stop_pressing(phase, t, .true.)
      phase%gap_other(t) = spec%gap(i)%other
      phase%direction(:, t) = [0.0_wp, 0.0_wp, 1.0_wp]
    end do
    do i = 1, size(spec%press)
      t = spec%press(i)%tool
      phase%pressed(t) = .true.
      phase%active(t) = .true.
      phase%keeps_tool_load(t) = .false.
      phase%tool_load_end(:, t) = spec%press(i)%vector
      call set_line(phase, t, spec%press(i)%vector)
    end do
    do i = 1, size(spec%tilt)
      associate (tilt => spec%tilt(i))
        phase%tilt(tilt%tool) = new_tilt(tilt%pivot, tilt%stiffness, model%tool(tilt%tool)%surface)
      end associate
    end do
    do t = 1, size(phase%active)
      if (spec%at_once) call stop_pressing(phase, t, .false.)
      if (spec%unload .or. any(spec%release%tool == t)) call withdraw(model, t, phase)
    end do
    if (spec%unload .and. any(phase%withdrawn) .and. size(spec%table) == 0) phase%opening = opening
    phase%trial = spec%trial
    phase%duration = spec%duration
    phase%length = 0.0_wp
    if (spec%control == 0) return
    phase%length = norm2(phase%move(:, spec%control))
    moving = 1.0_wp
    if (phase%withdrawn(spec%control)) moving = 1.0_wp - phase%opening
    if (phase%length > 0.0_wp) phase%trial = moving*spec%trial/phase%length
    if (spec%speed > 0.0_wp) phase%duration = phase%length/spec%speed/moving
  end subroutine set_tools

  !> Withdraw a tool that has contact, by its `move` in the phase or else along its line.
  subroutine withdraw(model, tool, phase)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    !> With the lines of all tools.
    type(phase_t), intent(inout) :: phase

    if (.not. phase%active(tool)) return
    call stop_pressing(phase, tool, .true.)
    phase%withdrawn(tool) = .true.
    phase%goes_back(tool) = .not. norm2(phase%move(:, tool)) > 0.0_wp
    if (phase%goes_back(tool)) phase%move(:, tool) = withdrawal(model, tool, phase%direction)
  end subroutine withdraw

  !> Set the line along which a tool moves; a vector of zero leaves it unchanged.
  subroutine set_line(phase, tool, vector)
    type(phase_t), intent(inout) :: phase
    integer, intent(in) :: tool
    real(wp), intent(in) :: vector(3)

    if (norm2(vector) > 0.0_wp) phase%direction(:, tool) = vector/norm2(vector)
  end subroutine set_line

  !> Remove the force from a tool that is held, moved or released.
  subroutine stop_pressing(phase, tool, active)
    type(phase_t), intent(inout) :: phase
    integer, intent(in) :: tool
    !> Whether it has contact.
    logical, intent(in) :: active

    phase%active(tool) = active
    phase%pressed(tool) = .false.
    phase%tilt(tool) = tilt_t()
    phase%cushion(tool) = cushion_t()
    phase%spacer = pack(phase%spacer, phase%spacer%tool /= tool)
    phase%tool_load_end(:, tool) = 0.0_wp
  end subroutine stop_pressing

  !> Set the prescribed directions. For a sheet unloaded by this phase or an earlier one, supports
  !> are added that stop the rigid motions left free.
  subroutine set_supports(model, unloaded, led, phase)
    type(model_t), intent(in) :: model
    logical, intent(in) :: unloaded
    !> Directions that *BOUNDARY and `displace` prescribe, `(3, n_node)`.
    logical, intent(in) :: led(:, :)
    type(phase_t), intent(inout) :: phase

    phase%prescribed = led
    phase%floats = .false.
    phase%support = reshape([integer ::], [2, 0])
    if (.not. unloaded) return
    call choose_supports(model%start_positions(), led, phase%support, model%bound_nodes())
    phase%floats = any(phase%withdrawn)
    if (.not. phase%floats) phase%prescribed = phase%held()
  end subroutine set_supports

  !> Set which draw-beads act from their first phase on: those of an active tool, and those without
  !> a tool until the sheet is unloaded for the first time. They leave with their tool, those
  !> without one with all tools. One that returns with its tool begins anew.
  pure subroutine set_drawbeads(model, number, unloaded, before, phase)
    type(model_t), intent(in) :: model
    !> Of the phase.
    integer, intent(in) :: number
    !> Whether this phase or an earlier one unloads the sheet.
    logical, intent(in) :: unloaded
    type(phase_t), intent(in) :: before
    type(phase_t), intent(inout) :: phase

    logical :: acts_before(size(model%drawbead))
    integer :: b

    acts_before = before%beads%active .and. .not. before%beads%leaves
    phase%beads%active = .not. unloaded
    phase%beads%leaves = spread(unloaded .and. any(phase%withdrawn), 1, size(model%drawbead))
    do b = 1, size(model%drawbead)
      associate (tool => model%drawbead(b)%tool)
        if (tool == 0) cycle
        phase%beads%active(b) = phase%acts(tool)
        phase%beads%leaves(b) = phase%withdrawn(tool)
      end associate
    end do
    phase%beads%active = phase%beads%active .and. number >= model%drawbead%from
    phase%beads%leaves = phase%beads%leaves .and. acts_before
    phase%beads%active = phase%beads%active .or. phase%beads%leaves
    phase%beads%new = phase%beads%active .and. .not. acts_before
  end subroutine set_drawbeads

end module dd3_setup_phases
