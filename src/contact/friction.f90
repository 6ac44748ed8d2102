! SPDX-License-Identifier: GPL-3.0-or-later
!> Coulomb's friction with a coefficient that depends on the contact pressure:
!>     mu = mu_0 f_1(p) f_2(p) ...,    p = N/A
!> with the normal force N of a point and its area A. What a contact law needs is the limit of the
!> tangential force, Y(N) = mu N, and its slope
!>     dY/dN = mu (1 + e_1 + e_2 + ...),    e_i = p f_i'/f_i.
!> The factors are
!>     power    f = (p/p_0)^(n-1), p_min <= p <= p_max,
!>     table    straight between points p:f,
!> constant beyond the least and the largest pressure.
!> Source: Filzek, Ludwig and Groche, Proc. IDDRG (2011), power law.
module dd3_contact_friction
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : kind_real, kind_text, law_value_t, pair_name, row
  use dd3_base_text, only : same_name, to_text
  use dd3_material_description, only : add_problem, description_t, problem_t, value_of
  implicit none
  private
  public :: friction_t, friction_limit_t, sliding_t, coulomb
  public :: friction_laws, check_friction_law

  !> A factor on the coefficient of friction.
  type :: factor_t
    !> Pressures beyond which the factor is constant, MPa.
    real(wp) :: least = 0.0_wp, largest = huge(1.0_wp)
    !> Reference pressure p_0, MPa, and exponent n - 1 of the power law.
    real(wp) :: reference = 1.0_wp, exponent = 0.0_wp
    !> Points of a table, MPa and factor; not allocated for a power law.
    real(wp), allocatable :: pressure(:), value(:)
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
    procedure :: limit
    procedure :: numbers
  end type friction_t

  !> What friction depends on at a point beside its normal force.
  type :: sliding_t
    !> mm2.
    real(wp) :: area = 1.0_wp
  end type sliding_t

  !> Limit of the tangential force, N, and its derivative in the normal force.
  type :: friction_limit_t
    real(wp) :: value = 0.0_wp, slope = 0.0_wp
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

    allocate (law(2))
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
    law(2)%name = "table"
    law(2)%title = "points p:f of pressure and factor joined by straight lines"
    law(2)%source = "-"
    allocate (law(2)%rows, source=[ &
      row(pair_name, kind_real, "MPa", "-", "factor f on `friction` at the pressure p, MPa", &
          0.0_wp, lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", &
          "file with p and f in each line, in place of the points; # begins a comment")])
  end function friction_laws

  !> Require what the bounds of the parameters do not: pressures that rise, and a friction stress
  !> that does not fall with the pressure.
  subroutine check_friction_law(name, values, problems)
    character(len=*), intent(in) :: name
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(out) :: problems(:)

    real(wp), allocatable :: p(:), f(:)
    integer :: i

    allocate (problems(0))
    if (same_name(name, "power")) then
      if (value_of(values, "p_max", huge(1.0_wp)) <= value_of(values, "p_min")) then
        call add_problem(problems, 0, "p_max is not above p_min", "p_min < p_max")
      end if
      return
    end if
    p = values%abscissa
    f = values%value
    if (size(p) < 2) then
      call add_problem(problems, 0, "a table needs two points at least", "table p1:f1 p2:f2 ...")
      return
    end if
    if (p(1) < 0.0_wp) call add_problem(problems, 1, "the pressure is negative", &
        "pressures from 0 on")
    do i = 2, size(p)
      if (.not. p(i) > p(i - 1)) then
        call add_problem(problems, i, "the pressure "//to_text(p(i))// &
            " is not larger than the one before", "pressures that rise")
      else if (f(i) + p(i)*(f(i) - f(i - 1))/(p(i) - p(i - 1)) < 0.0_wp) then
        call add_problem(problems, i, "the friction stress f p falls before "//to_text(p(i))// &
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
    else
      factor%pressure = values%abscissa
      factor%value = values%value
      factor%least = factor%pressure(1)
      factor%largest = factor%pressure(size(values))
    end if
    if (.not. allocated(self%factor)) allocate (self%factor(0))
    self%factor = [self%factor, factor]
  end subroutine add_law

  !> Whether the coefficient is not constant.
  pure logical function varies(self)
    class(friction_t), intent(in) :: self

    varies = allocated(self%factor)
  end function varies

  !> Kernel: return the limit of the tangential force at a point.
  pure type(friction_limit_t) function limit(self, normal_force, sliding)
    class(friction_t), intent(in) :: self
    !> Positive in compression, N.
    real(wp), intent(in) :: normal_force
    type(sliding_t), intent(in) :: sliding

    real(wp) :: mu, factor, elasticity, one
    integer :: i

    mu = self%coefficient
    one = 1.0_wp
    if (allocated(self%factor)) then
      do i = 1, size(self%factor)
        call evaluate(self%factor(i), normal_force/sliding%area, factor, elasticity)
        mu = mu*factor
        one = one + elasticity
      end do
    end if
    limit%value = mu*normal_force
    limit%slope = mu*one
  end function limit

  !> Kernel: evaluate a factor and its elasticity p f'/f.
  pure subroutine evaluate(self, pressure, factor, elasticity)
    type(factor_t), intent(in) :: self
    !> MPa.
    real(wp), intent(in) :: pressure
    real(wp), intent(out) :: factor, elasticity

    real(wp) :: p, slope
    integer :: i

    p = min(max(pressure, self%least), self%largest)
    elasticity = 0.0_wp
    if (.not. allocated(self%pressure)) then
      factor = (p/self%reference)**self%exponent
      if (p >= pressure .and. p <= pressure) elasticity = self%exponent
      return
    end if
    i = min(count(self%pressure <= p), size(self%pressure) - 1)
    slope = (self%value(i + 1) - self%value(i))/(self%pressure(i + 1) - self%pressure(i))
    factor = self%value(i) + slope*(p - self%pressure(i))
    if (p >= pressure .and. p <= pressure) elasticity = p*slope/factor
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
        numbers = [numbers, factor%least, factor%largest, factor%reference, factor%exponent]
        if (allocated(factor%pressure)) numbers = [numbers, factor%pressure, factor%value]
      end associate
    end do
  end function numbers

end module dd3_contact_friction
