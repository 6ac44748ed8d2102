!> The saturating law of J. E. Hockett and O. D. Sherby (1975): Y = Ysat - (Ysat - Y0)
!> exp(-(N p)^q). For q < 1 its slope is unbounded at p = 0, so up to a plastic strain that no one
!> can see the curve is replaced by its chord.
module dd3_material_hardening_hockett_sherby
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_relaxation, only : longest_decay
  use dd3_material_description, only : description_t, problem_t, add_problem, position_of, value_of
  use dd3_material_flow, only : flow_direction_t, flow_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: hockett_sherby_t

  !> Plastic strain below which the chord holds.
  real(wp), parameter :: shortest = 1.0e-8_wp

  !> The law.
  type, extends(hardening_t) :: hockett_sherby_t
    private
    !> Flow stress at saturation and its distance from the initial one, MPa.
    real(wp) :: saturation = 0.0_wp, gain = 0.0_wp
    !> Rate of saturation; exponent.
    real(wp) :: rate = 0.0_wp, q = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: flow_stress
  end type hockett_sherby_t

contains

  !> Says its name, source and parameters.
  subroutine describe(description)
    !> What the law says of itself.
    type(description_t), intent(out) :: description

    description%name = "hockett_sherby"
    description%title = "Y = Ysat - (Ysat - Y0) exp(-(N p)^q)"
    description%source = "J. E. Hockett, O. D. Sherby, J. Mech. Phys. Solids 23 (1975) 87-98"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("Ysat", kind_real, "MPa", "", "flow stress at saturation", 0.0_wp, lower_open=.true.), &
      row("N", kind_real, "", "", "rate of saturation", 0.0_wp, lower_open=.true.), &
      row("q", kind_real, "", "", "exponent", 0.0_wp, 2.0_wp, lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 150.0_wp), law_value_t("Ysat", 420.0_wp), law_value_t("N", 5.0_wp), &
      law_value_t("q", 0.7_wp)])
  end subroutine describe

  !> Finds a flow stress that would fall.
  subroutine check(values, problems)
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> Receives what is wrong.
    type(problem_t), allocatable, intent(inout) :: problems(:)

    if (size(problems) > 0) return
    if (value_of(values, "Ysat") >= value_of(values, "Y0")) return
    call add_problem(problems, position_of(values, "Ysat"), "Ysat is smaller than Y0", &
                     "at least Y0")
  end subroutine check

  !> Takes its parameters.
  subroutine set(self, values)
    !> The law.
    class(hockett_sherby_t), intent(inout) :: self
    !> Its parameters.
    type(law_value_t), intent(in) :: values(:)

    self%saturation = value_of(values, "Ysat")
    self%gain = self%saturation - value_of(values, "Y0")
    self%rate = value_of(values, "N")
    self%q = value_of(values, "q")
  end subroutine set

  !> The flow stress after a plastic increment.
  pure subroutine flow_stress(self, plastic, old, increment, direction, flow)
    !> The law.
    class(hockett_sherby_t), intent(in) :: self
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
    real(wp) :: strain, power, missing

    associate (unused => old, no_direction => direction)
    end associate
    strain = max(plastic + increment, shortest)
    power = (self%rate*strain)**self%q
    missing = self%gain*exp(-min(power, longest_decay))
    flow%value = self%saturation - missing
    flow%slope = missing*self%q*power/strain
    if (plastic + increment < shortest) then
      flow%slope = (self%gain - missing)/shortest
      flow%value = self%saturation - self%gain + flow%slope*(plastic + increment)
    end if
    flow%gradient = 0.0_wp
  end subroutine flow_stress

end module dd3_material_hardening_hockett_sherby
