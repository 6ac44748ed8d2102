! SPDX-License-Identifier: GPL-3.0-or-later
!> Writer of JSON (RFC 8259): objects, arrays, texts, numbers, logicals, null. A number has as many
!> digits as give the same number when it is read; one that is not finite is null. Bytes that are
!> not UTF-8 are replaced.
!>
!> Values are added in their order. The name of a member comes first; it is empty for an element of
!> an array and for the outermost value.
module dd3_base_json
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_kinds, only : i8, wp
  use dd3_base_text, only : newline, text_buffer_t, to_text
  implicit none
  private
  public :: json_t

  !> Digits with which every real number is read again as itself, and fewer to try before.
  integer, parameter :: least_digits = 15, most_digits = 17
  !> Replacement character of Unicode, U+FFFD.
  character(len=*), parameter :: replacement = achar(92)//"ufffd"
  character(len=*), parameter :: hexadecimal = "0123456789abcdef"

  !> A JSON text while it is written.
  type :: json_t
    private
    type(text_buffer_t) :: buffer
    !> Objects and arrays that are open, and those of them that are written in a single line: all
    !> beyond level `flat`, 0 if there is none.
    integer :: level = 0, flat = 0
    !> Whether no value of the innermost object or array is written yet.
    logical :: empty = .true.
  contains
    procedure :: begin_object
    procedure :: end_object
    procedure :: begin_array
    procedure :: end_array
    procedure, private :: add_text, add_real, add_integer, add_logical, add_reals, add_integers
    generic :: add => add_text, add_real, add_integer, add_logical, add_reals, add_integers
    procedure :: add_null
    procedure :: add_optional
    procedure :: add_written
    procedure :: text => json_text
    procedure, private :: begin
    procedure, private :: finish
    procedure, private :: start_value
  end type json_t

contains

  !> Begin an object.
  subroutine begin_object(self, name, flat)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    !> Write it in a single line, with all that it contains.
    logical, intent(in), optional :: flat

    call self%begin(name, "{", flat)
  end subroutine begin_object

  subroutine end_object(self)
    class(json_t), intent(inout) :: self

    call self%finish("}")
  end subroutine end_object

  !> Begin an array.
  subroutine begin_array(self, name, flat)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    !> Write it in a single line, with all that it contains.
    logical, intent(in), optional :: flat

    call self%begin(name, "[", flat)
  end subroutine begin_array

  subroutine end_array(self)
    class(json_t), intent(inout) :: self

    call self%finish("]")
  end subroutine end_array

  subroutine add_text(self, name, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name, value

    call self%start_value(name)
    call self%buffer%add(quoted(value))
  end subroutine add_text

  subroutine add_real(self, name, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    !> Null if it is not finite.
    real(wp), intent(in) :: value

    call self%start_value(name)
    call self%buffer%add(number(value))
  end subroutine add_real

  subroutine add_integer(self, name, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: value

    call self%start_value(name)
    call self%buffer%add(to_text(value))
  end subroutine add_integer

  subroutine add_logical(self, name, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    logical, intent(in) :: value

    call self%start_value(name)
    call self%buffer%add(trim(merge("true ", "false", value)))
  end subroutine add_logical

  !> Add an array of real numbers, in a single line.
  subroutine add_reals(self, name, values)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: values(:)

    integer :: i

    call self%begin_array(name, flat=.true.)
    do i = 1, size(values)
      call self%add("", values(i))
    end do
    call self%end_array()
  end subroutine add_reals

  !> Add an array of integers, in a single line.
  subroutine add_integers(self, name, values)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: values(:)

    integer :: i

    call self%begin_array(name, flat=.true.)
    do i = 1, size(values)
      call self%add("", values(i))
    end do
    call self%end_array()
  end subroutine add_integers

  subroutine add_null(self, name)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name

    call self%start_value(name)
    call self%buffer%add("null")
  end subroutine add_null

  !> Add a text, or null if it is empty.
  subroutine add_optional(self, name, value)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name, value

    if (value == "") then
      call self%add_null(name)
    else
      call self%add(name, value)
    end if
  end subroutine add_optional

  !> Add a value, or several members, that are written already; no-op if the text is empty.
  subroutine add_written(self, name, json)
    class(json_t), intent(inout) :: self
    !> Empty if the text has the names.
    character(len=*), intent(in) :: name
    character(len=*), intent(in) :: json

    if (len(json) == 0) return
    call self%start_value(name)
    call self%buffer%add(json)
  end subroutine add_written

  !> Return the text written so far.
  function json_text(self) result(text)
    class(json_t), intent(in) :: self
    character(len=:), allocatable :: text

    text = self%buffer%text()
  end function json_text

  !> Begin an object or an array.
  subroutine begin(self, name, bracket, flat)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    character, intent(in) :: bracket
    logical, intent(in), optional :: flat

    call self%start_value(name)
    call self%buffer%add(bracket)
    self%level = self%level + 1
    self%empty = .true.
    if (.not. present(flat)) return
    if (flat .and. self%flat == 0) self%flat = self%level
  end subroutine begin

  !> End the innermost object or array.
  subroutine finish(self, bracket)
    class(json_t), intent(inout) :: self
    character, intent(in) :: bracket

    self%level = self%level - 1
    if (self%flat > self%level) then
      self%flat = 0
    else if (self%flat == 0 .and. .not. self%empty) then
      call self%buffer%add(newline//repeat(" ", int(2*self%level, i8)))
    end if
    call self%buffer%add(bracket)
    self%empty = .false.
  end subroutine finish

  !> Write what precedes a value: comma, line end, name.
  subroutine start_value(self, name)
    class(json_t), intent(inout) :: self
    character(len=*), intent(in) :: name

    if (.not. self%empty) call self%buffer%add(",")
    if (self%level > 0 .and. self%flat == 0) then
      call self%buffer%add(newline//repeat(" ", int(2*self%level, i8)))
    else if (.not. self%empty) then
      call self%buffer%add(" ")
    end if
    if (name /= "") call self%buffer%add(quoted(name)//": ")
    self%empty = .false.
  end subroutine start_value

  !> Return a number with the fewest of some digits that give it again.
  function number(value) result(text)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: text

    real(wp) :: again
    integer :: digits

    text = "null"
    if (.not. ieee_is_finite(value)) return
    ! Rounded up, the largest numbers would overflow when they are read again.
    do digits = merge(most_digits, least_digits, abs(value) > 0.5_wp*huge(value)), most_digits
      text = to_text(value, digits)
      read (text, *) again
      if (abs(again - value) <= 0.0_wp) exit
    end do
  end function number

  !> Return a text in quotes, with its special characters escaped.
  function quoted(value) result(text)
    character(len=*), intent(in) :: value
    character(len=:), allocatable :: text

    type(text_buffer_t) :: buffer
    integer :: i, n

    call buffer%add('"')
    i = 1
    do while (i <= len(value))
      n = character_length(value(i:))
      if (n == 0) then
        call buffer%add(replacement)
      else if (n == 1) then
        call buffer%add(escaped(value(i:i)))
      else
        call buffer%add(value(i:i + n - 1))
      end if
      i = i + max(1, n)
    end do
    call buffer%add('"')
    text = buffer%text()
  end function quoted

  !> Return an ASCII character as it is written in a text.
  pure function escaped(letter) result(text)
    character, intent(in) :: letter
    character(len=:), allocatable :: text

    integer :: code

    code = iachar(letter)
    select case (code)
    case (34, 92)
      text = achar(92)//letter
    case (9)
      text = achar(92)//"t"
    case (10)
      text = achar(92)//"n"
    case (0:8, 11:31, 127)
      text = achar(92)//"u00"//hexadecimal(code/16 + 1:code/16 + 1)// &
          hexadecimal(mod(code, 16) + 1:mod(code, 16) + 1)
    case default
      text = letter
    end select
  end function escaped

  !> Return the number of bytes of the UTF-8 character at the start of a text; 0 if it is none
  !> (Unicode 15, table 3-7).
  pure integer function character_length(text) result(n)
    character(len=*), intent(in) :: text

    integer :: lead, lower, upper, i, byte

    lead = ichar(text(1:1))
    n = 1
    if (lead < 128) return
    lower = 128
    upper = 191
    select case (lead)
    case (194:223)
      n = 2
    case (224:239)
      n = 3
    case (240:244)
      n = 4
    case default
      n = 0
    end select
    if (lead == 224) lower = 160
    if (lead == 237) upper = 159
    if (lead == 240) lower = 144
    if (lead == 244) upper = 143
    if (n > len(text)) n = 0
    do i = 2, n
      byte = ichar(text(i:i))
      if (byte < lower .or. byte > upper) n = 0
      lower = 128
      upper = 191
    end do
  end function character_length

end module dd3_base_json
