! SPDX-License-Identifier: GPL-3.0-or-later
!> The criterion of D. C. Drucker (1949),
!>
!>     sb = 3 [(J2^3 - c J3^2)/(27 - 4c)]^(1/6),   J2 = S:S/2,   J3 = det S
!>
!> of the deviator S = T', or, orthotropic, of the transformed stress S = L T of Yld'91, as proposed
!> by O. Cazacu and F. Barlat (2001). Convex for -27/8 <= c <= 9/4; von Mises for c = 0.
module dd3_material_yield_drucker
  use dd3_base_kinds, only : inverse_sqrt2, wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, value_of
  use dd3_material_yield_invariant, only : invariant_criterion_t, add_cubic, transform_forms
  use dd3_material_yield_transformation, only : transformation_t, barlat_transformation
  implicit none
  private
  public :: drucker_t

  type, extends(invariant_criterion_t) :: drucker_t
  contains
    procedure, nopass :: describe
    procedure :: set
  end type drucker_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    integer :: i

    description%name = "drucker"
    description%title = "isotropic by the invariants J2 and J3; orthotropic with C1 to C6"
    description%source = "D. C. Drucker, J. Appl. Mech. 16 (1949) 349-357; "// &
        "O. Cazacu, F. Barlat, Math. Mech. Solids 6 (2001) 613-630"
    allocate (description%rows, source=[ &
      row("c", kind_real, "", "", "weight of J3^2; 0: von Mises", -27/8.0_wp, 9/4.0_wp), &
      row("C1", kind_real, "", "1", "coefficient of T22-T33 in the transformed stress"), &
      row("C2", kind_real, "", "1", "coefficient of T33-T11"), &
      row("C3", kind_real, "", "1", "coefficient of T11-T22"), &
      row("C4", kind_real, "", "1", "coefficient of T23"), &
      row("C5", kind_real, "", "1", "coefficient of T31"), &
      row("C6", kind_real, "", "1", "coefficient of T12")])
    allocate (description%example, source=[ &
      law_value_t("c", 0.0_wp), (law_value_t(description%rows(i)%name, 1.0_wp), i=2, 7)])
  end subroutine describe

  subroutine set(self, values)
    class(drucker_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    type(transformation_t) :: transformation
    real(wp) :: normal(3), shear(3)
    integer :: i

    self%always_convex = .true.
    self%c = value_of(values, "c")
    self%factor = 729/(27 - 4*self%c)
    self%quadratic = 0.0_wp
    self%cubic = 0.0_wp
    do i = 1, 6
      self%quadratic(i, i) = 1.0_wp
    end do
    do i = 1, 3
      call add_cubic(self%cubic, i, i + 3, i + 3, -0.5_wp)
    end do
    call add_cubic(self%cubic, 1, 2, 3, 1.0_wp)
    call add_cubic(self%cubic, 4, 5, 6, inverse_sqrt2)
    normal = [value_of(values, "C1", 1.0_wp), value_of(values, "C2", 1.0_wp), &
        value_of(values, "C3", 1.0_wp)]
    shear = [value_of(values, "C4", 1.0_wp), value_of(values, "C5", 1.0_wp), &
        value_of(values, "C6", 1.0_wp)]
    call barlat_transformation(transformation, normal, shear)
    call transform_forms(transformation, self%quadratic, self%cubic)
  end subroutine set

end module dd3_material_yield_drucker
