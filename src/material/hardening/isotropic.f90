! SPDX-License-Identifier: GPL-3.0-or-later
!> Isotropic hardening laws: the flow stress depends on the equivalent plastic strain alone.
module dd3_material_hardening_isotropic
  use dd3_base_kinds, only : wp
  use dd3_material_flow, only : flow_direction_t, flow_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: isotropic_hardening_t, chord_strain

  !> A law whose slope is unbounded at p = 0 is replaced by its chord up to this plastic strain.
  real(wp), parameter :: chord_strain = 1.0e-8_wp

  !> An isotropic hardening law.
  type, abstract, extends(hardening_t) :: isotropic_hardening_t
    !> Strain at which the hardening curve begins.
    real(wp) :: prestrain = 0.0_wp
  contains
    procedure(hardening_curve_interface), deferred :: hardening_curve
    procedure :: flow_stress
  end type isotropic_hardening_t

  abstract interface
    !> Evaluate the hardening curve.
    pure subroutine hardening_curve_interface(self, strain, stress, slope)
      import :: isotropic_hardening_t, wp
      class(isotropic_hardening_t), intent(in) :: self
      !> Equivalent plastic strain, to which the prestrain has been added.
      real(wp), intent(in) :: strain
      !> Flow stress and its derivative in the strain, MPa.
      real(wp), intent(out) :: stress, slope
    end subroutine hardening_curve_interface
  end interface

contains

  !> Evaluate the flow stress at the end of a plastic increment.
  pure subroutine flow_stress(self, plastic_strain, start, increment, direction, flow)
    class(isotropic_hardening_t), intent(in) :: self
    real(wp), intent(in) :: plastic_strain
    !> Unused: no internal variables besides the plastic strain.
    real(wp), intent(in) :: start(self%n_internal)
    real(wp), intent(in) :: increment
    !> Unused.
    type(flow_direction_t), intent(in) :: direction
    type(flow_response_t), intent(out) :: flow

    associate (unused => start, no_direction => direction)
    end associate
    call self%hardening_curve(self%prestrain + plastic_strain + increment, flow%value, flow%slope)
    flow%gradient = 0.0_wp
  end subroutine flow_stress

end module dd3_material_hardening_isotropic
