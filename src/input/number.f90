!> Numbers as Fortran or C write them: 12, -1.5, .5, 1.e-3, 1d3, 2.1E+5.
module dd3_input_number
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: parse_real, parse_integer, parse_pair

  !> Largest decimal exponent accepted.
  integer, parameter :: largest_exponent = 300

contains

  !> Reads a word as a real number.
  pure subroutine parse_real(text, value, ok)
    !> The word.
    character(len=*), intent(in) :: text
    !> The number; 0 if the word is none.
    real(wp), intent(out) :: value
    !> Whether the word is a number that can be held.
    logical, intent(out) :: ok

    integer :: mantissa, exponent, status

    value = 0.0_wp
    ok = .false.
    mantissa = mantissa_length(text)
    if (mantissa == 0 .or. len(text) > 60) return
    exponent = 0
    if (mantissa < len(text)) then
      if (scan(text(mantissa + 1:mantissa + 1), "eEdD") == 0) return
      call parse_integer(text(mantissa + 2:), exponent, ok)
      if (.not. ok) return
      ok = .false.
    end if
    if (abs(exponent) > largest_exponent) return
    read (text, '(f60.0)', iostat=status) value
    ok = status == 0
    if (.not. ok) value = 0.0_wp
  end subroutine parse_real

  !> Number of characters of the sign, digits and point a word begins with; 0 if it does not begin
  !> like a number.
  pure integer function mantissa_length(text) result(last)
    !> The word.
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

  !> Reads a word as a whole number.
  pure subroutine parse_integer(text, value, ok)
    !> The word.
    character(len=*), intent(in) :: text
    !> The number; 0 if the word is none.
    integer, intent(out) :: value
    !> Whether the word is a number that can be held.
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

  !> Reads two numbers with a colon between them.
  pure subroutine parse_pair(text, first, second, ok)
    !> The word.
    character(len=*), intent(in) :: text
    !> The numbers; 0 where there is none.
    real(wp), intent(out) :: first, second
    !> Whether there are two.
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
