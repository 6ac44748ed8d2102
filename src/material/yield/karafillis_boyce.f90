! SPDX-License-Identifier: GPL-3.0-or-later
!> The orthotropic criterion of A. P. Karafillis and M. C. Boyce (1993), a mixture of two functions
!> of the principal values of the deviator S = L T:
!>
!>     2 sb^2k = (1-c) (|S1-S2|^2k + |S2-S3|^2k + |S3-S1|^2k)
!>               + c 3^2k/(2^(2k-1)+1) (|S1|^2k + |S2|^2k + |S3|^2k)
!>     S11 = C (T11 + beta1 T22 + beta2 T33)          S23 = C gamma1 T23
!>     S22 = C (beta1 T11 + alpha1 T22 + beta3 T33)   S31 = C gamma2 T31
!>     S33 = C (beta2 T11 + beta3 T22 + alpha2 T33)   S12 = C gamma3 T12
!>     beta1 = (alpha2-alpha1-1)/2   beta2 = (alpha1-alpha2-1)/2   beta3 = (1-alpha1-alpha2)/2
!>
!> Isotropic for C = 2/3, alpha = 1, gamma = 3/2. The tables of the paper list half of gamma3.
module dd3_material_yield_karafillis_boyce
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_yield_power, only : exponent_t, new_exponent, function_t, powers, root_of
  use dd3_material_yield_principal, only : principal_criterion_t, add_differences
  use dd3_material_yield_transformation, only : new_transformation
  implicit none
  private
  public :: karafillis_boyce_t

  type, extends(principal_criterion_t) :: karafillis_boyce_t
    private
    !> 2k.
    type(exponent_t) :: exponent
    !> c.
    real(wp) :: mixture = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: principal_function
  end type karafillis_boyce_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "karafillis_boyce"
    description%title = "orthotropic, of exponent 2k, a mixture of two functions"
    description%source = "A. P. Karafillis, M. C. Boyce, J. Mech. Phys. Solids 41 (1993) 1859-1886"
    allocate (description%rows, source=[ &
      row("k", kind_real, "", "", "half the exponent", 1.0_wp, 50.0_wp), &
      row("c", kind_real, "", "", "part of the second function", 0.0_wp, 1.0_wp), &
      row("scale", kind_real, "", "", "the paper's C; isotropic: 2/3", 0.0_wp, &
          lower_open=.true.), &
      row("alpha1", kind_real, "", "", "factor of T22 in S22; isotropic: 1"), &
      row("alpha2", kind_real, "", "", "factor of T33 in S33; isotropic: 1"), &
      row("gamma1", kind_real, "", "1.5", "factor of T23"), &
      row("gamma2", kind_real, "", "1.5", "factor of T31"), &
      row("gamma3", kind_real, "", "1.5", "factor of T12: twice the number of the paper's tables")])
    allocate (description%example, source=[ &
      law_value_t("k", 2.0_wp), law_value_t("c", 0.5_wp), law_value_t("scale", 2/3.0_wp), &
      law_value_t("alpha1", 1.0_wp), law_value_t("alpha2", 1.0_wp), &
      law_value_t("gamma1", 1.5_wp), law_value_t("gamma2", 1.5_wp), &
      law_value_t("gamma3", 1.5_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(karafillis_boyce_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    real(wp) :: alpha(2), beta(3), shear(3), normal(3, 3), scale

    self%always_convex = .true.
    scale = value_of(values, "scale")
    alpha = [value_of(values, "alpha1"), value_of(values, "alpha2")]
    beta = 0.5_wp*[alpha(2) - alpha(1) - 1, alpha(1) - alpha(2) - 1, 1 - alpha(1) - alpha(2)]
    normal(:, 1) = [1.0_wp, beta(1), beta(2)]
    normal(:, 2) = [beta(1), alpha(1), beta(3)]
    normal(:, 3) = [beta(2), beta(3), alpha(2)]
    shear = [value_of(values, "gamma1", 1.5_wp), value_of(values, "gamma2", 1.5_wp), &
        value_of(values, "gamma3", 1.5_wp)]
    call new_transformation(self%transformation(1), scale*normal, scale*shear)
    call new_exponent(self%exponent, 2*value_of(values, "k"))
    self%mixture = value_of(values, "c")
  end subroutine set

  !> Evaluate the function of the principal values. The largest difference is at least 3/2 of any
  !> value, which bounds the second function too.
  pure subroutine principal_function(self, e, q)
    class(karafillis_boyce_t), intent(in) :: self
    real(wp), intent(in) :: e(6)
    type(function_t), intent(out) :: q

    type(function_t) :: f
    real(wp) :: scale, m, weight, power(3), d(3), dd(3)
    integer :: i

    f = function_t(0.0_wp, 0.0_wp, 0.0_wp)
    m = self%exponent%value
    scale = maxval(e(1:3)) - minval(e(1:3))
    call add_differences(self%exponent, 0.5_wp*(1 - self%mixture), e(1:3)/scale, f)
    weight = self%mixture/(1 + 2.0_wp**(1 - m))
    call powers(3, self%exponent, 1.5_wp*e(1:3)/scale, power, d, dd)
    f%value = f%value + weight*sum(power)
    do i = 1, 3
      f%first(i) = f%first(i) + 1.5_wp*weight*d(i)
      f%second(i, i) = f%second(i, i) + 2.25_wp*weight*dd(i)
    end do
    call root_of(3, m, scale, 1.0_wp, f, q)
  end subroutine principal_function

end module dd3_material_yield_karafillis_boyce
