! SPDX-License-Identifier: GPL-3.0-or-later
!> Isotropic linear elasticity (Hooke), in Kelvin vectors.
module dd3_material_elasticity
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : kelvin_identity
  implicit none
  private
  public :: elasticity_t, new_elasticity, elastic_stress, elastic_strain

  type :: elasticity_t
    !> Young's modulus, MPa.
    real(wp) :: young = 0.0_wp
    !> Shear modulus G, MPa; Lamé's first constant, MPa.
    real(wp) :: shear = 0.0_wp, lame = 0.0_wp
    !> -nu/(1 + nu), the factor of the trace of the stress in 2G times a normal strain.
    real(wp) :: trace_factor = 0.0_wp
    !> d stress/d strain, MPa, and its inverse.
    real(wp) :: stiffness(6, 6) = 0.0_wp, compliance(6, 6) = 0.0_wp
  end type elasticity_t

contains

  !> Initialise the constants.
  subroutine new_elasticity(self, young, poisson)
    type(elasticity_t), intent(out) :: self
    !> Young's modulus, MPa; Poisson's ratio, above -1 and below 1/2.
    real(wp), intent(in) :: young, poisson

    real(wp) :: normal
    integer :: i, j

    self%young = young
    self%shear = young/(2*(1 + poisson))
    self%lame = young*poisson/((1 + poisson)*(1 - 2*poisson))
    self%trace_factor = -poisson/(1 + poisson)
    do j = 1, 6
      do i = 1, 6
        normal = kelvin_identity(i)*kelvin_identity(j)
        self%stiffness(i, j) = self%lame*normal
        self%compliance(i, j) = self%trace_factor*normal/(2*self%shear)
      end do
      self%stiffness(j, j) = self%stiffness(j, j) + 2*self%shear
      self%compliance(j, j) = self%compliance(j, j) + 1/(2*self%shear)
    end do
  end subroutine new_elasticity

  !> Return the stress of an elastic strain, MPa.
  pure function elastic_stress(self, strain) result(stress)
    type(elasticity_t), intent(in) :: self
    real(wp), intent(in) :: strain(6)
    real(wp) :: stress(6)

    stress = 2*self%shear*strain
    stress(1:3) = stress(1:3) + self%lame*(strain(1) + strain(2) + strain(3))
  end function elastic_stress

  !> Return the elastic strain of a stress in MPa.
  pure function elastic_strain(self, stress) result(strain)
    type(elasticity_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    real(wp) :: strain(6)

    real(wp) :: factor

    factor = 1/(2*self%shear)
    strain = factor*stress
    strain(1:3) = strain(1:3) + factor*self%trace_factor*(stress(1) + stress(2) + stress(3))
  end function elastic_strain

end module dd3_material_elasticity
