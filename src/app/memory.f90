! SPDX-License-Identifier: GPL-3.0-or-later
!> Ends of the program that no caller can handle, above all for lack of memory: a sentence on the
!> error stream and in job.log, a run.json that was composed before, and exit code 3.
!>
!> The compiled program allocates through `malloc` and `realloc`, and gfortran does not check each
!> of them: arrays that an assignment reallocates are written through a null pointer. So the linker
!> directs both to the procedures below (`--wrap`, CMakeLists.txt), which end the program if there
!> is no memory. An end within a library, which allocates for itself, is caught by a procedure that
!> `exit` calls. Neither may allocate memory, so that texts are written piece by piece. Module
!> variables hold what the procedures need, as they have no arguments for it.
module dd3_app_memory
  use, intrinsic :: iso_c_binding, only : c_associated, c_funloc, c_int, c_null_char, c_ptr, &
      c_size_t
  use dd3_base_posix, only : c_atexit, c_exit, posix_creat, posix_exit, posix_rename, &
      posix_write
  implicit none
  private
  public :: watch_memory, watch_log, watch_run_file, end_program, ended_message

  !> Descriptor of the error stream.
  integer(c_int), parameter :: error_stream = 2
  !> Exit code of a run that stopped before its end.
  integer(c_int), parameter :: code_stopped = 3
  !> Remedy in the message.
  character(len=*), parameter :: remedy = "; a mesh with fewer elements needs less, or raise "// &
      "the limit (ulimit -v, the memory asked of a batch queue)"

  !> Message in run.json on such an end.
  character(len=*), parameter :: ended_message = "the program was ended, most often for lack "// &
      "of memory; see job.log"

  !> Path of run.json, its temporary name, both with a null character, and its content then; not
  !> allocated if there is none.
  character(len=:), allocatable, save :: run_path, run_part, run_text
  !> Descriptor of job.log; negative if there is none.
  integer(c_int), save :: log_descriptor = -1
  !> Whether the program ends as it should; whether a message is being written.
  logical, save :: finished = .false., ending = .false.

  interface
    !> malloc(3) of the C library.
    type(c_ptr) function c_malloc(bytes) bind(c, name="__real_malloc")
      import :: c_ptr, c_size_t
      integer(c_size_t), value :: bytes
    end function c_malloc
    !> realloc(3) of the C library.
    type(c_ptr) function c_realloc(old, bytes) bind(c, name="__real_realloc")
      import :: c_ptr, c_size_t
      type(c_ptr), value :: old
      integer(c_size_t), value :: bytes
    end function c_realloc
  end interface

contains

  !> Watch the ends of the program from now on.
  subroutine watch_memory()
    integer(c_int) :: ignored

    finished = .false.
    ignored = c_atexit(c_funloc(end_in_library))
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

  !> Take the place of malloc(3) in the compiled program.
  type(c_ptr) function checked_malloc(bytes) result(memory) bind(c, name="__wrap_malloc")
    integer(c_size_t), value :: bytes

    memory = c_malloc(bytes)
    if (.not. c_associated(memory) .and. bytes > 0) call end_without_memory(bytes)
  end function checked_malloc

  !> Take the place of realloc(3) in the compiled program.
  type(c_ptr) function checked_realloc(old, bytes) result(memory) bind(c, name="__wrap_realloc")
    type(c_ptr), value :: old
    integer(c_size_t), value :: bytes

    memory = c_realloc(old, bytes)
    if (.not. c_associated(memory) .and. bytes > 0) call end_without_memory(bytes)
  end function checked_realloc

  !> End the program as an array cannot be allocated.
  subroutine end_without_memory(bytes)
    integer(c_size_t), intent(in) :: bytes

    integer(c_size_t), parameter :: megabyte = 1000000_c_size_t

    if (ending) call posix_exit(code_stopped)
    ending = .true.
    call put("stopped E202: not enough memory: an array of ")
    call put_integer(bytes/megabyte + merge(1_c_size_t, 0_c_size_t, bytes < megabyte))
    call put(" MB could not be allocated"//remedy//new_line("a"))
    call write_run_file()
    call posix_exit(code_stopped)
  end subroutine end_without_memory

  !> Called by `exit`: a library has ended the program.
  subroutine end_in_library() bind(c)
    if (finished .or. ending) return
    ending = .true.
    call put("stopped E202: a library ended the program, most often for lack of memory; its "// &
        "own message is on the error stream"//remedy//new_line("a"))
    call write_run_file()
    call posix_exit(code_stopped)
  end subroutine end_in_library

  !> Write a text on the error stream and into job.log.
  subroutine put(text)
    character(len=*), intent(in) :: text

    integer(c_size_t) :: ignored

    if (index(text, "stopped") == 1) ignored = posix_write(error_stream, "dd3imp: ", 8_c_size_t)
    ignored = posix_write(error_stream, text, len(text, c_size_t))
    if (log_descriptor >= 0) ignored = posix_write(log_descriptor, text, len(text, c_size_t))
  end subroutine put

  !> Write run.json under its temporary name and rename it.
  subroutine write_run_file()
    integer(c_int), parameter :: mode = int(o'666', c_int)
    integer(c_int) :: file, ignored

    if (.not. allocated(run_text)) return
    file = posix_creat(run_part, mode)
    if (file < 0) return
    if (posix_write(file, run_text, len(run_text, c_size_t)) == len(run_text, c_size_t)) &
        ignored = posix_rename(run_part, run_path)
  end subroutine write_run_file

  !> Write a number.
  subroutine put_integer(number)
    integer(c_size_t), intent(in) :: number

    character(len=20) :: digits
    integer(c_size_t) :: rest
    integer :: i

    rest = number
    do i = len(digits), 1, -1
      digits(i:i) = achar(iachar("0") + int(mod(rest, 10_c_size_t)))
      rest = rest/10_c_size_t
      if (rest == 0) exit
    end do
    call put(digits(max(1, i):))
  end subroutine put_integer

end module dd3_app_memory
