! SPDX-License-Identifier: GPL-3.0-or-later
!> The factor as a table over the temperature: straight between the points, constant before the
!> first and beyond the last.
module dd3_material_temperature_table
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real, kind_text, pair_name
  use dd3_material_description, only : description_t, problem_t, check_table
  use dd3_material_straight, only : straight
  use dd3_material_temperature_law, only : temperature_t
  implicit none
  private
  public :: table_t

  type, extends(temperature_t) :: table_t
    private
    !> Temperatures and factors of the points.
    real(wp), allocatable :: place(:), value(:)
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: factor
  end type table_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "table"
    description%title = "points temperature:factor joined by straight lines, constant beyond them"
    description%source = "-"
    allocate (description%rows, source=[ &
      row(pair_name, kind_real, "", "-", "factor at the temperature, two points or more: "// &
          "20:1 200:0.8 300:0.5", 0.0_wp, lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", "file with temperature and factor in each line, in place "// &
          "of the points; # begins a comment")])
    allocate (description%example, source=[ &
      law_value_t(pair_name, 1.0_wp, 20.0_wp), law_value_t(pair_name, 0.9_wp, 120.0_wp), &
      law_value_t(pair_name, 0.6_wp, 250.0_wp)])
  end subroutine describe

  !> Require two points or more with temperatures that rise.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    if (size(problems) > 0) return
    call check_table(values, "temperature", "temperatures", "temperature1:factor1 "// &
        "temperature2:factor2 ...", problems)
  end subroutine check

  subroutine set(self, values)
    class(table_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%place = pack(values%abscissa, values%name == pair_name)
    self%value = pack(values%value, values%name == pair_name)
  end subroutine set

  !> Evaluate the factor on the flow stress.
  pure subroutine factor(self, temperature, value, slope)
    class(table_t), intent(in) :: self
    real(wp), intent(in) :: temperature
    real(wp), intent(out) :: value, slope

    call straight(self%place, self%value, temperature, value, slope)
  end subroutine factor

end module dd3_material_temperature_table
