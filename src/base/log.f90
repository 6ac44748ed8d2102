! SPDX-License-Identifier: GPL-3.0-or-later
!> Log of a run, on the screen and in job.log. On a terminal, a status line is rewritten in place;
!> it is cleared before anything else is written. Of several ranks only the first writes.
module dd3_base_log
  use, intrinsic :: iso_c_binding, only : c_int
  use dd3_base_error, only : error_t, keep_first
  use dd3_base_file, only : file_t, standard_output
  use dd3_base_message, only : message_list_t, message_t, new_message
  use dd3_base_posix, only : posix_isatty
  use dd3_base_ranks, only : this_rank
  use dd3_base_text, only : newline
  implicit none
  private
  public :: log_t

  !> Carriage return, and the terminal sequence that clears the line.
  character(len=*), parameter :: wipe = achar(13)//achar(27)//"[K"

  !> The log of a run.
  type :: log_t
    !> Whether nothing is written to the screen.
    logical :: quiet = .false.
    !> Whether the screen is a terminal that can rewrite a line.
    logical :: terminal = .false.
    !> Warnings and notes so far.
    type(message_list_t) :: told
    !> Running phase, not allocated before the first, and accepted increments.
    character(len=:), allocatable :: phase
    integer :: increment = 0
    !> Length of the status line on the screen.
    integer, private :: live_length = 0
    !> Screen and job.log.
    type(file_t), private :: screen, file
    !> Lines written before job.log was opened.
    character(len=:), allocatable, private :: held
    !> First failed write to job.log, until it is reported.
    type(error_t), allocatable, private :: failure
  contains
    procedure :: start => log_start
    procedure :: open => log_open
    procedure :: say => log_say
    procedure :: tell => log_tell
    procedure :: report => log_report
    procedure :: note => log_note
    procedure :: live => log_live
    procedure :: check => log_check
    procedure :: descriptor => log_descriptor
    procedure :: close => log_close
  end type log_t

contains

  !> Attach to the screen. Lines are kept for job.log until it is open.
  subroutine log_start(self, quiet)
    class(log_t), intent(inout) :: self
    !> Whether nothing is written to the screen.
    logical, intent(in) :: quiet

    character(len=16) :: kind
    integer :: status

    self%quiet = this_rank() > 0 .or. quiet
    self%held = ""
    self%live_length = 0
    call self%screen%attach(int(standard_output, c_int), "screen")
    call get_environment_variable("TERM", kind, status=status)
    self%terminal = posix_isatty(int(standard_output, c_int)) == 1
    if (self%quiet .or. kind == "dumb" .or. kind == "") self%terminal = .false.
  end subroutine log_start

  !> Open job.log, locked against other runs, and write the lines kept for it.
  subroutine log_open(self, path, quiet, error, earlier)
    class(log_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    !> Whether nothing is written to the screen.
    logical, intent(in) :: quiet
    !> Set if job.log cannot be written, or another run writes it.
    type(error_t), allocatable, intent(out) :: error
    !> Log of an earlier run that is continued.
    character(len=*), intent(in), optional :: earlier

    if (this_rank() > 0) return
    if (.not. allocated(self%held)) call self%start(quiet)
    self%quiet = quiet
    call self%file%create(path, error, locked=.true.)
    if (.not. allocated(error)) call self%file%keep_room(error)
    if (allocated(error)) return
    if (present(earlier)) self%held = earlier//self%held
    call self%file%put(self%held, error)
    self%held = ""
    if (.not. allocated(error)) call self%file%flush(error)
  end subroutine log_open

  !> Write one or several lines to the screen and to job.log.
  subroutine log_say(self, text)
    class(log_t), intent(inout) :: self
    character(len=*), intent(in) :: text

    type(error_t), allocatable :: ignored

    if (.not. allocated(self%held)) call self%start(self%quiet)
    if (.not. self%quiet) then
      if (self%live_length > 0) call self%screen%put(wipe, ignored)
      self%live_length = 0
      call self%screen%put(text//newline, ignored)
      call self%screen%flush(ignored)
    end if
    call self%note(text)
  end subroutine log_say

  !> Write a warning or a note, and keep it with the phase and the increment.
  subroutine log_tell(self, message)
    class(log_t), intent(inout) :: self
    type(message_t), intent(in) :: message

    type(message_t) :: told

    told = message
    if (allocated(self%phase)) told%phase = self%phase
    told%increment = self%increment
    call self%told%add(told)
    call self%say(message%line())
  end subroutine log_tell

  !> Tell a text under a code; no-op if it is empty.
  subroutine log_report(self, code, text)
    class(log_t), intent(inout) :: self
    character(len=*), intent(in) :: code, text

    if (len(text) > 0) call self%tell(new_message(code, text))
  end subroutine log_report

  !> Write one or several lines to job.log only, at once: they are there if the program is killed.
  subroutine log_note(self, text)
    class(log_t), intent(inout) :: self
    character(len=*), intent(in) :: text

    type(error_t), allocatable :: error, late

    if (this_rank() > 0) return
    if (self%file%descriptor < 0) then
      if (.not. allocated(self%held)) call self%start(self%quiet)
      self%held = self%held//text//newline
      return
    end if
    call self%file%put(text//newline, error)
    call self%file%flush(late)
    call keep_first(error, late)
    if (.not. allocated(error) .or. allocated(self%failure)) return
    call move_alloc(error, self%failure)
  end subroutine log_note

  !> Rewrite the status line; an empty text clears it. No-op if the screen is not a terminal.
  subroutine log_live(self, text)
    class(log_t), intent(inout) :: self
    !> A single line.
    character(len=*), intent(in) :: text

    type(error_t), allocatable :: ignored

    if (.not. self%terminal) return
    if (len(text) == 0 .and. self%live_length == 0) return
    call self%screen%put(wipe//text(:min(len(text), screen_width() - 1)), ignored)
    call self%screen%flush(ignored)
    self%live_length = len(text)
  end subroutine log_live

  !> Flush job.log, check that it still has its name, and return its first failed write, once.
  subroutine log_check(self, error)
    class(log_t), intent(inout) :: self
    !> Set if job.log cannot be written.
    type(error_t), allocatable, intent(out) :: error

    if (self%file%descriptor >= 0) call self%file%flush(error)
    if (allocated(self%failure)) call move_alloc(self%failure, error)
  end subroutine log_check

  !> Return the descriptor of job.log; negative if it is not open.
  pure integer(c_int) function log_descriptor(self)
    class(log_t), intent(in) :: self

    log_descriptor = self%file%descriptor
  end function log_descriptor

  !> Clear the status line and close job.log.
  subroutine log_close(self, error)
    class(log_t), intent(inout) :: self
    !> Set if job.log cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%live("")
    call self%file%close(error)
    if (allocated(self%failure)) call move_alloc(self%failure, error)
  end subroutine log_close

  !> Return the number of columns of the screen.
  integer function screen_width()
    character(len=8) :: columns
    integer :: status

    screen_width = 80
    call get_environment_variable("COLUMNS", columns, status=status)
    if (status /= 0) return
    read (columns, *, iostat=status) screen_width
    if (status /= 0 .or. screen_width < 20) screen_width = 80
  end function screen_width

end module dd3_base_log
