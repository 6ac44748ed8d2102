! SPDX-License-Identifier: GPL-3.0-or-later
!> The chord modulus of F. Yoshida, T. Uemori and K. Fujiwara (2002): the mean slope of unloading
!> falls with the plastic strain and saturates, E = E0 - (E0 - Ea) (1 - exp(-xi p)).
module dd3_material_modulus_chord
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_backstress_relaxation, only : longest_decay
  use dd3_material_description, only : description_t, value_of
  use dd3_material_modulus_law, only : modulus_t
  implicit none
  private
  public :: chord_t

  type, extends(modulus_t) :: chord_t
    private
    !> Modulus at saturation, MPa; rate of saturation.
    real(wp) :: saturated = 1.0_wp, rate = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: young_at
  end type chord_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "chord"
    description%title = "E = young - (young - Ea) (1 - exp(-xi p))"
    description%source = "F. Yoshida, T. Uemori, K. Fujiwara, "// &
        "Int. J. Plasticity 18 (2002) 633-659"
    allocate (description%rows, source=[ &
      row("Ea", kind_real, "MPa", "", "Young's modulus at large plastic strain, at most young", &
          0.0_wp, lower_open=.true.), &
      row("xi", kind_real, "", "", "rate of saturation", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("Ea", 1.63e5_wp), law_value_t("xi", 30.8_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(chord_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%saturated = value_of(values, "Ea")
    self%rate = value_of(values, "xi")
  end subroutine set

  !> Return Young's modulus of a plastic strain, MPa.
  pure real(wp) function young_at(self, initial, plastic_strain)
    class(chord_t), intent(in) :: self
    real(wp), intent(in) :: initial, plastic_strain

    young_at = self%saturated + (initial - self%saturated) &
        *exp(-min(self%rate*plastic_strain, longest_decay))
  end function young_at

end module dd3_material_modulus_chord
