! SPDX-License-Identifier: GPL-3.0-or-later
!> Start of a phase: a transition from the state at the end of the phase before. It depends on the
!> model and the state alone, and stores all that the phase starts from in the state.
module dd3_process_phase_start
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank, largest_over_ranks, sum_over_ranks, this_rank
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : to_text
  use dd3_contact_operator, only : status_gap
  use dd3_sheet_surface_point, only : surface_point_t
  use dd3_model_contact_results, only : candidate_hits, nearest_candidate, nearest_t
  use dd3_model_contact_layer, only : held_offsets, starting_offset
  use dd3_model_energy, only : contact_energy, elastic_energy
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : outward_normals
  use dd3_model_phase, only : phase_t
  use dd3_model_pressed_tools, only : begin_tilts
  use dd3_model_tool_supports, only : spacer_room
  use dd3_model_reactions, only : reactions
  use dd3_model_rigid_supports, only : choose_supports
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : external_forces
  use dd3_model_terms_released, only : hold_released
  use dd3_model_turning, only : begin_turns
  use dd3_model_tolerances, only : start_depth, tangential, wrong_side_depth
  use dd3_process_phase_end, only : until_value
  use dd3_settings_until, only : until_force
  use dd3_tools_closest, only : hint_t, hit_t
  implicit none
  private
  public :: begin_phase, check_returns, gap_of_tool, place_supports, return_tools

  !> Largest number of advances of a pressed tool towards the sheet; each covers the smallest gap.
  integer, parameter :: most_advances = 200

contains

  !> Begin a phase: forces continue from their present values, those of lost constraints become
  !> forces that fade over the phase, and a pressed tool without contact approaches the sheet.
  !>
  !> A release is predicted elastic: beyond the maximum of the force, the tangents of loading would
  !> continue on the descending branch instead of unloading.
  subroutine begin_phase(model, number, state)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> The committed state.
    type(state_t), intent(inout) :: state

    real(wp) :: stored, force(3, model%n_node)
    integer :: tool, k, released_by(model%n_node)
    logical :: lost, tilted(model%n_tool), pressed(model%n_tool)

    tilted = .false.
    pressed = .false.
    if (number > 1) pressed = model%phase(number - 1)%pressed
    if (number > 1) tilted = [(model%phase(number - 1)%tilts(tool), tool=1, model%n_tool)]
    stored = contact_energy(model, state)
    force = 0.0_wp
    lost = .false.
    do k = 1, size(state%term)
      call state%term(k)%of%lose(model, number, state%configuration_t, force, lost)
      call state%term(k)%of%begin_phase(model, number, state%configuration_t)
    end do
    call free_directions(model, number, state, force, lost)
    call give_up_stresses(model, state, force)
    do tool = 1, model%n_tool
      if (model%returns(number, tool)) state%contact%hint(tool, :) = hint_t()
    end do
    state%phase = number
    state%begun = .true.
    state%progress = 0.0_wp
    call state%observed%begin_phase()
    state%open = .false.
    associate (phase => model%phase(number), start => state%start)
      start%x = state%x
      call begin_turns(phase, state)
      call begin_tilts(phase, tilted, state%tools)
      call set_tool_loads(phase, state)
      start%until_from_below = .true.
      if (phase%until%kind == until_force) start%until_from_below = &
          abs(until_value(phase, state)) <= phase%until%value
      call release_contacts(model, phase, state, force, released_by, lost)
      if (phase%unloaded .and. .not. any(phase%withdrawn) .and. (lost .or. number == 1)) then
        call fade_stresses(model, state, force, released_by)
      end if
      call hold_released(state%term, force, released_by, turns=number > 1)
      if (lost .or. any(phase%withdrawn)) state%sheet%plastic = .false.
      do tool = 1, model%n_tool
        if (phase%pressed(tool) .and. phase%active(tool)) call approach(model, tool, state)
      end do
      where (spread(phase%pressed .and. .not. pressed, 1, 3)) &
          state%tools%rest = state%tools%displacement
      call place_layers(model, number, state)
      start%layer_offset = state%tools%layer_offset
      start%held_offset = held_offsets(model, phase, state)
      start%tool_displacement = state%tools%displacement
      start%plastic_strain = state%sheet%internal_variables(1, :, :)
      start%elastic_energy = elastic_energy(model, state)
    end associate
    state%work%tools = state%work%tools + contact_energy(model, state) - stored
    state%external_force = external_forces(state%term, model, state%configuration_t)
  end subroutine begin_phase

  !> End the fading of stresses; what is left of their forces is added to those of lost constraints.
  subroutine give_up_stresses(model, state, force)
    type(model_t), intent(in) :: model
    !> The state at the end of the phase before.
    type(state_t), intent(inout) :: state
    !> Forces of the nodes on lost constraints, `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)

    if (.not. state%sheet%fades) return
    associate (left => model%phase(state%phase)%fading(state%progress))
      force = force - left*state%sheet%fading_force
      call state%sheet%end_fading(left)
    end associate
  end subroutine give_up_stresses

  !> Let the nodal forces of the stresses fade in place of those of lost constraints. Loads that go
  !> on are held in balance as long as these have not faded.
  subroutine fade_stresses(model, state, force, released_by)
    type(model_t), intent(in) :: model
    !> In the running phase, with its loads.
    type(state_t), intent(inout) :: state
    !> Forces of the nodes on lost constraints, `(3, n_node)`, N; get those that balance the loads.
    real(wp), intent(out) :: force(:, :)
    !> Tool that releases each node, `(n_node)`; gets none.
    integer, intent(out) :: released_by(:)

    call state%sheet%begin_fading()
    force = 0.0_wp
    released_by = 0
    call hold_released(state%term, force, released_by, turns=.false.)
    force = external_forces(state%term, model, state%configuration_t)
  end subroutine fade_stresses

  !> Put the tools that the phase before withdrew along paths of the program's choice back to where
  !> they were: they have no contact, and a phase that names them again tells their motion from
  !> there.
  pure subroutine return_tools(model, number, state)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> The state at the end of the phase before.
    type(state_t), intent(inout) :: state

    if (number == 1) return
    where (spread(model%phase(number - 1)%goes_back, 1, 3)) &
        state%tools%displacement = state%start%tool_displacement
  end subroutine return_tools

  !> Choose the supports of a phase that unloads the sheet anew where those of the start positions
  !> do not hold it: it has turned since.
  subroutine place_supports(model, number, x)
    type(model_t), intent(inout) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> Positions of the nodes at its start, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    integer, allocatable :: support(:, :)

    associate (phase => model%phase(number))
      if (size(phase%support, 2) == 0) return
      phase%prescribed = phase%led()
      call choose_supports(x, phase%prescribed, support, model%bound_nodes(), before=phase%support)
      phase%support = support
      if (.not. phase%floats) phase%prescribed = phase%held()
    end associate
  end subroutine place_supports

  !> Set the offsets of the layers of tools that begin to act, and of all where the layer or the
  !> formulation of the contact changes.
  subroutine place_layers(model, number, state)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> The tools stand at their positions at the start of the phase.
    type(state_t), intent(inout) :: state

    integer :: tool
    logical :: changes

    changes = .false.
    associate (phase => model%phase(number))
      if (number > 1) changes = abs(phase%layer - model%phase(number - 1)%layer) > 0.0_wp
      do tool = 1, model%n_tool
        if (.not. phase%active(tool)) cycle
        if (.not. (changes .or. model%begins(number, tool))) cycle
        state%tools%layer_offset(tool) = starting_offset(model, phase, state, tool)
      end do
    end associate
  end subroutine place_layers

  !> Report tools that return after their release and would start inside the sheet.
  subroutine check_returns(model, number, state, error)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> State at the end of the phase before.
    type(state_t), intent(in) :: state
    !> Set if a tool would start inside the sheet.
    type(error_t), allocatable, intent(out) :: error

    type(hit_t), allocatable :: hit(:)
    type(nearest_t) :: deepest
    character(len=:), allocatable :: advice
    integer :: tool, k

    do tool = 1, model%n_tool
      if (.not. model%returns(number, tool)) cycle
      hit = candidate_hits(model, tool, state%placement(tool), state%x, &
          model%tolerance%start_search, wrong_side_depth*model%largest_thickness())
      deepest = nearest_candidate(model, hit%distance, hit%distance, &
          hit%found .and. -hit%distance > start_depth)
      if (deepest%node == 0) cycle
      advice = "release it by `unload = on` instead of `at_once`, with a move clear of the sheet"
      do k = number - 1, 1, -1
        if (.not. model%phase(k)%active(tool)) cycle
        if (model%phase(k)%withdrawn(tool)) then
          advice = "move the tool clear of the sheet in the phase that releases it"
        end if
        exit
      end do
      call fatal_error(error, "phase '"//model%phase(number)%name//"' brings back tool '"// &
          model%tool(tool)%name//"', which was released, but node "// &
          to_text(deepest%node)//" is "//to_text(-deepest%distance, 3)// &
          " mm inside it: "//advice, "E206")
      return
    end do
  end subroutine check_returns

  !> Set the forces pressed on the tools at the start and at the end of a phase. A tool that was
  !> held or moved until now starts from the contact force on it in the direction of its line.
  subroutine set_tool_loads(phase, state)
    type(phase_t), intent(in) :: phase
    type(state_t), intent(inout) :: state

    integer :: tool

    associate (start => state%start)
      start%tool_load = 0.0_wp
      do tool = 1, size(phase%pressed)
        if (.not. phase%pressed(tool)) cycle
        if (norm2(state%tools%load(:, tool)) > 0.0_wp) then
          start%tool_load(:, tool) = state%tools%load(:, tool)
        else
          start%tool_load(:, tool) = phase%direction(:, tool) &
              *max(0.0_wp, -dot_product(phase%direction(:, tool), state%tools%force(:, tool)))
        end if
      end do
      start%tool_load_end = phase%tool_load_end
      where (spread(phase%pressed .and. phase%keeps_tool_load, 1, 3)) &
          start%tool_load_end = start%tool_load
    end associate
  end subroutine set_tool_loads

  !> Take the reactions of the directions that the phase frees from the forces of lost constraints.
  subroutine free_directions(model, number, state, force, lost)
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    !> The state at the end of the phase before.
    type(state_t), intent(in) :: state
    !> Forces of the nodes on lost constraints, `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)
    !> Set where a direction is freed.
    logical, intent(inout) :: lost

    real(wp) :: reaction(3, model%n_node)
    logical :: freed(3, model%n_node)

    freed = .false.
    if (number > 1) freed = model%phase(number - 1)%prescribed
    freed = freed .and. .not. model%phase(number)%prescribed
    reaction = reactions(model, state)
    where (.not. freed) reaction = 0.0_wp
    force = force - reaction
    lost = lost .or. any(freed)
  end subroutine free_directions

  !> Add the contact forces of tools that still touched at the end of their withdrawal to the forces
  !> of lost constraints.
  subroutine release_contacts(model, phase, state, force, released_by, lost)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(state_t), intent(inout) :: state
    !> Forces of the nodes on lost constraints, `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)
    !> Tool that releases each node, `(n_node)`; 0 for none.
    integer, intent(out) :: released_by(:)
    !> Set where a tool is released.
    logical, intent(inout) :: lost

    type(surface_point_t) :: point
    integer :: c, tool
    logical :: released

    released = .false.
    released_by = 0
    if (this_rank() > 0) force = 0.0_wp
    do c = 1, size(state%contact%tool)
      tool = state%contact%tool(c)
      if (tool == 0) cycle
      if (phase%active(tool)) cycle
      point = model%contact_point(c)%at_place(state%contact%place(c))
      call point%add_nodal_forces(state%x, state%contact%lambda(:, c), force)
      released_by(point%node(:point%n_surface)) = tool
      state%contact%lambda(:, c) = 0.0_wp
      state%contact%status(c) = status_gap
      state%contact%tool(c) = 0
      released = .true.
    end do
    call sum_over_ranks(size(force), force)
    call largest_over_ranks(size(released_by), released_by)
    call state%find_touching()
    lost = any_rank(released) .or. lost
  end subroutine release_contacts

  !> Move a pressed tool without contact along its line to first contact.
  subroutine approach(model, tool, state)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    type(state_t), intent(inout) :: state

    real(wp) :: gap, facing
    integer :: k

    if (state%tools%touches(tool)) return
    do k = 1, most_advances
      call gap_of_tool(model, tool, state, gap, facing)
      gap = min(gap, max(0.0_wp, spacer_room(model%phase(state%phase), state%tools, tool)))
      if (gap <= model%tolerance%closed .or. gap > model%tolerance%tool_search) return
      if (facing <= tangential) return
      state%tools%displacement(:, tool) = state%tools%displacement(:, tool) &
          + gap*model%phase(state%phase)%direction(:, tool)
    end do
  end subroutine approach

  !> Find the smallest gap between the contact layer of a pressed tool and its candidates.
  subroutine gap_of_tool(model, tool, state, gap, facing)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    type(state_t), intent(in) :: state
    !> Smallest gap, mm; a huge value if no candidate lies before the tool.
    real(wp), intent(out) :: gap
    !> Largest component of the tool's normals at these candidates along the direction of its force;
    !> negative if the force points away from the sheet.
    real(wp), intent(out) :: facing

    type(hit_t), allocatable :: hit(:)
    real(wp) :: largest(2)
    integer :: c

    hit = candidate_hits(model, tool, state%placement(tool), state%x, &
        model%tolerance%tool_search, model%tolerance%committed_depth, &
        outward_normals(model, state%x, model%touched_faces(tool)))
    largest = [-huge(1.0_wp), -1.0_wp]
    associate (phase => model%phase(state%phase))
      do c = 1, model%n_contact
        if (.not. hit(c)%found) cycle
        largest = max(largest, [-(hit(c)%distance + state%tools%layer_offset(tool) &
            - phase%layer*model%thickness_at(model%contact_node(c))), &
            dot_product(hit(c)%normal, phase%direction(:, tool))])
      end do
    end associate
    call largest_over_ranks(2, largest)
    gap = -largest(1)
    facing = largest(2)
  end subroutine gap_of_tool

end module dd3_process_phase_start
