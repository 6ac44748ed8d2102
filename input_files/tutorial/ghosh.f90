! SPDX-License-Identifier: GPL-3.0-or-later
!> The hardening law known as Ghosh's: Y = K (e0 + p)^n - C, Swift's law less a constant.
module dd3_material_hardening_ghosh
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, problem_t, add_problem, position_of, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t
  implicit none
  private
  public :: ghosh_t

  type, extends(isotropic_hardening_t) :: ghosh_t
    private
    !> Factor K and constant C, MPa; exponent. The parent's prestrain is e0.
    real(wp) :: k = 0.0_wp, c = 0.0_wp, n = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: hardening_curve
  end type ghosh_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "ghosh"
    description%title = "Y = K (e0 + p)^n - C"
    description%source = "Swift's law less a constant, known as Ghosh's"
    allocate (description%rows, source=[ &
      row("K", kind_real, "MPa", "", "factor", 0.0_wp, lower_open=.true.), &
      row("e0", kind_real, "", "", "strain before the start", 1.0e-12_wp), &
      row("n", kind_real, "", "", "exponent", 0.0_wp, 1.0_wp, lower_open=.true.), &
      row("C", kind_real, "MPa", "", "constant that is subtracted", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("K", 700.0_wp), law_value_t("e0", 0.02_wp), law_value_t("n", 0.2_wp), &
      law_value_t("C", 150.0_wp)])
  end subroutine describe

  !> Require a positive initial flow stress.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    if (size(problems) > 0) return
    if (value_of(values, "K")*value_of(values, "e0")**value_of(values, "n") &
        > value_of(values, "C")) return
    call add_problem(problems, position_of(values, "C"), &
        "the initial flow stress is not positive", "C below K e0^n")
  end subroutine check

  subroutine set(self, values)
    class(ghosh_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%k = value_of(values, "K")
    self%c = value_of(values, "C")
    self%n = value_of(values, "n")
    self%prestrain = value_of(values, "e0")
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(ghosh_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    stress = self%k*strain**self%n - self%c
    slope = self%n*(stress + self%c)/strain
  end subroutine hardening_curve

end module dd3_material_hardening_ghosh
