! SPDX-License-Identifier: GPL-3.0-or-later
!> The factor of G. R. Johnson and W. H. Cook (1983): 1 - ((T - Tr)/(Tm - Tr))^m, one below Tr.
module dd3_material_temperature_johnson_cook
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, problem_t, add_problem, position_of, value_of
  use dd3_material_temperature_law, only : temperature_t
  implicit none
  private
  public :: johnson_cook_t

  !> Factor that is left near the melting temperature, for a flow stress above zero.
  real(wp), parameter :: least = 1.0e-3_wp

  type, extends(temperature_t) :: johnson_cook_t
    private
    !> Reference and melting temperature; exponent.
    real(wp) :: reference = 0.0_wp, melting = 1.0_wp, m = 1.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: factor
  end type johnson_cook_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "johnson_cook"
    description%title = "factor 1 - ((T - Tr)/(Tm - Tr))^m, 1 below Tr, at least 0.001"
    description%source = "G. R. Johnson, W. H. Cook, "// &
        "7th Int. Symp. on Ballistics, The Hague (1983) 541-547"
    allocate (description%rows, source=[ &
      row("Tr", kind_real, "C", "20", "temperature of the test that the hardening law describes"), &
      row("Tm", kind_real, "C", "", "melting temperature, above Tr"), &
      row("m", kind_real, "", "", "exponent", 0.0_wp, 10.0_wp, lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("Tr", 20.0_wp), law_value_t("Tm", 1500.0_wp), law_value_t("m", 1.0_wp)])
  end subroutine describe

  !> Require a melting temperature above the reference.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    if (size(problems) > 0) return
    if (.not. value_of(values, "Tm") > value_of(values, "Tr")) call add_problem(problems, &
        position_of(values, "Tm"), "the melting temperature is not above Tr", "Tm > Tr")
  end subroutine check

  subroutine set(self, values)
    class(johnson_cook_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%reference = value_of(values, "Tr")
    self%melting = value_of(values, "Tm")
    self%m = value_of(values, "m")
  end subroutine set

  !> Evaluate the factor on the flow stress.
  pure subroutine factor(self, temperature, value, slope)
    class(johnson_cook_t), intent(in) :: self
    real(wp), intent(in) :: temperature
    real(wp), intent(out) :: value, slope

    real(wp) :: loss

    value = 1.0_wp
    slope = 0.0_wp
    if (temperature <= self%reference) return
    loss = ((temperature - self%reference)/(self%melting - self%reference))**self%m
    value = max(least, 1 - loss)
    if (loss < 1 - least) slope = -self%m*loss/(temperature - self%reference)
  end subroutine factor

end module dd3_material_temperature_johnson_cook
