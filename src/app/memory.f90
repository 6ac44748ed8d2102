! SPDX-License-Identifier: GPL-3.0-or-later
!> Ends of the program that no caller can handle, above all for lack of memory: a sentence on the
!> error stream and in job.log, a run.json that was composed before, and exit code 3.
!>
!> They are written by a procedure that `exit` calls. gfortran calls `exit` if an array cannot be
!> allocated, and so do libraries; for allocations that gfortran does not check,
!> `src/external/checked_malloc.f90` does so. No memory is allocated here, so that texts are written
!> piece by piece. Module variables hold what the procedure needs, as it has no arguments.
module dd3_app_memory
  use, intrinsic :: iso_c_binding, only : c_funloc, c_int, c_null_char, c_size_t
  use dd3_base_posix, only : c_atexit, c_exit, posix_creat, posix_exit, posix_rename, &
      posix_write
  implicit none
  private
  public :: watch_memory, watch_log, watch_run_file, end_program, ended_message

  !> Descriptor of the error stream.
  integer(c_int), parameter :: error_stream = 2
  !> Exit code of a run that stopped before its end.
  integer(c_int), parameter :: code_stopped = 3

  !> Message on the error stream and in job.log, and that in run.json.
  character(len=*), parameter :: message = "stopped E202: not enough memory, or a library "// &
      "ended the program with a message of its own; a mesh with fewer elements needs less "// &
      "memory, or raise the limit (ulimit -v, the memory asked of a batch queue)"//new_line("a")
  character(len=*), parameter :: ended_message = "the program was ended, most often for lack "// &
      "of memory; see job.log"

  !> Path of run.json, its temporary name, both with a null character, and its content then; not
  !> allocated if there is none.
  character(len=:), allocatable :: run_path, run_part, run_text
  !> Descriptor of job.log; negative if there is none.
  integer(c_int) :: log_descriptor = -1
  !> Whether the program ends as it should.
  logical :: finished = .false.

contains

  !> Watch the ends of the program from now on.
  subroutine watch_memory()
    integer(c_int) :: ignored

    finished = .false.
    ignored = c_atexit(c_funloc(end_without_memory))
  end subroutine watch_memory

  !> Write the message of such an end into job.log too.
  subroutine watch_log(descriptor)
    !> Negative if there is none any more.
    integer(c_int), intent(in) :: descriptor

    log_descriptor = descriptor
  end subroutine watch_log

  !> Write run.json too on such an end.
  subroutine watch_run_file(path, part, text)
    !> Its path, and its temporary name; empty if there is none any more.
    character(len=*), intent(in) :: path, part
    !> Its content then.
    character(len=*), intent(in) :: text

    if (allocated(run_text)) deallocate (run_text)
    if (path == "") return
    run_path = path//c_null_char
    run_part = part//c_null_char
    run_text = text
  end subroutine watch_run_file

  !> End the program.
  subroutine end_program(code)
    integer, intent(in) :: code

    finished = .true.
    call c_exit(int(code, c_int))
  end subroutine end_program

  !> Called by `exit`: write the message and run.json, and end with exit code 3.
  subroutine end_without_memory() bind(c)
    integer(c_size_t) :: ignored

    if (finished) return
    ignored = posix_write(error_stream, "dd3imp: "//message, len("dd3imp: "//message, c_size_t))
    if (log_descriptor >= 0) ignored = posix_write(log_descriptor, message, len(message, c_size_t))
    call write_run_file()
    call posix_exit(code_stopped)
  end subroutine end_without_memory

  !> Write run.json under its temporary name and rename it.
  subroutine write_run_file()
    integer(c_int), parameter :: mode = int(o'666', c_int)
    integer(c_int) :: file, ignored

    if (.not. allocated(run_text)) return
    file = posix_creat(run_part, mode)
    if (file < 0) return
    if (posix_write(file, run_text, len(run_text, c_size_t)) == len(run_text, c_size_t)) then
      ignored = posix_rename(run_part, run_path)
    end if
  end subroutine write_run_file

end module dd3_app_memory
