!> Text files as lists of lines: any line end, any line length, no control characters.
module dd3_input_text_file
  use dd3_base_kinds, only : i8
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : text_t, to_text
  implicit none
  private
  public :: read_lines, resolve_path, folder_of

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

    character(len=:), allocatable :: content

    call read_content(path, content, error)
    if (allocated(error)) return
    call blank_no_break_spaces(content)
    call split_lines(content, line)
    call refuse_control_characters(line, error)
  end subroutine read_lines

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

  !> Split a text into lines at LF, CR LF or CR; a UTF-8 byte order mark is skipped.
  pure subroutine split_lines(content, line)
    character(len=*), intent(in) :: content
    type(text_t), allocatable, intent(out) :: line(:)

    character(len=*), parameter :: mark = char(239)//char(187)//char(191)
    integer :: start, next, pass, n

    do pass = 1, 2
      n = 0
      start = 1
      if (len(content) >= 3) then
        if (content(:3) == mark) start = 4
      end if
      do while (start <= len(content))
        do next = start, len(content)
          if (content(next:next) == achar(10) .or. content(next:next) == achar(13)) exit
        end do
        n = n + 1
        if (pass == 2) line(n)%s = content(start:next - 1)
        start = next + 1
        if (start > len(content)) exit
        if (content(start - 1:start) == achar(13)//achar(10)) start = start + 1
      end do
      if (pass == 1) allocate (line(n))
    end do
  end subroutine split_lines

  !> Report the first control character other than tab and form feed.
  pure subroutine refuse_control_characters(line, error)
    type(text_t), intent(in) :: line(:)
    type(error_t), allocatable, intent(out) :: error

    character(len=2) :: hex
    integer :: i, j, byte

    do i = 1, size(line)
      do j = 1, len(line(i)%s)
        byte = ichar(line(i)%s(j:j))
        if ((byte < 32 .and. byte /= 9 .and. byte /= 12) .or. byte == 127) then
          write (hex, '(z2.2)') byte
          allocate (error)
          error%message = "not a text file: byte 0x"//hex//" in line "//to_text(i)
          return
        end if
      end do
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
