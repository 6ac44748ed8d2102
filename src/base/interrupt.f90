!> Interruption of a run from the keyboard (SIGINT) or by the system (SIGTERM): the run ends after
!> the current increment with complete results. A second signal of the same kind stops it at once.
!> The flag is a module variable because a signal handler has no other arguments.
module dd3_base_interrupt
  use, intrinsic :: iso_c_binding, only : c_int, c_intptr_t, c_funptr, c_funloc, c_null_funptr
  implicit none
  private
  public :: watch_interrupts, interrupted

  !> Numbers of the signals: keyboard, system, file size limit exceeded.
  integer(c_int), parameter :: sigint = 2, sigterm = 15, sigxfsz = 25
  !> Number of the signal received; 0 if there was none.
  integer(c_int), volatile, save :: caught = 0

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
  !> that the write fails with an ordinary error.
  subroutine watch_interrupts()
    type(c_funptr) :: previous
    integer(c_intptr_t), parameter :: ignore = 1

    caught = 0
    previous = c_signal(sigint, c_funloc(catch_signal))
    previous = c_signal(sigterm, c_funloc(catch_signal))
    previous = c_signal(sigxfsz, transfer(ignore, c_null_funptr))
  end subroutine watch_interrupts

  !> Whether a signal was received.
  logical function interrupted()
    interrupted = caught /= 0
  end function interrupted

  !> Set the flag and restore the default action for the next signal.
  subroutine catch_signal(number) bind(c)
    integer(c_int), value :: number

    type(c_funptr) :: previous

    caught = number
    previous = c_signal(number, c_null_funptr)
  end subroutine catch_signal

end module dd3_base_interrupt
