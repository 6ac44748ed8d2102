! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of the numbers in a value: type, range, how many.
module dd3_input_number_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_parameter, only : parameter_t, in_range, kind_real, kind_integer, kind_integers
  use dd3_base_text, only : to_text
  use dd3_input_block, only : entry_t, token_t
  use dd3_input_describe, only : describe
  use dd3_input_number, only : parse_real, parse_integer
  implicit none
  private
  public :: check_numbers, check_range, check_count, add_real, add_integer, not_a_number

contains

  !> Check the numbers of an entry.
  subroutine check_numbers(entry, row, errors)
    type(entry_t), intent(inout) :: entry
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    integer :: i, required, before

    before = errors%count
    do i = 1, size(entry%value)
      if (row%kind == kind_integer .or. row%kind == kind_integers) then
        call add_integer(entry, entry%value(i), describe(row), errors)
      else
        call add_real(entry, entry%value(i), describe(row), errors)
      end if
      if (errors%count > before) cycle
      call check_range(entry%number(i), row, entry%value(i)%at, describe(row), errors)
    end do
    if (errors%count > before) return
    required = row%count
    if (row%kind == kind_real .or. row%kind == kind_integer) required = 1
    call check_count(entry, required, describe(row), errors)
  end subroutine check_numbers

  !> Check the number of values in an entry.
  subroutine check_count(entry, required, expected, errors)
    type(entry_t), intent(in) :: entry
    !> Number of values required; 0 for any number.
    integer, intent(in) :: required
    character(len=*), intent(in) :: expected
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: values
    integer :: given

    given = size(entry%value)
    if (required == 0 .or. given == required) return
    values = " values"
    if (required == 1) values = " value"
    ! The caret is below the first excess value or, if some are missing, below the last one.
    call errors%push_input(entry%value(min(given, required + 1))%at, "expected "// &
        to_text(required)//values//", got "//to_text(given), expected, code="E132")
  end subroutine check_count

  !> Append a word as a real number to the numbers of an entry.
  subroutine add_real(entry, token, expected, errors)
    type(entry_t), intent(inout) :: entry
    type(token_t), intent(in) :: token
    character(len=*), intent(in) :: expected
    type(error_list_t), intent(inout) :: errors

    real(wp) :: value
    logical :: ok

    call parse_real(token%text, value, ok)
    if (ok) then
      call entry%add_number(value)
    else
      call errors%push_input(token%at, not_a_number(token%text), expected, code="E131")
    end if
  end subroutine add_real

  !> Return the message for a word that is not a number.
  pure function not_a_number(word) result(text)
    character(len=*), intent(in) :: word
    character(len=:), allocatable :: text

    text = "'"//word//"' is not a number"
    if (index(word, ",") > 0) then
      text = text//": use a decimal point, and blanks between values"
    else if (verify(word, "+-.0123456789eEdD") == 0 .and. scan(word, "eEdD") > 1) then
      text = "'"//word//"' is not a representable number"
    end if
  end function not_a_number

  !> Append a word as an integer to the numbers of an entry.
  subroutine add_integer(entry, token, expected, errors)
    type(entry_t), intent(inout) :: entry
    type(token_t), intent(in) :: token
    character(len=*), intent(in) :: expected
    type(error_list_t), intent(inout) :: errors

    integer :: value
    logical :: ok

    call parse_integer(token%text, value, ok)
    if (ok) then
      call entry%add_number(real(value, wp))
    else
      call errors%push_input(token%at, not_an_integer(token%text), expected, code="E131")
    end if
  end subroutine add_integer

  !> Return the message for a word that is not an integer.
  pure function not_an_integer(word) result(text)
    character(len=*), intent(in) :: word
    character(len=:), allocatable :: text

    text = "'"//word//"' is not an integer"
    if (len(word) > 9 .and. verify(word, "+-0123456789") == 0) then
      text = "'"//word//"' is not a representable integer"
    end if
  end function not_an_integer

  !> Check a number against its row's bounds.
  subroutine check_range(value, row, at, expected, errors)
    real(wp), intent(in) :: value
    type(parameter_t), intent(in) :: row
    !> Where the number is written.
    type(location_t), intent(in) :: at
    character(len=*), intent(in) :: expected
    type(error_list_t), intent(inout) :: errors

    if (in_range(row, value)) return
    call errors%push_input(at, trim(row%name)//" = "//to_text(value)//" is out of range", &
        expected, code="E133")
  end subroutine check_range

end module dd3_input_number_check
