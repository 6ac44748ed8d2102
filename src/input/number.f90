! SPDX-License-Identifier: GPL-3.0-or-later
!> Parser of numbers as in Fortran or C: 12, -1.5, .5, 1.e-3, 1d3, 2.1E+5.
module dd3_input_number
  use, intrinsic :: iso_c_binding, only : c_char, c_double, c_null_char, c_null_ptr, c_ptr
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: parse_real, parse_integer, parse_pair

  !> Largest decimal exponent accepted.
  integer, parameter :: largest_exponent = 300
  !> Largest number of characters of a number.
  integer, parameter :: longest_number = 60

  interface
    !> strtod(3): several times faster than an internal read, which calls it too.
    pure real(c_double) function c_strtod(text, end) bind(c, name="strtod")
      import :: c_char, c_double, c_ptr
      character(kind=c_char), intent(in) :: text(*)
      type(c_ptr), value :: end
    end function c_strtod
  end interface

contains

  !> Parse a real number.
  pure subroutine parse_real(text, value, ok)
    character(len=*), intent(in) :: text
    !> Number; 0 if not ok.
    real(wp), intent(out) :: value
    !> Whether the text is a number within the range of the kind.
    logical, intent(out) :: ok

    character(len=longest_number + 1, kind=c_char) :: buffer
    integer :: mantissa, exponent

    value = 0.0_wp
    ok = .false.
    mantissa = mantissa_length(text)
    if (mantissa == 0 .or. len(text) > longest_number) return
    exponent = 0
    if (mantissa < len(text)) then
      if (scan(text(mantissa + 1:mantissa + 1), "eEdD") == 0) return
      call parse_integer(text(mantissa + 2:), exponent, ok)
      if (.not. ok) return
      ok = .false.
    end if
    if (abs(exponent) > largest_exponent) return
    buffer = text//c_null_char
    if (mantissa < len(text)) buffer(mantissa + 1:mantissa + 1) = "e"
    value = real(c_strtod(buffer, c_null_ptr), wp)
    ok = abs(value) <= huge(value)
    if (.not. ok) value = 0.0_wp
  end subroutine parse_real

  !> Return the length of the sign, digits and point at the start of a text; 0 without digits.
  pure integer function mantissa_length(text) result(last)
    character(len=*), intent(in) :: text

    integer :: i, digits, points

    digits = 0
    points = 0
    last = 0
    do i = 1, len(text)
      select case (text(i:i))
      case ("0":"9")
        digits = digits + 1
      case (".")
        points = points + 1
        if (points > 1) exit
      case ("+", "-")
        if (i > 1) exit
      case default
        exit
      end select
      last = i
    end do
    if (digits == 0) last = 0
  end function mantissa_length

  !> Parse an integer.
  pure subroutine parse_integer(text, value, ok)
    character(len=*), intent(in) :: text
    !> Number; 0 if not ok.
    integer, intent(out) :: value
    !> Whether the text is an integer within the range of the kind.
    logical, intent(out) :: ok

    integer :: start, status

    value = 0
    ok = .false.
    start = 1
    if (len(text) == 0) return
    if (scan(text(1:1), "+-") == 1) start = 2
    if (start > len(text) .or. len(text) > 20) return
    if (verify(text(start:), "0123456789") > 0) return
    read (text, '(i20)', iostat=status) value
    ok = status == 0
    if (.not. ok) value = 0
  end subroutine parse_integer

  !> Parse a pair of numbers separated by a colon.
  pure subroutine parse_pair(text, first, second, ok)
    character(len=*), intent(in) :: text
    !> Numbers; 0 if not ok.
    real(wp), intent(out) :: first, second
    logical, intent(out) :: ok

    integer :: colon

    first = 0.0_wp
    second = 0.0_wp
    colon = index(text, ":")
    ok = colon > 1 .and. colon < len(text)
    if (.not. ok) return
    call parse_real(text(:colon - 1), first, ok)
    if (ok) call parse_real(text(colon + 1:), second, ok)
  end subroutine parse_pair

end module dd3_input_number
