!> The saturating law of E. Voce (1948): Y = Y0 + Rsat (1 - exp(-CR p)).
module dd3_material_hardening_voce
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_relaxation, only : longest_decay
  use dd3_material_description, only : description_t, value_of
  use dd3_material_flow, only : flow_direction_t, flow_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: voce_t

  !> The law.
  type, extends(hardening_t) :: voce_t
    private
    !> Initial flow stress and its largest gain, MPa.
    real(wp) :: y0 = 0.0_wp, gain = 0.0_wp
    !> Rate of saturation.
    real(wp) :: rate = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: flow_stress
  end type voce_t

contains

  !> Says its name, source and parameters.
  subroutine describe(description)
    !> What the law says of itself.
    type(description_t), intent(out) :: description

    description%name = "voce"
    description%title = "Y = Y0 + Rsat (1 - exp(-CR p))"
    description%source = "E. Voce, J. Inst. Metals 74 (1948) 537-562"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("Rsat", kind_real, "MPa", "", "gain of flow stress at saturation", 0.0_wp), &
      row("CR", kind_real, "", "", "rate of saturation", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 200.0_wp), law_value_t("Rsat", 150.0_wp), law_value_t("CR", 10.0_wp)])
  end subroutine describe

  !> Takes its parameters.
  subroutine set(self, values)
    !> The law.
    class(voce_t), intent(inout) :: self
    !> Its parameters.
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
    self%gain = value_of(values, "Rsat")
    self%rate = value_of(values, "CR")
  end subroutine set

  !> The flow stress after a plastic increment.
  pure subroutine flow_stress(self, plastic, old, increment, direction, flow)
    !> The law.
    class(voce_t), intent(in) :: self
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
    real(wp) :: missing

    associate (unused => old, no_direction => direction)
    end associate
    missing = self%gain*exp(-min(self%rate*(plastic + increment), longest_decay))
    flow%value = self%y0 + self%gain - missing
    flow%slope = self%rate*missing
    flow%gradient = 0.0_wp
  end subroutine flow_stress

end module dd3_material_hardening_voce
