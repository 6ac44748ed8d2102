! SPDX-License-Identifier: GPL-3.0-or-later
!> Text files as lists of lines: any line end, any line length, no control characters.
module dd3_input_text_file
  use dd3_base_kinds, only : i8
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : text_t, to_text
  implicit none
  private
  public :: read_lines, read_text, clean_text, split_lines, next_line, resolve_path, folder_of

  !> Maximum size of an input file, bytes.
  integer(i8), parameter :: largest_file = 200000000

contains

  !> Read a whole text file.
  subroutine read_lines(path, line, error)
    character(len=*), intent(in) :: path
    !> Lines without line ends.
    type(text_t), allocatable, intent(out) :: line(:)
    !> Set if the file cannot be read.
    type(error_t), allocatable, intent(out) :: error

    character(len=:), allocatable :: text

    call read_text(path, text, error)
    if (.not. allocated(error)) call split_lines(text, line)
  end subroutine read_lines

  !> Split a text into its lines, without line ends.
  pure subroutine split_lines(text, line)
    character(len=*), intent(in) :: text
    type(text_t), allocatable, intent(out) :: line(:)

    integer :: first, last, next, pass, n

    do pass = 1, 2
      n = 0
      next = 1
      do while (next <= len(text))
        call next_line(text, next, first, last)
        n = n + 1
        if (pass == 2) line(n)%s = text(first:last)
      end do
      if (pass == 1) allocate (line(n))
    end do
  end subroutine split_lines

  !> Read the text of a file, without a UTF-8 byte order mark, for `next_line`.
  subroutine read_text(path, text, error)
    character(len=*), intent(in) :: path
    character(len=:), allocatable, intent(out) :: text
    !> Set if the file cannot be read.
    type(error_t), allocatable, intent(out) :: error

    call read_content(path, text, error)
    if (.not. allocated(error)) call clean_text(text, error)
  end subroutine read_text

  !> Remove the byte order mark of a text, blank its no-break spaces, refuse control characters.
  pure subroutine clean_text(text, error)
    character(len=:), allocatable, intent(inout) :: text
    !> Set if there are control characters.
    type(error_t), allocatable, intent(out) :: error

    character(len=*), parameter :: mark = char(239)//char(187)//char(191)

    call blank_no_break_spaces(text)
    if (text(:min(len(mark), len(text))) == mark) text = text(len(mark) + 1:)
    call refuse_control_characters(text, error)
  end subroutine clean_text

  !> Find the line that begins at `next`; lines end at LF, CR LF or CR.
  pure subroutine next_line(text, next, first, last)
    character(len=*), intent(in) :: text
    !> At most the length of the text on entry; the first character behind the line end on return.
    integer, intent(inout) :: next
    !> First and last character of the line; last < first if it is empty.
    integer, intent(out) :: first, last

    first = next
    do next = first, len(text)
      if (text(next:next) == achar(10) .or. text(next:next) == achar(13)) exit
    end do
    last = next - 1
    next = next + 1
    if (next > len(text)) return
    if (text(next - 1:next) == achar(13)//achar(10)) next = next + 1
  end subroutine next_line

  !> Read all bytes of a file.
  subroutine read_content(path, content, error)
    character(len=*), intent(in) :: path
    character(len=:), allocatable, intent(out) :: content
    !> Set if the file cannot be read.
    type(error_t), allocatable, intent(out) :: error

    integer(i8) :: length
    integer :: unit, status
    character(len=1) :: byte
    logical :: there

    inquire (file=path//"/.", exist=there)
    if (there) then
      call fatal_error(error, "is a directory")
      return
    end if
    inquire (file=path, exist=there)
    if (.not. there) then
      call fatal_error(error, "no such file")
      return
    end if
    open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
        action="read", iostat=status)
    if (status /= 0) then
      call fatal_error(error, "cannot open it for reading")
      return
    end if
    inquire (unit=unit, size=length)
    if (length > largest_file) then
      call fatal_error(error, "too large for an input file")
    else
      allocate (character(len=max(0_i8, length)) :: content)
      if (length > 0) read (unit, iostat=status) content
      if (status /= 0) call fatal_error(error, "read error")
      if (length <= 0) read (unit, iostat=status) byte
      if (length <= 0 .and. status == 0) call fatal_error(error, &
          "a pipe or a device, expected a regular file")
    end if
    ! allow(C181)
    close (unit, iostat=status)
  end subroutine read_content

  !> Replace the no-break spaces of UTF-8, as in text copied from a web page, by two blanks each.
  pure subroutine blank_no_break_spaces(content)
    character(len=*), intent(inout) :: content

    integer :: i

    do i = 1, len(content) - 1
      if (content(i:i + 1) == char(194)//char(160)) content(i:i + 1) = "  "
    end do
  end subroutine blank_no_break_spaces

  !> Report the first control character other than line ends, tab and form feed.
  pure subroutine refuse_control_characters(text, error)
    character(len=*), intent(in) :: text
    type(error_t), allocatable, intent(out) :: error

    character(len=2) :: hex
    integer :: i, byte, number, next, first, last

    do i = 1, len(text)
      byte = ichar(text(i:i))
      if (byte < 32) then
        if (byte == 10 .or. byte == 13 .or. byte == 9 .or. byte == 12) cycle
      else if (byte /= 127) then
        cycle
      end if
      number = 0
      next = 1
      do while (next <= i)
        call next_line(text, next, first, last)
        number = number + 1
      end do
      write (hex, '(z2.2)') byte
      allocate (error)
      error%message = "not a text file: byte 0x"//hex//" in line "//to_text(number)
      return
    end do
  end subroutine refuse_control_characters

  !> Return the folder part of a path with its slash; empty if there is none.
  pure function folder_of(path) result(folder)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: folder

    folder = path(:index(path, "/", back=.true.))
  end function folder_of

  !> Return a path that is written relative to a folder.
  pure function resolve_path(folder, path) result(resolved)
    !> With a slash at the end, or empty.
    character(len=*), intent(in) :: folder
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: resolved

    resolved = folder//path
    if (index(path, "/") == 1) resolved = path
  end function resolve_path

end module dd3_input_text_file
