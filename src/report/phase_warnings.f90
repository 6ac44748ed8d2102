! SPDX-License-Identifier: GPL-3.0-or-later
!> Notes and warnings at the start and at the end of a phase: nodes that stay held, a pressed tool
!> without contact, an unsupported sheet, yielding during a release, gaps of the contact layers, and
!> those on chosen supports, on tools and on the refinement.
module dd3_report_phase_warnings
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : to_text
  use dd3_contact_compliant, only : gap_under_force
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_tensor, only : identity
  use dd3_model_contact_layer, only : deflection_at, layer_at
  use dd3_model_contact_results, only : tool_contact_t, tool_contacts, tool_deflections
  use dd3_model_energy, only : elastic_energy, energy_error
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_rigid_motion, only : new_supported_part, part_name, parts_of_nodes, &
      rigid_motion_t
  use dd3_model_state, only : state_t
  use dd3_model_terms_loads, only : is_laid_down
  use dd3_model_terms_released, only : has_released
  use dd3_model_terms_viscous, only : viscous_work
  use dd3_model_tolerances, only : tangential
  use dd3_model_tool_supports, only : spacer_force
  use dd3_process_phase_end, only : phase_is_over, until_met, until_tolerance, until_value
  use dd3_process_phase_start, only : gap_of_tool
  use dd3_report_heated_sheet, only : heat_warning
  use dd3_report_limits_reached, only : limits_note
  use dd3_report_necked_sheet, only : necking_warning
  use dd3_report_refinement_warnings, only : add_refinement_warnings
  use dd3_report_tool_warnings, only : add_tool_warnings
  use dd3_report_unload_report, only : add_reactions, imbalance_warning, unload_note
  use dd3_settings_adaptive, only : adaptive_spec_t
  use dd3_settings_until, only : until_force
  use dd3_tools_closest, only : hint_t, hit_t
  use dd3_tools_tool, only : find_on_tool
  implicit none
  private
  public :: start_notes, end_notes
  public :: energy_warning, gap_note, press_warning, release_warning, snap_warning
  public :: support_warning, until_warning

  !> Increase of plastic strain in a release that is reported.
  real(wp), parameter :: notable_strain = 1.0e-3_wp

  !> Part by which the force of spacers exceeds that of their tool that is reported.
  real(wp), parameter :: notable_push = 1.0e-2_wp

  !> Work of viscous forces over the elastic energy released that is reported.
  real(wp), parameter :: notable_damping = 1.0e-3_wp

  !> Error of the energy balance over the work of a run that is reported, where the plastic work is
  !> that multiple of the elastic energy: before, the closing of the contact outweighs the forming.
  real(wp), parameter :: notable_energy = 0.05_wp, formed = 20.0_wp

contains

  !> Return the notes and warnings at the start of the running phase.
  subroutine start_notes(model, state, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(message_list_t), intent(out) :: notes

    associate (phase => model%phase(state%phase))
      if (len(phase%kept_displacements) > 0) call notes%add_new("N101", "phase '"//phase%name// &
          "' keeps directions where earlier phases displaced them: "//phase%kept_displacements// &
          " (`free` frees them)")
      call notes%add_new("W102", press_warning(model, state))
      call notes%add_new("W129", spacer_warning(model, state))
      call notes%add_new("W103", support_warning(model, state))
      call notes%add_new("N102", unload_note(model, state))
      call notes%add_new("W104", imbalance_warning(model, state))
      if (phase_is_over(model, state)) call notes%add_new("N105", "phase '"//phase%name// &
          "' has no increment: the condition of its early end holds at its start")
    end associate
  end subroutine start_notes

  !> Return the notes and warnings on the running phase at its end, or where the run stops in it.
  subroutine end_notes(model, state, ended, adaptive, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Whether the phase has reached its end.
    logical, intent(in) :: ended
    type(adaptive_spec_t), intent(in) :: adaptive
    type(message_list_t), intent(out) :: notes

    if (ended) then
      call notes%add_new("W105", until_warning(model%phase(state%phase), state))
      call notes%add_new("W106", release_warning(model, state))
      call notes%add_new("W116", snap_warning(model, state, elastic_energy(model, state)))
      call add_reactions(model, state, notes)
      call notes%add_new("N104", gap_note(model, state))
      call notes%add_new("N110", deflection_note(model, state))
      if (state%phase == size(model%phase)) then
        call notes%add_new("W115", energy_warning(state, elastic_energy(model, state), &
          energy_error(model, state)))
      end if
    end if
    if (.not. ended .or. state%phase == size(model%phase)) then
      call notes%add_new("W123", necking_warning(model, state))
      call notes%add_new("W128", heat_warning(model, state))
      call notes%add_new("N111", limits_note(model, state))
    end if
    call add_tool_warnings(model, state, ended, adaptive, notes)
    call add_refinement_warnings(model, state, adaptive, notes)
  end subroutine end_notes

  !> Return a warning if a phase with an early end went on to its end, or beyond the value that
  !> should end it; empty otherwise.
  function until_warning(phase, state) result(text)
    type(phase_t), intent(in) :: phase
    !> State at the end of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    character(len=:), allocatable :: quantity, unit, fault
    real(wp) :: excess

    text = ""
    if (phase%until%tool == 0) return
    fault = "without meeting"
    if (until_met(phase, state)) then
      excess = abs(until_value(phase, state)) - phase%until%value
      if (.not. state%start%until_from_below) excess = -excess
      if (excess <= until_tolerance(phase)*phase%until%value) return
      fault = "beyond"
    end if
    quantity = "displacement"
    unit = " mm"
    if (phase%until%kind == until_force) then
      quantity = "force"
      unit = " N"
    end if
    text = "phase '"//phase%name//"' ended "//fault//" its `until`: the "//quantity// &
        " is "//to_text(abs(until_value(phase, state)), 4)//unit//", not "// &
        to_text(phase%until%value)//unit
  end function until_warning

  !> Return a warning if a pressed tool has no contact at the start of a phase because its force
  !> points the wrong way, or no candidate lies ahead of it; empty otherwise.
  function press_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the start of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: gap, facing
    integer :: tool

    text = ""
    associate (phase => model%phase(state%phase))
      do tool = 1, model%n_tool
        if (.not. (phase%pressed(tool) .and. phase%active(tool))) cycle
        if (state%tools%touches(tool)) cycle
        call gap_of_tool(model, tool, state, gap, facing)
        if (facing > tangential .and. gap <= model%tolerance%touch) cycle
        text = "in phase '"//phase%name//"' the pressed tool '"//model%tool(tool)%name// &
            "' does not meet the sheet along its force"
        if (gap <= model%tolerance%tool_search .and. facing < -tangential) text = &
            "in phase '"//phase%name//"' the force on tool '"//model%tool(tool)%name// &
            "' points away from the sheet; is its sign wrong?"
        return
      end do
    end associate
  end function press_warning

  !> Return a warning if the spacers of a pressed tool push it back at the start of a phase by more
  !> than its force, which no equilibrium leaves; empty otherwise.
  function spacer_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the start of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: force, load
    integer :: tool

    text = ""
    associate (phase => model%phase(state%phase))
      do tool = 1, model%n_tool
        if (.not. phase%pressed(tool)) cycle
        force = spacer_force(phase, state%tools, tool)
        load = norm2(state%tools%load(:, tool))
        if (.not. phase%keeps_tool_load(tool)) load = max(load, norm2(phase%tool_load_end(:, tool)))
        if (force <= (1.0_wp + notable_push)*load) cycle
        text = "at the start of phase '"//phase%name//"' spacers push tool '"// &
            model%tool(tool)%name//"' back by "//to_text(force)//" N, more than its force of "// &
            to_text(load)//" N: it begins below the gap of the spacer, by which it is moved back"
        return
      end do
    end associate
  end function spacer_warning

  !> Return a warning if neither supports nor tools in contact hold the sheet, or a part of it, at
  !> the start of a phase; empty otherwise, and where it is laid down.
  function support_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the start of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    type(rigid_motion_t) :: body
    integer :: part(model%n_node), k, tool

    text = ""
    if (is_laid_down(state%term)) return
    part = parts_of_nodes(model%connectivity, model%n_node)
    associate (phase => model%phase(state%phase))
      do k = 1, maxval(part)
        call new_supported_part(body, state%x, phase%held(), part == k)
        if (len(body%free_motion()) == 0) cycle
        do tool = 1, model%n_tool
          if (phase%active(tool)) call hold_in_contact(body, model, state, tool, part == k)
        end do
        call body%share()
        text = body%free_motion()
        if (len(text) == 0) cycle
        text = "at the start of phase '"//phase%name//"' nothing holds "// &
            part_name(part, k)//": it is free to "//text//"; supports are missing, or a tool "// &
            "in contact from the start"
        return
      end do
    end associate
  end function support_warning

  !> Hold a body where a tool is in contact, in the normal direction and, with friction, in the
  !> tangential ones; a pressed tool does not hold along its line.
  subroutine hold_in_contact(body, model, state, tool, member)
    type(rigid_motion_t), intent(inout) :: body
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    !> Nodes of the body, `(n_node)`.
    logical, intent(in) :: member(:)

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: direction(3), normal(3)
    integer :: c, d

    do c = 1, model%n_contact_fixed
      if (.not. (model%candidate(tool, c) .and. member(model%contact_node(c)))) cycle
      associate (x => model%contact_point(c)%position(state%x), phase => model%phase(state%phase))
        if (state%contact%tool(c) == tool .and. norm2(state%contact%lambda(:, c)) > 0.0_wp) then
          normal = state%contact%lambda(:, c)/norm2(state%contact%lambda(:, c))
        else
          hint = hint_t()
          call find_on_tool(model%tool(tool), state%placement(tool), x, hint, &
              model%tolerance%touch + phase%layer*model%thickness_at(model%contact_node(c)), &
              model%tolerance%committed_depth + deflection_at(model, state, c) &
              + state%tools%layer_offset(tool), hit)
          if (.not. hit%found) cycle
          normal = hit%normal
        end if
        do d = 0, 3
          direction = normal
          if (d > 0) direction = model%tool(tool)%friction%coefficient*identity(:, d)
          if (phase%pressed(tool)) direction = direction &
              - dot_product(direction, phase%direction(:, tool))*phase%direction(:, tool)
          call body%hold(x, direction)
        end do
      end associate
    end do
  end subroutine hold_in_contact

  !> Return a warning if the sheet yields while nothing acts on it but fading forces of lost
  !> constraints: then the free shape depends on how they fade; empty otherwise.
  function release_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the end of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: increase(model%n_element)
    integer :: e, t

    text = ""
    if (.not. (has_released(state%term) .or. state%sheet%fades)) return
    associate (phase => model%phase(state%phase))
      if (phase%control > 0 .or. any(phase%pressed .or. phase%withdrawn)) return
      if (any(abs(phase%move) > 0.0_wp) .or. any(phase%gap_other > 0) &
          .or. any([(phase%turns(t), t=1, model%n_tool)])) return
      if (any(abs(phase%displacement) > 0.0_wp) .or. size(phase%motion) > 0 &
          .or. .not. (all(phase%loads%keeps) .and. all(phase%pressures%keeps))) return
    end associate
    increase = 0.0_wp
    increase(model%part%element) = &
        maxval(state%sheet%internal_variables(1, :, :) - state%start%plastic_strain, dim=1)
    call sum_over_ranks(size(increase), increase)
    e = maxloc(increase, dim=1)
    if (increase(e) > notable_strain) text = "in phase '"// &
        model%phase(state%phase)%name//"' the plastic strain of element "//to_text(e)// &
        " increased by "//to_text(increase(e), 3)// &
        " while the forces of lost constraints faded: the free shape depends on how they fade"
  end function release_warning

  !> Return a warning if viscous forces took more than a small fraction of the change of the elastic
  !> energy in a phase (in a release the energy set free): the sheet has snapped; empty otherwise.
  function snap_warning(model, state, elastic) result(text)
    type(model_t), intent(in) :: model
    !> State at the end of the phase.
    type(state_t), intent(in) :: state
    !> Elastic energy, mJ.
    real(wp), intent(in) :: elastic
    character(len=:), allocatable :: text

    real(wp) :: work, change

    text = ""
    work = viscous_work(state%term)
    change = max(abs(elastic - state%start%elastic_energy), tiny(1.0_wp))
    if (work > notable_damping*change) text = "in phase '"//model%phase(state%phase)%name// &
        "' the sheet snapped: viscous forces took "//to_text(work, 3)//" mJ, "// &
        to_text(100.0_wp*work/change, 2)//" % of the change of the elastic energy"
  end function snap_warning

  !> Return a warning if the energy balance at the end of a run is far from closed; empty otherwise.
  function energy_warning(state, elastic, error) result(text)
    type(state_t), intent(in) :: state
    !> Elastic energy, and error of the balance, mJ.
    real(wp), intent(in) :: elastic, error
    character(len=:), allocatable :: text

    real(wp) :: work

    text = ""
    if (state%work%plastic < formed*elastic) return
    work = max(abs(state%work%tools), abs(state%work%external), abs(state%work%internal))
    if (abs(error) > notable_energy*work) text = "the energy balance of the run is off by "// &
        to_text(100.0_wp*abs(error)/work, 2)//" % of its work: the increments are too "// &
        "large; compare with `accuracy = fine` in *LIMITS"
  end function energy_warning

  !> Return a note on the mean gap between sheet and tools, weighted by the contact forces: what the
  !> layers keep the sheet off the tools. Friction counts in the forces, about 1 % of them. Empty in
  !> the mixed formulation and without contact.
  function gap_note(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the end of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: moment(model%n_tool), total(model%n_tool), force
    integer :: c, tool

    text = ""
    associate (phase => model%phase(state%phase))
      if (phase%mixed) return
      moment = 0.0_wp
      total = 0.0_wp
      do c = 1, model%n_contact
        if (state%contact%status(c) == status_gap) cycle
        force = norm2(state%contact%lambda(:, c))
        associate (t => state%contact%tool(c))
          moment(t) = moment(t) + force*gap_under_force(layer_at(model, phase, t, c), force)
          total(t) = total(t) + force
        end associate
      end do
      call sum_over_ranks(size(moment), moment)
      call sum_over_ranks(size(total), total)
      do tool = 1, model%n_tool
        if (total(tool) <= 0.0_wp) cycle
        text = text//", "//to_text(moment(tool)/total(tool), 2)//" mm at '"// &
            model%tool(tool)%name//"'"
      end do
      if (len(text) > 0) text = "phase '"//phase%name// &
          "': mean gap in the contact layers by force"//text(2:)
    end associate
  end function gap_note

  !> Return a note on the largest deflection of elastic tools; empty without them.
  function deflection_note(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the end of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    type(tool_contact_t) :: contact(model%n_tool)
    real(wp) :: deflection(model%n_tool)
    integer :: tool

    text = ""
    deflection = tool_deflections(model, state)
    if (.not. any(deflection > 0.0_wp)) return
    contact = tool_contacts(model, state)
    do tool = 1, model%n_tool
      if (deflection(tool) <= 0.0_wp) cycle
      text = text//", '"//model%tool(tool)%name//"' "//to_text(deflection(tool), 3)// &
          " mm, pressure up to "//to_text(contact(tool)%pressure, 3)//" MPa"
    end do
    if (len(text) > 0) text = "phase '"//model%phase(state%phase)%name// &
        "': largest deflection of elastic tools"//text(2:)
  end function deflection_note

end module dd3_report_phase_warnings
