! SPDX-License-Identifier: GPL-3.0-or-later
!> Lines of an `.inp` file: fields separated by commas, keywords with parameters. Fields keep their
!> columns, and numbers are parsed without copies, as a mesh has millions of them.
module dd3_mesh_inp_line
  use dd3_base_text, only : lower_case
  implicit none
  private
  public :: fields_t, parameter_list_t, split_fields, split_keyword, field_integer, is_comment

  !> Largest number of fields in a line.
  integer, parameter :: most_fields = 64
  !> Largest number of digits of a label.
  integer, parameter :: most_digits = 9
  character(len=*), parameter :: blanks = " "//achar(9)//achar(12)

  !> Fields of a line without the blanks around them.
  type :: fields_t
    integer :: n = 0
    !> First and last column of each field; last < first for an empty one.
    integer :: first(most_fields) = 1, last(most_fields) = 0
    !> Whether the line ends with a comma, after which it may go on in the next one.
    logical :: open = .false.
    !> Whether the line has more fields.
    logical :: overflow = .false.
  end type fields_t

  !> Keyword and parameters of a line `*KEYWORD, NAME=VALUE, NAME`.
  type :: parameter_list_t
    integer :: n = 0
    !> Keyword, then names of the parameters: in lower case; columns in the line.
    character(len=32) :: name(most_fields) = ""
    integer :: column(most_fields) = 1
    !> Columns of the values; last < first if there is none.
    integer :: first(most_fields) = 1, last(most_fields) = 0
    !> Whether a parameter was taken: what nobody took is not read.
    logical :: taken(most_fields) = .false.
    !> Whether the line ends with a comma.
    logical :: open = .false.
  contains
    procedure :: take
  end type parameter_list_t

contains

  !> Whether a line has no data: it is blank or a comment.
  pure logical function is_comment(text)
    character(len=*), intent(in) :: text

    is_comment = verify(text, blanks) == 0
    if (.not. is_comment .and. len(text) > 1) is_comment = text(1:2) == "**"
  end function is_comment

  !> Split a line at its commas. A comma at its end begins no further field.
  pure subroutine split_fields(text, fields)
    character(len=*), intent(in) :: text
    type(fields_t), intent(out) :: fields

    integer :: i, start, length

    length = verify(text, blanks, back=.true.)
    start = 1
    do i = 1, length + 1
      if (i <= length) then
        if (text(i:i) /= ",") cycle
      end if
      fields%open = i == length
      if (fields%n == most_fields) then
        fields%overflow = .true.
        return
      end if
      fields%n = fields%n + 1
      call trim_bounds(text, start, i - 1, fields%first(fields%n), fields%last(fields%n))
      if (fields%open) return
      start = i + 1
    end do
  end subroutine split_fields

  !> Find the bounds of a part of a text without the blanks around it.
  pure subroutine trim_bounds(text, start, end, first, last)
    character(len=*), intent(in) :: text
    integer, intent(in) :: start, end
    integer, intent(out) :: first, last

    first = start
    last = end
    do while (first <= last)
      if (index(blanks, text(first:first)) == 0) exit
      first = first + 1
    end do
    do while (first <= last)
      if (index(blanks, text(last:last)) == 0) exit
      last = last - 1
    end do
  end subroutine trim_bounds

  !> Split the line of a keyword.
  pure subroutine split_keyword(text, list)
    character(len=*), intent(in) :: text
    type(parameter_list_t), intent(out) :: list

    type(fields_t) :: fields
    integer :: i, equals, first, last

    call split_fields(text, fields)
    list%n = fields%n
    list%open = fields%open
    do i = 1, fields%n
      equals = index(text(fields%first(i):fields%last(i)), "=")
      list%column(i) = fields%first(i)
      last = fields%last(i)
      if (equals > 0) then
        call trim_bounds(text, fields%first(i) + equals, last, list%first(i), list%last(i))
        call unquote(text, list%first(i), list%last(i))
        call trim_bounds(text, fields%first(i), fields%first(i) + equals - 2, first, last)
      end if
      list%name(i) = lower_case(text(fields%first(i):last))
    end do
  end subroutine split_keyword

  !> Take a parameter; return its position, 0 if it is not given.
  pure subroutine take(self, name, position)
    class(parameter_list_t), intent(inout) :: self
    !> In lower case.
    character(len=*), intent(in) :: name
    integer, intent(out) :: position

    do position = 2, self%n
      if (self%name(position) /= name) cycle
      self%taken(position) = .true.
      return
    end do
    position = 0
  end subroutine take

  !> Exclude the quotes around a value.
  pure subroutine unquote(text, first, last)
    character(len=*), intent(in) :: text
    integer, intent(inout) :: first, last

    if (last <= first) return
    if (scan(text(first:first), "'""") == 0 .or. text(last:last) /= text(first:first)) return
    first = first + 1
    last = last - 1
  end subroutine unquote

  !> Read a label: a positive integer.
  pure subroutine field_integer(text, value, ok)
    !> Field without blanks around it.
    character(len=*), intent(in) :: text
    integer, intent(out) :: value
    logical, intent(out) :: ok

    integer :: i, digit

    value = 0
    ok = len(text) > 0 .and. len(text) <= most_digits
    if (.not. ok) return
    do i = 1, len(text)
      digit = ichar(text(i:i)) - ichar("0")
      ok = digit >= 0 .and. digit <= 9
      if (.not. ok) return
      value = 10*value + digit
    end do
    ok = value > 0
  end subroutine field_integer

end module dd3_mesh_inp_line
