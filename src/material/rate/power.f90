! SPDX-License-Identifier: GPL-3.0-or-later
!> A power of the rate: (1 + rate/reference)^m. Above the reference rate it tends to
!> (rate/reference)^m, with m the sensitivity d ln(stress)/d ln(rate); at rest it is one.
module dd3_material_rate_power
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_rate_law, only : rate_t
  implicit none
  private
  public :: power_t

  type, extends(rate_t) :: power_t
    private
    !> Sensitivity; reference rate, 1/s.
    real(wp) :: m = 0.0_wp, reference = 1.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: factor
  end type power_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "power"
    description%title = "factor (1 + rate/reference)^m"
    description%source = "-"
    allocate (description%rows, source=[ &
      row("m", kind_real, "", "", "sensitivity d ln Y/d ln rate above the reference rate", &
          0.0_wp, 1.0_wp), &
      row("reference", kind_real, "1/s", "", "rate at which the factor is 2^m", 0.0_wp, &
          lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("m", 0.015_wp), law_value_t("reference", 1.0e-4_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(power_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%m = value_of(values, "m")
    self%reference = value_of(values, "reference")
  end subroutine set

  !> Evaluate the factor on the flow stress.
  pure subroutine factor(self, rate, value, slope)
    class(power_t), intent(in) :: self
    real(wp), intent(in) :: rate
    real(wp), intent(out) :: value, slope

    value = (1 + rate/self%reference)**self%m
    slope = self%m*value/(self%reference + rate)
  end subroutine factor

end module dd3_material_rate_power
