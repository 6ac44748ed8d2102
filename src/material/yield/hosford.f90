!> The isotropic criterion of A. V. Hershey (1954) and W. F. Hosford (1972),
!>
!>     2 sb^m = |S1-S2|^m + |S2-S3|^m + |S3-S1|^m
!>
!> von Mises for m = 2 and m = 4, near Tresca for large m; m = 6 for body-centred, 8 for
!> face-centred cubic metals.
module dd3_material_yield_hosford
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, parameter_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_yield_power, only : exponent_t, new_exponent, take_root
  use dd3_material_yield_principal, only : principal_criterion_t, add_differences
  use dd3_material_yield_transformation, only : barlat_transformation
  implicit none
  private
  public :: hosford_t, exponent_row, hosford_function

  !> The criterion.
  type, extends(principal_criterion_t) :: hosford_t
    !> m.
    type(exponent_t) :: exponent
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: principal_function
  end type hosford_t

contains

  !> Says its name, source and parameters.
  subroutine describe(description)
    !> What the law says of itself.
    type(description_t), intent(out) :: description

    description%name = "hosford"
    description%title = "isotropic, of exponent m"
    description%source = "A. V. Hershey, J. Appl. Mech. 21 (1954) 241-249; "// &
                         "W. F. Hosford, J. Appl. Mech. 39 (1972) 607-609"
    allocate (description%rows, source=[exponent_row()])
    allocate (description%example, source=[law_value_t("m", 4.0_wp)])
  end subroutine describe

  !> The parameter m of criteria of a high exponent.
  type(parameter_t) function exponent_row()
    exponent_row = row("m", kind_real, "", "", &
                       "exponent: 6 for body-centred, 8 for face-centred cubic metals", &
                       2.0_wp, 100.0_wp)
  end function exponent_row

  !> Takes its parameters.
  subroutine set(self, values)
    !> The criterion.
    class(hosford_t), intent(inout) :: self
    !> Its parameters.
    type(law_value_t), intent(in) :: values(:)
    real(wp), parameter :: ones(3) = 1.0_wp

    self%always_convex = .true.
    call barlat_transformation(self%transformation(1), ones, ones)
    call new_exponent(self%exponent, value_of(values, "m"))
  end subroutine set

  !> The function of the principal values, with its derivatives.
  pure subroutine principal_function(self, e, q, first, second)
    !> The criterion.
    class(hosford_t), intent(in) :: self
    !> Principal values, MPa.
    real(wp), intent(in) :: e(6)
    !> The function, MPa.
    real(wp), intent(out) :: q
    !> Its derivatives.
    real(wp), intent(out) :: first(6), second(6, 6)

    call hosford_function(self%exponent, e, q, first, second)
  end subroutine principal_function

  !> The function of three principal values, with its derivatives.
  pure subroutine hosford_function(exponent, e, q, first, second)
    !> m.
    type(exponent_t), intent(in) :: exponent
    !> Principal values, MPa.
    real(wp), intent(in) :: e(6)
    !> The function, MPa.
    real(wp), intent(out) :: q
    !> Its derivatives.
    real(wp), intent(out) :: first(6), second(6, 6)
    real(wp) :: f, f_first(6), f_second(6, 6), scale

    f = 0.0_wp
    f_first = 0.0_wp
    f_second = 0.0_wp
    scale = maxval(e(1:3)) - minval(e(1:3))
    call add_differences(exponent, 0.5_wp, e(1:3)/scale, f, f_first, f_second)
    call take_root(3, exponent%value, scale, 1.0_wp, f, f_first, f_second, q, first, second)
  end subroutine hosford_function

end module dd3_material_yield_hosford
