! SPDX-License-Identifier: GPL-3.0-or-later
!> Outline of a law as written: a name, then `key = value` pairs or value pairs `p:Y`. The names and
!> values themselves are checked against the law's table, see dd3_input_law.
module dd3_input_law_outline
  use dd3_base_error, only : error_list_t
  use dd3_base_parameter, only : parameter_t
  use dd3_base_text, only : lower_case
  use dd3_input_block, only : entry_t, token_t
  use dd3_input_describe, only : describe, split_words, not_available
  use dd3_input_token, only : line_t, token_list_t, add_token, split_line
  implicit none
  private
  public :: check_law_outline, is_pair

contains

  !> Check the outline of a law. A missing value becomes an empty word, which the check of the law's
  !> parameters reports.
  subroutine check_law_outline(entry, row, errors)
    type(entry_t), intent(inout) :: entry
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: word
    integer :: i

    call unfold_law(entry, errors)
    entry%value(1)%text = lower_case(entry%value(1)%text)
    if (any(split_words(row%later) == entry%value(1)%text)) then
      call errors%push_input(entry%value(1)%at, "'"//entry%value(1)%text//"' "//not_available, &
          code="E116")
      return
    end if
    if (is_equals(entry%value(1))) then
      call errors%push_input(entry%value(1)%at, "the law's name is missing", describe(row), &
          code="E121")
      return
    end if
    call add_words(word, entry, 1, 1)
    i = 2
    do while (i <= size(entry%value))
      if (is_pair(entry%value(i))) then
        call add_words(word, entry, i, i)
        i = i + 1
      else if (equals_at(entry, i) .or. .not. equals_at(entry, i + 1)) then
        call errors%push_input(entry%value(i)%at, "'"//entry%value(i)%text// &
            "' is not followed by =value", describe(row), code="E121")
        i = next_parameter(entry, i + 1)
      else if (i + 2 > size(entry%value) .or. equals_at(entry, i + 2) .or. &
          equals_at(entry, i + 3)) then
        call add_words(word, entry, i, i + 1)
        call add_token(word, "", .false., entry%value(i)%at)
        i = i + 2
      else
        call add_words(word, entry, i, i + 2)
        i = i + 3
      end if
    end do
    entry%value = word%item(:word%count)
  end subroutine check_law_outline

  !> Return the first position from `start` on where a parameter or a pair begins.
  pure integer function next_parameter(entry, start) result(k)
    type(entry_t), intent(in) :: entry
    integer, intent(in) :: start

    do k = start, size(entry%value)
      if (is_pair(entry%value(k)) .or. equals_at(entry, k + 1)) return
    end do
  end function next_parameter

  !> Append the words `first` to `last` of an entry's value to a list.
  subroutine add_words(word, entry, first, last)
    type(token_list_t), intent(inout) :: word
    type(entry_t), intent(in) :: entry
    integer, intent(in) :: first, last

    integer :: i

    do i = first, last
      call add_token(word, entry%value(i)%text, entry%value(i)%quoted, entry%value(i)%at)
    end do
  end subroutine add_words

  !> Split a whole law in one pair of quotes into words, as it comes from a parameter.
  subroutine unfold_law(entry, errors)
    type(entry_t), intent(inout) :: entry
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: word
    type(line_t) :: line
    logical :: continues
    integer :: i

    if (.not. entry%value(1)%quoted .or. scan(entry%value(1)%text, " =") == 0) return
    line%file = entry%value(1)%at%file
    line%text = entry%value(1)%text
    call split_line(line, word, continues, errors)
    do i = 1, word%count
      word%item(i)%at = entry%value(1)%at
    end do
    call add_words(word, entry, 2, size(entry%value))
    if (word%count > 0) entry%value = word%item(:word%count)
  end subroutine unfold_law

  !> Whether a word is a value pair `p:Y`.
  pure logical function is_pair(token)
    type(token_t), intent(in) :: token

    is_pair = index(token%text, ":") > 0 .and. .not. token%quoted
  end function is_pair

  !> Whether a word is an equals sign.
  pure logical function is_equals(token)
    type(token_t), intent(in) :: token

    is_equals = token%text == "=" .and. .not. token%quoted
  end function is_equals

  !> Whether word i of a value is an equals sign; false beyond the end.
  pure logical function equals_at(entry, i)
    type(entry_t), intent(in) :: entry
    integer, intent(in) :: i

    equals_at = .false.
    if (i <= size(entry%value)) equals_at = is_equals(entry%value(i))
  end function equals_at

end module dd3_input_law_outline
