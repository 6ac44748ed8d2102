! SPDX-License-Identifier: GPL-3.0-or-later
!> Walk over the components of a state: `visit_state` passes every component with its name to a
!> visitor, so that a component is named in one place only: here, or in its term.
module dd3_model_state_walk
  use dd3_base_kinds, only : wp
  use dd3_model_part, only : of_elements, of_points
  use dd3_model_configuration, only : phase_start_t
  use dd3_model_state, only : state_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_tools_closest, only : hint_t
  implicit none
  private
  public :: visit_state

contains

  !> Pass every component of a state to a visitor, always in the same order.
  subroutine visit_state(state, visitor)
    type(state_t), intent(inout) :: state
    class(state_visitor_t), intent(inout) :: visitor

    integer :: k

    call visitor%one_integer("increment", state%increment)
    call visitor%one_integer("phase", state%phase)
    call visitor%one_logical("begun", state%begun)
    call visitor%one_real("progress", state%progress)
    call visitor%one_real("travel", state%travel)
    call visitor%one_real("r_cap", state%r_cap)
    call visitor%one_integer("history_increment", state%history_increment)
    call visitor%one_integer("fields_increment", state%fields_increment)
    call visitor%reals("x", size(state%x), state%x)
    call visitor%reals("internal_force", size(state%internal_force), state%internal_force)
    call visitor%reals("external_force", size(state%external_force), state%external_force)
    associate (n => size(state%plastic, 2), n_point => size(state%plastic, 1), &
        n_variable => size(state%internal_variables, 1))
      call visitor%reals_of_items(of_elements, "stress", 6*n_point, n, state%stress)
      call visitor%reals_of_items(of_elements, "internal_variables", n_variable*n_point, n, &
          state%internal_variables)
      call visitor%reals_of_items(of_elements, "orientation", 9*n_point, n, state%orientation)
      call visitor%reals_of_items(of_elements, "enhanced", size(state%enhanced, 1), n, &
          state%enhanced)
      call visitor%logicals_of_items(of_elements, "plastic", n_point, n, state%plastic)
    end associate
    associate (n => size(state%status))
      call visitor%reals_of_items(of_points, "lambda", 3, n, state%lambda)
      call visitor%integers_of_items(of_points, "status", 1, n, state%status)
      call visitor%integers_of_items(of_points, "contact_tool", 1, n, state%contact_tool)
      call visitor%reals_of_items(of_points, "place", 1, n, state%place)
      call visit_hints("hint", size(state%hint, 1), n, state%hint, visitor)
      call visitor%reals_of_items(of_points, "slip_path", 1, n, state%slip_path)
    end associate
    call visitor%reals("tool_displacement", size(state%tool_displacement), state%tool_displacement)
    call visitor%reals("tool_centre", size(state%tool_centre), state%tool_centre)
    call visitor%reals("tool_rotation", size(state%tool_rotation), state%tool_rotation)
    call visitor%reals("tool_angle", size(state%tool_angle), state%tool_angle)
    call visitor%reals("tool_load", size(state%tool_load), state%tool_load)
    call visitor%reals("tool_force", size(state%tool_force), state%tool_force)
    call visitor%reals("layer_offset", size(state%layer_offset), state%layer_offset)
    call visitor%logicals("touched", size(state%touched), state%touched)
    call visitor%reals("tool_depth", size(state%tool_depth), state%tool_depth)
    call visitor%one_logical("open", state%open)
    call visitor%reals("largest_depth", size(state%largest_depth), state%largest_depth)
    call visitor%integers("deepest_face", size(state%deepest_face), state%deepest_face)
    call visitor%reals("deepest_radius", size(state%deepest_radius), state%deepest_radius)
    call visitor%integers("open_edge", size(state%open_edge), state%open_edge)
    call visitor%reals("open_edge_displacement", size(state%open_edge_displacement), &
        state%open_edge_displacement)
    call visitor%one_real("tool_work", state%tool_work)
    call visitor%one_real("external_work", state%external_work)
    call visitor%one_real("internal_work", state%internal_work)
    call visitor%one_real("plastic_work", state%plastic_work)
    call visitor%one_real("friction_work", state%friction_work)
    call visit_phase_start(state%start, visitor)
    do k = 1, size(state%term)
      call state%term(k)%of%walk(visitor)
    end do
  end subroutine visit_state

  !> Pass every component of the values at the start of a phase to a visitor.
  subroutine visit_phase_start(start, visitor)
    type(phase_start_t), intent(inout) :: start
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("start_tool_displacement", size(start%tool_displacement), &
        start%tool_displacement)
    call visitor%reals("start_tool_rotation", size(start%tool_rotation), start%tool_rotation)
    call visitor%reals("start_tool_angle", size(start%tool_angle), start%tool_angle)
    call visitor%reals("start_tool_load", size(start%tool_load), start%tool_load)
    call visitor%reals("start_tool_load_end", size(start%tool_load_end), start%tool_load_end)
    call visitor%reals("start_layer_offset", size(start%layer_offset), start%layer_offset)
    call visitor%reals_of_items(of_points, "start_held_offset", 1, size(start%held_offset), &
        start%held_offset)
    call visitor%reals("start_x", size(start%x), start%x)
    call visitor%reals_of_items(of_elements, "start_plastic_strain", &
        size(start%plastic_strain, 1), size(start%plastic_strain, 2), start%plastic_strain)
    call visitor%one_real("start_elastic_energy", start%elastic_energy)
    call visitor%one_logical("start_until_from_below", start%until_from_below)
  end subroutine visit_phase_start

  !> Pass every component of the closest points to a visitor.
  subroutine visit_hints(name, n_tool, n, hint, visitor)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n_tool, n
    type(hint_t), intent(inout) :: hint(n_tool, n)
    class(state_visitor_t), intent(inout) :: visitor

    real(wp), allocatable :: anchor(:, :, :), u(:, :), v(:, :), clearance(:, :)
    integer, allocatable :: patch(:, :)
    logical, allocatable :: due(:, :)
    integer :: i, t

    patch = hint%patch
    u = hint%u
    v = hint%v
    due = hint%due
    clearance = hint%clearance
    allocate (anchor(3, n_tool, n))
    do i = 1, n
      do t = 1, n_tool
        anchor(:, t, i) = hint(t, i)%anchor
      end do
    end do
    call visitor%integers_of_items(of_points, name//"_patch", n_tool, n, patch)
    call visitor%reals_of_items(of_points, name//"_u", n_tool, n, u)
    call visitor%reals_of_items(of_points, name//"_v", n_tool, n, v)
    call visitor%logicals_of_items(of_points, name//"_due", n_tool, n, due)
    call visitor%reals_of_items(of_points, name//"_anchor", 3*n_tool, n, anchor)
    call visitor%reals_of_items(of_points, name//"_clearance", n_tool, n, clearance)
    do i = 1, n
      do t = 1, n_tool
        hint(t, i) = hint_t(patch=patch(t, i), u=u(t, i), v=v(t, i), due=due(t, i), &
            anchor=anchor(:, t, i), clearance=clearance(t, i))
      end do
    end do
  end subroutine visit_hints

end module dd3_model_state_walk
