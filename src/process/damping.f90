! SPDX-License-Identifier: GPL-3.0-or-later
!> Viscous forces against the velocity of the nodes, in increments of a release that fail without: a
!> sheet that snaps off a tool has no equilibrium near the one before, and approaches the next in
!> several increments. The committed state of a damped increment is out of balance by these forces;
!> the first attempt at each increment has none, so that the snap ends in equilibrium.
module dd3_process_damping
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_element_kinematics, only : point_volumes
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_support_springs, only : bending_stiffness
  implicit none
  private
  public :: damping_coefficients, is_release

  !> Least sum of the coefficients, over the stiffness of the sheet in bending: that of the first
  !> damped attempt.
  real(wp), parameter :: least = 1.0e-3_wp
  !> Thicknesses by which the contact forces that are left would move the sheet against the
  !> coefficients of damped attempt `reached`, and the factor from one attempt to the next behind
  !> it. A sheet moves in an increment by what the least coefficients that converge let it.
  real(wp), parameter :: snap = 10.0_wp, growth = 8.0_wp
  integer, parameter :: reached = 3

contains

  !> Whether the running phase releases the sheet: tools that it withdraws, forces of lost
  !> constraints that fade.
  pure logical function is_release(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    is_release = any(model%phase(state%phase)%withdrawn) .or. any(abs(state%start%fading) > 0.0_wp)
  end function is_release

  !> Return the viscous force of each node over its displacement in the increment, N/mm, by its
  !> volume.
  function damping_coefficients(model, state, attempt) result(coefficient)
    type(model_t), intent(in) :: model
    !> Committed.
    type(state_t), intent(in) :: state
    !> Number of the damped attempt, from 1.
    integer, intent(in) :: attempt
    real(wp) :: coefficient(model%n_node)

    real(wp) :: x(3, model%n_node), volume(model%element%n_point), force(1), low, high
    integer :: e

    x = model%start_positions()
    coefficient = 0.0_wp
    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e))
        call point_volumes(model%element, x(:, nodes), volume)
        coefficient(nodes) = coefficient(nodes) + sum(volume)/real(size(nodes), wp)
      end associate
    end do
    force = sum(norm2(state%lambda, dim=1))
    call sum_over_ranks(1, force)
    low = least*bending_stiffness(model)
    high = max(force(1)/(snap*model%thickness), low*growth**(reached - 1))
    coefficient = coefficient/sum(coefficient)*growth**max(0, attempt - reached) &
        *low*(high/low)**(real(min(attempt, reached) - 1, wp)/real(reached - 1, wp))
  end function damping_coefficients

end module dd3_process_damping
