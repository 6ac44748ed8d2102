! SPDX-License-Identifier: GPL-3.0-or-later
!> Flow curves measured at several rates. The hardening law is that of the lowest rate, r1, and the
!> factor is the flow stress at the rate over that of the first curve: straight over the logarithm
!> of the rate between the curves, and over the plastic strain between the points of a curve;
!> constant beyond the first and the last of both.
module dd3_material_rate_curves
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real, kind_text, pair_name, parameter_t
  use dd3_base_text, only : to_text
  use dd3_material_description, only : add_problem, description_t, problem_t
  use dd3_material_rate_law, only : rate_t
  use dd3_material_straight, only : straight
  implicit none
  private
  public :: curves_t

  !> Largest number of curves.
  integer, parameter :: most = 8

  !> Points of a curve, MPa.
  type :: curve_t
    real(wp), allocatable :: strain(:), stress(:)
  end type curve_t

  type, extends(rate_t) :: curves_t
    private
    type(curve_t), allocatable :: curve(:)
    !> Logarithms of the rates of the curves.
    real(wp), allocatable :: logarithm(:)
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: factor
    procedure :: factor_at
  end type curves_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    type(parameter_t) :: rates(most)
    integer :: k

    description%name = "curves"
    description%title = "flow curves at several rates, over the first of them"
    description%source = "-"
    do k = 1, most
      rates(k) = row("r"//to_text(k), kind_real, "1/s", merge(" ", "-", k <= 2), &
          "rate of curve "//to_text(k), 0.0_wp, lower_open=.true.)
    end do
    allocate (description%rows, source=[rates, &
      row(pair_name, kind_real, "MPa", "-", "flow stress Y at the plastic strain p of the "// &
          "curves, one after the other; each begins at p = 0: 0:160 0.1:280 0:180 0.1:290", &
          0.0_wp, lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", &
          "file with p and Y in each line, in place of the points; # begins a comment")])
    description%example = [law_value_t("r1", 1.0e-3_wp), law_value_t("r2", 1.0_wp), &
        law_value_t("r3", 100.0_wp), &
        points([0.0_wp, 0.1_wp, 0.4_wp], [160.0_wp, 310.0_wp, 445.0_wp]), &
        points([0.0_wp, 0.1_wp, 0.4_wp], [185.0_wp, 325.0_wp, 465.0_wp]), &
        points([0.0_wp, 0.1_wp, 0.3_wp, 0.4_wp], [210.0_wp, 350.0_wp, 440.0_wp, 490.0_wp])]
  end subroutine describe

  !> Return points as values of the law.
  pure function points(strain, stress) result(values)
    real(wp), intent(in) :: strain(:), stress(:)
    type(law_value_t) :: values(size(strain))

    values%name = pair_name
    values%abscissa = strain
    values%value = stress
  end function points

  !> Require a rate for each curve, rates that rise, curves that begin at zero, and flow stresses
  !> that do not fall with the rate.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    type(curve_t), allocatable :: curve(:)
    real(wp), allocatable :: rate(:), strain(:)
    integer :: k, i

    if (size(problems) > 0) return
    call check_points(values, problems)
    if (size(problems) > 0) return
    call collect(values, curve, rate)
    if (size(curve) /= size(rate)) then
      call add_problem(problems, 0, to_text(size(curve))//" curves that begin at p = 0 and "// &
          to_text(size(rate))//" rates", "r1= r2= ... of the curves, 0:Y1 p2:Y2 ... of each")
      return
    end if
    do k = 2, size(rate)
      if (.not. rate(k) > rate(k - 1)) call add_problem(problems, k, "the rate "// &
          to_text(rate(k))//" is not larger than the one before", "rates that rise")
      strain = [curve(k)%strain, curve(k - 1)%strain]
      do i = 1, size(strain)
        if (stress_at(curve(k), strain(i)) >= stress_at(curve(k - 1), strain(i))) cycle
        call add_problem(problems, k, "at the plastic strain "//to_text(strain(i))// &
            " the flow stress falls with the rate", "curves that do not cross")
        exit
      end do
    end do
  end subroutine check

  !> Require plastic strains that begin at zero, and rise or begin again.
  subroutine check_points(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    real(wp) :: last
    integer :: i

    last = -1.0_wp
    do i = 1, size(values)
      if (values(i)%name /= pair_name) cycle
      associate (strain => values(i)%abscissa)
        if (strain < 0.0_wp .or. (strain > 0.0_wp .and. .not. (last >= 0.0_wp &
            .and. strain > last))) call add_problem(problems, i, "the plastic strain is "// &
            to_text(strain), "plastic strains from 0 on that rise, or the 0 of the next curve")
        last = strain
      end associate
    end do
  end subroutine check_points

  !> Collect the curves and their rates.
  pure subroutine collect(values, curve, rate)
    type(law_value_t), intent(in) :: values(:)
    type(curve_t), allocatable, intent(out) :: curve(:)
    real(wp), allocatable, intent(out) :: rate(:)

    type(law_value_t), allocatable :: pair(:)
    integer, allocatable :: first(:)
    integer :: i

    pair = pack(values, values%name == pair_name)
    rate = pack(values%value, values%name /= pair_name)
    first = [pack([(i, i=1, size(pair))], .not. pair%abscissa > 0.0_wp), size(pair) + 1]
    allocate (curve(size(first) - 1))
    do i = 1, size(curve)
      associate (part => pair(first(i):first(i + 1) - 1))
        curve(i)%strain = part%abscissa
        curve(i)%stress = part%value
      end associate
    end do
  end subroutine collect

  subroutine set(self, values)
    class(curves_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    real(wp), allocatable :: rate(:)

    call collect(values, self%curve, rate)
    self%logarithm = log(rate)
  end subroutine set

  !> Return the flow stress of a curve, MPa.
  pure real(wp) function stress_at(curve, strain)
    type(curve_t), intent(in) :: curve
    real(wp), intent(in) :: strain

    real(wp) :: slope

    call straight(curve%strain, curve%stress, strain, stress_at, slope)
  end function stress_at

  !> Evaluate the factor at the first plastic strain.
  pure subroutine factor(self, rate, value, slope)
    class(curves_t), intent(in) :: self
    real(wp), intent(in) :: rate
    real(wp), intent(out) :: value, slope

    real(wp) :: by_strain

    call self%factor_at(0.0_wp, rate, value, slope, by_strain)
  end subroutine factor

  !> Evaluate the factor and its derivatives in the rate and in the plastic strain.
  pure subroutine factor_at(self, strain, rate, value, slope, by_strain)
    class(curves_t), intent(in) :: self
    real(wp), intent(in) :: strain, rate
    real(wp), intent(out) :: value, slope, by_strain

    real(wp) :: place, weight, base, base_slope, stress(2), stress_slope(2)
    integer :: k, i

    value = 1.0_wp
    slope = 0.0_wp
    by_strain = 0.0_wp
    place = self%logarithm(1)
    if (rate > 0.0_wp) place = log(rate)
    k = min(count(self%logarithm <= place), size(self%curve) - 1)
    if (k == 0) return
    associate (width => self%logarithm(k + 1) - self%logarithm(k))
      weight = min((place - self%logarithm(k))/width, 1.0_wp)
      call straight(self%curve(1)%strain, self%curve(1)%stress, strain, base, base_slope)
      do i = 1, 2
        call straight(self%curve(k + i - 1)%strain, self%curve(k + i - 1)%stress, strain, &
            stress(i), stress_slope(i))
      end do
      value = ((1 - weight)*stress(1) + weight*stress(2))/base
      by_strain = ((1 - weight)*stress_slope(1) + weight*stress_slope(2))/base &
          - value*base_slope/base
      if (weight < 1.0_wp .and. rate > 0.0_wp) slope = (stress(2) - stress(1))/(base*width*rate)
    end associate
  end subroutine factor_at

end module dd3_material_rate_curves
