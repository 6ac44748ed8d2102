! SPDX-License-Identifier: GPL-3.0-or-later
!> Files that only one program writes: opened without being truncated, locked by flock, then
!> truncated. The system releases the lock when the program ends, however it ends. File systems
!> without locks give the file without one.
module dd3_base_lock
  use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_long, c_null_char, c_ptr
  use dd3_base_identity, only : is_regular
  use dd3_base_posix, only : c_fclose, c_fopen, linux_flock, posix_close, posix_dup, &
      posix_fileno, posix_ftruncate
  use dd3_base_system_error, only : errno
  implicit none
  private
  public :: open_locked

  !> Exclusive lock; do not wait for it.
  integer(c_int), parameter :: exclusive = 2, at_once = 4
  !> Error number of Linux: the lock is held by another program.
  integer(c_int), parameter :: ewouldblock = 11

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
