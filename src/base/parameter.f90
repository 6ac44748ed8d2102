!> The row of a keyword table: the parser, the range check, the echo, `--help` and the manual derive
!> from it.
module dd3_base_parameter
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  implicit none
  private
  public :: parameter_t, law_value_t, row, pair_name, in_range, range_text
  public :: kind_real, kind_integer, kind_logical, kind_name, kind_text, kind_reals, kind_names, &
      kind_law, kind_other, kind_integers

  !> One real number.
  integer, parameter :: kind_real = 1
  !> One whole number.
  integer, parameter :: kind_integer = 2
  !> on/off, yes/no, true/false.
  integer, parameter :: kind_logical = 3
  !> One bare word, lower-cased: the name of a set, a tool, a law, an option.
  integer, parameter :: kind_name = 4
  !> A string, kept as written: a path or a title.
  integer, parameter :: kind_text = 5
  !> `count` real numbers.
  integer, parameter :: kind_reals = 6
  !> Several bare words.
  integer, parameter :: kind_names = 7
  !> A law's name followed by `key=value` pairs.
  integer, parameter :: kind_law = 8
  !> A form of its own, given by `form`.
  integer, parameter :: kind_other = 9
  !> `count` whole numbers.
  integer, parameter :: kind_integers = 10

  !> Name of the parameter of a law that takes pairs `p:Y` in any number.
  character(len=*), parameter :: pair_name = "p:Y"

  !> A keyword, or a law's parameter.
  type :: parameter_t
    !> Name as written in the input (upper and lower case are the same).
    character(len=24) :: name = ""
    !> One of the `kind_*` values.
    integer :: kind = kind_real
    !> How many values, for `kind_reals`, `kind_integers`, `kind_names`; 0 for any number from one.
    integer :: count = 1
    !> Unit of the value, empty where it has none.
    character(len=16) :: unit = ""
    !> Default as it would be written; empty where the value must be given; `-` where leaving it out
    !> means "absent".
    character(len=24) :: default = ""
    !> Smallest and largest value allowed.
    real(wp) :: lower = -huge(1.0_wp), upper = huge(1.0_wp)
    !> Whether the bounds themselves are refused.
    logical :: lower_open = .false., upper_open = .false.
    !> Whether `off` may stand in place of a number.
    logical :: may_be_off = .false.
    !> Whether the key may be given several times.
    logical :: repeatable = .false.
    !> Alternatives of a `kind_name`, separated by blanks; empty where any word will do.
    character(len=120) :: choices = ""
    !> What stands where in the value of a `kind_other`; alternatives separated by `/`. The words
    !> `set`, `tool`, `material`,
    !> `axis`, `number`, `count` and `range` stand for such values, `a|b` for one of two words,
    !> `...` repeats the word before
    !> it, `[mm]` may be left out. For a `kind_name`, `set`, `tool` or `material` says what must
    !> bear the name.
    character(len=80) :: form = ""
    !> Alternatives, or laws, that this version does not provide, separated by blanks; `*` for the
    !> whole key.
    character(len=120) :: later = ""
    !> One line of help.
    character(len=160) :: help = ""
  end type parameter_t

  !> A law's parameter as given by the user.
  type :: law_value_t
    !> Name as written in the input.
    character(len=24) :: name = ""
    !> Its value; of a pair, what stands behind the colon.
    real(wp) :: value = 0.0_wp
    !> Of a pair, what stands before the colon.
    real(wp) :: abscissa = 0.0_wp
  end type law_value_t

contains

  !> A row with the common members; the others can be set afterwards.
  pure function row(name, kind, unit, default, help, lower, upper, lower_open, upper_open, count, &
                    may_be_off, repeatable, choices, form, later)
    !> See the components of `parameter_t`.
    character(len=*), intent(in) :: name, unit, default, help
    !> See the components of `parameter_t`.
    integer, intent(in) :: kind
    !> See the components of `parameter_t`.
    real(wp), intent(in), optional :: lower, upper
    !> See the components of `parameter_t`.
    logical, intent(in), optional :: lower_open, upper_open, may_be_off, repeatable
    !> See the components of `parameter_t`.
    integer, intent(in), optional :: count
    !> See the components of `parameter_t`.
    character(len=*), intent(in), optional :: choices, form, later
    type(parameter_t) :: row

    row%name = name
    row%kind = kind
    row%unit = unit
    row%default = default
    row%help = help
    if (present(lower)) row%lower = lower
    if (present(upper)) row%upper = upper
    if (present(lower_open)) row%lower_open = lower_open
    if (present(upper_open)) row%upper_open = upper_open
    if (present(count)) row%count = count
    if (present(may_be_off)) row%may_be_off = may_be_off
    if (present(repeatable)) row%repeatable = repeatable
    if (present(choices)) row%choices = choices
    if (present(form)) row%form = form
    if (present(later)) row%later = later
  end function row

  !> Whether a value lies within the bounds of a parameter; a NaN does not.
  pure logical function in_range(row, value)
    type(parameter_t), intent(in) :: row
    real(wp), intent(in) :: value

    in_range = value >= row%lower .and. value <= row%upper
    if (row%lower_open .and. .not. value > row%lower) in_range = .false.
    if (row%upper_open .and. .not. value < row%upper) in_range = .false.
  end function in_range

  !> The bounds of a parameter, as they follow what it is; empty where there are none.
  pure function range_text(row) result(text)
    type(parameter_t), intent(in) :: row
    character(len=:), allocatable :: text

    text = ""
    if (row%lower > -huge(1.0_wp)) then
      text = text//", "//trim(merge("> ", ">=", row%lower_open))//" "//to_text(row%lower)
    end if
    if (row%upper < huge(1.0_wp)) then
      text = text//", "//trim(merge("< ", "<=", row%upper_open))//" "//to_text(row%upper)
    end if
  end function range_text

end module dd3_base_parameter
