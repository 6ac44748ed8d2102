! SPDX-License-Identifier: GPL-3.0-or-later
!> Choice between all threads and one by measured time. Where other work keeps the processors busy,
!> each thread waits for the slowest, and several can be slower than one. The results do not depend
!> on the number.
!>
!> The first iterations of the corrector's attempts are compared: they all do the same work. A trial
!> takes a few of them in turn with all threads and with one.
module dd3_system_thread_choice
  use dd3_base_clock, only : wall_time
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_threads, only : set_threads
  implicit none
  private
  public :: thread_choice_t, new_thread_choice

  !> Iterations measured in a trial.
  integer, parameter :: trial_length = 4
  !> Iterations between two trials: at first, and at most; doubled if the choice stays the same.
  integer, parameter :: first_interval = 16, most_interval = 256
  !> Ratio of two equal times of an iteration by scatter alone.
  real(wp), parameter :: scatter = 0.9_wp

  !> The choice, and the measurements so far.
  type :: thread_choice_t
    !> Number of all threads, and of those chosen.
    integer :: all = 1, chosen = 1
    !> What changed in the choice, and why, for the log; the reader clears it.
    character(len=120) :: news = ""
    !> Iterations until the next trial, and its number of iterations left.
    integer, private :: wait = 0, left = 0, interval = first_interval
    !> Number of threads in the present iteration, and its start, s.
    integer, private :: now = 1
    real(wp), private :: began = 0.0_wp
    !> Smallest time of an iteration in the present trial with one thread and with all, s.
    real(wp), private :: seconds(2) = huge(1.0_wp)
  contains
    procedure :: begin_iteration
    procedure :: end_iteration
    procedure :: record
  end type thread_choice_t

contains

  !> Start with all threads.
  subroutine new_thread_choice(self, threads)
    type(thread_choice_t), intent(out) :: self
    integer, intent(in) :: threads

    self%all = threads
    self%chosen = threads
    self%now = threads
  end subroutine new_thread_choice

  !> Begin the first iteration of an attempt; in a trial it takes one thread and all in turn.
  subroutine begin_iteration(self)
    class(thread_choice_t), intent(inout) :: self

    if (self%all == 1) return
    if (self%wait > 0) then
      self%wait = self%wait - 1
      return
    end if
    if (self%left == 0) then
      self%left = trial_length
      self%seconds = huge(1.0_wp)
    end if
    self%now = merge(self%all, 1, mod(self%left, 2) == 0)
    call set_threads(self%now)
    self%began = wall_time()
  end subroutine begin_iteration

  !> End that iteration and record its time.
  subroutine end_iteration(self)
    class(thread_choice_t), intent(inout) :: self

    call self%record(wall_time() - self%began)
  end subroutine end_iteration

  !> Record the time of an iteration of a trial. After the last one, choose the faster if the
  !> difference exceeds the scatter, and set when to compare again.
  subroutine record(self, seconds)
    class(thread_choice_t), intent(inout) :: self
    real(wp), intent(in) :: seconds

    integer :: which, faster

    if (self%left == 0) return
    which = merge(1, 2, self%now == 1)
    self%seconds(which) = min(self%seconds(which), seconds)
    self%left = self%left - 1
    if (self%left == 0) then
      faster = self%chosen
      if (self%seconds(1) < scatter*self%seconds(2)) faster = 1
      if (self%seconds(2) < scatter*self%seconds(1)) faster = self%all
      self%interval = min(2*self%interval, most_interval)
      if (faster /= self%chosen) then
        self%interval = first_interval
        self%news = "threads: "//to_text(faster)//" from here on: an iteration took "// &
            to_text(self%seconds(1), 3)//" s with one, "//to_text(self%seconds(2), 3)// &
            " s with "//to_text(self%all)
      end if
      self%chosen = faster
      self%wait = self%interval
    end if
    call set_threads(self%chosen)
  end subroutine record

end module dd3_system_thread_choice
