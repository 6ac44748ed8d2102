! SPDX-License-Identifier: GPL-3.0-or-later
!> Vectors of Abaqus' order, 11 22 33 12 13 23 with engineering shear strains, and Kelvin vectors.
module dd3_library_voigt
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : kelvin_factor
  implicit none
  private
  public :: kelvin_stress, kelvin_strain, voigt_stress, voigt_tangent

  !> Position in a Kelvin vector of the components 11 22 33 12 13 23; the order is its own inverse.
  integer, parameter :: place(6) = [1, 2, 3, 6, 5, 4]

contains

  !> Return the Kelvin vector of a stress.
  pure function kelvin_stress(stress) result(kelvin)
    real(wp), intent(in) :: stress(6)
    real(wp) :: kelvin(6)

    kelvin = kelvin_factor*stress(place)
  end function kelvin_stress

  !> Return the Kelvin vector of a strain.
  pure function kelvin_strain(strain) result(kelvin)
    !> With engineering shear strains.
    real(wp), intent(in) :: strain(6)
    real(wp) :: kelvin(6)

    kelvin = strain(place)/kelvin_factor
  end function kelvin_strain

  !> Return the components of a stress.
  pure function voigt_stress(kelvin) result(stress)
    real(wp), intent(in) :: kelvin(6)
    real(wp) :: stress(6)

    stress = kelvin(place)/kelvin_factor
  end function voigt_stress

  !> Return the derivative of the stress in the strain with engineering shears.
  pure function voigt_tangent(kelvin) result(tangent)
    !> Derivative of the Kelvin vectors.
    real(wp), intent(in) :: kelvin(6, 6)
    real(wp) :: tangent(6, 6)

    integer :: j

    do j = 1, 6
      tangent(:, j) = kelvin(place, place(j))/(kelvin_factor*kelvin_factor(j))
    end do
  end function voigt_tangent

end module dd3_library_voigt
