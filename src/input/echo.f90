! SPDX-License-Identifier: GPL-3.0-or-later
!> The checked input as text, with all defaults filled in and marked, for the log and `--check`.
module dd3_input_echo
  use dd3_base_kinds, only : i8
  use dd3_base_text, only : text_buffer_t, newline, upper_case
  use dd3_input_block, only : block_t, entry_t
  use dd3_input_case, only : case_t
  use dd3_input_table, only : block_row_t, block_table, find_block, find_key
  implicit none
  private
  public :: echo_case, entry_words

  !> Column of the remarks (unit, default).
  integer, parameter :: remark_column = 52

contains

  !> Return the whole case as text; all lines end in a newline.
  function echo_case(case) result(text)
    type(case_t), intent(in) :: case
    character(len=:), allocatable :: text

    type(text_buffer_t) :: buffer
    type(block_row_t), allocatable :: table(:)
    integer :: i, row

    table = block_table()
    do i = 1, case%deck%n_block
      row = find_block(table, case%deck%block(i)%keyword)
      if (row > 0) call buffer%add(echo_block(case%deck%block(i), table(row)))
    end do
    text = buffer%text()
  end function echo_case

  function echo_block(block, row) result(text)
    type(block_t), intent(in) :: block
    type(block_row_t), intent(in) :: row
    character(len=:), allocatable :: text

    type(text_buffer_t) :: buffer
    integer :: i, k

    call buffer%add(trim("*"//upper_case(block%keyword)//" "//block%name)//newline)
    do i = 1, block%n_entry
      k = find_key(row%key, block%entry(i)%key)
      if (k > 0) then
        call buffer%add(echo_entry(block%entry(i), trim(row%key(k)%unit)))
      else
        call buffer%add("  "//entry_words(block%entry(i))//newline)
      end if
    end do
    text = buffer%text()
  end function echo_block

  function echo_entry(entry, unit) result(text)
    type(entry_t), intent(in) :: entry
    !> Unit of its numbers.
    character(len=*), intent(in) :: unit
    character(len=:), allocatable :: text

    character(len=:), allocatable :: remark
    integer(i8) :: gap

    text = "  "//entry%key//" = "//entry_words(entry)
    remark = ""
    if (unit /= "") remark = unit
    if (entry%defaulted .and. remark /= "") remark = remark//", default"
    if (entry%defaulted .and. remark == "") remark = "default"
    if (remark /= "") then
      gap = int(max(1, remark_column - len(text)), i8)
      text = text//repeat(" ", gap)//"# "//remark
    end if
    text = text//newline
  end function echo_entry

  !> Return a value as it would be written.
  function entry_words(entry) result(text)
    type(entry_t), intent(in) :: entry
    character(len=:), allocatable :: text

    type(text_buffer_t) :: buffer
    logical :: glued
    integer :: i

    glued = .true.
    do i = 1, size(entry%value)
      associate (word => entry%value(i)%text)
        if (entry%value(i)%quoted .and. entry%key /= "text") then
          if (.not. glued) call buffer%add(" ")
          call buffer%add('"'//word//'"')
          glued = .false.
        else if (word == "=") then
          call buffer%add(word)
          glued = .true.
        else
          if (.not. glued) call buffer%add(" ")
          call buffer%add(word)
          glued = .false.
        end if
      end associate
    end do
    text = buffer%text()
  end function entry_words

end module dd3_input_echo
