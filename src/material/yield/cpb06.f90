! SPDX-License-Identifier: GPL-3.0-or-later
!> The orthotropic criterion of O. Cazacu, B. Plunkett and F. Barlat, "CPB06", with different
!> strengths in tension and compression: of the principal values of S = C s, s the deviator,
!>
!>     sb^m = sum (|S_i| - k S_i)^m / sum (|P_i| - k P_i)^m
!>     S11 = C11 s11 + C12 s22 + C13 s33    S23 = C44 s23
!>     S22 = C12 s11 + C22 s22 + C23 s33    S31 = C55 s31
!>     S33 = C13 s11 + C23 s22 + C33 s33    S12 = C66 s12
!>
!> and P_i = (2 Ci1 - Ci2 - Ci3)/3: sb = T11 in tension along rolling. Shear factors default to
!> isotropy in their plane, as C66 = (C11 + C22)/2 - C12. With m = 2 the second derivative is
!> discontinuous at a principal value of zero.
module dd3_material_yield_cpb06
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, problem_t, add_problem, value_of
  use dd3_material_yield_power, only : exponent_t, new_exponent, exponent_row, function_t, powers, &
      root_of
  use dd3_material_yield_principal, only : principal_criterion_t
  use dd3_material_yield_transformation, only : new_transformation
  implicit none
  private
  public :: cpb06_t

  type, extends(principal_criterion_t) :: cpb06_t
    private
    !> m.
    type(exponent_t) :: exponent
    real(wp) :: k = 0.0_wp
    !> Factor of the root.
    real(wp) :: normalisation = 1.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: principal_function
  end type cpb06_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "cpb06"
    description%title = "orthotropic, of exponent m, tension and compression differ"
    description%source = "O. Cazacu, B. Plunkett, F. Barlat, Int. J. Plasticity 22 (2006) 1171-1194"
    allocate (description%rows, source=[ &
      row("C11", kind_real, "", "", "factor of s11 in S11; isotropic: 1"), &
      row("C12", kind_real, "", "", "factor of s22 in S11; isotropic: 0"), &
      row("C13", kind_real, "", "", "factor of s33 in S11"), &
      row("C22", kind_real, "", "", "factor of s22 in S22"), &
      row("C23", kind_real, "", "", "factor of s33 in S22"), &
      row("C33", kind_real, "", "", "factor of s33 in S33"), &
      row("C44", kind_real, "", "-", "factor of s23; (C22+C33)/2 - C23 where left out"), &
      row("C55", kind_real, "", "-", "factor of s31; (C33+C11)/2 - C13 where left out"), &
      row("C66", kind_real, "", "-", "factor of s12; (C11+C22)/2 - C12 where left out"), &
      row("k", kind_real, "", "", "difference of tension and compression; 0: none", &
          -1.0_wp, 1.0_wp), &
      exponent_row()])
    allocate (description%example, source=[ &
      law_value_t("C11", 1.0_wp), law_value_t("C12", 0.0_wp), law_value_t("C13", 0.0_wp), &
      law_value_t("C22", 1.0_wp), law_value_t("C23", 0.0_wp), law_value_t("C33", 1.0_wp), &
      law_value_t("C44", 1.0_wp), law_value_t("C55", 1.0_wp), law_value_t("C66", 1.0_wp), &
      law_value_t("k", 0.0_wp), law_value_t("m", 4.0_wp)])
  end subroutine describe

  !> Require a positive equivalent stress in tension along rolling.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    real(wp) :: p(3), k

    if (size(problems) > 0) return
    p = along_rolling(values)
    k = value_of(values, "k")
    if (any(abs(p) - k*p > 0.0_wp)) return
    call add_problem(problems, 0, "no equivalent stress along rolling: |P_i| = k P_i", &
        "C11 other than the mean of C12 and C13, or |k| below 1")
  end subroutine check

  !> Return the block of the normal components.
  pure function normal_block(values) result(c)
    type(law_value_t), intent(in) :: values(:)
    real(wp) :: c(3, 3)

    c(:, 1) = [value_of(values, "C11"), value_of(values, "C12"), value_of(values, "C13")]
    c(:, 2) = [value_of(values, "C12"), value_of(values, "C22"), value_of(values, "C23")]
    c(:, 3) = [value_of(values, "C13"), value_of(values, "C23"), value_of(values, "C33")]
  end function normal_block

  !> Return the factor of the shear in a plane of isotropy with the axes i and j.
  pure real(wp) function isotropic_shear(c, i, j)
    !> Return the block of the normal components.
    real(wp), intent(in) :: c(3, 3)
    integer, intent(in) :: i, j

    isotropic_shear = (c(i, i) + c(j, j))/2 - c(i, j)
  end function isotropic_shear

  !> Return P of unit tension along rolling.
  pure function along_rolling(values) result(p)
    type(law_value_t), intent(in) :: values(:)
    real(wp) :: p(3)

    p = matmul(normal_block(values), [2.0_wp, -1.0_wp, -1.0_wp])/3
  end function along_rolling

  subroutine set(self, values)
    class(cpb06_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    type(function_t) :: q
    real(wp) :: c(3, 3), shear(3), e(6)

    self%always_convex = .true.
    c = normal_block(values)
    shear = [value_of(values, "C44", isotropic_shear(c, 2, 3)), &
        value_of(values, "C55", isotropic_shear(c, 3, 1)), &
        value_of(values, "C66", isotropic_shear(c, 1, 2))]
    call new_transformation(self%transformation(1), c, shear)
    call new_exponent(self%exponent, value_of(values, "m"))
    self%k = value_of(values, "k")
    self%normalisation = 1.0_wp
    e(1:3) = along_rolling(values)
    e(4:6) = 0.0_wp
    call self%principal_function(e, q)
    self%normalisation = 1/q%value
  end subroutine set

  !> Evaluate the function of the principal values; zero if no term is positive.
  pure subroutine principal_function(self, e, q)
    class(cpb06_t), intent(in) :: self
    real(wp), intent(in) :: e(6)
    type(function_t), intent(out) :: q

    type(function_t) :: f
    real(wp) :: slope(3), x(3), scale, power(3), d(3), dd(3)
    integer :: i

    q = function_t(0.0_wp, 0.0_wp, 0.0_wp)
    slope = sign(1.0_wp, e(1:3)) - self%k
    x = slope*e(1:3)
    scale = maxval(x)
    if (.not. scale > 0.0_wp) return
    x = x/scale
    call powers(3, self%exponent, x, power, d, dd)
    f%value = sum(power)
    f%second = 0.0_wp
    do i = 1, 3
      f%first(i) = slope(i)*d(i)
      f%second(i, i) = slope(i)**2*dd(i)
    end do
    call root_of(3, self%exponent%value, scale, 1.0_wp, f, q)
    q%value = self%normalisation*q%value
    q%first(1:3) = self%normalisation*q%first(1:3)
    q%second(1:3, 1:3) = self%normalisation*q%second(1:3, 1:3)
  end subroutine principal_function

end module dd3_material_yield_cpb06
