! SPDX-License-Identifier: GPL-3.0-or-later
!> Mixture of the laws of E. Voce (1948) and H. W. Swift (1952), after the mixture of Voce's with
!> Hollomon's law by J. H. Sung, J. H. Kim and R. H. Wagoner (2010):
!> Y = alpha (Y0 + Rsat (1 - exp(-CR p))) + (1 - alpha) K (e0 + p)^n.
module dd3_material_hardening_swift_voce
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_relaxation, only : longest_decay
  use dd3_material_description, only : description_t, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t
  implicit none
  private
  public :: swift_voce_t

  type, extends(isotropic_hardening_t) :: swift_voce_t
    private
    !> Weight of Voce's law.
    real(wp) :: alpha = 0.0_wp
    !> Swift's K (MPa), e0 and n.
    real(wp) :: k = 0.0_wp, e0 = 0.0_wp, n = 0.0_wp
    !> Voce's Y0 and Rsat (MPa), CR.
    real(wp) :: y0 = 0.0_wp, gain = 0.0_wp, rate = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: hardening_curve
  end type swift_voce_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "swift_voce"
    description%title = "Y = alpha (Y0 + Rsat (1 - exp(-CR p))) + (1 - alpha) K (e0 + p)^n"
    description%source = "J. H. Sung, J. H. Kim, R. H. Wagoner, Int. J. Plasticity 26 "// &
        "(2010) 1746-1771"
    allocate (description%rows, source=[ &
      row("alpha", kind_real, "", "", "weight of Voce's law, the rest is Swift's", &
          0.0_wp, 1.0_wp), &
      row("K", kind_real, "MPa", "", "Swift's factor", 0.0_wp, lower_open=.true.), &
      row("e0", kind_real, "", "", "Swift's strain before the start", 1.0e-12_wp), &
      row("n", kind_real, "", "", "Swift's exponent", 0.0_wp, 1.0_wp, lower_open=.true.), &
      row("Y0", kind_real, "MPa", "", "Voce's initial flow stress", 0.0_wp, lower_open=.true.), &
      row("Rsat", kind_real, "MPa", "", "Voce's gain at saturation", 0.0_wp), &
      row("CR", kind_real, "", "", "Voce's rate of saturation", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("alpha", 0.4_wp), law_value_t("K", 565.0_wp), &
      law_value_t("e0", 0.007117_wp), law_value_t("n", 0.259_wp), &
      law_value_t("Y0", 160.0_wp), law_value_t("Rsat", 200.0_wp), law_value_t("CR", 10.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(swift_voce_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%alpha = value_of(values, "alpha")
    self%k = value_of(values, "K")
    self%e0 = value_of(values, "e0")
    self%n = value_of(values, "n")
    self%y0 = value_of(values, "Y0")
    self%gain = value_of(values, "Rsat")
    self%rate = value_of(values, "CR")
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(swift_voce_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    real(wp) :: power, missing

    missing = self%alpha*self%gain*exp(-min(self%rate*strain, longest_decay))
    power = (1 - self%alpha)*self%k*(self%e0 + strain)**self%n
    stress = self%alpha*(self%y0 + self%gain) - missing + power
    slope = self%rate*missing + self%n*power/(self%e0 + strain)
  end subroutine hardening_curve

end module dd3_material_hardening_swift_voce
