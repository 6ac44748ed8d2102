!> The failures of the test that is running.
!>
!> The asserts of a test file name no object to write to, so these must be kept by the module.
module pf_failure
  implicit none
  private
  public :: SourceLocation, failure_t, fail, anyExceptions, take_failures, with_message

  !> Where an assert stands.
  type :: SourceLocation
    !> Name of the test file.
    character(len=72) :: file = ""
    !> Line number, from 1.
    integer :: line = 0
  end type SourceLocation

  !> One assert that did not hold.
  type :: failure_t
    !> What happened, may hold several lines.
    character(len=:), allocatable :: message
    !> Where the assert stands.
    type(SourceLocation) :: location
  end type failure_t

  !> The failures since they were last taken.
  type(failure_t), allocatable :: failures(:)

contains

  !> Notes a failure.
  subroutine fail(text, location)
    !> What happened.
    character(len=*), intent(in) :: text
    !> Where the assert stands.
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

  !> Whether an assert of the running test failed.
  logical function anyExceptions()
    anyExceptions = allocated(failures)
  end function anyExceptions

  !> Hands the failures over and forgets them.
  subroutine take_failures(taken)
    !> The failures; empty where there is none.
    type(failure_t), allocatable, intent(out) :: taken(:)

    if (allocated(failures)) then
      call move_alloc(failures, taken)
    else
      allocate (taken(0))
    end if
  end subroutine take_failures

  !> The message of the test's writer on a line of its own, then the text.
  function with_message(message, text) result(both)
    !> The message, if any.
    character(len=*), intent(in), optional :: message
    !> The text.
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: both

    both = text
    if (present(message)) both = message//new_line("a")//text
  end function with_message

end module pf_failure
