! SPDX-License-Identifier: GPL-3.0-or-later
!> The flow stress as a table over the equivalent plastic strain, interpolated by a monotone cubic
!> (F. N. Fritsch, R. E. Carlson, 1980, region 3). Beyond the last pair the curve is straight, with
!> the slope given or that of the cubic at its end.
module dd3_material_hardening_table
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real, kind_text, pair_name
  use dd3_base_text, only : to_text
  use dd3_material_description, only : description_t, problem_t, add_problem, &
      check_strains, is_given, value_of
  use dd3_material_hardening_isotropic, only : isotropic_hardening_t
  implicit none
  private
  public :: table_t

  type, extends(isotropic_hardening_t) :: table_t
    private
    !> Plastic strains, flow stresses (MPa) and slopes (MPa) of the pairs.
    real(wp), allocatable :: strain(:), stress(:), slope(:)
    !> Slope beyond the last pair, MPa.
    real(wp) :: end_slope = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: hardening_curve
  end type table_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "table"
    description%title = "points p:Y joined by a monotone cubic, straight beyond the last"
    description%source = "F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238-246"
    allocate (description%rows, source=[ &
      row(pair_name, kind_real, "MPa", "-", &
          "flow stress Y at the plastic strain p, two points or more: 0:160 0.05:280 ...", &
          0.0_wp, lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", &
          "file with p and Y in each line, in place of the points; # begins a comment"), &
      row("slope", kind_real, "MPa", "-", &
          "slope beyond the last point; left out: that of the curve there; 0: constant", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t(pair_name, 160.0_wp, 0.0_wp), law_value_t(pair_name, 230.0_wp, 0.02_wp), &
      law_value_t(pair_name, 300.0_wp, 0.08_wp), law_value_t(pair_name, 370.0_wp, 0.2_wp), &
      law_value_t(pair_name, 430.0_wp, 0.4_wp), law_value_t(pair_name, 500.0_wp, 0.8_wp)])
  end subroutine describe

  !> Require plastic strains as in any table, and flow stresses that do not decrease.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    real(wp), allocatable :: stress(:)
    integer, allocatable :: place(:)
    integer :: i

    if (size(problems) > 0) return
    call check_strains(values, "0:Y, the initial flow stress", "0:Y1 p2:Y2 ...", problems)
    place = pack([(i, i=1, size(values))], values%name == pair_name)
    stress = values(place)%value
    do i = 2, size(stress)
      if (stress(i) < stress(i - 1)) call add_problem(problems, place(i), &
          "the flow stress falls to "//to_text(stress(i)), "flow stresses that do not fall")
    end do
  end subroutine check

  subroutine set(self, values)
    class(table_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    integer :: i

    self%strain = pack(values%abscissa, values%name == pair_name)
    self%stress = pack(values%value, values%name == pair_name)
    self%slope = [(0.0_wp, i=1, size(self%strain))]
    call choose_slopes(size(self%strain), self%strain, self%stress, self%slope)
    self%end_slope = self%slope(size(self%slope))
    if (is_given(values, "slope")) self%end_slope = value_of(values, "slope")
  end subroutine set

  !> Choose the slopes at the pairs: the mean of the two secants, reduced where the cubic would not
  !> be monotone.
  pure subroutine choose_slopes(n, x, y, slope)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n), y(n)
    real(wp), intent(out) :: slope(n)

    real(wp) :: secant(n - 1), length
    integer :: i

    secant = (y(2:) - y(:n - 1))/(x(2:) - x(:n - 1))
    slope(1) = secant(1)
    slope(n) = secant(n - 1)
    do i = 2, n - 1
      slope(i) = 0.5_wp*(secant(i - 1) + secant(i))
    end do
    do i = 1, n - 1
      if (secant(i) > 0.0_wp) then
        length = norm2(slope(i:i + 1))/secant(i)
        if (length > 3.0_wp) slope(i:i + 1) = slope(i:i + 1)*(3/length)
      else
        slope(i:i + 1) = 0.0_wp
      end if
    end do
  end subroutine choose_slopes

  !> Evaluate the hardening curve.
  pure subroutine hardening_curve(self, strain, stress, slope)
    class(table_t), intent(in) :: self
    real(wp), intent(in) :: strain
    real(wp), intent(out) :: stress, slope

    integer :: n

    n = size(self%strain)
    if (strain >= self%strain(n)) then
      stress = self%stress(n) + self%end_slope*(strain - self%strain(n))
      slope = self%end_slope
    else
      n = interval(self%strain, strain)
      call cubic(strain, self%strain(n:n + 1), self%stress(n:n + 1), self%slope(n:n + 1), &
          stress, slope)
    end if
  end subroutine hardening_curve

  !> Return the interval that holds a strain, by bisection; the first if the strain is below x(1).
  pure integer function interval(x, strain)
    !> Increasing strains.
    real(wp), intent(in) :: x(:)
    !> The strain, below the last of them.
    real(wp), intent(in) :: strain

    integer :: above, middle

    interval = 1
    above = size(x)
    do while (above - interval > 1)
      middle = (interval + above)/2
      if (x(middle) <= strain) then
        interval = middle
      else
        above = middle
      end if
    end do
  end function interval

  !> Evaluate Hermite's cubic and its slope at x.
  pure subroutine cubic(x, x_end, y_end, slope_end, value, slope)
    real(wp), intent(in) :: x
    !> Abscissae, values and slopes of the two ends.
    real(wp), intent(in) :: x_end(2), y_end(2), slope_end(2)
    real(wp), intent(out) :: value, slope

    real(wp) :: h, t, rise, bend

    h = x_end(2) - x_end(1)
    t = (x - x_end(1))/h
    rise = (y_end(2) - y_end(1))/h
    bend = slope_end(1) + slope_end(2) - 2*rise
    value = y_end(1) + h*t*(slope_end(1) + t*(rise - slope_end(1) + (t - 1)*bend))
    slope = slope_end(1) + t*(2*(rise - slope_end(1)) + (3*t - 2)*bend)
  end subroutine cubic

end module dd3_material_hardening_table
