! SPDX-License-Identifier: GPL-3.0-or-later
!> Comparisons of flattened arrays, behind the asserts with two sides.
module pf_compare
  use, intrinsic :: iso_fortran_env, only : dp => real64, i8 => int64
  use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_is_finite
  use pf_failure, only : SourceLocation, fail, with_message
  implicit none
  private
  public :: compare_reals, compare_integers, compare_logicals, compare_texts, shape_text
  public :: compare_equal, compare_notequal, compare_lessthan, compare_lessthanorequal
  public :: compare_greaterthan, compare_greaterthanorequal, compare_relativelyequal

  !> Relations between the expected and the actual side.
  integer, parameter :: compare_equal = 1, compare_notequal = 2, compare_lessthan = 3, &
      compare_lessthanorequal = 4, compare_greaterthan = 5, compare_greaterthanorequal = 6, &
      compare_relativelyequal = 7
  !> Their names in messages.
  character(len=24), parameter :: operation_name(7) = [character(len=24) :: "assertEqual", &
      "assertNotEqual", "assertLessThan", "assertLessThanOrEqual", "assertGreaterThan", &
      "assertGreaterThanOrEqual", "assertRelativelyEqual"]

contains

  !> Compare real numbers element by element.
  subroutine compare_reals(operation, expected, expected_shape, actual, actual_shape, tolerance, &
      message, location)
    integer, intent(in) :: operation
    !> The expected one may be a single number.
    real(dp), intent(in) :: expected(:), actual(:)
    !> Shapes before flattening; empty for a scalar.
    integer, intent(in) :: expected_shape(:), actual_shape(:)
    !> Largest difference allowed.
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    character(len=100) :: left, right, difference
    integer :: i, j

    if (.not. conformable(operation, expected_shape, actual_shape, message, location)) return
    do i = 1, size(actual)
      j = min(i, size(expected))
      if (reals_hold(operation, expected(j), actual(i), tolerance)) cycle
      write (left, '(g0)') expected(j)
      write (right, '(g0)') actual(i)
      difference = "none: a NaN or infinity"
      if (ieee_is_finite(expected(j)) .and. ieee_is_finite(actual(i))) then
        write (difference, '(g0,a,g0,a)') actual(i) - expected(j), " (tolerance ", tolerance, ")"
      end if
      call fail_at(operation, left, right, difference, i, actual_shape, message, location)
      return
    end do
  end subroutine compare_reals

  !> Check the relation of a pair of real numbers; it never holds for a NaN.
  logical function reals_hold(operation, expected, actual, tolerance)
    integer, intent(in) :: operation
    !> The pair, and the largest difference allowed.
    real(dp), intent(in) :: expected, actual, tolerance

    reals_hold = .false.
    if (ieee_is_nan(expected) .or. ieee_is_nan(actual)) return
    select case (operation)
    case (compare_equal)
      reals_hold = expected == actual .or. near(expected, actual, tolerance)
    case (compare_notequal)
      reals_hold = expected /= actual
    case (compare_lessthan)
      reals_hold = expected < actual
    case (compare_lessthanorequal)
      reals_hold = expected <= actual
    case (compare_greaterthan)
      reals_hold = expected > actual
    case (compare_greaterthanorequal)
      reals_hold = expected >= actual
    case (compare_relativelyequal)
      if (abs(expected) > 0.0_dp) reals_hold = near(expected, actual, tolerance*abs(expected))
    case default
      ! No such relation: it does not hold.
    end select
  end function reals_hold

  !> Check that two finite numbers differ by no more than the tolerance.
  logical function near(expected, actual, tolerance)
    !> The numbers, and the largest difference allowed.
    real(dp), intent(in) :: expected, actual, tolerance

    near = .false.
    if (ieee_is_finite(expected) .and. ieee_is_finite(actual)) then
      near = abs(actual - expected) <= tolerance
    end if
  end function near

  !> Compare integers element by element.
  subroutine compare_integers(operation, expected, expected_shape, actual, actual_shape, message, &
      location)
    integer, intent(in) :: operation
    !> The expected one may be a single number.
    integer(i8), intent(in) :: expected(:), actual(:)
    !> Shapes before flattening; empty for a scalar.
    integer, intent(in) :: expected_shape(:), actual_shape(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    character(len=24) :: left, right, difference
    integer :: i, j

    if (.not. conformable(operation, expected_shape, actual_shape, message, location)) return
    do i = 1, size(actual)
      j = min(i, size(expected))
      if (integers_hold(operation, expected(j), actual(i))) cycle
      write (left, '(i0)') expected(j)
      write (right, '(i0)') actual(i)
      write (difference, '(i0)') actual(i) - expected(j)
      call fail_at(operation, left, right, difference, i, actual_shape, message, location)
      return
    end do
  end subroutine compare_integers

  !> Check the relation of a pair of integers.
  logical function integers_hold(operation, expected, actual)
    integer, intent(in) :: operation
    integer(i8), intent(in) :: expected, actual

    integers_hold = .false.
    select case (operation)
    case (compare_equal)
      integers_hold = expected == actual
    case (compare_notequal)
      integers_hold = expected /= actual
    case (compare_lessthan)
      integers_hold = expected < actual
    case (compare_lessthanorequal)
      integers_hold = expected <= actual
    case (compare_greaterthan)
      integers_hold = expected > actual
    case (compare_greaterthanorequal)
      integers_hold = expected >= actual
    case default
      ! No such relation: it does not hold.
    end select
  end function integers_hold

  !> Compare logicals element by element: equal or not equal.
  subroutine compare_logicals(operation, expected, expected_shape, actual, actual_shape, message, &
      location)
    !> `compare_equal` or `compare_notequal`.
    integer, intent(in) :: operation
    !> The expected one may be a single logical.
    logical, intent(in) :: expected(:), actual(:)
    !> Shapes before flattening; empty for a scalar.
    integer, intent(in) :: expected_shape(:), actual_shape(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    character(len=1) :: left, right
    integer :: i, j

    if (.not. conformable(operation, expected_shape, actual_shape, message, location)) return
    do i = 1, size(actual)
      j = min(i, size(expected))
      if ((expected(j) .eqv. actual(i)) .eqv. (operation == compare_equal)) cycle
      write (left, '(l1)') expected(j)
      write (right, '(l1)') actual(i)
      call fail_at(operation, left, right, "", i, actual_shape, message, location)
      return
    end do
  end subroutine compare_logicals

  !> Compare two texts, without blanks at both ends.
  subroutine compare_texts(expected, actual, message, location)
    character(len=*), intent(in) :: expected, actual
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    integer :: no_shape(0)

    if (trim(adjustl(expected)) == trim(adjustl(actual))) return
    call fail_at(compare_equal, """"//trim(expected)//"""", """"//trim(actual)//"""", "", 1, &
        no_shape, message, location)
  end subroutine compare_texts

  !> Check that the shapes conform; record a failure if they do not.
  logical function conformable(operation, expected_shape, actual_shape, message, location)
    integer, intent(in) :: operation
    integer, intent(in) :: expected_shape(:), actual_shape(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    conformable = size(expected_shape) == 0
    if (conformable) return
    conformable = all(expected_shape == actual_shape)
    if (.not. conformable) call fail(with_message(message, trim(operation_name(operation)) &
        //": the shapes differ"//new_line("a")//"expected shape: "//shape_text(expected_shape) &
        //new_line("a")//"actual shape:   "//shape_text(actual_shape)), location)
  end function conformable

  !> Record a failure with both values and the position in the array.
  subroutine fail_at(operation, left, right, difference, place, actual_shape, message, location)
    integer, intent(in) :: operation
    !> The values as texts, and their difference, empty if it is not defined.
    character(len=*), intent(in) :: left, right, difference
    !> Index of the flattened element.
    integer, intent(in) :: place
    !> Shape of the actual side.
    integer, intent(in) :: actual_shape(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    character(len=:), allocatable :: text
    integer :: index(size(actual_shape)), rest, k

    text = trim(operation_name(operation))//" failed"//new_line("a")//"expected:   "//trim(left) &
        //new_line("a")//"actual:     "//trim(right)
    if (difference /= "") text = text//new_line("a")//"difference: "//trim(difference)
    if (size(actual_shape) > 0) then
      rest = place - 1
      do k = 1, size(actual_shape)
        index(k) = 1 + modulo(rest, actual_shape(k))
        rest = rest/actual_shape(k)
      end do
      text = text//new_line("a")//"first bad index: "//shape_text(index)
    end if
    call fail(with_message(message, text), location)
  end subroutine fail_at

  !> Return integers as `[1, 2, 3]`.
  function shape_text(numbers) result(text)
    integer, intent(in) :: numbers(:)
    character(len=:), allocatable :: text

    character(len=12) :: one
    integer :: i

    text = "["
    do i = 1, size(numbers)
      write (one, '(i0)') numbers(i)
      if (i > 1) text = text//", "
      text = text//trim(one)
    end do
    text = text//"]"
  end function shape_text

end module pf_compare
