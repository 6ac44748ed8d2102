!> Stiffness of the springs that hold the sheet where lost constraints left it, while they fade.
module dd3_system_release
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : identity
  use dd3_model_loads, only : fading_factor, spring_stiffness
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: add_release_stiffness

contains

  !> Add the stiffness of the springs to that of the sheet.
  subroutine add_release_stiffness(system, model, state)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp) :: stiffness
    integer :: node, k

    do node = 1, model%n_node
      associate (fading => state%start%fading(:, node))
        if (all(abs(fading) <= 0.0_wp)) cycle
        stiffness = fading_factor(state%progress) &
            *spring_stiffness(fading, model%thickness_at(node))
        k = system%stiffness%diagonal(node)
        system%stiffness%value(:, :, k) = system%stiffness%value(:, :, k) + stiffness*identity
      end associate
    end do
  end subroutine add_release_stiffness

end module dd3_system_release
