! SPDX-License-Identifier: GPL-3.0-or-later
!> Wall-clock and processor time, and the time spent in the sections of a run.
module dd3_base_clock
  use, intrinsic :: iso_c_binding, only : c_int, c_long
  use dd3_base_kinds, only : wp, i8
  implicit none
  private
  public :: wall_time, processor_time, profile_t, section_names
  public :: section_material, section_assembly, section_contact, section_factorisation, &
      section_solve, section_elimination, section_output

  !> Sections that are timed separately.
  integer, parameter :: section_material = 1, section_assembly = 2, section_contact = 3, &
      section_factorisation = 4, section_solve = 5, section_elimination = 6, section_output = 7
  character(len=13), parameter :: section_names(7) = [character(len=13) :: "material", "assembly", &
      "contact", "factorisation", "solve", "elimination", "output"]

  !> Seconds spent in each section.
  type :: profile_t
    real(wp) :: seconds(size(section_names)) = 0.0_wp
    !> Start of the current section, s.
    real(wp) :: began = 0.0_wp
  contains
    procedure :: start => profile_start
    procedure :: add => profile_add
  end type profile_t

  !> Clock of the processor time of the calling thread (CLOCK_THREAD_CPUTIME_ID of Linux).
  integer(c_int), parameter :: thread_clock = 3

  !> Seconds and nanoseconds (POSIX).
  type, bind(c) :: timespec_t
    integer(c_long) :: seconds = 0_c_long, nanoseconds = 0_c_long
  end type timespec_t

  interface
    !> Read a clock (POSIX).
    integer(c_int) function clock_gettime(clock, time) bind(c, name="clock_gettime")
      import :: c_int, timespec_t
      integer(c_int), value :: clock
      type(timespec_t), intent(out) :: time
    end function clock_gettime
  end interface

contains

  !> Return the time that the processor has spent on the calling thread, s: other load on the
  !> machine does not count.
  real(wp) function processor_time()
    type(timespec_t) :: time
    integer(c_int) :: ignored

    ignored = clock_gettime(thread_clock, time)
    processor_time = real(time%seconds, wp) + 1.0e-9_wp*real(time%nanoseconds, wp)
  end function processor_time

  !> Return the time of a monotonic clock, s.
  real(wp) function wall_time()
    integer(i8) :: count, rate

    call system_clock(count, rate)
    wall_time = real(count, wp)/real(rate, wp)
  end function wall_time

  !> Start timing a section.
  subroutine profile_start(self)
    class(profile_t), intent(inout) :: self

    self%began = wall_time()
  end subroutine profile_start

  !> Add the time since the start, or since the last call, to a section.
  subroutine profile_add(self, section)
    class(profile_t), intent(inout) :: self
    !> One of the `section_*` values.
    integer, intent(in) :: section

    real(wp) :: now

    now = wall_time()
    self%seconds(section) = self%seconds(section) + now - self%began
    self%began = now
  end subroutine profile_add

end module dd3_base_clock
