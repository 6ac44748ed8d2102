! SPDX-License-Identifier: GPL-3.0-or-later
!> Limits of a material that have no influence on its stress: the damage of a law of fracture, and
!> the equivalent plastic strain over that of the forming limit curve.
!>
!> The damage grows by dD/dp = n D^(1-1/n)/p_f, with the strain to fracture p_f of the stress at the
!> end of the increment, so that D^(1/n) grows by dp/p_f.
!>
!> The forming limit curve, of proportional paths, is independent of the path in terms of the
!> equivalent plastic strain p and of the direction of plastic flow: the limit in the direction of
!> the ratio beta of the rates of minor and major strain is p_f = e_1(beta)/(de_1/dp), with the
!> major strain e_1 of the curve, and de_1/dp of the present flow.
!> Source: Neukamm, Feucht and Haufe, Proc. 7th European LS-DYNA Conf. (2009), damage; Zeng,
!> Chappuis, Xia and Zhu, SAE 2008-01-1445, and Stoughton and Yoon, Int. J. Solids Struct. 49 (2012)
!> 3616-3625, forming limits.
module dd3_material_limits
  use dd3_base_kinds, only : wp
  use dd3_material_fracture_law, only : fracture_t
  implicit none
  private
  public :: forming_limit_t, damage_after, stress_state

  !> Forming limit curve: minor and major logarithmic strain of its points, the minor one
  !> increasing. Beyond the points the end lines go on.
  type :: forming_limit_t
    real(wp), allocatable :: minor(:), major(:)
  contains
    procedure :: major_strain
    procedure :: ratio
  end type forming_limit_t

contains

  !> Return the damage at the end of a plastic increment.
  pure real(wp) function damage_after(fracture, start, increment, stress)
    class(fracture_t), intent(in) :: fracture
    !> Damage at the start.
    real(wp), intent(in) :: start
    !> Of the equivalent plastic strain.
    real(wp), intent(in) :: increment
    !> At the end, Kelvin, MPa.
    real(wp), intent(in) :: stress(6)

    real(wp) :: triaxiality, lode

    call stress_state(stress, triaxiality, lode)
    damage_after = (start**(1/fracture%exponent) &
        + increment/fracture%strain(triaxiality, lode))**fracture%exponent
  end function damage_after

  !> Evaluate the triaxiality and the normalised Lode angle of a stress.
  pure subroutine stress_state(stress, triaxiality, lode)
    !> Kelvin, MPa.
    real(wp), intent(in) :: stress(6)
    real(wp), intent(out) :: triaxiality, lode

    real(wp), parameter :: half_pi = acos(-1.0_wp)/2.0_wp
    real(wp) :: mean, s(6), equivalent, determinant

    mean = sum(stress(:3))/3.0_wp
    s = stress
    s(:3) = s(:3) - mean
    equivalent = sqrt(1.5_wp*dot_product(s, s))
    triaxiality = 0.0_wp
    lode = 0.0_wp
    if (.not. equivalent > 0.0_wp) return
    triaxiality = mean/equivalent
    s = s/equivalent
    ! The shears of a Kelvin vector are sqrt(2) times those of the tensor.
    determinant = s(1)*s(2)*s(3) + s(4)*s(5)*s(6)/sqrt(2.0_wp) &
        - 0.5_wp*(s(1)*s(4)**2 + s(2)*s(5)**2 + s(3)*s(6)**2)
    lode = 1.0_wp - acos(max(-1.0_wp, min(1.0_wp, 13.5_wp*determinant)))/half_pi
  end subroutine stress_state

  !> Return the equivalent plastic strain over that of the limit in the direction of plastic flow; 0
  !> where the sheet does not thin.
  pure real(wp) function ratio(self, plastic_strain, flow)
    class(forming_limit_t), intent(in) :: self
    real(wp), intent(in) :: plastic_strain
    !> Rate of the plastic strain over that of the equivalent one, Kelvin, the third axis normal to
    !> the sheet.
    real(wp), intent(in) :: flow(6)

    real(wp) :: mean, radius, limit

    ratio = 0.0_wp
    mean = 0.5_wp*(flow(1) + flow(2))
    radius = sqrt((0.5_wp*(flow(1) - flow(2)))**2 + 0.5_wp*flow(6)**2)
    if (.not. mean > 0.0_wp) return
    limit = self%major_strain((mean - radius)/(mean + radius))
    if (limit < huge(1.0_wp)) ratio = plastic_strain*(mean + radius)/limit
  end function ratio

  !> Return the major strain at which the path of a ratio of minor and major strain meets the curve;
  !> huge if it does not.
  pure real(wp) function major_strain(self, beta)
    class(forming_limit_t), intent(in) :: self
    real(wp), intent(in) :: beta

    real(wp) :: slope
    integer :: i

    associate (x => self%minor, y => self%major)
      i = min(max(count(x <= beta*y), 1), size(x) - 1)
      slope = (y(i + 1) - y(i))/(x(i + 1) - x(i))
      major_strain = huge(1.0_wp)
      if (slope*beta < 1.0_wp) major_strain = (y(i) - slope*x(i))/(1.0_wp - slope*beta)
      if (.not. major_strain > 0.0_wp) major_strain = huge(1.0_wp)
    end associate
  end function major_strain

end module dd3_material_limits
