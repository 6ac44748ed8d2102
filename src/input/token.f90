! SPDX-License-Identifier: GPL-3.0-or-later
!> Splits a line of the input into words with their locations.
module dd3_input_token
  use dd3_base_error, only : location_t, error_list_t
  use dd3_base_text, only : slice
  use dd3_input_block, only : token_t
  implicit none
  private
  public :: line_t, token_list_t, place, split_line, add_token

  !> Number of characters shown of a long line.
  integer, parameter :: shown = 160
  !> Characters that separate words.
  character(len=*), parameter :: blanks = " "//achar(9)//achar(12)

  !> One line of an input file.
  type :: line_t
    !> Name of the file as given by the user.
    character(len=:), allocatable :: file
    !> Line number, from 1.
    integer :: number = 0
    !> Position in the whole text with included files inserted.
    integer :: order = 0
    character(len=:), allocatable :: text
  end type line_t

  !> A list of words.
  type :: token_list_t
    integer :: count = 0
    !> Words, `item(1:count)`.
    type(token_t), allocatable :: item(:)
  end type token_list_t

contains

  !> Return the location of part of a line; only the text around it is kept of a long line.
  pure function place(line, column, width) result(location)
    type(line_t), intent(in) :: line
    !> First character, from 1.
    integer, intent(in) :: column
    !> Number of characters.
    integer, intent(in) :: width
    type(location_t) :: location

    integer :: start

    location%file = line%file
    location%line = line%number
    location%order = line%order
    location%column = column
    location%width = width
    if (len(line%text) <= shown) then
      location%text = line%text
      return
    end if
    start = max(1, min(column - shown/3, len(line%text) - shown + 1))
    location%column = column - start + 1
    location%text = slice(line%text, start, start + shown - 1)
    location%width = min(width, shown - location%column + 1)
    if (start > 1) location%text(:3) = "..."
    if (start + shown - 1 < len(line%text)) location%text(shown - 2:) = "..."
  end function place

  !> Split a line into words. Words are separated by blanks; an equals sign is a word of its own; a
  !> word in quotes may contain blanks; # or ! begins a comment; an ampersand at the end continues
  !> the line on the next one.
  subroutine split_line(line, token, continues, errors)
    type(line_t), intent(in) :: line
    !> The words are appended.
    type(token_list_t), intent(inout) :: token
    !> Whether the line is continued on the next one.
    logical, intent(out) :: continues
    type(error_list_t), intent(inout) :: errors

    integer :: start, last

    continues = .false.
    last = 0
    do
      start = last + 1
      if (start > len(line%text)) return
      if (index(blanks, line%text(start:start)) > 0) then
        last = start
        cycle
      end if
      select case (line%text(start:start))
      case ("#", "!")
        return
      case ("'", '"')
        last = closing_quote(line%text, start)
        if (last == 0) then
          call errors%push_input(place(line, start, len_trim(line%text) - start + 1), &
              "unclosed quote", "a second "//line%text(start:start)//" on the same line", &
              code="E103")
          return
        end if
        call add_token(token, slice(line%text, start + 1, last - 1), .true., place(line, start, &
            last - start + 1))
      case ("=")
        last = start
        call add_token(token, "=", .false., place(line, start, 1))
      case default
        last = word_end(line%text, start)
        if (ends_in_ampersand(line%text, last)) then
          continues = .true.
          last = last - 1
        end if
        if (last >= start) then
          call add_token(token, slice(line%text, start, last), .false., place(line, start, &
              last - start + 1))
        end if
        if (continues) return
      end select
    end do
  end subroutine split_line

  !> Return the position of the quote that closes the one at `start`; 0 if there is none.
  pure integer function closing_quote(text, start) result(last)
    character(len=*), intent(in) :: text
    integer, intent(in) :: start

    last = index(text(start + 1:), text(start:start))
    if (last > 0) last = start + last
  end function closing_quote

  !> Return the position of the last character of the word that begins at `start`.
  pure integer function word_end(text, start) result(last)
    character(len=*), intent(in) :: text
    integer, intent(in) :: start

    last = scan(text(start:), blanks//"=#!")
    if (last == 0) then
      last = len(text)
    else
      last = start + last - 2
    end if
  end function word_end

  !> Whether the word up to `last` ends in an ampersand, followed only by blanks or a comment.
  pure logical function ends_in_ampersand(text, last)
    character(len=*), intent(in) :: text
    integer, intent(in) :: last

    integer :: next

    ends_in_ampersand = text(last:last) == "&"
    if (.not. ends_in_ampersand) return
    next = verify(text(last + 1:), blanks)
    if (next > 0) ends_in_ampersand = scan(text(last + next:last + next), "#!") == 1
  end function ends_in_ampersand

  !> Append a word to a list.
  subroutine add_token(token, text, quoted, at)
    type(token_list_t), intent(inout) :: token
    character(len=*), intent(in) :: text
    logical, intent(in) :: quoted
    type(location_t), intent(in) :: at

    type(token_t), allocatable :: larger(:)
    integer :: i

    if (.not. allocated(token%item)) allocate (token%item(16))
    if (token%count == size(token%item)) then
      allocate (larger(2*token%count))
      do i = 1, token%count
        call move_alloc(token%item(i)%text, larger(i)%text)
        larger(i)%quoted = token%item(i)%quoted
        call move_location(token%item(i)%at, larger(i)%at)
      end do
      call move_alloc(larger, token%item)
    end if
    token%count = token%count + 1
    token%item(token%count)%text = text
    token%item(token%count)%quoted = quoted
    token%item(token%count)%at = at
  end subroutine add_token

  !> Move a location without copying its texts.
  subroutine move_location(from, to)
    type(location_t), intent(inout) :: from
    type(location_t), intent(out) :: to

    call move_alloc(from%file, to%file)
    call move_alloc(from%text, to%text)
    to%line = from%line
    to%column = from%column
    to%width = from%width
    to%order = from%order
  end subroutine move_location

end module dd3_input_token
