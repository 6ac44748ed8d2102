! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact layer of the tools in the compliant formulation, and penalty in the mixed one. A tool may
!> start at the sheet, inside the height of its layer. So that the sheet starts without pressure,
!> the layer begins behind its place by what is missing, and advances to it over the first part of
!> the phase. What is left of the offset at the end of the phase, or what a change of the layer or
!> of the formulation makes necessary, stays as long as the tool is held or withdrawn, and goes when
!> it moves otherwise or is pressed: the sheet between held tools keeps its force. The penalty of
!> the augmented Lagrangian does not change the converged solution; it weighs gap and slip against
!> forces where the contact status is decided.
module dd3_model_contact_layer
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks, sum_over_ranks
  use dd3_contact_compliant, only : layer_t, new_layer, place_under_force
  use dd3_contact_operator, only : status_gap
  use dd3_model_configuration, only : configuration_t, no_offset
  use dd3_model_contact_data, only : side_faces
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : is_normal_held, phase_t
  use dd3_model_state, only : state_t
  use dd3_tools_closest, only : border_t, hint_t, hit_t
  use dd3_tools_tool, only : find_on_tool
  implicit none
  private
  public :: layer_at, deflection_at, border_at, contact_penalty, starting_offset, held_offsets
  public :: layer_offset, layer_advances, offset_at, offset_rate, progress_left

  !> Part of the phase over which the layers advance.
  real(wp), parameter :: advance = 0.1_wp
  !> Radius of the border of a tool over the thickness of the sheet.
  real(wp), parameter :: border_radius = 0.5_wp
  !> Progress below which a rest is round-off.
  real(wp), parameter :: no_progress = 1.0e-9_wp
  !> Automatic penalty over the stiffness of the sheet under a candidate. Where a node closes, the
  !> linearisation leaves gaps and slips of the order of the curvature of tool and path; a penalty
  !> near the stiffness of the sheet turns them into forces that decide the status wrongly.
  real(wp), parameter :: fraction = 1.0e-3_wp

contains

  !> Return the layer of a tool at a candidate. An elastic tool deflects by the pressure on the area
  !> of the sheet without strain, as the layer does; it changes as the thickness does.
  pure type(layer_t) function layer_at(model, phase, tool, c) result(layer)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool, c

    associate (kind => model%touched_faces(tool))
      layer = new_layer(phase%layer, model%thickness_at(model%contact_node(c)), &
          model%contact_stiffness(c, kind))
      if (model%tool(tool)%compliance > 0.0_wp) layer%compliance = &
          model%tool(tool)%compliance/model%contact_area(c, kind)
    end associate
  end function layer_at

  !> Return an upper bound of the deflection of a candidate's tool, mm: by the norm of the contact
  !> force. By as much a candidate in equilibrium may lie inside the tool's surface.
  pure real(wp) function deflection_at(model, state, c) result(deflection)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: c

    deflection = 0.0_wp
    associate (tool => state%contact%tool(c))
      if (tool == 0) return
      if (model%tool(tool)%compliance > 0.0_wp) deflection = model%tool(tool)%compliance &
          *norm2(state%contact%lambda(:, c))/model%contact_area(c, model%touched_faces(tool))
    end associate
  end function deflection_at

  !> Return the contact of a candidate beside the border of a tool: within the layer. In the mixed
  !> formulation there is none.
  pure type(border_t) function border_at(model, phase, c) result(border)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c

    if (.not. phase%layer > 0.0_wp) return
    associate (thickness => model%thickness_at(model%contact_node(c)))
      border = border_t(border_radius*thickness, phase%layer*thickness)
    end associate
  end function border_at

  !> Return the penalty of a candidate, N/mm: that of the input, or the automatic one if there is
  !> none in the input.
  pure real(wp) function contact_penalty(model, phase, c)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Number of the candidate.
    integer, intent(in) :: c

    contact_penalty = phase%penalty
    if (phase%penalty <= 0.0_wp) contact_penalty = fraction &
        *model%contact_stiffness(c, side_faces)
  end function contact_penalty

  !> Whether the layer of a tool advances to its place in a phase.
  pure logical function layer_advances(model, number, tool)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    integer, intent(in) :: tool

    associate (phase => model%phase(number))
      layer_advances = model%begins(number, tool) .or. phase%pressed(tool) .or. phase%moves(tool)
      layer_advances = layer_advances .and. .not. phase%withdrawn(tool)
    end associate
  end function layer_advances

  !> Return the offset of the layer of a tool at the progress of a state, mm.
  pure real(wp) function layer_offset(model, state, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool

    layer_offset = state%start%layer_offset(tool)
    if (layer_advances(model, state%phase, tool)) layer_offset = layer_offset &
        *progress_left(state%progress)/advance
  end function layer_offset

  !> Return the progress after which the layers are in their places.
  pure real(wp) function progress_left(progress)
    real(wp), intent(in) :: progress

    progress_left = max(0.0_wp, advance - progress)
    if (progress_left <= no_progress) progress_left = 0.0_wp
  end function progress_left

  !> Return the distance by which the layer of a tool lies behind its place at a point, mm.
  pure real(wp) function offset_at(state, tool, c)
    class(configuration_t), intent(in) :: state
    integer, intent(in) :: tool, c

    offset_at = state%tools%layer_offset(tool)
    if (state%start%held_offset(c) > no_offset) offset_at = state%start%held_offset(c)
  end function offset_at

  !> Return the derivative of the offset of a layer behind the progress of a state, mm.
  pure real(wp) function offset_rate(model, state, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool

    offset_rate = 0.0_wp
    if (.not. progress_left(state%progress) > 0.0_wp) return
    if (layer_advances(model, state%phase, tool)) offset_rate = &
        -state%start%layer_offset(tool)/advance
  end function offset_rate

  !> Return the offset with which a tool starts, mm: such that the sheet keeps the force on a tool
  !> in contact in the mean of its points, and that a tool without contact has no pressure in its
  !> layer. It is negative for a layer that is lower than the one before.
  function starting_offset(model, phase, state, tool) result(offset)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    real(wp) :: offset

    type(hint_t) :: hint
    type(hit_t) :: hit
    type(layer_t) :: layer
    !> Sums of the forces and of their products with the offsets; largest penetration, mm.
    real(wp) :: force, sums(2), missing(1)
    integer :: c

    missing = 0.0_wp
    sums = 0.0_wp
    do c = 1, model%n_contact_fixed
      if (.not. model%candidate(tool, c)) cycle
      layer = layer_at(model, phase, tool, c)
      hint = hint_t()
      call find_on_tool(model%tool(tool), state%placement(tool), &
          model%contact_point(c)%position(state%x), hint, &
          max(layer%height, phase%search_distance), model%tolerance%committed_depth &
          + deflection_at(model, state, c) + state%tools%layer_offset(tool), hit, &
          border=border_at(model, phase, c))
      if (.not. hit%found) cycle
      force = 0.0_wp
      if (state%contact%tool(c) == tool .and. state%contact%status(c) /= status_gap) then
        force = max(0.0_wp, -dot_product(state%contact%lambda(:, c), hit%normal))
      end if
      missing = max(missing, layer%height - hit%distance)
      sums = sums + force*[1.0_wp, place_under_force(layer, force) - hit%distance]
    end do
    call largest_over_ranks(1, missing)
    call sum_over_ranks(2, sums)
    offset = merge(missing(1), 0.0_wp, phase%layer > 0.0_wp)
    if (sums(1) > 0.0_wp) offset = sums(2)/sums(1)
  end function starting_offset

  !> Return the offsets at the points that prescribed displacements hold along the normal, mm,
  !> `no_offset` at others, `(n_contact)`: such that the force stays that at the start of the phase.
  !> The displacements there do not follow from the contact.
  function held_offsets(model, phase, state) result(offset)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> At the start of the phase.
    type(state_t), intent(in) :: state
    real(wp), allocatable :: offset(:)

    type(hint_t) :: hint
    type(hit_t) :: hit
    type(layer_t) :: layer
    real(wp) :: force, kept
    integer :: c, t, i

    allocate (offset(model%n_contact), source=no_offset)
    if (.not. phase%layer > 0.0_wp) return
    do c = 1, model%n_contact_fixed
      associate (point => model%contact_point(c))
        if (.not. all(any(phase%prescribed(:, point%node(:point%n_surface)), dim=1))) cycle
        do t = 1, model%n_tool
          if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
          layer = layer_at(model, phase, t, c)
          hint = hint_t()
          call find_on_tool(model%tool(t), state%placement(t), &
              model%contact_point(c)%position(state%x), hint, &
              max(layer%height, phase%search_distance), model%tolerance%committed_depth &
              + deflection_at(model, state, c) + offset_at(state, t, c), hit, &
              border=border_at(model, phase, c))
          if (.not. hit%found) cycle
          if (.not. all([(is_normal_held(phase, point%node(i), hit%normal), &
              i=1, point%n_surface)])) cycle
          force = 0.0_wp
          if (state%contact%tool(c) == t) force = max(0.0_wp, &
              -dot_product(state%contact%lambda(:, c), &
              hit%normal))
          kept = place_under_force(layer, force) - hit%distance
          if (force > 0.0_wp) offset(c) = kept
          if (force > 0.0_wp) exit
          if (hit%distance <= layer%height) offset(c) = max(offset(c), kept)
        end do
      end associate
    end do
  end function held_offsets

end module dd3_model_contact_layer
