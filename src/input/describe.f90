! SPDX-License-Identifier: GPL-3.0-or-later
!> Description of the values that a keyword's row expects, and splitting of its word lists.
module dd3_input_describe
  use dd3_base_parameter, only : parameter_t, range_text, kind_real, kind_integer, kind_logical, &
      kind_name, kind_text, kind_reals, kind_integers, kind_names, kind_law
  use dd3_base_text, only : to_text
  implicit none
  private
  public :: describe, split_words, word_length, not_available

  !> Longest word in a row's lists.
  integer, parameter :: word_length = 24
  !> Predicate for everything that is reserved for a later version.
  character(len=*), parameter :: not_available = "is not available in this version"

contains

  !> Return what a row expects, for example `size = 3 numbers, > 0, mm`.
  function describe(row) result(text)
    type(parameter_t), intent(in) :: row
    character(len=:), allocatable :: text

    character(len=:), allocatable :: many

    many = to_text(row%count)
    if (row%count == 0) many = "one or more"
    select case (row%kind)
    case (kind_real)
      text = "a number"
    case (kind_integer)
      text = "an integer"
    case (kind_logical)
      text = "on or off"
    case (kind_name)
      text = "a name"
      if (row%form /= "") text = "the name of a "//trim(row%form)
      if (row%choices /= "") text = "one of: "//trim(row%choices)
    case (kind_text)
      text = "a text"
    case (kind_reals)
      text = many//" numbers"
    case (kind_integers)
      text = many//" integers"
    case (kind_names)
      text = many//" words"
      if (row%choices /= "") text = "any of: "//trim(row%choices)
    case (kind_law)
      text = "law key=value ..."
    case default
      text = alternatives(row)
    end select
    text = trim(row%name)//" = "//text//range_text(row)
    if (row%unit /= "") text = text//", "//trim(row%unit)
    if (row%may_be_off) text = text//", or off"
  end function describe

  !> Return the alternative forms of a row's value, joined by "or".
  function alternatives(row) result(text)
    type(parameter_t), intent(in) :: row
    character(len=:), allocatable :: text

    character(len=word_length), allocatable :: word(:)
    integer :: i

    word = split_words(row%form, "/")
    text = ""
    do i = 1, size(word)
      if (word(i) == "/") word(i) = "or"
      if (i > 1) text = text//" "
      text = text//trim(word(i))
    end do
  end function alternatives

  !> Return the words separated by blanks. The separator, if given, also ends a word, and is a word
  !> of its own.
  pure function split_words(text, separator) result(word)
    character(len=*), intent(in) :: text
    character(len=1), intent(in), optional :: separator
    character(len=word_length), allocatable :: word(:)

    character(len=1) :: mark
    integer :: start, last

    mark = " "
    if (present(separator)) mark = separator
    allocate (word(0))
    start = 1
    do while (start <= len_trim(text))
      last = scan(text(start:), " "//mark)
      last = merge(len(text), start + last - 2, last == 0)
      if (last >= start) word = [character(len=word_length) :: word, text(start:last)]
      start = last + 2
      if (last + 1 > len_trim(text) .or. mark == " ") cycle
      if (text(last + 1:last + 1) == mark) word = [character(len=word_length) :: word, mark]
    end do
  end function split_words

end module dd3_input_describe
