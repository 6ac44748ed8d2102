! SPDX-License-Identifier: GPL-3.0-or-later
!> Failures of the running test.
!>
!> They are module variables because the asserts of a test file have no argument for them.
module pf_failure
  implicit none
  private
  public :: SourceLocation, failure_t, fail, anyExceptions, pop_failures, with_message

  !> Position of an assert.
  type :: SourceLocation
    character(len=72) :: file = ""
    !> Line number, from 1.
    integer :: line = 0
  end type SourceLocation

  !> An assert that failed.
  type :: failure_t
    !> May contain several lines.
    character(len=:), allocatable :: message
    type(SourceLocation) :: location
  end type failure_t

  !> Failures since the last call of `pop_failures`.
  type(failure_t), allocatable :: failures(:)

contains

  !> Record a failure.
  subroutine fail(text, location)
    character(len=*), intent(in) :: text
    type(SourceLocation), intent(in) :: location

    type(failure_t), allocatable :: longer(:)
    integer :: n

    n = 0
    if (allocated(failures)) n = size(failures)
    allocate (longer(n + 1))
    if (n > 0) longer(:n) = failures
    longer(n + 1)%message = text
    longer(n + 1)%location = location
    call move_alloc(longer, failures)
  end subroutine fail

  !> Check whether an assert of the running test failed.
  logical function anyExceptions()
    anyExceptions = allocated(failures)
  end function anyExceptions

  !> Return the failures and clear them.
  subroutine pop_failures(taken)
    !> Empty if there are none.
    type(failure_t), allocatable, intent(out) :: taken(:)

    if (allocated(failures)) then
      call move_alloc(failures, taken)
    else
      allocate (taken(0))
    end if
  end subroutine pop_failures

  !> Return the message of the test on its own line, then the text.
  function with_message(message, text) result(both)
    character(len=*), intent(in), optional :: message
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: both

    both = text
    if (present(message)) both = message//new_line("a")//text
  end function with_message

end module pf_failure
