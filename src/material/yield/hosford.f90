! SPDX-License-Identifier: GPL-3.0-or-later
!> The isotropic criterion of A. V. Hershey (1954) and W. F. Hosford (1972),
!>
!>     2 sb^m = |S1-S2|^m + |S2-S3|^m + |S3-S1|^m
!>
!> von Mises for m = 2 and m = 4, near Tresca for large m; m = 6 for body-centred, 8 for
!> face-centred cubic metals.
module dd3_material_yield_hosford
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_material_description, only : description_t, value_of
  use dd3_material_yield_power, only : exponent_t, new_exponent, exponent_row, function_t, root_of
  use dd3_material_yield_principal, only : principal_criterion_t, add_differences
  use dd3_material_yield_transformation, only : barlat_transformation
  implicit none
  private
  public :: hosford_t

  type, extends(principal_criterion_t) :: hosford_t
    !> m.
    type(exponent_t) :: exponent
  contains
    procedure, nopass :: describe
    procedure :: set
    procedure :: principal_function
  end type hosford_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "hosford"
    description%title = "isotropic, of exponent m"
    description%source = "A. V. Hershey, J. Appl. Mech. 21 (1954) 241-249; "// &
        "W. F. Hosford, J. Appl. Mech. 39 (1972) 607-609"
    allocate (description%rows, source=[exponent_row()])
    allocate (description%example, source=[law_value_t("m", 4.0_wp)])
  end subroutine describe

  subroutine set(self, values)
    class(hosford_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    real(wp), parameter :: ones(3) = 1.0_wp

    self%always_convex = .true.
    call barlat_transformation(self%transformation(1), ones, ones)
    call new_exponent(self%exponent, value_of(values, "m"))
  end subroutine set

  !> Evaluate the function of the three principal values.
  pure subroutine principal_function(self, e, q)
    class(hosford_t), intent(in) :: self
    real(wp), intent(in) :: e(6)
    type(function_t), intent(out) :: q

    type(function_t) :: f
    real(wp) :: scale

    f = function_t(0.0_wp, 0.0_wp, 0.0_wp)
    scale = maxval(e(1:3)) - minval(e(1:3))
    call add_differences(self%exponent, 0.5_wp, e(1:3)/scale, f)
    call root_of(3, self%exponent%value, scale, 1.0_wp, f, q)
  end subroutine principal_function

end module dd3_material_yield_hosford
