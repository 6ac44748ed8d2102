! SPDX-License-Identifier: GPL-3.0-or-later
!> The saturating law of J. E. Hockett and O. D. Sherby (1975): Y = Ysat - (Ysat - Y0)
!> exp(-(N p)^q), near p = 0 by its chord, as the slope is unbounded there for q < 1.
module dd3_material_hardening_hockett_sherby
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_relaxation, only : longest_decay
  use dd3_material_description, only : description_t, problem_t, add_problem, position_of, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t, chord_strain
  implicit none
  private
  public :: hockett_sherby_t

  type, extends(isotropic_hardening_t) :: hockett_sherby_t
    private
    !> Ysat and Ysat - Y0, MPa.
    real(wp) :: saturation = 0.0_wp, gain = 0.0_wp
    !> N and q.
    real(wp) :: rate = 0.0_wp, q = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: hardening_curve
  end type hockett_sherby_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "hockett_sherby"
    description%title = "Y = Ysat - (Ysat - Y0) exp(-(N p)^q)"
    description%source = "J. E. Hockett, O. D. Sherby, J. Mech. Phys. Solids 23 (1975) 87-98"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("Ysat", kind_real, "MPa", "", "flow stress at saturation", 0.0_wp, lower_open=.true.), &
      row("N", kind_real, "", "", "rate of saturation", 0.0_wp, lower_open=.true.), &
      row("q", kind_real, "", "", "exponent", 0.0_wp, 2.0_wp, lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 150.0_wp), law_value_t("Ysat", 420.0_wp), law_value_t("N", 5.0_wp), &
      law_value_t("q", 0.7_wp)])
  end subroutine describe

  !> Require a flow stress that does not decrease.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    if (size(problems) > 0) return
    if (value_of(values, "Ysat") >= value_of(values, "Y0")) return
    call add_problem(problems, position_of(values, "Ysat"), "Ysat is smaller than Y0", &
        "at least Y0")
  end subroutine check

  subroutine set(self, values)
    class(hockett_sherby_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%saturation = value_of(values, "Ysat")
    self%gain = self%saturation - value_of(values, "Y0")
    self%rate = value_of(values, "N")
    self%q = value_of(values, "q")
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(hockett_sherby_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    real(wp) :: x, power, missing

    x = max(strain, chord_strain)
    power = (self%rate*x)**self%q
    missing = self%gain*exp(-min(power, longest_decay))
    stress = self%saturation - missing
    slope = missing*self%q*power/x
    if (strain < chord_strain) then
      slope = (self%gain - missing)/chord_strain
      stress = self%saturation - self%gain + slope*strain
    end if
  end subroutine hardening_curve

end module dd3_material_hardening_hockett_sherby
