! SPDX-License-Identifier: GPL-3.0-or-later
!> Display of the progress of a run: on a terminal one line, rewritten in place at most ten times a
!> second; otherwise, and always in job.log, a plain line for every twentieth of a phase. The last
!> line of a phase stays on the terminal too.
module dd3_output_progress
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : wall_time
  use dd3_base_log, only : log_t
  use dd3_base_text, only : to_text
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: progress_t, progress_view_t, duration_text

  !> Shortest time between two updates of the live line, s.
  real(wp), parameter :: pause = 0.1_wp
  !> Plain lines in a phase.
  integer, parameter :: lines_per_phase = 20
  !> Shortest time over which the rate is averaged, s.
  real(wp), parameter :: shortest_average = 5.0_wp

  !> Data of an accepted increment that are displayed.
  type :: progress_view_t
    !> Running phase, from 1.
    integer :: phase = 1
    !> Progress in the phase, 0 to 1.
    real(wp) :: progress = 0.0_wp
    !> Path of the controlling tools since the job's start, mm.
    real(wp) :: travel = 0.0_wp
    integer :: increment = 0
    !> Number of elements where it changes; 0 otherwise.
    integer :: elements = 0
    !> Factor on the trial increment, and the limiter that set it.
    real(wp) :: r = 0.0_wp
    character(len=16) :: limiter = ""
    !> Iterations of the corrector.
    integer :: iterations = 0
    !> Force of the controlling tool, N.
    real(wp) :: force = 0.0_wp
  end type progress_view_t

  !> Display of a run.
  type :: progress_t
    character(len=24), allocatable, private :: phase_name(:)
    !> Controlling tool of each phase; blank if loads control it.
    character(len=24), allocatable, private :: control_name(:)
    !> Phase displayed last, and its plain lines so far.
    integer, private :: phase = 0, lines = 0
    !> Times of the last live line, of the last update of the rate and of the start of the phase, s.
    real(wp), private :: shown = 0.0_wp, rate_updated = 0.0_wp, phase_began = 0.0_wp
    !> Progress at the last update of the rate; rate of progress, 1/s.
    real(wp), private :: last_progress = 0.0_wp, rate = 0.0_wp
  contains
    procedure :: start => progress_start
    procedure :: update => progress_update
    procedure :: finish => progress_finish
  end type progress_t

contains

  !> Start the display.
  subroutine progress_start(self, model)
    class(progress_t), intent(inout) :: self
    type(model_t), intent(in) :: model

    integer :: i, control

    if (allocated(self%phase_name)) deallocate (self%phase_name, self%control_name)
    allocate (self%phase_name(size(model%phase)), self%control_name(size(model%phase)))
    do i = 1, size(model%phase)
      self%phase_name(i) = model%phase(i)%name
      self%control_name(i) = ""
      control = model%phase(i)%control
      if (control > 0) self%control_name(i) = model%tool(control)%name
    end do
    self%phase = 0
  end subroutine progress_start

  !> Show an accepted increment if a line is due.
  subroutine progress_update(self, log, view)
    class(progress_t), intent(inout) :: self
    type(log_t), intent(inout) :: log
    type(progress_view_t), intent(in) :: view

    real(wp) :: now
    integer :: line

    now = wall_time()
    if (view%phase /= self%phase) call begin_phase(self, log, view, now)
    line = int(view%progress*lines_per_phase + 1.0e-9_wp)
    if (line > self%lines) then
      self%lines = line
      if (log%terminal .and. view%progress < 1.0_wp) then
        call log%note(plain_line(self, view))
      else
        call log%say(plain_line(self, view))
      end if
    end if
    if (.not. log%terminal .or. now - self%shown < pause) return
    call update_rate(self, view%progress, now)
    call log%live(live_line(self, view))
    self%shown = now
  end subroutine progress_update

  !> Write the heading of a phase.
  subroutine begin_phase(self, log, view, now)
    type(progress_t), intent(inout) :: self
    type(log_t), intent(inout) :: log
    type(progress_view_t), intent(in) :: view
    !> Present time, s.
    real(wp), intent(in) :: now

    self%phase = view%phase
    self%lines = 0
    self%phase_began = now
    self%rate_updated = now
    self%last_progress = 0.0_wp
    self%rate = 0.0_wp
    call log%say("phase "//to_text(view%phase)//" of "//to_text(size(self%phase_name))//": "// &
        trim(self%phase_name(view%phase)))
    if (self%control_name(view%phase) == "") then
      call log%say("      done   increment            r  limited by        iterations")
    else
      call log%say("    travel   increment            r  limited by        iterations   "// &
          "force on "//trim(self%control_name(view%phase)))
      call log%say("        mm                                                        N")
    end if
  end subroutine begin_phase

  !> Average the rate of progress over a time that grows with the phase.
  subroutine update_rate(self, progress, now)
    type(progress_t), intent(inout) :: self
    !> Progress in the phase, 0 to 1.
    real(wp), intent(in) :: progress
    !> Present time, s.
    real(wp), intent(in) :: now

    real(wp) :: weight, passed

    passed = now - self%rate_updated
    if (passed <= 0.0_wp) return
    weight = min(1.0_wp, passed/max(shortest_average, 0.2_wp*(now - self%phase_began)))
    if (self%rate <= 0.0_wp) weight = 1.0_wp
    self%rate = (1.0_wp - weight)*self%rate + weight*(progress - self%last_progress)/passed
    self%rate_updated = now
    self%last_progress = progress
  end subroutine update_rate

  !> Return a line of the table of a phase.
  function plain_line(self, view) result(line)
    type(progress_t), intent(in) :: self
    type(progress_view_t), intent(in) :: view
    character(len=:), allocatable :: line

    character(len=100) :: buffer

    if (self%control_name(view%phase) == "") then
      write (buffer, '(f8.1, " %", i12, f13.5, 2x, a16, i12)') 100.0_wp*view%progress, &
          view%increment, view%r, view%limiter, view%iterations
    else
      write (buffer, '(f10.4, i12, f13.5, 2x, a16, i12, f14.1)') view%travel, view%increment, &
          view%r, view%limiter, view%iterations, view%force
    end if
    line = trim(buffer)
  end function plain_line

  !> Return the line that is rewritten in place.
  function live_line(self, view) result(line)
    type(progress_t), intent(in) :: self
    type(progress_view_t), intent(in) :: view
    character(len=:), allocatable :: line

    character(len=12) :: travel, r

    if (self%control_name(view%phase) == "") then
      write (travel, '(f5.1, " %")') 100.0_wp*view%progress
    else
      write (travel, '(f8.3, " mm")') view%travel
    end if
    write (r, '(f10.4)') view%r
    line = trim(self%phase_name(view%phase))//" "//trim(adjustl(travel))//", inc "// &
        to_text(view%increment)//", r "//trim(adjustl(r))//" ("//trim(view%limiter)//"), "// &
        to_text(view%iterations)//" it"
    if (view%elements > 0) line = line//", "//to_text(view%elements)//" elements"
    if (self%control_name(view%phase) /= "") line = line//", "//force_text(view%force)
    if (self%rate > 0.0_wp) then
      line = line//", "//duration_text((1.0_wp - view%progress)/self%rate)//" left"
      if (view%phase < size(self%phase_name)) line = line//" in phase"
    end if
  end function live_line

  !> Format a force with its unit.
  function force_text(force) result(text)
    !> N.
    real(wp), intent(in) :: force
    character(len=:), allocatable :: text

    character(len=24) :: buffer

    if (abs(force) < 1.0e4_wp) then
      write (buffer, '(f0.1, " N")') force
    else
      write (buffer, '(f0.2, " kN")') force/1000.0_wp
    end if
    text = trim(buffer)
    if (text(1:1) == ".") text = "0"//text
  end function force_text

  !> Format a time in seconds, minutes or hours.
  pure function duration_text(seconds) result(text)
    real(wp), intent(in) :: seconds
    character(len=:), allocatable :: text

    integer :: whole
    character(len=24) :: buffer

    whole = nint(min(seconds, 3.6e7_wp))
    if (whole < 60) then
      write (buffer, '(i0, " s")') whole
    else if (whole < 3600) then
      write (buffer, '(i0, ":", i2.2, " min")') whole/60, mod(whole, 60)
    else
      write (buffer, '(i0, ":", i2.2, " h")') whole/3600, mod(whole/60, 60)
    end if
    text = trim(buffer)
  end function duration_text

  !> Clear the live line.
  subroutine progress_finish(self, log)
    class(progress_t), intent(inout) :: self
    type(log_t), intent(inout) :: log

    call log%live("")
    self%phase = 0
  end subroutine progress_finish

end module dd3_output_progress
