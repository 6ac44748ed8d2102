! SPDX-License-Identifier: GPL-3.0-or-later
!> Tables of comma-separated values, written row by row.
module dd3_output_csv
  use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
  use dd3_base_kinds, only : wp, i8
  use dd3_base_error, only : error_t
  use dd3_base_file, only : file_t
  use dd3_base_file_system, only : keep_file, part_of, read_file, replace_file
  use dd3_base_text, only : newline, to_text
  implicit none
  private
  public :: table_t, suffix_kept, quoted, short_real

  !> Significant digits of a real number.
  integer, parameter :: digits = 10
  !> Smallest integer with one digit more.
  integer(i8), parameter :: full = 10_i8**int(digits, i8)

  !> Table open for writing.
  type :: table_t
    type(file_t) :: file
    !> Present row: `row(1:length)`.
    character(len=:), allocatable, private :: row
    integer(i8), private :: length = 0
    !> Cells in the row.
    integer, private :: cells = 0
  contains
    procedure :: open => table_open
    procedure :: resume => table_resume
    procedure :: add_text => table_add_text
    procedure :: add_integer => table_add_integer
    procedure :: add_real => table_add_real
    procedure :: add_reals => table_add_reals
    procedure :: take_row => table_take_row
    procedure :: end_row => table_end_row
    procedure :: close => table_close
  end type table_t

contains

  !> Make the file.
  subroutine table_open(self, path, error)
    class(table_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%row = repeat(" ", 1024)
    self%length = 0
    self%cells = 0
    call self%file%create(path, error)
    if (.not. allocated(error)) call self%file%keep_room(error)
  end subroutine table_open

  !> Make the file with the rows of an earlier table up to an increment, the first column. Without
  !> an earlier table of the same columns it begins with the heading alone.
  subroutine table_resume(self, source, path, heading, increment, found, error)
    class(table_t), intent(inout) :: self
    !> Paths of the earlier table and of this one; they may be the same.
    character(len=*), intent(in) :: source, path
    !> Lines before the first row.
    character(len=*), intent(in) :: heading
    !> Increment of the last row to be kept.
    integer, intent(in) :: increment
    !> The rows up to that of the increment are there.
    logical, intent(out) :: found
    !> Set if the file cannot be written; an earlier one is left as it is.
    type(error_t), allocatable, intent(out) :: error

    character(len=:), allocatable :: text
    type(error_t), allocatable :: unreadable
    integer(i8) :: last

    call read_file(source, text, unreadable)
    last = 0
    if (.not. allocated(unreadable)) last = end_of_rows(text, heading, increment)
    found = last > len(heading, i8)
    if (.not. found) text = heading
    if (.not. found) last = len(heading, i8)
    call self%open(part_of(path), error)
    if (.not. allocated(error)) call self%file%put(text(:last), error)
    if (.not. allocated(error)) call self%file%flush(error)
    if (.not. (found .or. allocated(error))) call keep_file(path, suffix_kept(increment))
    if (.not. allocated(error)) call replace_file(path, self%file, error)
  end subroutine table_resume

  !> Return the suffix of the name under which a record is kept that a restart cannot continue.
  function suffix_kept(increment) result(suffix)
    !> Increment of the restart.
    integer, intent(in) :: increment
    character(len=:), allocatable :: suffix

    suffix = ".until_"//to_text(increment)
  end function suffix_kept

  !> Return the length of a table up to the last row of an increment; 0 if the table has another
  !> heading or lacks that increment.
  pure integer(i8) function end_of_rows(text, heading, increment) result(last)
    character(len=*), intent(in) :: text, heading
    integer, intent(in) :: increment

    integer(i8) :: first, next
    integer :: row, status

    last = 0
    first = len(heading, i8) + 1
    if (len(text, i8) < first) return
    if (text(:first - 1) /= heading) return
    do
      next = index(text(first:), newline, kind=i8)
      if (next == 0) exit
      read (text(first:first + scan(text(first:), ",", kind=i8) - 2), *, iostat=status) row
      if (status /= 0) exit
      if (row > increment) exit
      first = first + next
      if (row == increment) last = first - 1
    end do
  end function end_of_rows

  !> Add a cell with text, in quotes where it needs them.
  subroutine table_add_text(self, text)
    class(table_t), intent(inout) :: self
    !> Trailing blanks are left out.
    character(len=*), intent(in) :: text

    if (scan(text, ',"'//achar(10)//achar(13)) > 0) then
      call add_cell(self, quoted(trim(text)))
    else
      call add_cell(self, trim(text))
    end if
  end subroutine table_add_text

  !> Add a cell with an integer.
  subroutine table_add_integer(self, value)
    class(table_t), intent(inout) :: self
    integer, intent(in) :: value
    character(len=12) :: buffer

    write (buffer, '(i0)') value
    call add_cell(self, trim(buffer))
  end subroutine table_add_integer

  !> Add a cell with a real number.
  subroutine table_add_real(self, value)
    class(table_t), intent(inout) :: self
    real(wp), intent(in) :: value
    character(len=24) :: buffer
    integer :: length

    call short_real(value, buffer, length)
    call add_cell(self, buffer(:length))
  end subroutine table_add_real

  !> Add a cell per real number.
  subroutine table_add_reals(self, values)
    class(table_t), intent(inout) :: self
    real(wp), intent(in) :: values(:)
    integer :: i

    do i = 1, size(values)
      call self%add_real(values(i))
    end do
  end subroutine table_add_reals

  !> Append a cell to the row.
  subroutine add_cell(self, text)
    class(table_t), intent(inout) :: self
    !> The cell as written.
    character(len=*), intent(in) :: text
    integer(i8) :: n

    n = len(text, i8)
    if (self%length + n + 2 > len(self%row, i8)) then
      self%row = self%row(:self%length)//repeat(" ", self%length + n + 1024)
    end if
    if (self%cells > 0) then
      self%length = self%length + 1
      self%row(self%length:self%length) = ","
    end if
    self%row(self%length + 1:self%length + n) = text
    self%length = self%length + n
    self%cells = self%cells + 1
  end subroutine add_cell

  !> Return the row, without its end of line, and begin the next.
  subroutine table_take_row(self, row)
    class(table_t), intent(inout) :: self
    character(len=:), allocatable, intent(out) :: row

    row = self%row(:self%length)
    self%length = 0
    self%cells = 0
  end subroutine table_take_row

  !> Write the row and begin the next.
  subroutine table_end_row(self, error)
    class(table_t), intent(inout) :: self
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%row(self%length + 1:self%length + 1) = newline
    call self%file%put(self%row(:self%length + 1), error)
    self%length = 0
    self%cells = 0
  end subroutine table_end_row

  !> Close the file.
  subroutine table_close(self, error)
    class(table_t), intent(inout) :: self
    !> Set if the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%file%close(error)
  end subroutine table_close

  !> Return a text in double quotes, those inside doubled (RFC 4180); ends of lines become blanks.
  pure function quoted(text)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: quoted
    integer :: i

    quoted = '"'
    do i = 1, len(text)
      select case (text(i:i))
      case ('"')
        quoted = quoted//'""'
      case (achar(10), achar(13))
        quoted = quoted//" "
      case default
        quoted = quoted//text(i:i)
      end select
    end do
    quoted = quoted//'"'
  end function quoted

  !> Write a real number with ten significant digits in its shortest form. Internal writes take
  !> several times as long.
  pure subroutine short_real(value, text, length)
    real(wp), intent(in) :: value
    !> `text(1:length)`.
    character(len=24), intent(out) :: text
    integer, intent(out) :: length
    real(wp) :: magnitude
    integer(i8) :: mantissa
    integer :: e

    text = ""
    magnitude = 0.0_wp
    if (ieee_is_nan(value)) then
      text = "nan"
    else if (abs(value) > huge(value)) then
      text = merge("inf ", "-inf", value > 0.0_wp)
    else
      magnitude = abs(value)
      if (magnitude < 1.0e-99_wp) text = "0"
      if (magnitude > 1.0e99_wp) write (text, '(es17.9e3)') value
    end if
    text = adjustl(text)
    length = len_trim(text)
    if (length > 0) return
    e = floor(log10(magnitude))
    mantissa = scaled(magnitude, e)
    if (mantissa >= full .or. mantissa < full/10_i8) then
      e = e + merge(1, -1, mantissa >= full)
      mantissa = scaled(magnitude, e)
    end if
    call put_number(mantissa, e, value < 0.0_wp, text, length)
  end subroutine short_real

  !> Return the first digits of a number as an integer.
  pure integer(i8) function scaled(magnitude, e)
    !> Positive.
    real(wp), intent(in) :: magnitude
    !> Power of ten of its first digit.
    integer, intent(in) :: e

    if (e < digits) then
      scaled = nint(magnitude*10.0_wp**(digits - 1 - e), i8)
    else
      scaled = nint(magnitude/10.0_wp**(e - digits + 1), i8)
    end if
  end function scaled

  !> Write digits with their decimal point, with an exponent only for large and small numbers.
  pure subroutine put_number(mantissa, e, negative, text, length)
    integer(i8), intent(in) :: mantissa
    !> Power of ten of the first digit.
    integer, intent(in) :: e
    logical, intent(in) :: negative
    !> `text(1:length)`.
    character(len=24), intent(out) :: text
    integer, intent(out) :: length
    character(len=digits) :: digit
    integer :: i, n
    integer(i8) :: rest

    rest = mantissa
    do i = digits, 1, -1
      digit(i:i) = achar(iachar("0") + int(mod(rest, 10_i8)))
      rest = rest/10_i8
    end do
    n = verify(digit, "0", back=.true.)
    text = ""
    if (negative) text = "-"
    i = merge(1, 0, negative)
    if (e < -4 .or. e >= digits) then
      text(i + 1:) = digit(1:1)//"."//digit(2:max(2, n))//"e"//exponent_text(e)
    else if (e < 0) then
      text(i + 1:) = "0."//repeat("0", int(-e - 1, i8))//digit(:n)
    else if (n > e + 1) then
      text(i + 1:) = digit(:e + 1)//"."//digit(e + 2:n)
    else
      text(i + 1:) = digit(:e + 1)
    end if
    length = len_trim(text)
  end subroutine put_number

  !> Return an exponent with its sign and two digits.
  pure function exponent_text(e) result(text)
    !> At most two digits.
    integer, intent(in) :: e
    character(len=3) :: text

    text = merge("-", "+", e < 0)//achar(iachar("0") + abs(e)/10) &
           //achar(iachar("0") + mod(abs(e), 10))
  end function exponent_text

end module dd3_output_csv
