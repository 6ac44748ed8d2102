! SPDX-License-Identifier: GPL-3.0-or-later
!> The factor as a table over the rate: straight over its logarithm or over the rate itself between
!> the points, constant before the first and beyond the last.
module dd3_material_rate_table
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real, kind_text, pair_name
  use dd3_base_text, only : to_text
  use dd3_material_description, only : description_t, problem_t, add_problem, check_table, &
      value_of
  use dd3_material_rate_law, only : rate_t
  use dd3_material_straight, only : straight
  implicit none
  private
  public :: table_t

  type, extends(rate_t) :: table_t
    private
    !> Rates of the points, 1/s, or their logarithms, and factors.
    real(wp), allocatable :: place(:), value(:)
    !> Whether the table is straight over the logarithm.
    logical :: logarithmic = .true.
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
    description%title = "points rate:factor joined by straight lines over the logarithm of the rate"
    description%source = "-"
    allocate (description%rows, source=[ &
      row(pair_name, kind_real, "", "-", "factor at the rate in 1/s, two points or more: "// &
          "0.001:1 1:1.05 1000:1.3", 0.0_wp, lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", &
          "file with rate and factor in each line, in place of the points; # begins a comment"), &
      row("logarithm", kind_real, "", "1", "1: straight over the logarithm of the rate; "// &
          "0: over the rate", 0.0_wp, 1.0_wp)])
    allocate (description%example, source=[ &
      law_value_t(pair_name, 1.0_wp, 1.0e-3_wp), law_value_t(pair_name, 1.03_wp, 0.1_wp), &
      law_value_t(pair_name, 1.1_wp, 10.0_wp), law_value_t(pair_name, 1.3_wp, 1.0e3_wp), &
      law_value_t("logarithm", 1.0_wp)])
  end subroutine describe

  !> Require two points or more, rates that rise, positive ones for the logarithm, and factors that
  !> do not fall, as the rate of a stress would not be unique.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    integer, allocatable :: place(:)
    integer :: i

    if (size(problems) > 0) return
    place = pack([(i, i=1, size(values))], values%name == pair_name)
    call check_table(values, "rate", "rates", "rate1:factor1 rate2:factor2 ...", problems)
    if (size(place) < 2) return
    if (values(place(1))%abscissa < 0.0_wp) call add_problem(problems, place(1), &
        "the rate is negative", "a rate in 1/s")
    if (value_of(values, "logarithm", 1.0_wp) > 0.5_wp .and. .not. values(place(1))%abscissa &
        > 0.0_wp) call add_problem(problems, place(1), "the first rate is "// &
        to_text(values(place(1))%abscissa)//", which has no logarithm", &
        "positive rates; or logarithm=0")
    do i = 2, size(place)
      associate (now => values(place(i)), before => values(place(i - 1)))
        if (now%value < before%value) call add_problem(problems, place(i), &
            "the factor falls to "//to_text(now%value), "factors that do not fall")
      end associate
    end do
  end subroutine check

  subroutine set(self, values)
    class(table_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%logarithmic = value_of(values, "logarithm", 1.0_wp) > 0.5_wp
    self%place = pack(values%abscissa, values%name == pair_name)
    if (self%logarithmic) self%place = log(self%place)
    self%value = pack(values%value, values%name == pair_name)
  end subroutine set

  !> Evaluate the factor on the flow stress.
  pure subroutine factor(self, rate, value, slope)
    class(table_t), intent(in) :: self
    real(wp), intent(in) :: rate
    real(wp), intent(out) :: value, slope

    if (.not. self%logarithmic) then
      call straight(self%place, self%value, rate, value, slope)
      return
    end if
    call straight(self%place, self%value, log(max(rate, tiny(1.0_wp))), value, slope)
    if (rate > 0.0_wp) slope = slope/rate
  end subroutine factor

end module dd3_material_rate_table
