!> Observation of the tools after an accepted increment: which of them have touched the sheet, and
!> how deep they enter its faces between the nodes.
module dd3_process_tool_observation
  use dd3_base_kinds, only : wp
  use dd3_contact_curvature, only : smallest_radius
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_tool_depth, only : measure_tool_depth, tool_depth_t
  implicit none
  private
  public :: observe_tools

contains

  !> Record contact and depth of the active tools in the state.
  subroutine observe_tools(model, state)
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(inout) :: state

    type(tool_depth_t) :: found
    integer :: tool

    state%tool_depth = 0.0_wp
    do tool = 1, model%n_tool
      if (.not. model%phase(state%phase)%active(tool)) cycle
      state%touched(tool) = state%touched(tool) .or. &
          any(state%contact_tool == tool .and. state%status /= status_gap)
      found = measure_tool_depth(model, state, tool)
      state%tool_depth(tool) = found%depth
      if (found%depth <= state%largest_depth(tool)) cycle
      state%largest_depth(tool) = found%depth
      state%deepest_face(tool) = found%face
      associate (x => state%x(:, model%face%corner(:, found%face)))
        state%deepest_radius(tool) = smallest_radius(model%tool(tool)%surface, found%x, &
            norm2(x(:, 3) - x(:, 1)))
      end associate
    end do
  end subroutine observe_tools

end module dd3_process_tool_observation
