!> Linear isotropic hardening: Y = Y0 + H p.
module dd3_material_hardening_linear
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_flow, only : flow_direction_t, flow_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: linear_t

  !> The law.
  type, extends(hardening_t) :: linear_t
    private
    !> Initial flow stress and slope, MPa.
    real(wp) :: y0 = 0.0_wp, slope = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: flow_stress
  end type linear_t

contains

  !> Says its name, source and parameters.
  subroutine describe(description)
    !> What the law says of itself.
    type(description_t), intent(out) :: description

    description%name = "linear"
    description%title = "Y = Y0 + H p"
    description%source = "W. Prager, J. Appl. Mech. 16 (1949) 215-218"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("H", kind_real, "MPa", "", "slope dY/dp", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 200.0_wp), law_value_t("H", 500.0_wp)])
  end subroutine describe

  !> Takes its parameters.
  subroutine set(self, values)
    !> The law.
    class(linear_t), intent(inout) :: self
    !> Its parameters.
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
    self%slope = value_of(values, "H")
  end subroutine set

  !> The flow stress after a plastic increment.
  pure subroutine flow_stress(self, plastic, old, increment, direction, flow)
    !> The law.
    class(linear_t), intent(in) :: self
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

    associate (unused => old, no_direction => direction)
    end associate
    flow%value = self%y0 + self%slope*(plastic + increment)
    flow%slope = self%slope
    flow%gradient = 0.0_wp
  end subroutine flow_stress

end module dd3_material_hardening_linear
