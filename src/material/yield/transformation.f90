!> Linear transformations S = L T of the stress that leave orthotropy: a full block for the normal
!> components and a factor for each shear component, both after the deviator has been taken, so
!> that a pressure drops out. In Kelvin's components shear factors are those of the tensor's.
module dd3_material_yield_transformation
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: transformation_t, new_transformation, barlat_transformation
  public :: deviator_of, transform, pull_back

  !> A transformation.
  type :: transformation_t
    !> Block of the normal components, times the deviator's projector.
    real(wp) :: normal(3, 3) = 0.0_wp
    !> Factors of the components 23, 31, 12.
    real(wp) :: shear(3) = 1.0_wp
  end type transformation_t

contains

  !> Makes a transformation from what it does to a deviator.
  pure subroutine new_transformation(self, normal, shear)
    !> The transformation.
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

  !> The transformation of F. Barlat, D. J. Lege and J. C. Brem (1991), of coefficients one in the
  !> isotropic case: S11 = [c (T11-T22) - b (T33-T11)]/3 and so on around, S23 = f T23, S31 = g T31,
  !> S12 = h T12.
  pure subroutine barlat_transformation(self, normal, shear)
    !> The transformation.
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

  !> Deviator of a stress, from differences of its normal components.
  pure function deviator_of(t) result(s)
    !> Stress, MPa.
    real(wp), intent(in) :: t(6)
    real(wp) :: s(6)

    s(1) = ((t(1) - t(2)) + (t(1) - t(3)))/3
    s(2) = ((t(2) - t(3)) + (t(2) - t(1)))/3
    s(3) = ((t(3) - t(1)) + (t(3) - t(2)))/3
    s(4:6) = t(4:6)
  end function deviator_of

  !> S = L s.
  pure function transform(self, s) result(image)
    !> The transformation.
    type(transformation_t), intent(in) :: self
    !> A deviator.
    real(wp), intent(in) :: s(6)
    real(wp) :: image(6)

    image(1:3) = self%normal(:, 1)*s(1) + self%normal(:, 2)*s(2) + self%normal(:, 3)*s(3)
    image(4:6) = self%shear*s(4:6)
  end function transform

  !> L^T g: a gradient in S as a gradient in T.
  pure function pull_back(self, g) result(image)
    !> The transformation.
    type(transformation_t), intent(in) :: self
    !> Gradient in S.
    real(wp), intent(in) :: g(6)
    real(wp) :: image(6)
    integer :: j

    do j = 1, 3
      image(j) = self%normal(1, j)*g(1) + self%normal(2, j)*g(2) + self%normal(3, j)*g(3)
    end do
    image(4:6) = self%shear*g(4:6)
  end function pull_back

end module dd3_material_yield_transformation
