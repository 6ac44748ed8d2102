! SPDX-License-Identifier: GPL-3.0-or-later
!> Row of a keyword table. The parser, the checks, the echo, `--help` and the manual derive from it.
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
  !> One integer.
  integer, parameter :: kind_integer = 2
  !> on/off, yes/no, true/false.
  integer, parameter :: kind_logical = 3
  !> One word, in lower case: the name of a set, a tool, a law, an option.
  integer, parameter :: kind_name = 4
  !> A text as written: a path or a title.
  integer, parameter :: kind_text = 5
  !> `count` real numbers.
  integer, parameter :: kind_reals = 6
  !> `count` words.
  integer, parameter :: kind_names = 7
  !> A law's name followed by `key=value` pairs.
  integer, parameter :: kind_law = 8
  !> A form of its own, given by `form`.
  integer, parameter :: kind_other = 9
  !> `count` integers.
  integer, parameter :: kind_integers = 10

  !> Name of the law parameter that stands for any number of pairs `p:Y`.
  character(len=*), parameter :: pair_name = "p:Y"

  !> A key, or a parameter of a law.
  type :: parameter_t
    !> Name as written in the input; case does not matter.
    character(len=24) :: name = ""
    !> One of the `kind_*` values.
    integer :: kind = kind_real
    !> Number of values of `kind_reals`, `kind_integers`, `kind_names`; 0 for one or more.
    integer :: count = 1
    character(len=16) :: unit = ""
    !> Default as it would be written; empty if a value must be given; `-` if the key may be left
    !> out and then has no value.
    character(len=24) :: default = ""
    !> Switch of the block that, when on, allows a key without default to be left out, and the value
    !> that the key has then.
    character(len=24) :: implied_by = "", implied = ""
    !> Bounds of the value.
    real(wp) :: lower = -huge(1.0_wp), upper = huge(1.0_wp)
    !> Whether the bounds are excluded.
    logical :: lower_open = .false., upper_open = .false.
    !> Whether the value may be `off`.
    logical :: may_be_off = .false.
    !> Whether the key may be given several times.
    logical :: repeatable = .false.
    !> Allowed words of a `kind_name` or `kind_names`, separated by blanks; empty to allow any.
    character(len=120) :: choices = ""
    !> Form of a `kind_other`, with alternatives separated by `/`. The words `set`, `tool`,
    !> `material`, `axis`, `number`, `count` and `range` stand for such values, `a|b` for one of two
    !> words, `...` repeats the word before it, `[mm]` may be left out. For a `kind_name`: `set`,
    !> `tool` or `material` if it must be the name of one.
    character(len=80) :: form = ""
    !> Choices or laws reserved for a later version, separated by blanks; `*` for the whole key.
    character(len=120) :: later = ""
    !> One line of help.
    character(len=160) :: help = ""
  end type parameter_t

  !> Value of a law's parameter.
  type :: law_value_t
    !> Name in the law's table.
    character(len=24) :: name = ""
    !> Value; of a pair `p:Y` the second number.
    real(wp) :: value = 0.0_wp
    !> First number of a pair.
    real(wp) :: abscissa = 0.0_wp
  end type law_value_t

contains

  !> Return a row; the arguments are the components of `parameter_t`.
  pure function row(name, kind, unit, default, help, lower, upper, lower_open, upper_open, count, &
      may_be_off, repeatable, choices, form, later)
    character(len=*), intent(in) :: name, unit, default, help
    integer, intent(in) :: kind
    real(wp), intent(in), optional :: lower, upper
    logical, intent(in), optional :: lower_open, upper_open, may_be_off, repeatable
    integer, intent(in), optional :: count
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

  !> Whether a value is within the bounds; false for NaN.
  pure logical function in_range(row, value)
    type(parameter_t), intent(in) :: row
    real(wp), intent(in) :: value

    in_range = value >= row%lower .and. value <= row%upper
    if (row%lower_open .and. .not. value > row%lower) in_range = .false.
    if (row%upper_open .and. .not. value < row%upper) in_range = .false.
  end function in_range

  !> Return the bounds as text, each after a comma; empty without bounds.
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
