!> A step of dX = (a N' - c X) dp, N' = dev(xi)/sb, to which the back-stress laws with one rate
!> reduce. It is exact where a and N' stay those of the end: X = e X_n + w a N' with e = exp(-c dp)
!> and w = (1 - e)/c.
module dd3_material_backstress_relaxation
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : kelvin_deviator, kelvin_deviator_projector
  use dd3_material_flow, only : flow_direction_t, back_response_t
  implicit none
  private
  public :: longest_decay, relax, relax_back_stress

  !> The function exp is given no exponent below minus this, where it would underflow.
  real(wp), parameter :: longest_decay = 700.0_wp

contains

  !> e and w of a step.
  pure subroutine relax(rate, increment, kept, weight)
    !> c, not negative; dp.
    real(wp), intent(in) :: rate, increment
    !> e; w, which is dp where c is zero.
    real(wp), intent(out) :: kept, weight
    !> Largest c dp at which the series is taken.
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

  !> The back-stress at the end of an increment and its derivatives.
  pure subroutine relax_back_stress(growth, rate, old, increment, direction, back)
    !> a, MPa; c.
    real(wp), intent(in) :: growth, rate
    !> Back-stress at the start, MPa.
    real(wp), intent(in) :: old(6)
    !> Plastic increment dp.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> The back-stress and its derivatives.
    type(back_response_t), intent(out) :: back
    real(wp) :: normal(6), factor, inverse, kept, weight
    integer :: j

    inverse = 0.0_wp
    if (direction%equivalent > 0.0_wp) inverse = 1/direction%equivalent
    normal = inverse*kelvin_deviator(direction%stress)
    call relax(rate, increment, kept, weight)
    back%value = kept*old + weight*growth*normal
    back%slope = kept*(growth*normal - rate*old)
    factor = weight*growth*inverse
    do j = 1, 6
      back%gradient(:, j) = factor*(kelvin_deviator_projector(:, j) - direction%gradient(j)*normal)
    end do
  end subroutine relax_back_stress

end module dd3_material_backstress_relaxation
