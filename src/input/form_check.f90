! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of values that have a form of their own, given by `form` in the keyword's row.
module dd3_input_form_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : as_written, error_list_t
  use dd3_base_parameter, only : parameter_t
  use dd3_base_text, only : lower_case, slice
  use dd3_input_block, only : entry_t, token_t
  use dd3_input_describe, only : describe, split_words, word_length
  use dd3_input_number, only : parse_integer
  use dd3_input_number_check, only : add_real, add_integer
  use dd3_input_table, only : axis_of
  use dd3_input_word_check, only : check_known_word
  implicit none
  private
  public :: check_form, form_for

contains

  !> Check a value against the form of its row.
  subroutine check_form(entry, row, errors)
    type(entry_t), intent(inout) :: entry
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    character(len=word_length), allocatable :: form(:)
    character(len=word_length) :: form_word
    integer :: i, k, before
    logical :: repeats

    before = errors%count
    form = form_for(entry, row)
    k = 1
    repeats = .false.
    do i = 1, size(entry%value)
      if (k > size(form)) then
        call errors%push_input(entry%value(i)%at, "unexpected value '"//entry%value(i)%text// &
            "'", describe(row), code="E132")
        return
      end if
      form_word = form(k)
      repeats = index(form_word, "...") > 0
      if (repeats) form_word = form_word(:index(form_word, "...") - 1)
      call check_form_word(entry, i, form_word, row, errors)
      if (errors%count > before) return
      if (.not. repeats) k = k + 1
    end do
    if (repeats .or. k > size(form)) return
    if (form(k)(1:1) == "[") return
    call errors%push_input(entry%value(size(entry%value))%at, &
        "a value is missing after this: "//trim(form(k)), describe(row), code="E121")
  end subroutine check_form

  !> Check one word of a value against one word of the form.
  subroutine check_form_word(entry, i, form_word, row, errors)
    type(entry_t), intent(inout) :: entry
    !> Position of the word.
    integer, intent(in) :: i
    !> Word of the form.
    character(len=*), intent(in) :: form_word
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: text

    text = lower_case(entry%value(i)%text)
    select case (form_word)
    case ("number")
      call add_real(entry, entry%value(i), describe(row), errors)
    case ("count")
      call add_count(entry, entry%value(i), row, errors)
    case ("axis")
      call entry%add_number(real(axis_of(text), wp))
      if (axis_of(text) == 0) call errors%push_input(entry%value(i)%at, "'"// &
          as_written(text, entry%value(i)%at)//"' is not an axis: expected x, y or z", &
          describe(row), code="E114")
    case ("range")
      call add_range(entry, entry%value(i), row, errors)
    case ("set", "tool", "material")
      entry%value(i)%text = text
    case default
      call check_known_word(entry%value(i), literals(form_word), describe(row), errors)
      entry%value(i)%text = text
    end select
  end subroutine check_form_word

  !> Return the words that may stand for a literal word of the form: `word`, `[word]`, `word|word`.
  pure function literals(form_word) result(known)
    character(len=*), intent(in) :: form_word
    character(len=word_length), allocatable :: known(:)

    character(len=len(form_word)) :: plain
    integer :: i

    plain = form_word
    do i = 1, len(form_word)
      if (scan(form_word(i:i), "[]|") > 0) plain(i:i) = " "
    end do
    known = split_words(plain)
  end function literals

  !> Append a positive integer to the numbers of an entry.
  subroutine add_count(entry, token, row, errors)
    type(entry_t), intent(inout) :: entry
    type(token_t), intent(in) :: token
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    integer :: before

    before = errors%count
    call add_integer(entry, token, describe(row), errors)
    if (errors%count > before) return
    if (entry%number(entry%n_number) >= 1.0_wp) return
    call errors%push_input(token%at, "'"//token%text// &
        "' is out of range: expected at least 1", describe(row), code="E133")
  end subroutine add_count

  !> Append a range of node numbers, `n` or `n-m`, to the numbers of an entry: first and last.
  subroutine add_range(entry, token, row, errors)
    type(entry_t), intent(inout) :: entry
    type(token_t), intent(in) :: token
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    integer :: dash, first, last
    logical :: ok, last_ok

    dash = index(token%text, "-")
    if (dash == 0) then
      call parse_integer(token%text, first, ok)
      last = first
    else
      call parse_integer(slice(token%text, 1, dash - 1), first, ok)
      call parse_integer(slice(token%text, dash + 1, len(token%text)), last, last_ok)
      ok = ok .and. last_ok
    end if
    if (ok) ok = first >= 1 .and. last >= first
    if (ok) then
      call entry%add_number(real(first, wp))
      call entry%add_number(real(last, wp))
    else
      call errors%push_input(token%at, "'"//token%text//"' is not a range of node numbers", &
          describe(row), code="E114")
    end if
  end subroutine add_range

  !> Return the words of the alternative form a value is meant for: the one that begins with the
  !> value's first word, or else the first one.
  function form_for(entry, row) result(form)
    type(entry_t), intent(in) :: entry
    type(parameter_t), intent(in) :: row
    character(len=word_length), allocatable :: form(:)

    character(len=word_length), allocatable :: all_words(:)
    character(len=:), allocatable :: given
    integer :: i, first, last

    all_words = split_words(row%form, "/")
    first = 1
    given = lower_case(entry%value(1)%text)
    do i = 1, size(all_words)
      if (all_words(i) == "/") first = i + 1
      if (i == first .and. all_words(i) == given) exit
    end do
    if (i > size(all_words)) first = 1
    last = first
    do while (last < size(all_words))
      if (all_words(last + 1) == "/") exit
      last = last + 1
    end do
    form = all_words(first:last)
  end function form_for

end module dd3_input_form_check
