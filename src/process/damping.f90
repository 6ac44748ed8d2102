! SPDX-License-Identifier: GPL-3.0-or-later
!> Viscous forces against the velocity of the nodes, in increments of a release that fail without: a
!> sheet that snaps off a tool has no equilibrium near the one before, and approaches the next in
!> several increments. The committed state of a damped increment is out of balance by these forces;
!> the first attempt at each increment has none, so that the snap ends in equilibrium.
module dd3_process_damping
  use dd3_base_kinds, only : wp
  use dd3_element_kinematics, only : point_volumes
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: damping_coefficients, is_release

  !> Factor on the coefficients from a damped attempt to the next one.
  real(wp), parameter :: growth = 8.0_wp

contains

  !> Whether the running phase releases the sheet: tools that it withdraws, forces of lost
  !> constraints that fade.
  pure logical function is_release(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    is_release = any(model%phase(state%phase)%withdrawn) .or. any(abs(state%start%fading) > 0.0_wp)
  end function is_release

  !> Return the viscous force of each node over its displacement in the increment, N/mm. In the first
  !> damped attempt they sum up to E V t**2/L**4, V the volume, t the thickness and L the size of the
  !> sheet: about the stiffness in bending of the whole sheet.
  function damping_coefficients(model, attempt) result(coefficient)
    type(model_t), intent(in) :: model
    !> Number of the damped attempt, from 1.
    integer, intent(in) :: attempt
    real(wp) :: coefficient(model%n_node)

    real(wp) :: x(3, model%n_node), volume(model%element%n_point), modulus
    integer :: e

    x = model%start_positions()
    modulus = growth**(attempt - 1)*model%least_shear()*model%thickness**2 &
        /maxval(maxval(x, dim=2) - minval(x, dim=2))**4
    coefficient = 0.0_wp
    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e))
        call point_volumes(model%element, x(:, nodes), volume)
        coefficient(nodes) = coefficient(nodes) + modulus*sum(volume)/real(size(nodes), wp)
      end associate
    end do
  end function damping_coefficients

end module dd3_process_damping
