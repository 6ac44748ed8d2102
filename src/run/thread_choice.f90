! SPDX-License-Identifier: GPL-3.0-or-later
!> Choice between all threads and one by the times of the attempts. Where other work keeps the
!> processors busy, each thread waits for the slowest, and several can be slower than one. The
!> results do not depend on the number.
!>
!> All threads are taken while the processors are free. Otherwise two attempts one after another are
!> compared, with all threads and with one.
module dd3_run_thread_choice
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_threads, only : set_threads
  implicit none
  private
  public :: thread_choice_t, new_thread_choice

  !> Processor time of a thread over the wall-clock time below which other work is assumed.
  real(wp), parameter :: busy = 0.8_wp
  !> Ratio of two equal times of an iteration by scatter alone.
  real(wp), parameter :: scatter = 0.8_wp
  !> Attempts between two comparisons: at first, and at most; doubled if the choice stays the same.
  integer, parameter :: first_interval = 8, most_interval = 128

  type :: thread_choice_t
    !> Number of all threads, and of those chosen.
    integer, private :: all = 1, chosen = 1
    !> What changed in the choice, and why, for the log; the reader clears it.
    character(len=120) :: news = ""
    !> Whether the present attempt takes the other number, for comparison.
    logical, private :: compares = .false.
    !> Time of an iteration in the attempt before, s.
    real(wp), private :: before = 0.0_wp
    !> Attempts until the next comparison.
    integer, private :: wait = 0, interval = first_interval
  contains
    procedure :: record
  end type thread_choice_t

contains

  !> Start with all threads.
  subroutine new_thread_choice(self, threads)
    type(thread_choice_t), intent(out) :: self
    integer, intent(in) :: threads

    self%all = threads
    self%chosen = threads
  end subroutine new_thread_choice

  !> Record the time of an attempt and set the number of threads of the next one.
  subroutine record(self, seconds, processor, iterations)
    class(thread_choice_t), intent(inout) :: self
    !> Wall-clock time, and processor time of the calling thread in it, s.
    real(wp), intent(in) :: seconds, processor
    !> No-op if 0.
    integer, intent(in) :: iterations

    real(wp) :: time

    if (self%all == 1 .or. iterations == 0) return
    time = seconds/real(iterations, wp)
    if (self%compares) then
      call compare(self, time)
    else if (self%wait > 0) then
      self%wait = self%wait - 1
    else if (self%chosen == 1 .or. processor < busy*seconds) then
      self%compares = .true.
      self%before = time
      call set_threads(other(self))
    end if
  end subroutine record

  !> Take the other number of threads if it was faster.
  subroutine compare(self, time)
    type(thread_choice_t), intent(inout) :: self
    !> Time of an iteration with the other number, s.
    real(wp), intent(in) :: time

    self%compares = .false.
    self%interval = min(2*self%interval, most_interval)
    if (time < scatter*self%before) then
      self%news = "threads: "//to_text(other(self))//" from here on: an iteration took "// &
          to_text(time, 3)//" s, and "//to_text(self%before, 3)//" s with "//to_text(self%chosen)
      self%chosen = other(self)
      self%interval = first_interval
    end if
    self%wait = self%interval
    call set_threads(self%chosen)
  end subroutine compare

  !> Return the number of threads that is not chosen.
  pure integer function other(self)
    type(thread_choice_t), intent(in) :: self

    other = merge(self%all, 1, self%chosen == 1)
  end function other

end module dd3_run_thread_choice
