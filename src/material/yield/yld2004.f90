! SPDX-License-Identifier: GPL-3.0-or-later
!> The orthotropic criterion "Yld2004-18p" of F. Barlat and others: all differences between the
!> principal values of two linear transformations of the deviator s,
!>
!>     4 sb^m = sum over i, j of |S'_i - S''_j|^m,   S' = C' s,   S'' = C'' s
!>     S11 = -c12 s22 - c13 s33    S23 = c44 s23
!>     S22 = -c21 s11 - c23 s33    S31 = c55 s31
!>     S33 = -c31 s11 - c32 s22    S12 = c66 s12
!>
!> with coefficients c of C' and d of C''. Hosford's for c = d = 1.
module dd3_material_yield_yld2004
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_yield_power, only : exponent_t, new_exponent, exponent_row, function_t, powers, &
      root_of
  use dd3_material_yield_principal, only : principal_criterion_t
  use dd3_material_yield_transformation, only : transformation_t, new_transformation
  implicit none
  private
  public :: yld2004_t

  type, extends(principal_criterion_t) :: yld2004_t
    private
    !> m.
    type(exponent_t) :: exponent
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: principal_function
  end type yld2004_t

  !> Indices of a transformation's coefficients.
  character(len=2), parameter :: indices(9) = ["12", "13", "21", "23", "31", "32", "44", "55", "66"]

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    character(len=24) :: name(18)
    integer :: i

    description%name = "yld2004"
    description%title = "orthotropic, of exponent m, two linear transformations (Yld2004-18p)"
    description%source = "F. Barlat, H. Aretz, J. W. Yoon and others, Int. J. Plasticity 21 "// &
        "(2005) 1009-1039"
    name = [character(len=24) :: "c"//indices, "d"//indices]
    allocate (description%rows, source=[ &
      (row(name(i), kind_real, "", "", "first transformation: minus the entry "//name(i)(2:2)// &
           ","//name(i)(3:3)//"; isotropic: 1"), i=1, 6), &
      (row(name(i), kind_real, "", "1", "first transformation: factor of "//shear_of(name(i))), &
       i=7, 9), &
      (row(name(i), kind_real, "", "", "second transformation: minus the entry "// &
           name(i)(2:2)//","//name(i)(3:3)), i=10, 15), &
      (row(name(i), kind_real, "", "1", "second transformation: factor of "//shear_of(name(i))), &
       i=16, 18), &
      exponent_row()])
    allocate (description%example, source=[ &
      (law_value_t(name(i), 1.0_wp), i=1, 18), law_value_t("m", 4.0_wp)])
  end subroutine describe

  !> Return the name of the shear component that a coefficient multiplies.
  pure character(len=3) function shear_of(name)
    character(len=*), intent(in) :: name

    select case (name(2:3))
    case ("44")
      shear_of = "s23"
    case ("55")
      shear_of = "s31"
    case default
      shear_of = "s12"
    end select
  end function shear_of

  subroutine set(self, values)
    class(yld2004_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%always_convex = .true.
    self%count = 2
    call set_transformation("c", values, self%transformation(1))
    call set_transformation("d", values, self%transformation(2))
    call new_exponent(self%exponent, value_of(values, "m"))
  end subroutine set

  !> Set one of the transformations.
  subroutine set_transformation(letter, values, transformation)
    !> First letter of the names of its coefficients.
    character(len=1), intent(in) :: letter
    type(law_value_t), intent(in) :: values(:)
    type(transformation_t), intent(out) :: transformation

    real(wp) :: c(9), normal(3, 3)
    integer :: i

    do i = 1, 9
      c(i) = value_of(values, letter//indices(i), 1.0_wp)
    end do
    normal(:, 1) = [0.0_wp, -c(3), -c(5)]
    normal(:, 2) = [-c(1), 0.0_wp, -c(6)]
    normal(:, 3) = [-c(2), -c(4), 0.0_wp]
    call new_transformation(transformation, normal, c(7:9))
  end subroutine set_transformation

  !> Evaluate the function of the principal values.
  pure subroutine principal_function(self, e, q)
    class(yld2004_t), intent(in) :: self
    real(wp), intent(in) :: e(6)
    type(function_t), intent(out) :: q

    type(function_t) :: f
    real(wp) :: scale, power(3), d(3), dd(3)
    integer :: i

    f = function_t(0.0_wp, 0.0_wp, 0.0_wp)
    scale = max(maxval(e(1:3)) - minval(e(4:6)), maxval(e(4:6)) - minval(e(1:3)))
    do i = 1, 3
      call powers(3, self%exponent, (e(i) - e(4:6))/scale, power, d, dd)
      f%value = f%value + 0.25_wp*sum(power)
      f%first(i) = 0.25_wp*sum(d)
      f%first(4:6) = f%first(4:6) - 0.25_wp*d
      f%second(i, i) = 0.25_wp*sum(dd)
      f%second(i, 4:6) = -0.25_wp*dd
      f%second(4:6, i) = -0.25_wp*dd
      f%second(4, 4) = f%second(4, 4) + 0.25_wp*dd(1)
      f%second(5, 5) = f%second(5, 5) + 0.25_wp*dd(2)
      f%second(6, 6) = f%second(6, 6) + 0.25_wp*dd(3)
    end do
    call root_of(6, self%exponent%value, scale, 1.0_wp, f, q)
  end subroutine principal_function

end module dd3_material_yield_yld2004
