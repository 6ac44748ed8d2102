!> Tables of comma-separated values, written row by row.
module dd3_output_csv
  use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
  use dd3_base_kinds, only : wp, i8
  use dd3_base_error, only : error_t
  use dd3_base_file, only : file_t
  use dd3_base_text, only : newline
  implicit none
  private
  public :: table_t, quoted, short_real

  !> Significant digits of a real number.
  integer, parameter :: digits = 10
  !> The least whole number with one digit more.
  integer(i8), parameter :: full = 10_i8**int(digits, i8)

  !> A table open for writing.
  type :: table_t
    !> The file.
    type(file_t) :: file
    !> The row begun: `row(1:length)`.
    character(len=:), allocatable, private :: row
    !> Characters in the row.
    integer(i8), private :: length = 0
    !> Number of its cells.
    integer, private :: cells = 0
  contains
    procedure :: open => table_open
    procedure :: add_text => table_add_text
    procedure :: add_integer => table_add_integer
    procedure :: add_real => table_add_real
    procedure :: add_reals => table_add_reals
    procedure :: take_row => table_take_row
    procedure :: end_row => table_end_row
    procedure :: close => table_close
  end type table_t

contains

  !> Makes the file.
  subroutine table_open(self, path, error)
    !> The table.
    class(table_t), intent(inout) :: self
    !> Name of the file.
    character(len=*), intent(in) :: path
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%row = repeat(" ", 1024)
    self%length = 0
    self%cells = 0
    call self%file%create(path, error)
    if (.not. allocated(error)) call self%file%keep_room(error)
  end subroutine table_open

  !> Adds a cell with text, in quotes where it needs them.
  subroutine table_add_text(self, text)
    !> The table.
    class(table_t), intent(inout) :: self
    !> The text; trailing blanks are left out.
    character(len=*), intent(in) :: text

    if (scan(text, ',"'//achar(10)//achar(13)) > 0) then
      call add_cell(self, quoted(trim(text)))
    else
      call add_cell(self, trim(text))
    end if
  end subroutine table_add_text

  !> Adds a cell with a whole number.
  subroutine table_add_integer(self, value)
    !> The table.
    class(table_t), intent(inout) :: self
    !> The number.
    integer, intent(in) :: value
    character(len=12) :: buffer

    write (buffer, '(i0)') value
    call add_cell(self, trim(buffer))
  end subroutine table_add_integer

  !> Adds a cell with a real number.
  subroutine table_add_real(self, value)
    !> The table.
    class(table_t), intent(inout) :: self
    !> The number.
    real(wp), intent(in) :: value
    character(len=24) :: buffer
    integer :: length

    call short_real(value, buffer, length)
    call add_cell(self, buffer(:length))
  end subroutine table_add_real

  !> Adds a cell for each real number.
  subroutine table_add_reals(self, values)
    !> The table.
    class(table_t), intent(inout) :: self
    !> The numbers.
    real(wp), intent(in) :: values(:)
    integer :: i

    do i = 1, size(values)
      call self%add_real(values(i))
    end do
  end subroutine table_add_reals

  !> Puts a cell behind the row.
  subroutine add_cell(self, text)
    !> The table.
    class(table_t), intent(inout) :: self
    !> The cell as it is to stand in the file.
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

  !> Hands out the row, without its end of line, and begins the next.
  subroutine table_take_row(self, row)
    !> The table.
    class(table_t), intent(inout) :: self
    !> The row.
    character(len=:), allocatable, intent(out) :: row

    row = self%row(:self%length)
    self%length = 0
    self%cells = 0
  end subroutine table_take_row

  !> Writes the row and begins the next.
  subroutine table_end_row(self, error)
    !> The table.
    class(table_t), intent(inout) :: self
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%row(self%length + 1:self%length + 1) = newline
    call self%file%put(self%row(:self%length + 1), error)
    self%length = 0
    self%cells = 0
  end subroutine table_end_row

  !> Closes the file.
  subroutine table_close(self, error)
    !> The table.
    class(table_t), intent(inout) :: self
    !> Says why the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%file%close(error)
  end subroutine table_close

  !> The text in double quotes, those inside doubled (RFC 4180); ends of lines become blanks.
  pure function quoted(text)
    !> The text.
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

  !> A real number with ten significant digits, as short as that can be written. Internal writes
  !> take several times as long.
  pure subroutine short_real(value, text, length)
    !> The number.
    real(wp), intent(in) :: value
    !> The text: `text(1:length)`.
    character(len=24), intent(out) :: text
    !> Its length.
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

  !> The number's first digits as a whole number.
  pure integer(i8) function scaled(magnitude, e)
    !> The number, positive.
    real(wp), intent(in) :: magnitude
    !> Power of ten of its first digit.
    integer, intent(in) :: e

    if (e < digits) then
      scaled = nint(magnitude*10.0_wp**(digits - 1 - e), i8)
    else
      scaled = nint(magnitude/10.0_wp**(e - digits + 1), i8)
    end if
  end function scaled

  !> Writes digits with their point: plain where the number is neither large nor small.
  pure subroutine put_number(mantissa, e, negative, text, length)
    !> The digits.
    integer(i8), intent(in) :: mantissa
    !> Power of ten of the first digit.
    integer, intent(in) :: e
    !> Whether a minus stands before them.
    logical, intent(in) :: negative
    !> The text: `text(1:length)`.
    character(len=24), intent(out) :: text
    !> Its length.
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

  !> An exponent with its sign and two digits.
  pure function exponent_text(e) result(text)
    !> The exponent, of at most two digits.
    integer, intent(in) :: e
    character(len=3) :: text

    text = merge("-", "+", e < 0)//achar(iachar("0") + abs(e)/10) &
           //achar(iachar("0") + mod(abs(e), 10))
  end function exponent_text

end module dd3_output_csv
