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

    real(wp) :: block(3, 3, 4, 4)
    integer :: s, f, a, b, k

    do s = 1, size(state%pressure)
      if (.not. abs(state%pressure(s)) > 0.0_wp) cycle
      do f = 1, size(model%pressure_set(s)%corner, 2)
        associate (corner => model%pressure_set(s)%corner(:, f))
          block = face_stiffness(state%x(:, corner))
          do a = 1, 4
            do b = 1, 4
              k = position_of(system%stiffness, corner(a), corner(b))
              system%stiffness%value(:, :, k) = system%stiffness%value(:, :, k) &
                  - state%pressure(s)*block(:, :, a, b)
            end do
          end do
        end associate
      end do
    end do
  end subroutine add_pressure_stiffness

end module dd3_system_pressure
