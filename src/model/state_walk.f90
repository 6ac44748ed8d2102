! SPDX-License-Identifier: GPL-3.0-or-later
!> Walk over the components of a state: `visit_state` passes every component with its name to a
!> visitor, so that a component is named in one place only: in its part, its term, or here.
module dd3_model_state_walk
  use dd3_base_kinds, only : wp
  use dd3_model_part, only : of_elements, of_points
  use dd3_model_configuration, only : phase_start_t
  use dd3_model_state, only : state_t
  use dd3_model_state_visitor, only : state_visitor_t
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
    call visitor%one_real("time", state%time)
    call visitor%one_real("r_cap", state%r_cap)
    call visitor%one_integer("history_increment", state%history_increment)
    call visitor%one_integer("fields_increment", state%fields_increment)
    call visitor%reals("x", size(state%x), state%x)
    call visitor%reals("external_force", size(state%external_force), state%external_force)
    call state%sheet%walk(visitor)
    call state%contact%walk(visitor)
    call state%tools%walk(visitor)
    call state%observed%walk(visitor)
    call state%work%walk(visitor)
    call visitor%one_logical("open", state%open)
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

end module dd3_model_state_walk
