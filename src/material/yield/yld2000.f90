! SPDX-License-Identifier: GPL-3.0-or-later
!> The orthotropic criterion "Yld2000-2d" of F. Barlat and others of plane stress: principal values
!> of two linear transformations X' = L' T, X'' = L'' T,
!>
!>     2 sb^m = |X'1-X'2|^m + |2 X''2 + X''1|^m + |2 X''1 + X''2|^m
!>     L'11 = 2 alpha1/3   L'12 = -alpha1/3   L'21 = -alpha2/3   L'22 = 2 alpha2/3   L'66 = alpha7
!>     9 L''11 = -2 alpha3 + 2 alpha4 + 8 alpha5 - 2 alpha6
!>     9 L''12 =    alpha3 - 4 alpha4 - 4 alpha5 + 4 alpha6
!>     9 L''21 =  4 alpha3 - 4 alpha4 - 4 alpha5 +   alpha6
!>     9 L''22 = -2 alpha3 + 8 alpha4 + 2 alpha5 - 2 alpha6                    L''66 = alpha8
!>
!> With half the difference V' of X'1 and X'2, V'' likewise, and U'' = 3 (X''1 + X''2)/2 these are
!> the pairs (V', V') with half the weight and (U'', V''). V' and V'' take up f T23 and g T31 in the
!> extension, as T12 in the isotropic case.
module dd3_material_yield_yld2000
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_yield_planar, only : planar_criterion_t, norm_t, pair_t
  use dd3_material_yield_power, only : new_exponent, exponent_row
  implicit none
  private
  public :: yld2000_t

  type, extends(planar_criterion_t) :: yld2000_t
  contains
    procedure, nopass :: describe
    procedure :: set
  end type yld2000_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    character(len=6), parameter :: name(8) = ["alpha1", "alpha2", "alpha3", "alpha4", "alpha5", &
        "alpha6", "alpha7", "alpha8"]
    integer :: i

    description%name = "yld2000"
    description%title = "orthotropic, of exponent m, of plane stress with an extension (Yld2000-2d)"
    description%source = "F. Barlat, J. C. Brem, J. W. Yoon and others, Int. J. Plasticity 19 "// &
        "(2003) 1297-1319"
    allocate (description%rows, source=[ &
      (row(name(i), kind_real, "", "", "first transformation; isotropic: 1"), i=1, 2), &
      (row(name(i), kind_real, "", "", "second transformation; isotropic: 1"), i=3, 6), &
      row(name(7), kind_real, "", "1", "first transformation: factor of T12"), &
      row(name(8), kind_real, "", "1", "second transformation: factor of T12"), &
      row("f", kind_real, "", "1", "both transformations: factor of T23 (extension)"), &
      row("g", kind_real, "", "1", "both transformations: factor of T31 (extension)"), &
      exponent_row()])
    allocate (description%example, source=[ &
      (law_value_t(name(i), 1.0_wp), i=1, 8), law_value_t("f", 1.0_wp), law_value_t("g", 1.0_wp), &
      law_value_t("m", 4.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(yld2000_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    type(norm_t) :: first, second, sum
    real(wp) :: alpha(8), x(2, 2), across(2)
    character(len=6) :: name
    integer :: i

    self%always_convex = .true.
    do i = 1, 8
      write (name, '(a, i0)') "alpha", i
      alpha(i) = value_of(values, name, 1.0_wp)
    end do
    across = [value_of(values, "f", 1.0_wp), value_of(values, "g", 1.0_wp)]
    first = norm_t([2*alpha(1) + alpha(2), -alpha(1) - 2*alpha(2)]/6, [across, alpha(7)]**2)
    x(1, :) = [-2*alpha(3) + 2*alpha(4) + 8*alpha(5) - 2*alpha(6), &
               alpha(3) - 4*alpha(4) - 4*alpha(5) + 4*alpha(6)]/9
    x(2, :) = [4*alpha(3) - 4*alpha(4) - 4*alpha(5) + alpha(6), &
               -2*alpha(3) + 8*alpha(4) + 2*alpha(5) - 2*alpha(6)]/9
    sum = norm_t(1.5_wp*(x(1, :) + x(2, :)))
    second = norm_t(0.5_wp*(x(1, :) - x(2, :)), [across, alpha(8)]**2)
    self%pairs = [pair_t(0.5_wp, first, first), pair_t(0.5_wp, sum, second)]
    call new_exponent(self%exponent, value_of(values, "m"))
  end subroutine set

end module dd3_material_yield_yld2000
