!> The state at the start of a job.
module dd3_model_initial
  use dd3_model_model, only : model_t
  use dd3_model_state, only : new_state, state_t
  implicit none
  private
  public :: new_initial_state

contains

  !> A virgin sheet where the mesh puts it, and the tools at their initial positions.
  subroutine new_initial_state(state, model)
    !> The state made.
    type(state_t), intent(out) :: state
    !> The model.
    type(model_t), intent(in) :: model

    integer :: e, p, tool

    call new_state(state, model%n_node, model%element%n_point, model%n_element, model%n_internal, &
                   model%n_contact, model%n_tool, size(model%load_set))
    state%x = model%x0
    do e = 1, model%n_element
      do p = 1, model%element%n_point
        state%orientation(:, :, p, e) = model%axes(:, :, model%material_of(e))
      end do
    end do
    do tool = 1, model%n_tool
      state%tool_displacement(:, tool) = model%tool(tool)%position
    end do
  end subroutine new_initial_state

end module dd3_model_initial
