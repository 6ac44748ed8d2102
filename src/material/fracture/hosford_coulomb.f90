! SPDX-License-Identifier: GPL-3.0-or-later
!> The strain to fracture of D. Mohr and S. J. Marcadet (2015):
!>     b (1 + c)^(1/n) (g_H + c (2 eta + f_1 + f_3))^(-1/n),
!>     g_H = {[(f_1 - f_2)^a + (f_2 - f_3)^a + (f_1 - f_3)^a]/2}^(1/a),
!> with the triaxiality eta and the principal deviatoric stresses over von Mises's stress,
!>     f_i = 2/3 cos(pi/6 (1 - theta)), 2/3 cos(pi/6 (3 + theta)), -2/3 cos(pi/6 (1 + theta)),
!> theta the normalised Lode angle.
module dd3_material_fracture_hosford_coulomb
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_fracture_law, only : fracture_t
  implicit none
  private
  public :: hosford_coulomb_t

  type, extends(fracture_t) :: hosford_coulomb_t
    private
    real(wp) :: a = 1.0_wp, b = 1.0_wp, c = 0.0_wp, n = 0.1_wp
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: strain
  end type hosford_coulomb_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "hosford_coulomb"
    description%title = "strain to fracture by the stresses of Hosford and Coulomb"
    description%source = "D. Mohr, S. J. Marcadet, Int. J. Solids Struct. 67-68 (2015) 40-55"
    allocate (description%rows, source=[ &
      row("a", kind_real, "", "", "exponent of Hosford's stress; 2: von Mises, 1: Tresca", &
          1.0_wp, 20.0_wp), &
      row("b", kind_real, "", "", "strain to fracture in uniaxial and in equibiaxial tension", &
          0.0_wp, 10.0_wp, lower_open=.true.), &
      row("c", kind_real, "", "", "friction of Coulomb: dependence on the triaxiality", 0.0_wp), &
      row("n", kind_real, "", "0.1", "exponent of the transformation to strains", 0.0_wp, 1.0_wp, &
          lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("a", 1.3_wp), law_value_t("b", 0.8_wp), law_value_t("c", 0.05_wp), &
      law_value_t("n", 0.1_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(hosford_coulomb_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%a = value_of(values, "a")
    self%b = value_of(values, "b")
    self%c = value_of(values, "c")
    self%n = value_of(values, "n", 0.1_wp)
  end subroutine set

  !> Return the strain to fracture.
  pure real(wp) function strain(self, triaxiality, lode)
    class(hosford_coulomb_t), intent(in) :: self
    real(wp), intent(in) :: triaxiality, lode

    real(wp), parameter :: sixth = acos(-1.0_wp)/6.0_wp
    !> Stress below which there is no fracture.
    real(wp), parameter :: least = 1.0e-3_wp
    real(wp) :: f(3), hosford, stress

    f = 2.0_wp/3.0_wp*[cos(sixth*(1 - lode)), cos(sixth*(3 + lode)), -cos(sixth*(1 + lode))]
    hosford = (0.5_wp*(max(0.0_wp, f(1) - f(2))**self%a + max(0.0_wp, f(2) - f(3))**self%a &
        + (f(1) - f(3))**self%a))**(1/self%a)
    stress = (hosford + self%c*(2*triaxiality + f(1) + f(3)))/(1 + self%c)
    strain = huge(1.0_wp)
    if (stress > least) strain = self%b*exp(-log(stress)/self%n)
  end function strain

end module dd3_material_fracture_hosford_coulomb
