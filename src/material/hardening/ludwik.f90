! SPDX-License-Identifier: GPL-3.0-or-later
!> The power law of P. Ludwik (1909): Y = Y0 + K p^n, near p = 0 by its chord.
module dd3_material_hardening_ludwik
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t, chord_strain
  implicit none
  private
  public :: ludwik_t

  type, extends(isotropic_hardening_t) :: ludwik_t
    private
    !> Initial flow stress and factor (MPa), exponent.
    real(wp) :: y0 = 0.0_wp, k = 0.0_wp, n = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: hardening_curve
  end type ludwik_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "ludwik"
    description%title = "Y = Y0 + K p^n"
    description%source = "P. Ludwik, Elemente der technologischen Mechanik, Springer (1909)"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("K", kind_real, "MPa", "", "factor", 0.0_wp), &
      row("n", kind_real, "", "", "exponent", 0.0_wp, 1.0_wp, lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 150.0_wp), law_value_t("K", 450.0_wp), law_value_t("n", 0.5_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(ludwik_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
    self%k = value_of(values, "K")
    self%n = value_of(values, "n")
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(ludwik_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    real(wp) :: x, power

    x = max(strain, chord_strain)
    power = self%k*x**self%n
    slope = self%n*power/x
    if (strain < chord_strain) then
      slope = power/chord_strain
      power = slope*strain
    end if
    stress = self%y0 + power
  end subroutine hardening_curve

end module dd3_material_hardening_ludwik
