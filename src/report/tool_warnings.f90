! SPDX-License-Identifier: GPL-3.0-or-later
!> Warnings about the tools at the end of a phase, or of a run that stops within one: without
!> contact, entered between the nodes of the sheet, left over an open edge, ironing with contact
!> points between nodes, crossed.
module dd3_report_tool_warnings
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : to_text
  use dd3_model_contact_results, only : candidate_hits, nearest_candidate, nearest_t, &
      touching_tools
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_tolerances, only : notable_depth
  use dd3_process_open_edges, only : edge_name
  use dd3_report_suitable_levels, only : halvings, levels_advice
  use dd3_report_tool_crossing, only : crossing_t, find_crossing
  use dd3_settings_adaptive, only : adaptive_spec_t
  use dd3_tools_closest, only : hit_t
  implicit none
  private
  public :: add_tool_warnings, depth_warning

  !> Depth between the nodes that is reported, besides `notable_depth` thicknesses, relative to the
  !> edges of the face: the sagitta l/(8R) of a chord l on a radius R is pi/64 with four elements to
  !> the quarter circle. A smaller depth than `slight_depth` thicknesses is not reported.
  real(wp), parameter :: notable_slope = acos(-1.0_wp)/64.0_wp
  real(wp), parameter :: slight_depth = 0.02_wp
  !> Radius of a tool over the length of an element from which it is plane there.
  real(wp), parameter :: plane_radius = 1.0e3_wp

contains

  !> Add the warnings.
  subroutine add_tool_warnings(model, state, ended, adaptive, warnings)
    type(model_t), intent(in) :: model
    !> Last state of the phase.
    type(state_t), intent(in) :: state
    !> Whether the phase has reached its end. Before that, a tool may yet come to the sheet.
    logical, intent(in) :: ended
    type(adaptive_spec_t), intent(in) :: adaptive
    type(message_list_t), intent(inout) :: warnings

    integer :: a, b

    associate (phase => model%phase(state%phase), active => model%phase(state%phase)%active)
      do a = 1, model%n_tool
        if (.not. active(a)) cycle
        if (ended .and. .not. phase%withdrawn(a)) then
          call add("W108", contact_warning(model, state, a))
        end if
        if (.not. phase%withdrawn(a)) call add("W109", depth_warning(model, state, a, adaptive))
        call add("W110", edge_warning(model, state, a))
        do b = a + 1, model%n_tool
          if (.not. active(b)) cycle
          call add("W111", crossing_warning(model, state, a, b))
          call add("W112", ironing_warning(model, state, a, b))
        end do
      end do
    end associate

  contains

    !> Add a warning that is not empty.
    subroutine add(code, text)
      character(len=*), intent(in) :: code, text

      if (len(text) > 0) call warnings%add_new(code, "in phase '"// &
          model%phase(state%phase)%name//"' "//text)
    end subroutine add

  end subroutine add_tool_warnings

  !> Return a warning if a tool was moved or pressed in the phase and has never touched the sheet,
  !> unless it stands before the sheet, by less than its thickness, in a given gap to another tool
  !> or for the next phase, which moves or presses it.
  function contact_warning(model, state, tool) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    character(len=:), allocatable :: text

    type(hit_t), allocatable :: hit(:)
    type(nearest_t) :: nearest
    integer :: k

    text = ""
    associate (phase => model%phase(state%phase))
      if (state%tools%touched(tool)) return
      if (.not. (phase%pressed(tool) .or. phase%moves(tool))) return
    end associate
    associate (distance => model%tolerance%tool_search)
      hit = candidate_hits(model, tool, state%placement(tool), state%x, distance, distance)
    end associate
    nearest = nearest_candidate(model, hit%distance, abs(hit%distance), hit%found)
    if (nearest%node > 0 .and. nearest%distance >= 0.0_wp .and. &
        nearest%distance < model%thickness) then
      if (model%phase(state%phase)%gap_other(tool) > 0) return
      do k = state%phase + 1, min(state%phase + 1, size(model%phase))
        if (model%phase(k)%pressed(tool) .or. model%phase(k)%moves(tool)) return
      end do
    end if
    text = "tool '"//model%tool(tool)%name//"' moved without touching the sheet; at its end "
    if (nearest%node > 0) then
      text = text//"the nearest candidate, node "//to_text(nearest%node)//", is "// &
          to_text(abs(nearest%distance), 3)//" mm "// &
          trim(merge("behind   ", "in front ", nearest%distance < 0.0_wp))//" of its surface"
    else
      text = text//"no candidate lies in front of its surface"
    end if
    if (state%observed%largest_depth(tool) > 0.0_wp) then
      text = text//"; it passed between the nodes"
    else
      text = text//"; check its place, its normals and its set of candidates"
    end if
  end function contact_warning

  !> Return a warning if a tool has entered the faces of the sheet notably between their nodes.
  function depth_warning(model, state, tool, adaptive) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    type(adaptive_spec_t), intent(in) :: adaptive
    character(len=:), allocatable :: text

    real(wp) :: edge(3, 4), length, part, expected
    integer :: level

    text = ""
    if (state%observed%deepest_face(tool) == 0) return
    associate (depth => state%observed%largest_depth(tool)/model%thickness, &
        face => model%face%corner(:, state%observed%deepest_face(tool)))
      edge = state%x(:, face) - state%x(:, cshift(face, 1))
      length = maxval(norm2(edge, dim=1))
      part = length/real(parts_of_edge(model), wp)
      if (depth < slight_depth) return
      if (depth < notable_depth &
          .and. state%observed%largest_depth(tool) < notable_slope*part) return
      text = "tool '"//model%tool(tool)%name//"' entered the sheet between its nodes by up to "// &
          to_text(state%observed%largest_depth(tool), 3)//" mm ("//to_text(depth, 2)// &
          " thicknesses), at the face of element "// &
          to_text(model%face%element(state%observed%deepest_face(tool)))//" with edges up to "// &
          to_text(length, 3)//" mm long: the mesh is too coarse for the tool; expected "
    end associate
    associate (radius => state%observed%deepest_radius(tool))
      if (radius >= plane_radius*length) then
        text = text//"a line of nodes along the edge of the tool, or a radius there"
        return
      end if
      expected = length/part*suitable_length(min(radius, &
          part**2/(8.0_wp*state%observed%largest_depth(tool))), model%thickness)
      text = text//"elements at most "//to_text(expected, 3)//" mm long on its radius of "// &
          to_text(radius, 3)//" mm"
    end associate
    if (adaptive%levels == 0) return
    level = halvings(length, expected)
    if (allocated(model%level)) then
      level = level + model%level(model%face%element(state%observed%deepest_face(tool)))
    end if
    text = text//": "//levels_advice(adaptive, level, length/2.0_wp**halvings(length, expected))
  end function depth_warning

  !> Return the number of parts of an edge between contact points; 1 for faces with more than four
  !> nodes.
  pure integer function parts_of_edge(model)
    type(model_t), intent(in) :: model

    parts_of_edge = 1
    if (size(model%face%node, 1) == 4) then
      parts_of_edge = nint(sqrt(real(size(model%face_point, 1), wp))) - 1
    end if
  end function parts_of_edge

  !> Return the length between contact points with which a radius gives no warning, mm: the depth
  !> l**2/(8R) of elements of length l is slight, or notable neither for the thickness nor for the
  !> length. Where the tool is curved in two directions, or along the diagonal of a face, the radius
  !> is that of a cylinder that enters the elements as deep.
  pure real(wp) function suitable_length(radius, thickness) result(length)
    !> mm.
    real(wp), intent(in) :: radius, thickness

    length = max(sqrt(8.0_wp*radius*slight_depth*thickness), &
        min(sqrt(8.0_wp*radius*notable_depth*thickness), 8.0_wp*radius*notable_slope))
  end function suitable_length

  !> Return a warning if the sheet has left a tool under pressure where its surface ends.
  function edge_warning(model, state, tool) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    character(len=:), allocatable :: text

    text = ""
    associate (place => state%observed%open_edge(:, tool), &
        moved => state%observed%open_edge_displacement(tool))
      if (place(1) == 0) return
      text = "the sheet left tool '"//model%tool(tool)%name//"' under pressure over the open "// &
          edge_name(place(1), place(2))//", first at node "//to_text(place(3))
      if (moved > 0.0_wp) text = text//" after "//to_text(moved, 4)//" mm of the tool"
    end associate
    if (model%phase(state%phase)%mixed) then
      text = text//"; there is no contact beyond it"
    else
      text = text//"; it is rounded by half the thickness of the sheet"
    end if
    text = text//": if the tool goes on, continue its surface"
  end function edge_warning

  !> Return a warning if two tools have crossed in the phase.
  function crossing_warning(model, state, a, b) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: a, b
    character(len=:), allocatable :: text

    type(crossing_t) :: crossing

    text = ""
    crossing = find_crossing(model, state, a, b)
    if (crossing%depth <= 0.0_wp) return
    text = "tools '"//model%tool(a)%name//"' and '"//model%tool(b)%name// &
        "' crossed each other: they overlap by "//to_text(crossing%depth, 3)//" mm near "// &
        to_text(crossing%x(1), 4)//" "//to_text(crossing%x(2), 4)//" "//to_text(crossing%x(3), 4)
  end function crossing_warning

  !> Return a warning if two tools that move relative to each other pinch the sheet in a given
  !> clearance and contact points lie between its nodes too: there the transverse shear of a column
  !> of nodes, which ironing grades along the sheet, is taken for a curvature of the surface, and
  !> the points thin the sheet too much.
  function ironing_warning(model, state, a, b) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Tools.
    integer, intent(in) :: a, b
    character(len=:), allocatable :: text

    integer :: touching(model%n_node)
    integer :: node, pinched

    text = ""
    ! The points of a face are its nodes.
    if (size(model%face_point, 1) == size(model%face%node, 1)) return
    associate (phase => model%phase(state%phase))
      if (any(phase%pressed([a, b]))) return
      if (norm2(phase%move(:, a) - phase%move(:, b)) <= 0.0_wp) return
    end associate
    touching = touching_tools(model, state)
    pinched = 0
    do node = 1, model%n_node
      if (touching(node) /= a .or. model%opposite(node) == 0) cycle
      if (touching(model%opposite(node)) == b) pinched = pinched + 1
    end do
    if (pinched == 0) return
    text = "tools '"//model%tool(a)%name//"' and '"//model%tool(b)%name// &
        "' pinch the sheet at "//to_text(pinched)//" columns of nodes: where it is ironed, "// &
        "forces are too low with contact points between the nodes; compare with points = 1 in "// &
        "*CONTACT"
  end function ironing_warning

end module dd3_report_tool_warnings
