! SPDX-License-Identifier: GPL-3.0-or-later
!> Phases of the case with all names resolved. What a phase does not name stays unchanged: tools are
!> held, forces and loads kept.
module dd3_setup_phases
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t, phase_spec_t
  use dd3_mesh_mesh, only : mesh_t
  use dd3_settings_until, only : until_never
  use dd3_setup_displacements, only : set_displacements
  use dd3_model_load_sets, only : face_load_weights, load_set_t, pressure_set_t
  use dd3_model_gravity, only : gravity_name, new_weight_set
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_rigid_supports, only : choose_supports
  use dd3_model_tilt, only : new_tilt, tilt_t
  use dd3_model_turn, only : new_turn, turn_t
  use dd3_setup_withdrawal, only : withdrawal
  use dd3_tools_separation, only : offset_at_gap
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
      call set_turns(case%phase(i), model%phase(i))
      call set_displacements(case, i, mesh, model%fixed, led, model%phase(i))
      unloaded = (unloaded .or. case%phase(i)%unload) .and. &
          .not. any(model%phase(i)%active .and. .not. model%phase(i)%withdrawn)
      model%phase(i)%unloaded = unloaded
      model%phase(i)%has_gravity = case%phase(i)%has_gravity
      call set_supports(model, unloaded, led, model%phase(i))
      call set_drawbeads(model, unloaded, before%bead_active, model%phase(i))
      call set_loads(case%phase(i), model, model%phase(i))
      before = model%phase(i)
    end do
    call set_gaps(model, case, errors)
  end subroutine new_phases

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
    allocate (phase%tool_load_end(3, n_tool), phase%load_end(3, n_load), source=0.0_wp)
    allocate (phase%turn(n_tool), phase%tilt(n_tool))
    allocate (phase%gap_other(n_tool), source=0)
    allocate (phase%gap_offset(n_tool), source=0.0_wp)
    allocate (phase%pressed(n_tool), phase%withdrawn(n_tool), phase%goes_back(n_tool), &
        source=.false.)
    allocate (phase%active(n_tool), phase%keeps_tool_load(n_tool), source=.true.)
    allocate (phase%keeps_load(n_load), source=.true.)
    allocate (phase%displacement(3, n_node), source=0.0_wp)
    allocate (phase%motion(0))
    allocate (phase%pressure_end(size(model%pressure_set)), source=0.0_wp)
    allocate (phase%keeps_pressure(size(model%pressure_set)), source=.true.)
    allocate (phase%bead_active(size(model%drawbead)), source=.false.)
    phase%bead_new = phase%bead_active
    phase%bead_leaves = phase%bead_active
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
    phase%keeps_load = .true.
    phase%keeps_pressure = .true.
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
      if (spec%unload .or. any(spec%release%tool == t)) call withdraw(model, t, phase)
    end do
    if (spec%unload .and. any(phase%withdrawn) .and. size(spec%table) == 0) phase%opening = opening
    phase%trial = spec%trial
    phase%length = 0.0_wp
    if (spec%control == 0) return
    phase%length = norm2(phase%move(:, spec%control))
    if (phase%length > 0.0_wp) phase%trial = spec%trial/phase%length
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
    call choose_supports(model%start_positions(), led, phase%support)
    phase%floats = any(phase%withdrawn)
    if (.not. phase%floats) phase%prescribed = phase%held()
  end subroutine set_supports

  !> Set which draw-beads act: those of an active tool, and those without a tool as long as the
  !> sheet is not unloaded. They leave with their tool, those without one with all tools.
  pure subroutine set_drawbeads(model, unloaded, before, phase)
    type(model_t), intent(in) :: model
    logical, intent(in) :: unloaded
    !> Beads that act in the phase before, `(n_bead)`.
    logical, intent(in) :: before(:)
    type(phase_t), intent(inout) :: phase

    integer :: b

    phase%bead_active = .not. unloaded
    phase%bead_leaves = spread(unloaded .and. any(phase%withdrawn), 1, size(model%drawbead))
    do b = 1, size(model%drawbead)
      associate (tool => model%drawbead(b)%tool)
        if (tool == 0) cycle
        phase%bead_active(b) = phase%acts(tool)
        phase%bead_leaves(b) = phase%withdrawn(tool)
      end associate
    end do
    phase%bead_leaves = phase%bead_leaves .and. before
    phase%bead_active = phase%bead_active .or. phase%bead_leaves
    phase%bead_new = phase%bead_active .and. .not. before
  end subroutine set_drawbeads

  !> Set the loads of the sets that the phase names.
  subroutine set_loads(spec, model, phase)
    type(phase_spec_t), intent(in) :: spec
    type(model_t), intent(in) :: model
    type(phase_t), intent(inout) :: phase

    integer :: i, s

    do i = 1, size(spec%load)
      do s = 1, size(model%load_set)
        if (model%load_set(s)%name /= spec%load(i)%set) cycle
        phase%load_end(:, s) = spec%load(i)%force
        phase%keeps_load(s) = .false.
      end do
    end do
    do s = 1, size(model%load_set)
      if (.not. spec%has_gravity .or. model%load_set(s)%name /= gravity_name) cycle
      phase%load_end(:, s) = model%load_set(s)%scale*spec%gravity
      phase%keeps_load(s) = .false.
    end do
    do i = 1, size(spec%pressure)
      do s = 1, size(model%pressure_set)
        if (model%pressure_set(s)%name /= spec%pressure(i)%set) cycle
        phase%pressure_end(s) = spec%pressure(i)%value
        phase%keeps_pressure(s) = .false.
      end do
    end do
  end subroutine set_loads

  !> Report the first phase with gravity if a material of the sheet has no density.
  subroutine check_density(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: i, m

    do i = 1, size(case%phase)
      if (.not. case%phase(i)%has_gravity) cycle
      do m = 1, size(case%material)
        if (case%material(m)%density > 0.0_wp .or. .not. any(model%material_of == m)) cycle
        call errors%push_input(case%phase(i)%source%at("gravity"), "material '"// &
            case%material(m)%source%called()//"' has no density", &
            "density = 7.85e-9 (t/mm3, steel) in *MATERIAL "//case%material(m)%source%called(), &
            code="E121")
      end do
      return
    end do
  end subroutine check_density

  !> List the sets that carry a pressure in some phase, with their faces on the boundary.
  subroutine new_pressure_sets(model, case, mesh)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh

    type(pressure_set_t) :: set
    logical :: member(mesh%n_node), inside(model%face%n)
    integer :: i, j, s, f

    allocate (model%pressure_set(0))
    do i = 1, size(case%phase)
      do j = 1, size(case%phase(i)%pressure)
        associate (name => case%phase(i)%pressure(j)%set)
          if (any([(model%pressure_set(s)%name == name, s=1, size(model%pressure_set))])) cycle
          set%name = name
          member = .false.
          member(mesh%nodes_of(name)) = .true.
          inside = [(all(member(model%face%node(:, f))), f=1, model%face%n)]
          set%node = model%face%node(:, pack([(f, f=1, model%face%n)], inside))
          model%pressure_set = [model%pressure_set, set]
        end associate
      end do
    end do
  end subroutine new_pressure_sets

  !> List the sets that carry a load in some phase, in the order of the phases, then the weight.
  subroutine new_load_sets(model, case, mesh)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh

    type(load_set_t) :: set
    integer :: i, j, s

    allocate (model%load_set(0))
    do i = 1, size(case%phase)
      do j = 1, size(case%phase(i)%load)
        associate (name => case%phase(i)%load(j)%set)
          if (any([(model%load_set(s)%name == name, s=1, size(model%load_set))])) cycle
          set%name = name
          set%node = mesh%nodes_of(name)
          call face_load_weights(model%element, model%connectivity, model%x0, set%node, set%weight)
          model%load_set = [model%load_set, set]
        end associate
      end do
    end do
    if (.not. any(case%phase%has_gravity)) return
    call new_weight_set(set, model, case%material%density)
    model%load_set = [model%load_set, set]
  end subroutine new_load_sets

  !> Set the displacements at which tools have the gaps of the input.
  subroutine set_gaps(model, case, errors)
    !> With its tools and phases.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: gap, start(3)
    logical :: found
    integer :: i, k

    do i = 1, size(case%phase)
      do k = 1, size(case%phase(i)%gap)
        associate (spec => case%phase(i)%gap(k))
          gap = spec%value
          if (spec%in_thicknesses) gap = gap*model%thickness
          associate (tool => model%tool(spec%tool), other => model%tool(spec%other))
            start = tool%position - other%position
            start(:2) = start(:2) + aside(model, i, spec%tool) - aside(model, i, spec%other)
            call offset_at_gap(tool%surface, other%surface, start, gap, &
                model%phase(i)%gap_offset(spec%tool), found)
            if (.not. found) call errors%push_input(spec%at, "no displacement along z gives "// &
                "this gap between '"//tool%name//"' and '"//other%name//"'", &
                "two tools whose surfaces face each other along z", code="E144")
          end associate
        end associate
      end do
    end do
  end subroutine set_gaps

  !> Return how far `move` has moved a tool along x and y at the end of a phase, mm.
  pure function aside(model, phase, tool)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: phase
    integer, intent(in) :: tool
    real(wp) :: aside(2)

    integer :: i

    aside = 0.0_wp
    do i = 1, phase
      aside = aside + model%phase(i)%move(:2, tool)
    end do
  end function aside

end module dd3_setup_phases
