! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact between the candidates and the tools: closest points and, in a committed state, gap to
!> the nearest tool and pressure, which is normal force over area.
module dd3_model_contact_results
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_reals, largest_over_ranks, rank_of_smallest, sum_over_ranks
  use dd3_contact_operator, only : status_gap
  use dd3_model_contact_layer, only : border_at, deflection_at
  use dd3_model_contact_areas, only : nodal_areas, point_areas
  use dd3_model_model, only : model_t
  use dd3_model_contact_data, only : all_faces, side_faces
  use dd3_model_outward_normals, only : nodal_normals, normals_for_tools, outward_normals
  use dd3_model_state, only : state_t
  use dd3_tools_closest, only : hint_t, hit_t
  use dd3_tools_placement, only : placement_t
  use dd3_tools_tool, only : find_on_tool
  implicit none
  private
  public :: candidate_hits, nearest_candidate, nearest_t
  public :: contact_gaps, contact_pressures, tool_contact_t, tool_contacts, tool_deflections
  public :: touching_tools

  !> Contact of a tool: area, mm2, and largest pressure, MPa.
  type :: tool_contact_t
    real(wp) :: area = 0.0_wp, pressure = 0.0_wp
  end type tool_contact_t

  !> Candidate nearest to a tool: its node, 0 for none, and distance, mm.
  type :: nearest_t
    integer :: node = 0
    real(wp) :: distance = huge(1.0_wp)
  end type nearest_t

contains

  !> Return the candidate with the smallest value of a measure of its distance.
  function nearest_candidate(model, distance, measure, counts) result(nearest)
    type(model_t), intent(in) :: model
    !> Distances of the contact points of this rank, their measure, mm, and whether they count,
    !> `(n_contact)`.
    real(wp), intent(in) :: distance(:), measure(:)
    logical, intent(in) :: counts(:)
    type(nearest_t) :: nearest

    real(wp) :: values(3)
    integer :: c, node

    values = huge(1.0_wp)
    node = huge(1)
    c = minloc(measure, dim=1, mask=counts)
    if (c > 0) then
      node = model%contact_node(c)
      values = [measure(c), real(node, wp), distance(c)]
    end if
    if (model%part%divided) call broadcast_reals(rank_of_smallest(values(1), node), 3, values)
    if (values(2) < huge(1.0_wp)) nearest = nearest_t(nint(values(2)), values(3))
  end function nearest_candidate

  !> Return the closest points to the contact points of this rank, `(n_contact)`; none is found for
  !> a point that is no candidate.
  pure function candidate_hits(model, tool, placement, x, search_distance, depth, outward) &
      result(hit)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    type(placement_t), intent(in) :: placement
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Largest distance outside the tool, and depth inside it, mm.
    real(wp), intent(in) :: search_distance, depth
    !> Outward normals of the sheet, `(3, n_contact)`.
    real(wp), intent(in), optional :: outward(:, :)
    type(hit_t), allocatable :: hit(:)

    type(hint_t) :: hint
    real(wp) :: facing(3)
    integer :: c

    allocate (hit(model%n_contact))
    facing = 0.0_wp
    do c = 1, model%n_contact_fixed
      if (.not. model%candidate(tool, c)) cycle
      hint = hint_t()
      if (present(outward)) facing = outward(:, c)
      call find_on_tool(model%tool(tool), placement, model%contact_point(c)%position(x), hint, &
          search_distance, depth, hit(c), facing)
    end do
  end function candidate_hits

  !> Return the pressures at the nodes, `(n_node)`, MPa, positive in compression: the larger one
  !> where tools touch the side and the rim of the sheet; zero for a node without contact faces.
  function contact_pressures(model, state) result(pressure)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable :: pressure(:)

    real(wp) :: area(model%n_node), own(model%n_node), lambda(3, model%n_contact)
    integer :: c, kind

    allocate (pressure(model%n_node), source=0.0_wp)
    do kind = side_faces, all_faces
      if (.not. any(model%touched_faces == kind)) cycle
      lambda = 0.0_wp
      do c = 1, model%n_contact
        if (state%contact%tool(c) == 0) cycle
        if (model%touched_faces(state%contact%tool(c)) == kind) lambda(:, c) = &
            state%contact%lambda(:, c)
      end do
      area = nodal_areas(model, state%x, kind)
      own = sum(nodal_normals(model, state%x, kind) &
          *model%nodal_contact_forces(state%x, lambda, state%contact%place), dim=1) &
          /max(area, tiny(1.0_wp))
      where (area > 0.0_wp .and. abs(own) > abs(pressure)) pressure = own
    end do
  end function contact_pressures

  !> Return the tool that each node touches, `(n_node)`; 0 for none.
  function touching_tools(model, state) result(tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, allocatable :: tool(:)

    allocate (tool(model%n_node), source=0)
    associate (n => model%n_contact_node)
      tool(model%contact_node(:n)) = &
          merge(state%contact%tool(:n), 0, state%contact%status(:n) /= status_gap)
    end associate
    call largest_over_ranks(size(tool), tool)
  end function touching_tools

  !> Return the contact of each tool, `(n_tool)`.
  function tool_contacts(model, state) result(contact)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(tool_contact_t), allocatable :: contact(:)

    real(wp) :: area(model%n_contact), normal(3, model%n_contact)
    integer :: c, kind

    allocate (contact(model%n_tool))
    do kind = side_faces, all_faces
      if (.not. any(model%touched_faces == kind)) cycle
      area = point_areas(model, state%x, kind)
      normal = outward_normals(model, state%x, kind)
      do c = 1, model%n_contact
        if (state%contact%status(c) == status_gap .or. state%contact%tool(c) == 0) cycle
        if (model%touched_faces(state%contact%tool(c)) /= kind .or. area(c) <= 0.0_wp) cycle
        associate (tool => contact(state%contact%tool(c)))
          tool%area = tool%area + area(c)
          tool%pressure = max(tool%pressure, dot_product(normal(:, c), state%contact%lambda(:, &
              c))/area(c))
        end associate
      end do
    end do
    call sum_over_ranks(size(contact), contact%area)
    call largest_over_ranks(size(contact), contact%pressure)
  end function tool_contacts

  !> Return the largest deflection of each tool, `(n_tool)`, mm: its compliance times the
  !> pressure, at points that do not move on edges of the mesh.
  function tool_deflections(model, state) result(deflection)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable :: deflection(:)

    real(wp) :: normal(3, model%n_contact, all_faces)
    integer :: c

    allocate (deflection(model%n_tool), source=0.0_wp)
    if (.not. any(model%tool%compliance > 0.0_wp)) return
    normal = normals_for_tools(model, state%x)
    do c = 1, model%n_contact_fixed
      if (state%contact%status(c) == status_gap .or. state%contact%tool(c) == 0) cycle
      associate (tool => state%contact%tool(c), &
          kind => model%touched_faces(state%contact%tool(c)))
        deflection(tool) = max(deflection(tool), model%tool(tool)%compliance &
            *dot_product(normal(:, c, kind), state%contact%lambda(:, c)) &
            /model%contact_area(c, kind))
      end associate
    end do
    call largest_over_ranks(size(deflection), deflection)
  end function tool_deflections

  !> Return the gaps at the nodes to the tools without force, `(n_node)`, mm; at most the search
  !> distance of the phase, which is also the value where no active tool is that near, and at a node
  !> that is no candidate.
  function contact_gaps(model, state) result(gap)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable :: gap(:)

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: outward(3, model%n_contact, all_faces)
    integer :: c, t

    associate (phase => model%phase(state%phase))
      allocate (gap(model%n_node), source=-phase%search_distance)
      outward = normals_for_tools(model, state%x)
      do c = 1, model%n_contact_node
        do t = 1, model%n_tool
          if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
          hint = state%contact%hint(t, c)
          call find_on_tool(model%tool(t), state%placement(t), &
              model%contact_point(c)%position(state%x), hint, &
              phase%search_distance, model%tolerance%committed_depth &
              + deflection_at(model, state, c) + state%tools%layer_offset(t), hit, &
              outward(:, c, model%touched_faces(t)), border_at(model, phase, c))
          if (hit%found) gap(model%contact_node(c)) = max(gap(model%contact_node(c)), -hit%distance)
        end do
      end do
    end associate
    call largest_over_ranks(size(gap), gap)
    gap = -gap
  end function contact_gaps

end module dd3_model_contact_results
