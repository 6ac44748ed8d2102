!> Perfect plasticity: the flow stress is a constant, Y = Y0.
module dd3_material_hardening_perfect
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_flow, only : flow_direction_t, flow_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: perfect_t

  !> The law.
  type, extends(hardening_t) :: perfect_t
    private
    !> Flow stress, MPa.
    real(wp) :: y0 = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: flow_stress
  end type perfect_t

contains

  !> Says its name, source and parameters.
  subroutine describe(description)
    !> What the law says of itself.
    type(description_t), intent(out) :: description

    description%name = "perfect"
    description%title = "constant flow stress"
    description%source = "L. Prandtl, Proc. 1st Int. Congr. Appl. Mech., Delft "// &
                         "(1924) 43-54; A. Reuss, Z. angew. Math. Mech. 10 (1930) 266-274"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "flow stress", 0.0_wp, lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 200.0_wp)])
  end subroutine describe

  !> Takes its parameters.
  subroutine set(self, values)
    !> The law.
    class(perfect_t), intent(inout) :: self
    !> Its parameters.
    type(law_value_t), intent(in) :: values(:)

    self%y0 = value_of(values, "Y0")
  end subroutine set

  !> The flow stress after a plastic increment.
  pure subroutine flow_stress(self, plastic, old, increment, direction, flow)
    !> The law.
    class(perfect_t), intent(in) :: self
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

    associate (unused => old, no_direction => direction, no_history => plastic, &
               no_increment => increment)
    end associate
    flow%value = self%y0
    flow%slope = 0.0_wp
    flow%gradient = 0.0_wp
  end subroutine flow_stress

end module dd3_material_hardening_perfect
