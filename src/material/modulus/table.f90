! SPDX-License-Identifier: GPL-3.0-or-later
!> Young's modulus as a table over the equivalent plastic strain: straight between the points,
!> constant beyond the last.
module dd3_material_modulus_table
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real, kind_text, pair_name
  use dd3_base_text, only : to_text
  use dd3_material_description, only : description_t, problem_t, add_problem, &
      check_strains
  use dd3_material_modulus_law, only : modulus_t
  use dd3_material_straight, only : straight
  implicit none
  private
  public :: table_t

  type, extends(modulus_t) :: table_t
    private
    !> Plastic strains and moduli (MPa) of the points.
    real(wp), allocatable :: strain(:), young(:)
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: young_at
  end type table_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "table"
    description%title = "points p:E joined by straight lines, constant beyond the last"
    description%source = "-"
    allocate (description%rows, source=[ &
      row(pair_name, kind_real, "MPa", "-", &
          "Young's modulus E at the plastic strain p, the first of them 0:young", &
          0.0_wp, lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", &
          "file with p and E in each line, in place of the points; # begins a comment")])
    allocate (description%example, source=[ &
      law_value_t(pair_name, 2.1e5_wp, 0.0_wp), law_value_t(pair_name, 1.9e5_wp, 0.02_wp), &
      law_value_t(pair_name, 1.75e5_wp, 0.06_wp), law_value_t(pair_name, 1.65e5_wp, 0.15_wp)])
  end subroutine describe

  !> Require plastic strains as in any table, and moduli that do not increase.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    real(wp), allocatable :: young(:)
    integer, allocatable :: place(:)
    integer :: i

    if (size(problems) > 0) return
    call check_strains(values, "0:young, the initial modulus", "0:young p2:E2 ...", problems)
    place = pack([(i, i=1, size(values))], values%name == pair_name)
    young = values(place)%value
    do i = 2, size(young)
      if (young(i) > young(i - 1)) call add_problem(problems, place(i), &
          "the modulus rises to "//to_text(young(i)), "moduli that do not rise")
    end do
  end subroutine check

  subroutine set(self, values)
    class(table_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%strain = pack(values%abscissa, values%name == pair_name)
    self%young = pack(values%value, values%name == pair_name)
  end subroutine set

  !> Return Young's modulus of a plastic strain, MPa.
  pure real(wp) function young_at(self, initial, plastic_strain)
    class(table_t), intent(in) :: self
    !> Not used: the first point is the same.
    real(wp), intent(in) :: initial
    real(wp), intent(in) :: plastic_strain

    real(wp) :: slope

    associate (unused => initial)
    end associate
    call straight(self%strain, self%young, plastic_strain, young_at, slope)
  end function young_at

end module dd3_material_modulus_table
