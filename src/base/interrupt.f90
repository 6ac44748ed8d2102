! SPDX-License-Identifier: GPL-3.0-or-later
!> Interruption of a run: from the keyboard (SIGINT), by the system (SIGTERM), by the end of the
!> session (SIGHUP) or because nobody reads the output any more (SIGPIPE). The run ends after the
!> current iteration with the results of all accepted increments. A second signal of the same kind
!> stops it at once, but not SIGPIPE, which a run that goes on writing would receive again. The flag
!> is a module variable because a signal handler has no other arguments.
module dd3_base_interrupt
  use, intrinsic :: iso_c_binding, only : c_int, c_intptr_t, c_funptr, c_funloc, c_null_funptr
  use dd3_base_ranks, only : largest_over_ranks
  implicit none
  private
  public :: watch_interrupts, interrupted, interruption, interruption_code

  !> Code of the message on an interruption.
  character(len=*), parameter :: interruption_code = "E201"

  !> Numbers of the signals: end of the session, keyboard, broken pipe, system, file size limit
  !> exceeded.
  integer(c_int), parameter :: sighup = 1, sigint = 2, sigpipe = 13, sigterm = 15, sigxfsz = 25
  !> Handler that ignores a signal.
  integer(c_intptr_t), parameter :: ignore = 1
  !> Number of the signal received; 0 if there was none.
  integer(c_int), volatile :: caught = 0

  interface
    !> signal(2).
    type(c_funptr) function c_signal(number, handler) bind(c, name="signal")
      import :: c_int, c_funptr
      integer(c_int), value :: number
      type(c_funptr), value :: handler
    end function c_signal
  end interface

contains

  !> Install the handlers and reset the flag. The signal of an exceeded file size is ignored, so
  !> that the write fails with an ordinary error; SIGHUP and SIGPIPE stay ignored if they were at
  !> the start, as under nohup.
  subroutine watch_interrupts()
    type(c_funptr) :: previous

    caught = 0
    previous = c_signal(sigint, c_funloc(catch_signal))
    previous = c_signal(sigterm, c_funloc(catch_signal))
    call watch_unless_ignored(sighup)
    call watch_unless_ignored(sigpipe)
    previous = c_signal(sigxfsz, transfer(ignore, c_null_funptr))
  end subroutine watch_interrupts

  !> Install the handler of a signal unless it is ignored.
  subroutine watch_unless_ignored(number)
    integer(c_int), intent(in) :: number

    type(c_funptr) :: previous

    previous = c_signal(number, c_funloc(catch_signal))
    if (transfer(previous, ignore) == ignore) then
      previous = c_signal(number, transfer(ignore, c_null_funptr))
    end if
  end subroutine watch_unless_ignored

  !> Whether a signal was received, by any rank; all of them must ask.
  logical function interrupted()
    integer :: number(1)

    number = int(caught)
    call largest_over_ranks(1, number)
    if (caught == 0) caught = int(number(1), c_int)
    interrupted = number(1) /= 0
  end function interrupted

  !> Return what interrupted the run, for messages.
  function interruption() result(text)
    character(len=:), allocatable :: text

    select case (caught)
    case (sighup)
      text = "interrupted by the end of the session (SIGHUP)"
    case (sigpipe)
      text = "interrupted, as nobody reads the output any more (SIGPIPE)"
    case (sigterm)
      text = "interrupted by the system or a batch queue (SIGTERM)"
    case default
      text = "interrupted by the user"
    end select
  end function interruption

  !> Set the flag and restore the default action for the next signal.
  subroutine catch_signal(number) bind(c)
    integer(c_int), value :: number

    type(c_funptr) :: previous

    caught = number
    if (number == sigpipe) then
      previous = c_signal(number, transfer(ignore, c_null_funptr))
    else
      previous = c_signal(number, c_null_funptr)
    end if
  end subroutine catch_signal

end module dd3_base_interrupt
