! SPDX-License-Identifier: GPL-3.0-or-later
!> Files that only one program writes: opened without being truncated, locked by flock, then
!> truncated. The system releases the lock when the program ends, however it ends. File systems
!> without locks give the file without one.
module dd3_base_lock
  use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_int, c_long, c_null_char, c_ptr
  use dd3_base_identity, only : is_regular
  use dd3_base_system_error, only : errno
  implicit none
  private
  public :: open_locked

  !> Exclusive lock; do not wait for it.
  integer(c_int), parameter :: exclusive = 2, at_once = 4
  !> Error number of Linux: the lock is held by another program.
  integer(c_int), parameter :: ewouldblock = 11

  interface
    !> fopen(3): unlike open(2), it has no variable arguments.
    type(c_ptr) function c_fopen(path, mode) bind(c, name="fopen")
      import :: c_char, c_ptr
      !> Null-terminated.
      character(kind=c_char), intent(in) :: path(*), mode(*)
    end function c_fopen
    !> fileno(3).
    integer(c_int) function posix_fileno(stream) bind(c, name="fileno")
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
    end function posix_fileno
    !> fclose(3).
    integer(c_int) function c_fclose(stream) bind(c, name="fclose")
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
    end function c_fclose
    !> dup(2).
    integer(c_int) function posix_dup(descriptor) bind(c, name="dup")
      import :: c_int
      integer(c_int), value :: descriptor
    end function posix_dup
    !> flock(2).
    integer(c_int) function linux_flock(descriptor, operation) bind(c, name="flock")
      import :: c_int
      integer(c_int), value :: descriptor, operation
    end function linux_flock
    !> ftruncate(2).
    integer(c_int) function posix_ftruncate(descriptor, length) bind(c, name="ftruncate")
      import :: c_int, c_long
      integer(c_int), value :: descriptor
      integer(c_long), value :: length
    end function posix_ftruncate
    !> close(2).
    integer(c_int) function posix_close(descriptor) bind(c, name="close")
      import :: c_int
      integer(c_int), value :: descriptor
    end function posix_close
  end interface

contains

  !> Open a file for writing, locked and empty; what it held is lost only if the lock was obtained.
  subroutine open_locked(path, descriptor, busy)
    character(len=*), intent(in) :: path
    !> Negative if the file cannot be opened (the reason is in errno), or is locked.
    integer(c_int), intent(out) :: descriptor
    !> Another program has locked it.
    logical, intent(out) :: busy

    type(c_ptr) :: stream
    integer(c_int) :: ignored

    busy = .false.
    descriptor = -1
    stream = c_fopen(path//c_null_char, "a"//c_null_char)
    if (.not. c_associated(stream)) return
    descriptor = posix_dup(posix_fileno(stream))
    ignored = c_fclose(stream)
    if (descriptor < 0) return
    if (.not. is_regular(descriptor)) return
    busy = linux_flock(descriptor, exclusive + at_once) /= 0
    if (busy) busy = errno() == ewouldblock
    if (busy) then
      ignored = posix_close(descriptor)
      descriptor = -1
    else
      ignored = posix_ftruncate(descriptor, 0_c_long)
    end if
  end subroutine open_locked

end module dd3_base_lock
