! SPDX-License-Identifier: GPL-3.0-or-later
!> The factor of G. R. Johnson and W. H. Cook (1983): 1 + C ln(rate/reference), one below the
!> reference rate.
module dd3_material_rate_johnson_cook
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_rate_law, only : rate_t
  implicit none
  private
  public :: johnson_cook_t

  type, extends(rate_t) :: johnson_cook_t
    private
    !> Factor C; reference rate, 1/s.
    real(wp) :: c = 0.0_wp, reference = 1.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: factor
  end type johnson_cook_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "johnson_cook"
    description%title = "factor 1 + C ln(rate/reference), 1 below the reference rate"
    description%source = "G. R. Johnson, W. H. Cook, "// &
        "7th Int. Symp. on Ballistics, The Hague (1983) 541-547"
    allocate (description%rows, source=[ &
      row("C", kind_real, "", "", "increase of the flow stress by a rate e times larger", &
          0.0_wp, 10.0_wp), &
      row("reference", kind_real, "1/s", "", "rate of the test that the hardening law describes", &
          0.0_wp, lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("C", 0.02_wp), law_value_t("reference", 1.0e-3_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(johnson_cook_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%c = value_of(values, "C")
    self%reference = value_of(values, "reference")
  end subroutine set

  !> Evaluate the factor on the flow stress.
  pure subroutine factor(self, rate, value, slope)
    class(johnson_cook_t), intent(in) :: self
    real(wp), intent(in) :: rate
    real(wp), intent(out) :: value, slope

    value = 1.0_wp
    slope = 0.0_wp
    if (rate <= self%reference) return
    value = 1 + self%c*log(rate/self%reference)
    slope = self%c/rate
  end subroutine factor

end module dd3_material_rate_johnson_cook
