!> The power law of P. Ludwik (1909): Y = Y0 + K p^n. Its slope is unbounded at p = 0, so up to a
!> plastic strain that no one can see the curve is replaced by its chord.
module dd3_material_hardening_ludwik
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_flow, only : flow_direction_t, flow_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: ludwik_t

  !> Plastic strain below which the chord holds.
  real(wp), parameter :: shortest = 1.0e-8_wp

  !> The law.
  type, extends(hardening_t) :: ludwik_t
    private
    !> Initial flow stress and factor, MPa.
    real(wp) :: y0 = 0.0_wp, k = 0.0_wp
    !> Exponent.
    real(wp) :: n = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: flow_stress
  end type ludwik_t

contains

  !> Says its name, source and parameters.
  subroutine describe(description)
    !> What the law says of itself.
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

  !> Takes its parameters.
  subroutine set(self, values)
    !> The law.
    class(ludwik_t), intent(inout) :: self
    !> Its parameters.
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
    self%k = value_of(values, "K")
    self%n = value_of(values, "n")
  end subroutine set

  !> The flow stress after a plastic increment.
  pure subroutine flow_stress(self, plastic, old, increment, direction, flow)
    !> The law.
    class(ludwik_t), intent(in) :: self
    !> Equivalent plastic strain at the start.
    real(wp), intent(in) :: plastic
    !> No other internal variables.
    real(wp), intent(in) :: old(self%n_internal)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> Flow stress and its derivatives.
    type(flow_response_t), intent(out) :: flow
    real(wp) :: strain, power

    associate (unused => old, no_direction => direction)
    end associate
    strain = max(plastic + increment, shortest)
    power = self%k*strain**self%n
    flow%slope = self%n*power/strain
    if (plastic + increment < shortest) then
      flow%slope = power/shortest
      power = flow%slope*(plastic + increment)
    end if
    flow%value = self%y0 + power
    flow%gradient = 0.0_wp
  end subroutine flow_stress

end module dd3_material_hardening_ludwik
