! SPDX-License-Identifier: GPL-3.0-or-later
!> The orthotropic criterion "BBC2008" of D.-S. Comsa and D. Banabic of plane stress, s = 1 or 2:
!>
!>     sb^2k = (w-1) sum over r = 1 ... s of { w^(r-1) [(L+M)^2k + (L-M)^2k]
!>                                            + w^(s-r) [(M+N)^2k + (M-N)^2k] },  w = (3/2)^(1/s)
!>     L   =  l1 T11 + l2 T22
!>     M^2 = (m1 T11 - m2 T22)^2 + (2 m3 T12)^2
!>     N^2 = (n1 T11 - n2 T22)^2 + (2 n3 T12)^2
!>
!> with coefficients of their own for each r; Hosford's if all are 1/2. M and N take up f T23 and
!> g T31 in the extension, as T12 in the isotropic case.
module dd3_material_yield_bbc2008
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_material_description, only : description_t, problem_t, add_problem, is_given, value_of
  use dd3_material_yield_planar, only : planar_criterion_t, norm_t, pair_t
  use dd3_material_yield_power, only : new_exponent
  implicit none
  private
  public :: bbc2008_t

  type, extends(planar_criterion_t) :: bbc2008_t
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
  end type bbc2008_t

  !> Names of the coefficients of each r, and what they multiply.
  character(len=4), parameter :: names(8, 2) = reshape([character(len=4) :: &
      "l1_1", "l2_1", "m1_1", "m2_1", "m3_1", "n1_1", "n2_1", "n3_1", &
      "l1_2", "l2_2", "m1_2", "m2_2", "m3_2", "n1_2", "n2_2", "n3_2"], [8, 2])
  character(len=8), parameter :: role(8) = [character(len=8) :: "L: T11", "L: T22", "M: T11", &
      "M: -T22", "M: 2 T12", "N: T11", "N: -T22", "N: 2 T12"]

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    integer :: i

    description%name = "bbc2008"
    description%title = "orthotropic, of exponent 2k, of plane stress with an extension (BBC2008)"
    description%source = "D.-S. Comsa, D. Banabic, Plane-stress yield criterion for highly-"// &
        "anisotropic sheet metals, NUMISHEET 2008, 43-48"
    allocate (description%rows, source=[ &
      (row(names(i, 1), kind_real, "", "", "r = 1, factor in "//trim(role(i))// &
           "; isotropic: 1/2"), i=1, 8), &
      (row(names(i, 2), kind_real, "", "-", "r = 2, factor in "//trim(role(i))// &
           "; left out with s = 1"), i=1, 8), &
      row("f", kind_real, "", "1", "M and N: factor of T23 (extension)"), &
      row("g", kind_real, "", "1", "M and N: factor of T31 (extension)"), &
      row("k", kind_real, "", "", "half the exponent: 3 for body-centred, 4 for face-centred "// &
          "cubic metals", 1.0_wp, 50.0_wp)])
    allocate (description%example, source=[ &
      (law_value_t(names(i, 1), 0.5_wp), i=1, 8), (law_value_t(names(i, 2), 0.5_wp), i=1, 8), &
      law_value_t("f", 1.0_wp), law_value_t("g", 1.0_wp), law_value_t("k", 2.0_wp)])
  end subroutine describe

  !> Require all coefficients of r = 2, or none.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    integer :: i

    if (terms(values) == 1) return
    do i = 1, 8
      if (is_given(values, names(i, 2))) cycle
      call add_problem(problems, 0, names(i, 2)//" is missing", &
          "all eight coefficients of r = 2, or none")
    end do
  end subroutine check

  !> Return s.
  pure integer function terms(values)
    type(law_value_t), intent(in) :: values(:)

    integer :: i

    terms = merge(2, 1, any([(is_given(values, names(i, 2)), i=1, 8)]))
  end function terms

  subroutine set(self, values)
    class(bbc2008_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    type(norm_t) :: l, m, n
    real(wp) :: c(8), across(2), w
    integer :: i, r, s

    self%always_convex = .true.
    s = terms(values)
    w = 1.5_wp**(1/real(s, wp))
    across = [value_of(values, "f", 1.0_wp), value_of(values, "g", 1.0_wp)]
    allocate (self%pairs(2*s))
    do r = 1, s
      do i = 1, 8
        c(i) = value_of(values, names(i, r), 0.5_wp)
      end do
      l = norm_t(c(1:2))
      m = norm_t([c(3), -c(4)], [across, 2*c(5)]**2)
      n = norm_t([c(6), -c(7)], [across, 2*c(8)]**2)
      self%pairs(2*r - 1) = pair_t((w - 1)*w**(r - 1), l, m)
      self%pairs(2*r) = pair_t((w - 1)*w**(s - r), m, n)
    end do
    call new_exponent(self%exponent, 2*value_of(values, "k"))
  end subroutine set

end module dd3_material_yield_bbc2008
