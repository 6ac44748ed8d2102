!> Linear kinematic hardening, W. Prager (1955): dX = k N' dp, N' = dev(T - X)/sb. In uniaxial
!> tension of a von Mises material the stress rises by k per unit of plastic strain.
module dd3_material_backstress_prager
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_law, only : backstress_t
  use dd3_material_backstress_relaxation, only : relax_back_stress
  use dd3_material_description, only : description_t, value_of
  use dd3_material_flow, only : flow_direction_t, back_response_t
  implicit none
  private
  public :: prager_t

  !> The law.
  type, extends(backstress_t) :: prager_t
    private
    !> Modulus k, MPa.
    real(wp) :: modulus = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: back_stress
  end type prager_t

contains

  !> Says its name, source and parameters.
  subroutine describe(description)
    !> What the law says of itself.
    type(description_t), intent(out) :: description

    description%name = "prager"
    description%title = "dX = k dev(T - X)/sb dp"
    description%source = "W. Prager, Proc. Inst. Mech. Eng. 169 (1955) 41-57"
    allocate (description%rows, source=[ &
      row("k", kind_real, "MPa", "", "kinematic modulus", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("k", 800.0_wp)])
  end subroutine describe

  !> Takes its parameters.
  subroutine set(self, values)
    !> The law.
    class(prager_t), intent(inout) :: self
    !> Its parameters.
    type(law_value_t), intent(in) :: values(:)

    self%modulus = value_of(values, "k")
  end subroutine set

  !> The back-stress after a plastic increment.
  pure subroutine back_stress(self, old, increment, direction, back)
    !> The law.
    class(prager_t), intent(in) :: self
    !> Back-stress at the start, MPa.
    real(wp), intent(in) :: old(6)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> The back-stress and its derivatives.
    type(back_response_t), intent(out) :: back

    call relax_back_stress(self%modulus, 0.0_wp, old, increment, direction, back)
  end subroutine back_stress

end module dd3_material_backstress_prager
