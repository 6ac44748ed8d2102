! SPDX-License-Identifier: GPL-3.0-or-later
!> The factor of G. R. Cowper and P. S. Symonds (1957): 1 + (rate/C)^(1/p).
module dd3_material_rate_cowper_symonds
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_rate_law, only : rate_t
  implicit none
  private
  public :: cowper_symonds_t

  !> The slope is unbounded at rate zero: up to this part of C the chord replaces the power.
  real(wp), parameter :: chord_part = 1.0e-15_wp

  type, extends(rate_t) :: cowper_symonds_t
    private
    !> Rate at which the flow stress is doubled, 1/s; inverse exponent.
    real(wp) :: c = 1.0_wp, p = 1.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: factor
  end type cowper_symonds_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "cowper_symonds"
    description%title = "factor 1 + (rate/C)^(1/p)"
    description%source = "G. R. Cowper, P. S. Symonds, Brown University, "// &
        "Technical Report 28 (1957)"
    allocate (description%rows, source=[ &
      row("C", kind_real, "1/s", "", "rate at which the flow stress is doubled", 0.0_wp, &
          lower_open=.true.), &
      row("p", kind_real, "", "", "inverse exponent", 1.0_wp, 100.0_wp)])
    allocate (description%example, source=[law_value_t("C", 40.0_wp), law_value_t("p", 5.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(cowper_symonds_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%c = value_of(values, "C")
    self%p = value_of(values, "p")
  end subroutine set

  !> Evaluate the factor on the flow stress.
  pure subroutine factor(self, rate, value, slope)
    class(cowper_symonds_t), intent(in) :: self
    real(wp), intent(in) :: rate
    real(wp), intent(out) :: value, slope

    real(wp) :: part

    part = max(rate/self%c, chord_part)
    value = part**(1/self%p)
    slope = value/(self%p*part*self%c)
    if (rate < chord_part*self%c) then
      slope = value/(part*self%c)
      value = slope*rate
    end if
    value = 1 + value
  end subroutine factor

end module dd3_material_rate_cowper_symonds
