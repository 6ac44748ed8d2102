! SPDX-License-Identifier: GPL-3.0-or-later
!> The orthotropic criterion of F. Barlat, D. J. Lege and J. C. Brem, "Yld'91": Hosford's function
!> of the principal values of S = L T,
!>
!>     2 sb^m = |S1-S2|^m + |S2-S3|^m + |S3-S1|^m
!>     S11 = [c (T11-T22) - b (T33-T11)]/3    S23 = f T23
!>     S22 = [a (T22-T33) - c (T11-T22)]/3    S31 = g T31
!>     S33 = [b (T33-T11) - a (T22-T33)]/3    S12 = h T12
module dd3_material_yield_yld91
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_yield_hosford, only : hosford_t
  use dd3_material_yield_power, only : new_exponent, exponent_row
  use dd3_material_yield_transformation, only : barlat_transformation
  implicit none
  private
  public :: yld91_t

  !> Hosford's criterion with another transformation.
  type, extends(hosford_t) :: yld91_t
  contains
    procedure, nopass :: describe
    procedure :: set
  end type yld91_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "yld91"
    description%title = "orthotropic, of exponent m, one linear transformation"
    description%source = "F. Barlat, D. J. Lege, J. C. Brem, Int. J. Plasticity 7 (1991) 693-712"
    allocate (description%rows, source=[ &
      row("a", kind_real, "", "", "coefficient of T22-T33; isotropic: 1"), &
      row("b", kind_real, "", "", "coefficient of T33-T11"), &
      row("c", kind_real, "", "", "coefficient of T11-T22"), &
      row("f", kind_real, "", "1", "coefficient of T23"), &
      row("g", kind_real, "", "1", "coefficient of T31"), &
      row("h", kind_real, "", "1", "coefficient of T12"), &
      exponent_row()])
    allocate (description%example, source=[ &
      law_value_t("a", 1.0_wp), law_value_t("b", 1.0_wp), law_value_t("c", 1.0_wp), &
      law_value_t("f", 1.0_wp), law_value_t("g", 1.0_wp), law_value_t("h", 1.0_wp), &
      law_value_t("m", 4.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(yld91_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    real(wp) :: normal(3), shear(3)

    self%always_convex = .true.
    normal = [value_of(values, "a"), value_of(values, "b"), value_of(values, "c")]
    shear = [value_of(values, "f", 1.0_wp), value_of(values, "g", 1.0_wp), &
        value_of(values, "h", 1.0_wp)]
    call barlat_transformation(self%transformation(1), normal, shear)
    call new_exponent(self%exponent, value_of(values, "m"))
  end subroutine set

end module dd3_material_yield_yld91
