!> Stiffness of the pressures, which follow the surface.
module dd3_system_pressure
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : position_of
  use dd3_model_model, only : model_t
  use dd3_model_pressures, only : face_stiffness
  use dd3_model_state, only : state_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: add_pressure_stiffness

contains

  !> Subtract the derivatives of the pressure forces from the stiffness.
  subroutine add_pressure_stiffness(system, model, state)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    integer :: s, f

    do s = 1, size(state%pressure)
      if (.not. abs(state%pressure(s)) > 0.0_wp) cycle
      do f = 1, size(model%pressure_set(s)%node, 2)
        associate (node => model%pressure_set(s)%node(:, f))
          call subtract_block(system, node, &
              state%pressure(s)*face_stiffness(model%element, state%x(:, node)))
        end associate
      end do
    end do
  end subroutine add_pressure_stiffness

  !> Subtract the stiffness of a face.
  subroutine subtract_block(system, node, stiffness)
    type(system_t), intent(inout) :: system
    !> Nodes of the face.
    integer, intent(in) :: node(:)
    !> As returned by `face_stiffness`.
    real(wp), intent(in) :: stiffness(:, :, :, :)

    integer :: a, b, k

    do a = 1, size(node)
      do b = 1, size(node)
        k = position_of(system%stiffness, node(a), node(b))
        system%stiffness%value(:, :, k) = system%stiffness%value(:, :, k) - stiffness(:, :, a, b)
      end do
    end do
  end subroutine subtract_block

end module dd3_system_pressure
