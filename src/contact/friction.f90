! SPDX-License-Identifier: GPL-3.0-or-later
!> Coulomb's friction with a coefficient that depends on the contact pressure, on the speed of
!> sliding and on the plastic strain of the sheet:
!>     mu = mu_0 f_1 f_2 ...,    p = N/A,  v = v_c + w/dt
!> with the normal force N of a point, its area A and the length w of its slip in the time dt. What
!> a contact law needs is the limit of the tangential force, Y = mu N, and its slopes
!>     dY/dN = mu (1 + sum of p f_i'/f_i),    dY/dw = mu N/dt (sum of f_i'/f_i),
!> the sums over the factors of the pressure and over those of the speed. The factors are
!>     power       f = (p/p_0)^(n-1), p_min <= p <= p_max,
!>     stribeck    f = r + (1 - r) exp(-(v/v_0)^n),
!>     tables      straight between points, constant beyond the first and the last.
!> Source: Filzek, Ludwig and Groche, Proc. IDDRG (2011), power law; Armstrong-Helouvry, Dupont and
!> Canudas de Wit, Automatica 30 (1994) 1083-1138, the exponential curve after Stribeck.
module dd3_contact_friction
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : kind_real, kind_text, law_value_t, pair_name, row
  use dd3_base_text, only : same_name, to_text
  use dd3_material_description, only : add_problem, check_table, description_t, problem_t, value_of
  implicit none
  private
  public :: friction_t, friction_limit_t, sliding_t, coulomb
  public :: friction_laws, check_friction_law

  !> What a factor depends on.
  integer, parameter :: by_pressure = 1, by_speed = 2, by_strain = 3

  !> A factor on the coefficient of friction, and what it depends on, x: a pressure, MPa, a speed,
  !> mm/s, or a strain.
  type :: factor_t
    integer :: by = by_pressure
    !> Values of x beyond which the factor is constant.
    real(wp) :: least = 0.0_wp, largest = huge(1.0_wp)
    !> p_0 and n - 1 of the power law, v_0 and n of Stribeck's curve and its r.
    real(wp) :: reference = 1.0_wp, exponent = 0.0_wp, rest = 0.0_wp
    !> Points of a table, x and factor; not allocated for a formula.
    real(wp), allocatable :: place(:), value(:)
  end type factor_t

  !> Friction of a tool.
  type :: friction_t
    !> Coefficient, without the factors.
    real(wp) :: coefficient = 0.0_wp
    !> Not allocated for a constant coefficient.
    type(factor_t), allocatable :: factor(:)
  contains
    procedure :: add_law
    procedure :: varies
    procedure :: needs_time
    procedure :: largest_coefficient
    procedure :: limit
    procedure :: numbers
  end type friction_t

  !> What friction depends on at a point beside its normal force and its slip.
  type :: sliding_t
    !> mm2.
    real(wp) :: area = 1.0_wp
    !> Speed v_c without slip, mm/s, and speed per slip 1/dt, 1/s.
    real(wp) :: speed = 0.0_wp, per_slip = 0.0_wp
    !> Equivalent plastic strain of the sheet.
    real(wp) :: strain = 0.0_wp
  end type sliding_t

  !> Limit of the tangential force, N, its derivative in the normal force and that in the length of
  !> the slip, N/mm.
  type :: friction_limit_t
    real(wp) :: value = 0.0_wp, slope = 0.0_wp, by_slip = 0.0_wp
  end type friction_limit_t

contains

  !> Return the friction with a constant coefficient.
  pure type(friction_t) function coulomb(coefficient)
    real(wp), intent(in) :: coefficient

    coulomb%coefficient = coefficient
  end function coulomb

  !> Return the laws of friction.
  function friction_laws() result(law)
    type(description_t), allocatable :: law(:)

    allocate (law(5))
    law(1)%name = "power"
    law(1)%title = "power of the contact pressure: factor (p/p0)^(n-1)"
    law(1)%source = "Filzek, Ludwig, Groche, IDDRG 2011"
    allocate (law(1)%rows, source=[ &
      row("p0", kind_real, "MPa", "", "pressure at which the coefficient is `friction`", 0.0_wp, &
          lower_open=.true.), &
      row("n", kind_real, "", "", "exponent of the friction stress; 1: constant coefficient", &
          0.0_wp, 2.0_wp, lower_open=.true.), &
      row("p_min", kind_real, "MPa", "", "pressure below which the coefficient is constant", &
          0.0_wp, lower_open=.true.), &
      row("p_max", kind_real, "MPa", "-", "pressure above which the coefficient is constant", &
          0.0_wp, lower_open=.true.)])
    law(2) = table_law("table", "pressure", "MPa")
    law(3)%name = "stribeck"
    law(3)%title = "Stribeck's curve over the speed: factor r + (1 - r) exp(-(v/v0)^n)"
    law(3)%source = "Armstrong-Helouvry et al. 1994"
    allocate (law(3)%rows, source=[ &
      row("v0", kind_real, "mm/s", "", "speed at which the decrease has reached 63 %", 0.0_wp, &
          lower_open=.true.), &
      row("r", kind_real, "", "", "factor at high speeds; it is 1 at rest", 0.0_wp, 1.0_wp, &
          lower_open=.true.), &
      row("n", kind_real, "", "1", "exponent", 1.0_wp)])
    law(4) = table_law("speed_table", "speed", "mm/s")
    law(5) = table_law("strain_table", "equivalent plastic strain", "")
  end function friction_laws

  !> Describe a table.
  type(description_t) function table_law(name, what, unit) result(law)
    !> Name of the law, name and unit of what it depends on.
    character(len=*), intent(in) :: name, what, unit

    law%name = name
    law%title = "points of "//what//" and factor joined by straight lines"
    law%source = "-"
    allocate (law%rows, source=[ &
      row(pair_name, kind_real, unit, "-", "factor on `friction` at the "//what, 0.0_wp, &
          lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", "file with "//what//" and factor in each line, in place "// &
          "of the points; # begins a comment")])
  end function table_law

  !> Require what the bounds of the parameters do not: points that rise, and a friction stress
  !> that does not fall with the pressure.
  subroutine check_friction_law(name, values, problems)
    character(len=*), intent(in) :: name
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(out) :: problems(:)

    character(len=:), allocatable :: what
    real(wp), allocatable :: x(:), f(:)
    integer :: i

    allocate (problems(0))
    if (same_name(name, "power")) then
      if (value_of(values, "p_max", huge(1.0_wp)) <= value_of(values, "p_min")) then
        call add_problem(problems, 0, "p_max is not above p_min", "p_min < p_max")
      end if
    end if
    if (same_name(name, "power") .or. same_name(name, "stribeck")) return
    x = values%abscissa
    f = values%value
    what = "pressure"
    if (same_name(name, "speed_table")) what = "speed"
    if (same_name(name, "strain_table")) what = "plastic strain"
    call check_table(values, what, what//"s", trim(name)//" x1:f1 x2:f2 ...", problems)
    if (size(x) > 0) then
      if (x(1) < 0.0_wp) call add_problem(problems, 1, "the "//what//" is negative", &
          what//"s from 0 on")
    end if
    if (.not. same_name(name, "table")) return
    do i = 2, size(x)
      if (x(i) > x(i - 1) .and. f(i)*(x(i) - x(i - 1)) + x(i)*(f(i) - f(i - 1)) < 0.0_wp) then
        call add_problem(problems, i, "the friction stress f p falls before "//to_text(x(i))// &
            " MPa", "a factor that falls more slowly than 1/p")
      end if
    end do
  end subroutine check_friction_law

  !> Add a law, with values without errors.
  subroutine add_law(self, name, values)
    class(friction_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    type(law_value_t), intent(in) :: values(:)

    type(factor_t) :: factor

    if (same_name(name, "power")) then
      factor%reference = value_of(values, "p0")
      factor%exponent = value_of(values, "n") - 1.0_wp
      factor%least = value_of(values, "p_min")
      factor%largest = value_of(values, "p_max", huge(1.0_wp))
    else if (same_name(name, "stribeck")) then
      factor%by = by_speed
      factor%reference = value_of(values, "v0")
      factor%exponent = value_of(values, "n", 1.0_wp)
      factor%rest = value_of(values, "r")
    else
      if (same_name(name, "speed_table")) factor%by = by_speed
      if (same_name(name, "strain_table")) factor%by = by_strain
      factor%place = values%abscissa
      factor%value = values%value
      factor%least = factor%place(1)
      factor%largest = factor%place(size(values))
    end if
    if (.not. allocated(self%factor)) allocate (self%factor(0))
    self%factor = [self%factor, factor]
  end subroutine add_law

  !> Whether the coefficient is not constant.
  pure logical function varies(self)
    class(friction_t), intent(in) :: self

    varies = allocated(self%factor)
  end function varies

  !> Return the largest coefficient, at pressures up to 1000 MPa.
  pure real(wp) function largest_coefficient(self) result(largest)
    class(friction_t), intent(in) :: self

    real(wp), parameter :: high_pressure = 1000.0_wp
    real(wp) :: factor(2), slope
    integer :: i

    largest = self%coefficient
    if (.not. allocated(self%factor)) return
    do i = 1, size(self%factor)
      associate (law => self%factor(i))
        if (allocated(law%value)) then
          largest = largest*maxval(law%value)
        else
          call evaluate(law, law%least, factor(1), slope)
          call evaluate(law, high_pressure, factor(2), slope)
          largest = largest*maxval(factor)
        end if
      end associate
    end do
  end function largest_coefficient

  !> Whether the coefficient depends on the speed.
  pure logical function needs_time(self)
    class(friction_t), intent(in) :: self

    needs_time = .false.
    if (allocated(self%factor)) needs_time = any(self%factor%by == by_speed)
  end function needs_time

  !> Kernel: return the limit of the tangential force at a point.
  pure type(friction_limit_t) function limit(self, normal_force, sliding, slip)
    class(friction_t), intent(in) :: self
    !> Positive in compression, N.
    real(wp), intent(in) :: normal_force
    type(sliding_t), intent(in) :: sliding
    !> Length of the tangential slip, mm.
    real(wp), intent(in) :: slip

    real(wp) :: mu, factor, slope, x(3), sums(3)
    integer :: i

    limit%value = self%coefficient*normal_force
    limit%slope = self%coefficient
    if (.not. allocated(self%factor)) return
    x(by_pressure) = normal_force/sliding%area
    x(by_speed) = sliding%speed + sliding%per_slip*slip
    x(by_strain) = sliding%strain
    mu = self%coefficient
    sums = 0.0_wp
    do i = 1, size(self%factor)
      associate (by => self%factor(i)%by)
        call evaluate(self%factor(i), x(by), factor, slope)
        mu = mu*factor
        sums(by) = sums(by) + slope/factor
      end associate
    end do
    limit%value = mu*normal_force
    limit%slope = mu*(1.0_wp + x(by_pressure)*sums(by_pressure))
    limit%by_slip = mu*normal_force*sliding%per_slip*sums(by_speed)
  end function limit

  !> Kernel: evaluate a factor and its derivative.
  pure subroutine evaluate(self, place, factor, slope)
    type(factor_t), intent(in) :: self
    !> MPa, mm/s or a strain.
    real(wp), intent(in) :: place
    real(wp), intent(out) :: factor, slope

    real(wp) :: x, falling
    integer :: i

    x = min(max(place, self%least), self%largest)
    if (allocated(self%place)) then
      i = min(count(self%place <= x), size(self%place) - 1)
      slope = (self%value(i + 1) - self%value(i))/(self%place(i + 1) - self%place(i))
      factor = self%value(i) + slope*(x - self%place(i))
    else if (self%by == by_pressure) then
      factor = (x/self%reference)**self%exponent
      slope = self%exponent*factor/x
    else
      falling = (1.0_wp - self%rest)*exp(-(x/self%reference)**self%exponent)
      factor = self%rest + falling
      slope = -falling*self%exponent/self%reference &
          *(x/self%reference)**(self%exponent - 1.0_wp)
    end if
    if (.not. (x >= place .and. x <= place)) slope = 0.0_wp
  end subroutine evaluate

  !> Return all that defines the friction, for check sums.
  pure function numbers(self)
    class(friction_t), intent(in) :: self
    real(wp), allocatable :: numbers(:)

    integer :: i

    numbers = [self%coefficient]
    if (.not. allocated(self%factor)) return
    do i = 1, size(self%factor)
      associate (factor => self%factor(i))
        numbers = [numbers, real(factor%by, wp), factor%least, factor%largest, factor%reference, &
            factor%exponent, factor%rest]
        if (allocated(factor%place)) numbers = [numbers, factor%place, factor%value]
      end associate
    end do
  end function numbers

end module dd3_contact_friction
