!> A wish to stop, from the keyboard (SIGINT) or the system (SIGTERM): the run ends after the
!> current increment with whole results. A second signal of the kind stops at once. The flag is a
!> variable of the module: a signal handler has no arguments, nothing else reaches it.
module dd3_base_interrupt
  use, intrinsic :: iso_c_binding, only : c_int, c_intptr_t, c_funptr, c_funloc, c_null_funptr
  implicit none
  private
  public :: watch_interrupts, interrupted

  !> Numbers of the signals: from the keyboard, from the system, a file grown past the allowed size.
  integer(c_int), parameter :: sigint = 2, sigterm = 15, sigxfsz = 25
  !> The number of the signal that came; 0 for none.
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

  !> From now on the signals only raise the flag. A write past an allowed file size is to be an
  !> ordinary error, so its signal is ignored.
  subroutine watch_interrupts()
    type(c_funptr) :: previous
    integer(c_intptr_t), parameter :: ignore = 1

    caught = 0
    previous = c_signal(sigint, c_funloc(remember))
    previous = c_signal(sigterm, c_funloc(remember))
    previous = c_signal(sigxfsz, transfer(ignore, c_null_funptr))
  end subroutine watch_interrupts

  !> Whether a signal came.
  logical function interrupted()
    interrupted = caught /= 0
  end function interrupted

  !> The handler: raises the flag and leaves the next signal to the system.
  subroutine remember(number) bind(c)
    !> The signal's number.
    integer(c_int), value :: number

    type(c_funptr) :: previous

    caught = number
    previous = c_signal(number, c_null_funptr)
  end subroutine remember

end module dd3_base_interrupt
