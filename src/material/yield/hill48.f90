! SPDX-License-Identifier: GPL-3.0-or-later
!> The quadratic criterion of orthotropic sheets, R. Hill (1948), in the axes 1 rolling, 2
!> transverse, 3 normal:
!>
!>     sb^2 = F (T22-T33)^2 + G (T33-T11)^2 + H (T11-T22)^2 + 2 L T23^2 + 2 M T31^2 + 2 N T12^2
!>
!> that is, sb = sqrt(v.P v) with a constant matrix P, V = P v / sb and H = (P - V V^T) / sb.
module dd3_material_yield_hill48
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_base_text, only : to_text
  use dd3_material_description, only : description_t, problem_t, add_problem, is_given, &
      position_of, value_of
  use dd3_material_flow, only : flow_direction_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  implicit none
  private
  public :: hill48_t

  type, extends(yield_criterion_t) :: hill48_t
    private
    !> The matrix P.
    real(wp) :: p(6, 6) = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: value
    procedure :: gradient
    procedure :: second_derivative
  end type hill48_t

  !> Coefficients of the equation.
  type :: coefficients_t
    real(wp) :: f, g, h, l, m, n
  end type coefficients_t

  !> Names of the parameters of either form.
  character(len=3), parameter :: letters(6) = ["F  ", "G  ", "H  ", "L  ", "M  ", "N  "]
  character(len=3), parameter :: ratios(3) = ["r0 ", "r45", "r90"]

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "hill48"
    description%title = "orthotropic, quadratic; by F G H L M N or by r0 r45 r90"
    description%source = "R. Hill, Proc. R. Soc. London A 193 (1948) 281-297"
    allocate (description%rows, source=[ &
      row("F", kind_real, "", "-", "factor of (T22-T33)^2; with G H and N in place of r-values"), &
      row("G", kind_real, "", "-", "factor of (T33-T11)^2"), &
      row("H", kind_real, "", "-", "factor of (T11-T22)^2"), &
      row("L", kind_real, "", "-", "half the factor of T23^2; N where left out", 0.0_wp, &
          lower_open=.true.), &
      row("M", kind_real, "", "-", "half the factor of T31^2; N where left out", 0.0_wp, &
          lower_open=.true.), &
      row("N", kind_real, "", "-", "half the factor of T12^2; 1.5 where left out", 0.0_wp, &
          lower_open=.true.), &
      row("r0", kind_real, "", "-", "r-value along the rolling direction; G+H = 1, L = M = N", &
          0.0_wp, lower_open=.true.), &
      row("r45", kind_real, "", "-", "r-value at 45 degrees", 0.0_wp), &
      row("r90", kind_real, "", "-", "r-value along the transverse direction", 0.0_wp, &
          lower_open=.true.)])
    allocate (description%example, source=[ &
      law_value_t("F", 0.5_wp), law_value_t("G", 0.5_wp), law_value_t("H", 0.5_wp), &
      law_value_t("L", 1.5_wp), law_value_t("M", 1.5_wp), law_value_t("N", 1.5_wp)])
  end subroutine describe

  !> Require one complete form, and a closed convex surface.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    type(coefficients_t) :: c
    logical :: by_letters, by_ratios
    integer :: i

    by_letters = any([(is_given(values, letters(i)), i=1, 6)])
    by_ratios = any([(is_given(values, ratios(i)), i=1, 3)])
    if (by_letters .and. by_ratios) then
      do i = 1, 3
        if (is_given(values, ratios(i))) then
          call add_problem(problems, position_of(values, ratios(i)), &
              trim(ratios(i))//" given together with F G H L M N", &
              "either F G H [L M N] or r0 r45 r90")
        end if
      end do
    else if (by_ratios) then
      call check_all_given(values, ratios, problems)
    else
      call check_all_given(values, letters(1:3), problems)
    end if
    if (size(problems) > 0) return
    c = coefficients(values)
    if (.not. (c%f + c%g > 0 .and. c%f*c%g + c%g*c%h + c%h*c%f > 0)) then
      call add_problem(problems, 0, "the surface is not closed: FG + GH + HF = "// &
          to_text(c%f*c%g + c%g*c%h + c%h*c%f)//", F + G = "//to_text(c%f + c%g), "both positive")
    end if
  end subroutine check

  !> Add a problem for each of the names that is not given.
  subroutine check_all_given(values, names, problems)
    type(law_value_t), intent(in) :: values(:)
    character(len=*), intent(in) :: names(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    integer :: i

    do i = 1, size(names)
      if (.not. is_given(values, names(i))) then
        call add_problem(problems, 0, trim(names(i))//" is missing", "F G H [L M N] or r0 r45 r90")
      end if
    end do
  end subroutine check_all_given

  !> Return the coefficients, given or from r-values with L = M = N and sb = T11 in tension along 1.
  pure type(coefficients_t) function coefficients(values) result(c)
    type(law_value_t), intent(in) :: values(:)

    real(wp) :: r0

    if (is_given(values, "r0")) then
      r0 = value_of(values, "r0")
      c%g = 1/(1 + r0)
      c%h = r0*c%g
      c%f = c%h/value_of(values, "r90")
      c%n = (c%f + c%g)*(value_of(values, "r45") + 0.5_wp)
      c%l = c%n
      c%m = c%n
    else
      c%f = value_of(values, "F")
      c%g = value_of(values, "G")
      c%h = value_of(values, "H")
      c%n = value_of(values, "N", 1.5_wp)
      c%l = value_of(values, "L", c%n)
      c%m = value_of(values, "M", c%n)
    end if
  end function coefficients

  subroutine set(self, values)
    class(hill48_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    type(coefficients_t) :: c

    self%always_convex = .true.
    c = coefficients(values)
    self%p = 0.0_wp
    self%p(1:3, 1) = [c%g + c%h, -c%h, -c%g]
    self%p(1:3, 2) = [-c%h, c%f + c%h, -c%f]
    self%p(1:3, 3) = [-c%g, -c%f, c%f + c%g]
    self%p(4, 4) = c%l
    self%p(5, 5) = c%m
    self%p(6, 6) = c%n
  end subroutine set

  !> Evaluate P t and t.P t by differences of the normal components, which removes the pressure
  !> without error.
  pure subroutine apply(p, t, w, square)
    real(wp), intent(in) :: p(6, 6), t(6)
    !> P t, MPa.
    real(wp), intent(out) :: w(6)
    !> t.P t, MPa2; not negative.
    real(wp), intent(out) :: square

    real(wp) :: d21, d31, d32

    d21 = t(2) - t(1)
    d31 = t(3) - t(1)
    d32 = t(3) - t(2)
    w(1) = p(2, 1)*d21 + p(3, 1)*d31
    w(2) = p(3, 2)*d32 - p(2, 1)*d21
    w(3) = -p(3, 1)*d31 - p(3, 2)*d32
    w(4) = p(4, 4)*t(4)
    w(5) = p(5, 5)*t(5)
    w(6) = p(6, 6)*t(6)
    square = w(4)*t(4) + w(5)*t(5) + w(6)*t(6) - p(2, 1)*d21**2 - p(3, 1)*d31**2 - p(3, 2)*d32**2
    square = max(0.0_wp, square)
  end subroutine apply

  !> Return the equivalent stress.
  pure real(wp) function value(self, stress)
    class(hill48_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)

    real(wp) :: w(6), square

    call apply(self%p, stress, w, square)
    value = sqrt(square)
  end function value

  !> Evaluate the equivalent stress and its gradient.
  pure subroutine gradient(self, stress, value, normal)
    class(hill48_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    real(wp), intent(out) :: value
    real(wp), intent(out) :: normal(6)

    real(wp) :: w(6), square

    call apply(self%p, stress, w, square)
    value = sqrt(square)
    normal = 0.0_wp
    if (value > 0.0_wp) normal = (1/value)*w
  end subroutine gradient

  !> Evaluate the equivalent stress and both derivatives.
  pure subroutine second_derivative(self, stress, direction)
    class(hill48_t), intent(in) :: self
    real(wp), intent(in) :: stress(6)
    type(flow_direction_t), intent(out) :: direction

    real(wp) :: w(6), value, factor
    integer :: j

    call apply(self%p, stress, w, value)
    value = sqrt(value)
    factor = 0.0_wp
    if (value > 0.0_wp) factor = 1/value
    direction%stress = stress
    direction%equivalent = value
    direction%gradient = factor*w
    do j = 1, 6
      direction%second(:, j) = factor*(self%p(:, j) - direction%gradient(j)*direction%gradient)
    end do
  end subroutine second_derivative

end module dd3_material_yield_hill48
