! SPDX-License-Identifier: GPL-3.0-or-later
!> Integration of dX = (a N' - c X) dp, N' = dev(xi)/sb, the form of back-stress laws with one rate.
!> It is exact for constant a and N', those of the end: X = e X_n + w a N' with e = exp(-c dp) and
!> w = (1 - e)/c.
module dd3_material_backstress_relaxation
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : kelvin_deviator, kelvin_deviator_projector
  use dd3_material_flow, only : flow_direction_t, back_response_t
  implicit none
  private
  public :: longest_decay, relax, relax_back_stress

  !> Largest x for which exp(-x) is evaluated, to avoid underflow.
  real(wp), parameter :: longest_decay = 700.0_wp

contains

  !> Evaluate e and w.
  pure subroutine relax(rate, increment, kept, weight)
    !> c, not negative; dp.
    real(wp), intent(in) :: rate, increment
    !> e; w, equal to dp for c = 0.
    real(wp), intent(out) :: kept, weight

    !> Largest c dp for which w is evaluated by its series.
    real(wp), parameter :: small = 1.0e-3_wp
    real(wp) :: x

    x = rate*increment
    kept = exp(-min(x, longest_decay))
    if (x > small) then
      weight = (1 - kept)/rate
    else
      weight = increment*(1 - x/2*(1 - x/3*(1 - x/4*(1 - x/5))))
    end if
  end subroutine relax

  !> Evaluate the back-stress at the end of an increment and its derivatives.
  pure subroutine relax_back_stress(modulus, rate, start, increment, direction, back)
    !> a, MPa; c.
    real(wp), intent(in) :: modulus, rate
    !> Back-stress at the start, MPa; dp.
    real(wp), intent(in) :: start(6), increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: back

    real(wp) :: normal(6), factor, inverse, kept, weight
    integer :: j

    inverse = 0.0_wp
    if (direction%equivalent > 0.0_wp) inverse = 1/direction%equivalent
    normal = inverse*kelvin_deviator(direction%stress)
    call relax(rate, increment, kept, weight)
    back%value = kept*start + weight*modulus*normal
    back%slope = kept*(modulus*normal - rate*start)
    factor = weight*modulus*inverse
    do j = 1, 6
      back%gradient(:, j) = factor*(kelvin_deviator_projector(:, j) - direction%gradient(j)*normal)
    end do
  end subroutine relax_back_stress

end module dd3_material_backstress_relaxation
