! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact between the candidates and the tools: closest points and, in a committed state, gap to
!> the nearest tool and pressure, which is normal force over area.
module dd3_model_contact_results
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : hint_t, hit_t
  use dd3_contact_operator, only : status_gap
  use dd3_contact_placement, only : placement_t
  use dd3_contact_tool, only : find_on_tool
  use dd3_model_contact_layer, only : border_at
  use dd3_model_contact_points, only : nodal_areas, point_areas
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : nodal_normals, outward_normals
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: candidate_hits, contact_gaps, contact_pressures, tool_contact_t, tool_contacts

  !> Contact of a tool: area, mm2, and largest pressure, MPa.
  type :: tool_contact_t
    real(wp) :: area = 0.0_wp, pressure = 0.0_wp
  end type tool_contact_t

contains

  !> Return the closest points, `(n_contact)`; none is found for a point that is no candidate.
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
    do c = 1, model%n_contact
      if (.not. model%candidate(tool, c)) cycle
      hint = hint_t()
      if (present(outward)) facing = outward(:, c)
      call find_on_tool(model%tool(tool), placement, model%contact_point(c)%position(x), hint, &
          search_distance, depth, hit(c), facing)
    end do
  end function candidate_hits

  !> Return the pressures at the nodes, `(n_node)`, MPa, positive in compression; zero for a node
  !> without contact faces.
  pure function contact_pressures(model, state) result(pressure)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable :: pressure(:)

    real(wp) :: area(model%n_node)

    area = nodal_areas(model, state%x)
    pressure = sum(nodal_normals(model, state%x) &
        *model%nodal_contact_forces(state%x, state%lambda), dim=1)
    where (area > 0.0_wp)
      pressure = pressure/max(area, tiny(1.0_wp))
    elsewhere
      pressure = 0.0_wp
    end where
  end function contact_pressures

  !> Return the contact of each tool, `(n_tool)`.
  pure function tool_contacts(model, state) result(contact)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(tool_contact_t), allocatable :: contact(:)

    real(wp) :: area(model%n_contact), normal(3, model%n_contact)
    integer :: c

    allocate (contact(model%n_tool))
    area = point_areas(model, state%x)
    normal = outward_normals(model, state%x)
    do c = 1, model%n_contact
      if (state%status(c) == status_gap .or. state%contact_tool(c) == 0) cycle
      if (area(c) <= 0.0_wp) cycle
      associate (tool => contact(state%contact_tool(c)))
        tool%area = tool%area + area(c)
        tool%pressure = max(tool%pressure, dot_product(normal(:, c), state%lambda(:, c))/area(c))
      end associate
    end do
  end function tool_contacts

  !> Return the gaps, `(n_contact_node)`, mm; at most the search distance of the phase, which is
  !> also the value where no active tool is that near.
  function contact_gaps(model, state) result(gap)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable :: gap(:)

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: outward(3, model%n_contact)
    integer :: c, t

    associate (phase => model%phase(state%phase))
      allocate (gap(model%n_contact_node), source=phase%search_distance)
      outward = outward_normals(model, state%x)
      do c = 1, model%n_contact_node
        do t = 1, model%n_tool
          if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
          hint = state%hint(t, c)
          call find_on_tool(model%tool(t), state%placement(t), &
              model%contact_point(c)%position(state%x), hint, &
              phase%search_distance, model%tolerance%committed_depth &
              + state%layer_offset(t), hit, outward(:, c), border_at(model, phase, c))
          if (hit%found) gap(c) = min(gap(c), hit%distance)
        end do
      end do
    end associate
  end function contact_gaps

end module dd3_model_contact_results
