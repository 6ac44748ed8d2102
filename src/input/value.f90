! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of a key's value against its row: form, type, range, known words.
module dd3_input_value
  use dd3_base_error, only : error_list_t
  use dd3_base_parameter, only : parameter_t, kind_real, kind_integer, kind_reals, kind_integers, &
      kind_law, kind_other
  use dd3_base_text, only : same_name
  use dd3_input_block, only : entry_t
  use dd3_input_describe, only : not_available
  use dd3_input_form_check, only : check_form
  use dd3_input_law_outline, only : check_law_outline
  use dd3_input_number_check, only : check_numbers
  use dd3_input_word_check, only : check_words
  implicit none
  private
  public :: check_value

contains

  !> Check an entry's value and collect its numbers; `entry%valid` is false if an error was added.
  subroutine check_value(entry, row, errors)
    type(entry_t), intent(inout) :: entry
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    integer :: before

    before = errors%count
    allocate (entry%number(0))
    if (size(entry%value) == 0) then
      entry%valid = .false.
      return
    end if
    if (row%later == "*") then
      call errors%push_input(entry%at, "'"//trim(row%name)//"' "//not_available, code="E116")
    else if (row%may_be_off .and. size(entry%value) == 1 .and. &
        same_name(entry%value(1)%text, "off")) then
      entry%is_off = .true.
    else
      select case (row%kind)
      case (kind_real, kind_reals, kind_integer, kind_integers)
        call check_numbers(entry, row, errors)
      case (kind_other)
        call check_form(entry, row, errors)
      case (kind_law)
        call check_law_outline(entry, row, errors)
      case default
        call check_words(entry, row, errors)
      end select
    end if
    call entry%trim_numbers()
    entry%valid = errors%count == before
  end subroutine check_value

end module dd3_input_value
