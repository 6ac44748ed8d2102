! SPDX-License-Identifier: GPL-3.0-or-later
!> The power law of H. W. Swift (1952): Y = K (e0 + p)^n, with e0 or the initial flow stress
!> Y0 = K e0^n given.
module dd3_material_hardening_swift
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_base_text, only : to_text
  use dd3_material_description, only : description_t, problem_t, add_problem, is_given, &
      position_of, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t
  implicit none
  private
  public :: swift_t

  type, extends(isotropic_hardening_t) :: swift_t
    private
    !> Factor K, MPa; exponent. The parent's prestrain is e0.
    real(wp) :: k = 0.0_wp, n = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: hardening_curve
  end type swift_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "swift"
    description%title = "Y = K (e0 + p)^n; by e0 or by Y0"
    description%source = "H. W. Swift, J. Mech. Phys. Solids 1 (1952) 1-18"
    allocate (description%rows, source=[ &
      row("K", kind_real, "MPa", "", "factor", 0.0_wp, lower_open=.true.), &
      row("e0", kind_real, "", "-", "strain before the start; or Y0 in its place", 1.0e-12_wp), &
      row("n", kind_real, "", "", "exponent", 0.0_wp, 1.0_wp, lower_open=.true.), &
      row("Y0", kind_real, "MPa", "-", "initial flow stress, in place of e0", 0.0_wp, &
          lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("K", 565.0_wp), law_value_t("e0", 0.007117_wp), law_value_t("n", 0.259_wp)])
  end subroutine describe

  !> Require either e0 or Y0, and a Y0 that gives an e0 between 1e-12 and 10.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    real(wp) :: logarithm

    if (is_given(values, "e0") .and. is_given(values, "Y0")) then
      call add_problem(problems, position_of(values, "Y0"), "both e0 and Y0 given", "one of them")
    else if (.not. (is_given(values, "e0") .or. is_given(values, "Y0"))) then
      call add_problem(problems, 0, "e0 is missing", "e0, or Y0 in its place")
    else if (is_given(values, "Y0") .and. size(problems) == 0) then
      logarithm = log10(value_of(values, "Y0")/value_of(values, "K"))/value_of(values, "n")
      if (logarithm < -12.0_wp .or. logarithm > 1.0_wp) then
        call add_problem(problems, position_of(values, "Y0"), &
            "Y0, K and n give e0 = (Y0/K)^(1/n) = 10^("//to_text(logarithm)//")", &
            "e0 from 1e-12 to 10")
      end if
    end if
  end subroutine check

  subroutine set(self, values)
    class(swift_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%k = value_of(values, "K")
    self%n = value_of(values, "n")
    self%prestrain = value_of(values, "e0")
    if (is_given(values, "Y0")) self%prestrain = (value_of(values, "Y0")/self%k)**(1/self%n)
  end subroutine set

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(swift_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    stress = self%k*strain**self%n
    slope = self%n*stress/strain
  end subroutine hardening_curve

end module dd3_material_hardening_swift
