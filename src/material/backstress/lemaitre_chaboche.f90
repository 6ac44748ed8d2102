! SPDX-License-Identifier: GPL-3.0-or-later
!> Saturating kinematic hardening, P. J. Armstrong and C. O. Frederick (1966), J. Lemaitre and
!> J.-L. Chaboche (1985): dX = CX (Xsat N' - X) dp, N' = dev(T - X)/sb.
module dd3_material_backstress_lemaitre_chaboche
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_law, only : backstress_t
  use dd3_material_backstress_relaxation, only : relax_back_stress
  use dd3_material_description, only : description_t, value_of
  use dd3_material_flow, only : flow_direction_t, back_response_t
  implicit none
  private
  public :: lemaitre_chaboche_t

  type, extends(backstress_t) :: lemaitre_chaboche_t
    private
    !> Rate of saturation CX.
    real(wp) :: rate = 0.0_wp
    !> Back-stress at saturation Xsat, MPa.
    real(wp) :: saturation = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: back_stress
  end type lemaitre_chaboche_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "lemaitre_chaboche"
    description%title = "dX = CX (Xsat dev(T - X)/sb - X) dp"
    description%source = "P. J. Armstrong, C. O. Frederick, CEGB report RD/B/N731 "// &
        "(1966); J. Lemaitre, J.-L. Chaboche, Mecanique des materiaux solides, Dunod (1985)"
    allocate (description%rows, source=[ &
      row("CX", kind_real, "", "", "rate of saturation", 0.0_wp), &
      row("Xsat", kind_real, "MPa", "", "back-stress at saturation", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("CX", 50.0_wp), law_value_t("Xsat", 60.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(lemaitre_chaboche_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%rate = value_of(values, "CX")
    self%saturation = value_of(values, "Xsat")
  end subroutine set

  !> Evaluate the back-stress at the end of a plastic increment.
  pure subroutine back_stress(self, start, increment, direction, back)
    class(lemaitre_chaboche_t), intent(in) :: self
    real(wp), intent(in) :: start(6), increment
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: back

    call relax_back_stress(self%rate*self%saturation, self%rate, start, increment, direction, back)
  end subroutine back_stress

end module dd3_material_backstress_lemaitre_chaboche
