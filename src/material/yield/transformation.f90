! SPDX-License-Identifier: GPL-3.0-or-later
!> Linear transformations S = L T of the stress that preserve orthotropy: a full block for the
!> normal components and a factor for each shear component, applied to the deviator and therefore
!> independent of pressure. Shear factors are the same for Kelvin and tensor components.
module dd3_material_yield_transformation
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: transformation_t, new_transformation, barlat_transformation
  public :: deviator_of, transform, pull_back

  type :: transformation_t
    !> Block of the normal components, times the deviator's projector.
    real(wp) :: normal(3, 3) = 0.0_wp
    !> Factors of the components 23, 31, 12.
    real(wp) :: shear(3) = 1.0_wp
  end type transformation_t

contains

  !> Initialise a transformation with its action on a deviator.
  pure subroutine new_transformation(self, normal, shear)
    type(transformation_t), intent(out) :: self
    !> Block of the normal components.
    real(wp), intent(in) :: normal(3, 3)
    !> Factors of the components 23, 31, 12.
    real(wp), intent(in) :: shear(3)

    integer :: i

    do i = 1, 3
      self%normal(i, :) = normal(i, :) - sum(normal(i, :))/3
    end do
    self%shear = shear
  end subroutine new_transformation

  !> Initialise the transformation of F. Barlat, D. J. Lege and J. C. Brem (1991), isotropic if all
  !> coefficients are one: S11 = [c (T11-T22) - b (T33-T11)]/3 and cyclically, S23 = f T23,
  !> S31 = g T31, S12 = h T12.
  pure subroutine barlat_transformation(self, normal, shear)
    type(transformation_t), intent(out) :: self
    !> a, b, c.
    real(wp), intent(in) :: normal(3)
    !> f, g, h.
    real(wp), intent(in) :: shear(3)

    real(wp) :: block(3, 3)

    associate (a => normal(1)/3, b => normal(2)/3, c => normal(3)/3)
      block(:, 1) = [b + c, -c, -b]
      block(:, 2) = [-c, c + a, -a]
      block(:, 3) = [-b, -a, a + b]
    end associate
    call new_transformation(self, block, shear)
  end subroutine barlat_transformation

  !> Return the deviator of a stress, from differences of its normal components.
  pure function deviator_of(t) result(s)
    real(wp), intent(in) :: t(6)
    real(wp) :: s(6)

    s(1) = ((t(1) - t(2)) + (t(1) - t(3)))/3
    s(2) = ((t(2) - t(3)) + (t(2) - t(1)))/3
    s(3) = ((t(3) - t(1)) + (t(3) - t(2)))/3
    s(4:6) = t(4:6)
  end function deviator_of

  !> Return S = L s of a deviator s.
  pure function transform(self, s) result(image)
    type(transformation_t), intent(in) :: self
    real(wp), intent(in) :: s(6)
    real(wp) :: image(6)

    image(1:3) = self%normal(:, 1)*s(1) + self%normal(:, 2)*s(2) + self%normal(:, 3)*s(3)
    image(4:6) = self%shear*s(4:6)
  end function transform

  !> Return L^T g, the gradient in T of a gradient g in S.
  pure function pull_back(self, g) result(image)
    type(transformation_t), intent(in) :: self
    real(wp), intent(in) :: g(6)
    real(wp) :: image(6)

    integer :: j

    do j = 1, 3
      image(j) = self%normal(1, j)*g(1) + self%normal(2, j)*g(2) + self%normal(3, j)*g(3)
    end do
    image(4:6) = self%shear*g(4:6)
  end function pull_back

end module dd3_material_yield_transformation
