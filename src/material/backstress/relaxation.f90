!> The backward Euler step of dX = (a N' - c X) dp, N' = dev(xi)/sb, to which the back-stress laws
!> with one rate reduce: X = (X_n + dp a N')/(1 + c dp).
module dd3_material_backstress_relaxation
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : kelvin_deviator, kelvin_deviator_projector
  use dd3_material_flow, only : flow_direction_t, back_response_t
  implicit none
  private
  public :: relax_back_stress

contains

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
    real(wp) :: normal(6), factor, inverse
    integer :: j

    inverse = 0.0_wp
    if (direction%equivalent > 0.0_wp) inverse = 1/direction%equivalent
    normal = inverse*kelvin_deviator(direction%stress)
    factor = 1/(1 + rate*increment)
    back%value = factor*(old + increment*growth*normal)
    back%slope = factor*(growth*normal - rate*back%value)
    factor = factor*increment*growth*inverse
    do j = 1, 6
      back%gradient(:, j) = factor*(kelvin_deviator_projector(:, j) - direction%gradient(j)*normal)
    end do
  end subroutine relax_back_stress

end module dd3_material_backstress_relaxation
