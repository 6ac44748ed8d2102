! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of the words in a value: on and off, names, options, texts.
module dd3_input_word_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : as_written, error_list_t
  use dd3_base_parameter, only : parameter_t, kind_logical, kind_text, kind_names
  use dd3_base_text, only : lower_case, same_name, suggestion
  use dd3_input_block, only : entry_t, token_t
  use dd3_input_describe, only : describe, split_words, word_length, not_available
  use dd3_input_number_check, only : check_count
  implicit none
  private
  public :: check_words, check_known_word

  !> More than there are choices for any key: further words are wrong or repeated among these.
  integer, parameter :: most_compared = 100

contains

  !> Check the words of an entry and bring names to lower case.
  subroutine check_words(entry, row, errors)
    type(entry_t), intent(inout) :: entry
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    integer :: i, required, before

    before = errors%count
    required = 1
    if (row%kind == kind_names) required = row%count
    call check_count(entry, required, describe(row), errors)
    if (errors%count > before .and. row%kind /= kind_names) return
    if (row%kind == kind_text) then
      if (entry%value(1)%text == "") then
        call errors%push_input(entry%value(1)%at, "the text is empty", describe(row), code="E133")
      end if
    else if (row%kind == kind_logical) then
      call check_switch(entry, row, errors)
    else
      do i = 1, size(entry%value)
        entry%value(i)%text = lower_case(entry%value(i)%text)
        call check_choice(entry%value(i), row, errors)
        if (occurs_before(entry, i)) call errors%push_input(entry%value(i)%at, "'"// &
            as_written(entry%value(i)%text, entry%value(i)%at)//"' is given twice", code="E122")
      end do
    end if
  end subroutine check_words

  !> Check a value that is on or off; its number is then 1 or 0.
  subroutine check_switch(entry, row, errors)
    type(entry_t), intent(inout) :: entry
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: text

    text = lower_case(entry%value(1)%text)
    select case (text)
    case ("on", "yes", "true")
      call entry%add_number(1.0_wp)
    case ("off", "no", "false")
      call entry%add_number(0.0_wp)
    case default
      call errors%push_input(entry%value(1)%at, "expected on or off, got '"// &
          entry%value(1)%text//"'", describe(row), code="E114")
    end select
  end subroutine check_switch

  !> Whether a word of a value also stands before position i, among the first `most_compared` words.
  pure logical function occurs_before(entry, i)
    type(entry_t), intent(in) :: entry
    integer, intent(in) :: i

    integer :: j

    occurs_before = .false.
    do j = 1, min(i - 1, most_compared)
      occurs_before = entry%value(j)%text == entry%value(i)%text
      if (occurs_before) return
    end do
  end function occurs_before

  !> Check a word against the row's choices.
  subroutine check_choice(token, row, errors)
    type(token_t), intent(in) :: token
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    if (len(token%text) <= word_length .and. any(split_words(row%later) == token%text)) then
      call errors%push_input(token%at, "'"//as_written(token%text, token%at)//"' "// &
          not_available, describe(row), code="E116")
    else if (row%choices /= "") then
      call check_known_word(token, split_words(row%choices), describe(row), errors)
    end if
  end subroutine check_choice

  !> Report a word that is not among the known ones.
  subroutine check_known_word(token, known, expected, errors)
    type(token_t), intent(in) :: token
    character(len=*), intent(in) :: known(:)
    character(len=*), intent(in) :: expected
    type(error_list_t), intent(inout) :: errors

    integer :: i

    do i = 1, size(known)
      if (same_name(known(i), token%text)) return
    end do
    call errors%push_input(token%at, "unknown word '"//as_written(token%text, token%at)//"'"// &
        suggestion(token%text, known), expected, code="E114")
  end subroutine check_known_word

end module dd3_input_word_check
