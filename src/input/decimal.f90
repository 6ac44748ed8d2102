! SPDX-License-Identifier: GPL-3.0-or-later
!> Fast reading of numbers from a line, for large files: plain decimals such as 12, -0.5 or 1.25.
!>
!> A number m/10^k of at most 18 digits is the quotient of integers of 128 bits: m is shifted so
!> that the quotient has more bits than the mantissa, its last bit is set if there is a remainder,
!> and the conversion to a real number rounds it once, to the nearest one.
module dd3_input_decimal
  use dd3_base_kinds, only : i8, wp
  use dd3_input_number, only : parse_real
  implicit none
  private
  public :: scan_real, is_blank

  !> Kind of integers of 128 bits.
  integer, parameter :: i16 = selected_int_kind(38)
  !> Largest number of digits: 10^18 is an integer of 64 bits.
  integer, parameter :: most_digits = 18
  !> Bits of the shifted numerator.
  integer, parameter :: numerator_bits = 126

contains

  !> Read the next word of a text as a real number of any form that `parse_real` accepts.
  pure subroutine scan_real(text, next, value, ok)
    character(len=*), intent(in) :: text
    !> Where the search for the word begins; behind it on return.
    integer, intent(inout) :: next
    real(wp), intent(out) :: value
    !> False if there is no word, or one that is no number.
    logical, intent(out) :: ok

    integer :: first

    do first = next, len(text)
      if (.not. is_blank(text(first:first))) exit
    end do
    next = first
    call scan_decimal(text, next, value, ok)
    if (ok) return
    do next = first, len(text)
      if (is_blank(text(next:next))) exit
    end do
    call parse_real(text(first:next - 1), value, ok)
  end subroutine scan_real

  !> Read a word if it is a plain decimal of at most 18 digits.
  pure subroutine scan_decimal(text, next, value, ok)
    character(len=*), intent(in) :: text
    !> First character of the word on entry; behind it on return.
    integer, intent(inout) :: next
    real(wp), intent(out) :: value
    !> False if the word has another form.
    logical, intent(out) :: ok

    integer(i8) :: mantissa
    integer :: digits, decimals, start
    logical :: negative

    negative = .false.
    if (next <= len(text)) negative = text(next:next) == "-"
    if (negative) next = next + 1
    mantissa = 0
    start = next
    call scan_digits(text, next, mantissa)
    digits = next - start
    decimals = 0
    if (next <= len(text)) then
      if (text(next:next) == ".") then
        next = next + 1
        start = next
        call scan_digits(text, next, mantissa)
        decimals = next - start
      end if
    end if
    ok = digits + decimals > 0 .and. digits + decimals <= most_digits
    if (ok .and. next <= len(text)) ok = is_blank(text(next:next))
    value = 0.0_wp
    if (ok) value = quotient(mantissa, decimals)
    if (negative) value = -value
  end subroutine scan_decimal

  !> Append digits to an integer; it is undefined after more than `most_digits` of them.
  pure subroutine scan_digits(text, next, number)
    character(len=*), intent(in) :: text
    !> First digit; behind the last one on return.
    integer, intent(inout) :: next
    integer(i8), intent(inout) :: number

    integer(i8), parameter :: full = 10_i8**int(most_digits - 1, i8)
    integer :: digit

    do next = next, len(text)
      digit = ichar(text(next:next)) - ichar("0")
      if (digit < 0 .or. digit > 9) exit
      if (number < full) number = 10_i8*number + int(digit, i8)
    end do
  end subroutine scan_digits

  !> Return m/10^k, rounded to the nearest real number.
  pure real(wp) function quotient(m, k)
    !> Less than 10^18, and at most 18.
    integer(i8), intent(in) :: m
    integer, intent(in) :: k

    integer(i16) :: numerator, denominator, ratio
    integer :: shift

    shift = numerator_bits - (storage_size(m) - leadz(m))
    numerator = shiftl(int(m, i16), shift)
    denominator = int(10_i8**int(k, i8), i16)
    ratio = numerator/denominator
    if (ratio*denominator /= numerator) ratio = ior(ratio, 1_i16)
    quotient = scale(real(ratio, wp), -shift)
  end function quotient

  pure logical function is_blank(letter)
    character(len=1), intent(in) :: letter

    is_blank = letter == " " .or. letter == achar(9) .or. letter == achar(12)
  end function is_blank

end module dd3_input_decimal
