! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: the input as read, from the keyword table.
module dd3_run_file_input
  use dd3_base_error, only : location_t
  use dd3_base_json, only : json_t
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : parameter_t, kind_integer, kind_integers, kind_law, kind_logical, &
      kind_name, kind_real, kind_reals, kind_text
  use dd3_input_block, only : block_t, entry_t
  use dd3_input_case, only : case_t
  use dd3_input_echo, only : entry_words
  use dd3_input_number, only : parse_real
  use dd3_input_table, only : block_row_t, block_table, find_block, find_key
  implicit none
  private
  public :: add_input, add_location

contains

  !> Add the files read and all blocks with their values, given or by default.
  subroutine add_input(json, case)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case

    type(block_row_t), allocatable :: table(:)
    integer :: i, row

    table = block_table()
    call json%begin_object("input")
    call json%begin_array("files", flat=.true.)
    do i = 1, size(case%deck%file)
      call json%add("", case%deck%file(i)%s)
    end do
    call json%end_array()
    call json%begin_array("blocks")
    do i = 1, case%deck%n_block
      row = find_block(table, case%deck%block(i)%keyword)
      if (row > 0) call add_block(json, case%deck%block(i), table(row)%key)
    end do
    call json%end_array()
    call json%end_object()
  end subroutine add_input

  !> Add a block.
  subroutine add_block(json, block, key)
    type(json_t), intent(inout) :: json
    type(block_t), intent(in) :: block
    !> Rows of its keys.
    type(parameter_t), intent(in) :: key(:)

    integer :: i

    call json%begin_object("")
    call json%add("keyword", block%keyword)
    call json%add("name", block%name)
    call add_location(json, "at", block%opened)
    call json%begin_array("entries")
    do i = 1, block%n_entry
      call add_entry(json, block%entry(i), key)
    end do
    call json%end_array()
    call json%end_object()
  end subroutine add_block

  !> Add a key with its value.
  subroutine add_entry(json, entry, key)
    type(json_t), intent(inout) :: json
    type(entry_t), intent(in) :: entry
    !> Rows of the block's keys.
    type(parameter_t), intent(in) :: key(:)

    type(location_t) :: at
    integer :: k

    call json%begin_object("", flat=.true.)
    call json%add("key", entry%key)
    k = find_key(key, entry%key)
    if (k > 0) then
      call add_value(json, entry, key(k)%kind)
    else
      call json%add("value", entry_words(entry))
    end if
    call json%add("text", entry_words(entry))
    if (k > 0) call json%add("unit", trim(key(k)%unit))
    if (k == 0) call json%add("unit", "")
    call json%add("default", entry%defaulted)
    if (.not. entry%defaulted) at = entry%at
    call add_location(json, "at", at)
    call json%end_object()
  end subroutine add_entry

  !> Add a value by its kind.
  subroutine add_value(json, entry, kind)
    type(json_t), intent(inout) :: json
    type(entry_t), intent(in) :: entry
    !> One of the `kind_*` values.
    integer, intent(in) :: kind

    integer :: i

    if (entry%is_off .or. .not. entry%valid) then
      call json%add("value", entry_words(entry))
      return
    end if
    select case (kind)
    case (kind_real, kind_integer)
      call json%add("value", entry%number(1))
    case (kind_logical)
      call json%add("value", entry%number(1) > 0.5_wp)
    case (kind_name, kind_text)
      call json%add("value", entry%value(1)%text)
    case (kind_law)
      call json%add("value", entry_words(entry))
    case (kind_reals, kind_integers)
      call json%add("value", entry%number)
    case default
      call json%begin_array("value", flat=.true.)
      do i = 1, size(entry%value)
        if (entry%value(i)%text /= "=") call add_word(json, entry%value(i)%text)
      end do
      call json%end_array()
    end select
  end subroutine add_value

  !> Add a word, as a number if it is one.
  subroutine add_word(json, word)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: word

    real(wp) :: value
    logical :: is_number

    call parse_real(word, value, is_number)
    if (is_number) then
      call json%add("", value)
    else
      call json%add("", word)
    end if
  end subroutine add_word

  !> Add a place in the input; null if there is none.
  subroutine add_location(json, name, at)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    type(location_t), intent(in) :: at

    if (.not. allocated(at%file)) then
      call json%add_null(name)
      return
    end if
    call json%begin_object(name, flat=.true.)
    call json%add("file", at%file)
    call json%add("line", at%line)
    call json%add("column", at%column)
    call json%end_object()
  end subroutine add_location

end module dd3_run_file_input
