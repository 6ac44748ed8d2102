! SPDX-License-Identifier: GPL-3.0-or-later
!> The orthotropic criterion of O. Cazacu and F. Barlat (2001): Drucker's with both invariants
!> generalised,
!>
!>     sb^6 = (J2^3 - c J3^2)/k6
!>     J2 = a1/6 (Txx-Tyy)^2 + a2/6 (Tyy-Tzz)^2 + a3/6 (Txx-Tzz)^2 + a4 Txy^2 + a5 Txz^2 + a6 Tyz^2
!>     J3 = (b1+b2)/27 Txx^3 + (b3+b4)/27 Tyy^3 + [2(b1+b4)-b2-b3]/27 Tzz^3
!>          - (b1 Tyy + b2 Tzz) Txx^2/9 - (b3 Tzz + b4 Txx) Tyy^2/9
!>          - [(b1-b2+b4) Txx + (b1-b3+b4) Tyy] Tzz^2/9 + 2(b1+b4)/9 Txx Tyy Tzz
!>          - Txz^2/3 [2 b9 Tyy - b8 Tzz - (2 b9-b8) Txx]
!>          - Txy^2/3 [2 b10 Tzz - b5 Tyy - (2 b10-b5) Txx]
!>          - Tyz^2/3 [(b6+b7) Txx - b6 Tyy - b7 Tzz] + 2 b11 Txy Txz Tyz
!>
!> with k6 = ((a1+a3)/6)^3 - c ((b1+b2)/27)^2: sb = Txx in tension along rolling. Drucker's for
!> a = b = 1. Not convex for all parameters, nor for all published ones.
module dd3_material_yield_cazacu_barlat2001
  use dd3_base_kinds, only : sqrt2, wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_base_text, only : to_text
  use dd3_material_description, only : description_t, problem_t, add_problem, position_of, value_of
  use dd3_material_yield_invariant, only : invariant_criterion_t, add_cubic, transform_forms
  use dd3_material_yield_transformation, only : transformation_t, new_transformation
  implicit none
  private
  public :: cazacu_barlat2001_t

  type, extends(invariant_criterion_t) :: cazacu_barlat2001_t
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
  end type cazacu_barlat2001_t

  !> Coefficients of the equations.
  type :: coefficients_t
    real(wp) :: a(6), b(11), c, k6
  end type coefficients_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    integer :: i

    description%name = "cazacu_barlat2001"
    description%title = "orthotropic, by generalised invariants J2 and J3; sb = T11 along rolling"
    description%source = "O. Cazacu, F. Barlat, Math. Mech. Solids 6 (2001) 613-630"
    allocate (description%rows, source=[ &
      row("a1", kind_real, "", "", "J2: factor of (T11-T22)^2/6; isotropic: 1"), &
      row("a2", kind_real, "", "", "J2: factor of (T22-T33)^2/6"), &
      row("a3", kind_real, "", "", "J2: factor of (T11-T33)^2/6"), &
      row("a4", kind_real, "", "1", "J2: factor of T12^2"), &
      row("a5", kind_real, "", "1", "J2: factor of T31^2"), &
      row("a6", kind_real, "", "1", "J2: factor of T23^2"), &
      row("b1", kind_real, "", "", "J3: normal components; isotropic: 1"), &
      row("b2", kind_real, "", "", "J3: normal components"), &
      row("b3", kind_real, "", "", "J3: normal components"), &
      row("b4", kind_real, "", "", "J3: normal components"), &
      row("b5", kind_real, "", "1", "J3: T12^2 with T11 and T22"), &
      row("b6", kind_real, "", "1", "J3: T23^2 with T11 and T22"), &
      row("b7", kind_real, "", "1", "J3: T23^2 with T11 and T33"), &
      row("b8", kind_real, "", "1", "J3: T31^2 with T11 and T33"), &
      row("b9", kind_real, "", "1", "J3: T31^2 with T11 and T22"), &
      row("b10", kind_real, "", "1", "J3: T12^2 with T11 and T33"), &
      row("b11", kind_real, "", "1", "J3: product of the shears"), &
      row("c", kind_real, "", "", "weight of J3^2; 0: a quadratic criterion"), &
      row("nonconvex", kind_real, "", "0", "1: take the parameters though the surface be not "// &
          "convex; stress updates may then fail", 0.0_wp, 1.0_wp)])
    allocate (description%example, source=[ &
      (law_value_t(description%rows(i)%name, 1.0_wp), i=1, 17), law_value_t("c", 0.0_wp)])
  end subroutine describe

  !> Require a positive equivalent stress in tension along rolling.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    type(coefficients_t) :: of
    real(wp) :: waived

    if (size(problems) > 0) return
    waived = value_of(values, "nonconvex")
    if (waived > 0.0_wp .and. waived < 1.0_wp) then
      call add_problem(problems, position_of(values, "nonconvex"), &
          "nonconvex = "//to_text(waived)//" is neither 0 nor 1", "0 or 1")
      return
    end if
    of = coefficients(values)
    if (of%k6 > 0.0_wp) return
    call add_problem(problems, 0, "no equivalent stress along rolling: ((a1+a3)/6)^3 - "// &
        "c ((b1+b2)/27)^2 = "//to_text(of%k6), "a positive number")
  end subroutine check

  !> Return the coefficients; isotropic values if not given.
  pure type(coefficients_t) function coefficients(values) result(of)
    type(law_value_t), intent(in) :: values(:)

    character(len=3) :: name
    integer :: i

    do i = 1, 6
      write (name, '(a, i0)') "a", i
      of%a(i) = value_of(values, name, 1.0_wp)
    end do
    do i = 1, 11
      write (name, '(a, i0)') "b", i
      of%b(i) = value_of(values, name, 1.0_wp)
    end do
    of%c = value_of(values, "c")
    of%k6 = ((of%a(1) + of%a(3))/6)**3 - of%c*((of%b(1) + of%b(2))/27)**2
  end function coefficients

  subroutine set(self, values)
    class(cazacu_barlat2001_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    type(coefficients_t) :: of
    type(transformation_t) :: deviator
    real(wp) :: normal(3, 3)

    of = coefficients(values)
    self%convexity_waived = value_of(values, "nonconvex") > 0.0_wp
    self%c = of%c
    self%factor = 1/of%k6
    call fill_quadratic(of%a, self%quadratic)
    self%cubic = 0.0_wp
    call add_normal_terms(of%b, self%cubic)
    call add_shear_terms(of%b, self%cubic)
    normal = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], &
                     [3, 3])
    call new_transformation(deviator, normal, [1.0_wp, 1.0_wp, 1.0_wp])
    call transform_forms(deviator, self%quadratic, self%cubic)
  end subroutine set

  !> Fill the form of J2.
  pure subroutine fill_quadratic(a, q)
    real(wp), intent(in) :: a(6)
    real(wp), intent(out) :: q(6, 6)

    q = 0.0_wp
    q(1:3, 1) = [a(1) + a(3), -a(1), -a(3)]/3
    q(1:3, 2) = [-a(1), a(1) + a(2), -a(2)]/3
    q(1:3, 3) = [-a(3), -a(2), a(2) + a(3)]/3
    q(4, 4) = a(6)
    q(5, 5) = a(5)
    q(6, 6) = a(4)
  end subroutine fill_quadratic

  !> Add the terms of J3 in the normal components.
  pure subroutine add_normal_terms(b, j3)
    real(wp), intent(in) :: b(11)
    real(wp), intent(inout) :: j3(6, 6, 6)

    call add_cubic(j3, 1, 1, 1, (b(1) + b(2))/27)
    call add_cubic(j3, 2, 2, 2, (b(3) + b(4))/27)
    call add_cubic(j3, 3, 3, 3, (2*(b(1) + b(4)) - b(2) - b(3))/27)
    call add_cubic(j3, 2, 1, 1, -b(1)/9)
    call add_cubic(j3, 3, 1, 1, -b(2)/9)
    call add_cubic(j3, 3, 2, 2, -b(3)/9)
    call add_cubic(j3, 1, 2, 2, -b(4)/9)
    call add_cubic(j3, 1, 3, 3, -(b(1) - b(2) + b(4))/9)
    call add_cubic(j3, 2, 3, 3, -(b(1) - b(3) + b(4))/9)
    call add_cubic(j3, 1, 2, 3, 2*(b(1) + b(4))/9)
  end subroutine add_normal_terms

  !> Add the terms of J3 with shears; Kelvin components are sqrt(2) times the tensor's.
  pure subroutine add_shear_terms(b, j3)
    real(wp), intent(in) :: b(11)
    real(wp), intent(inout) :: j3(6, 6, 6)

    call add_cubic(j3, 1, 4, 4, -(b(6) + b(7))/6)
    call add_cubic(j3, 2, 4, 4, b(6)/6)
    call add_cubic(j3, 3, 4, 4, b(7)/6)
    call add_cubic(j3, 1, 5, 5, (2*b(9) - b(8))/6)
    call add_cubic(j3, 2, 5, 5, -b(9)/3)
    call add_cubic(j3, 3, 5, 5, b(8)/6)
    call add_cubic(j3, 1, 6, 6, (2*b(10) - b(5))/6)
    call add_cubic(j3, 2, 6, 6, b(5)/6)
    call add_cubic(j3, 3, 6, 6, -b(10)/3)
    call add_cubic(j3, 4, 5, 6, b(11)/sqrt2)
  end subroutine add_shear_terms

end module dd3_material_yield_cazacu_barlat2001
