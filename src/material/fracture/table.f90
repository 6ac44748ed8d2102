! SPDX-License-Identifier: GPL-3.0-or-later
!> The strain to fracture as a table over the triaxiality: straight between the points, constant
!> before the first and beyond the last. With an exponent above 1 the damage grows slowly at first,
!> as in the model GISSMO.
module dd3_material_fracture_table
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real, kind_text, pair_name
  use dd3_material_description, only : description_t, problem_t, check_table, value_of
  use dd3_material_fracture_law, only : fracture_t
  use dd3_material_straight, only : straight
  implicit none
  private
  public :: table_t

  type, extends(fracture_t) :: table_t
    private
    !> Triaxialities and strains of the points.
    real(wp), allocatable :: place(:), value(:)
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: strain
  end type table_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "table"
    description%title = "points triaxiality:strain joined by straight lines, constant beyond them"
    description%source = "F. Neukamm, M. Feucht, A. Haufe, Proc. 7th European LS-DYNA Conf. (2009)"
    allocate (description%rows, source=[ &
      row(pair_name, kind_real, "", "-", "strain to fracture at the triaxiality, two points or "// &
          "more: 0:0.7 0.333:0.9 0.577:0.5 0.667:0.9", 0.0_wp, lower_open=.true., &
          repeatable=.true.), &
      row("file", kind_text, "", "-", "file with triaxiality and strain in each line, in place "// &
          "of the points; # begins a comment"), &
      row("exponent", kind_real, "", "1", "exponent of the growth of the damage; 1: linear in "// &
          "the plastic strain", 1.0_wp, 10.0_wp)])
    allocate (description%example, source=[ &
      law_value_t(pair_name, 0.7_wp, 0.0_wp), law_value_t(pair_name, 0.9_wp, 0.333_wp), &
      law_value_t(pair_name, 0.5_wp, 0.577_wp), law_value_t(pair_name, 0.9_wp, 0.667_wp), &
      law_value_t("exponent", 2.0_wp)])
  end subroutine describe

  !> Require two points or more with triaxialities that rise.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    if (size(problems) > 0) return
    call check_table(values, "triaxiality", "triaxialities", "triaxiality1:strain1 "// &
        "triaxiality2:strain2 ...", problems)
  end subroutine check

  subroutine set(self, values)
    class(table_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%place = pack(values%abscissa, values%name == pair_name)
    self%value = pack(values%value, values%name == pair_name)
    self%exponent = value_of(values, "exponent", 1.0_wp)
  end subroutine set

  !> Return the strain to fracture.
  pure real(wp) function strain(self, triaxiality, lode)
    class(table_t), intent(in) :: self
    real(wp), intent(in) :: triaxiality, lode

    real(wp) :: slope

    associate (unused => lode)
    end associate
    call straight(self%place, self%value, triaxiality, strain, slope)
  end function strain

end module dd3_material_fracture_table
