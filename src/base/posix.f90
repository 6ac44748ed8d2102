! SPDX-License-Identifier: GPL-3.0-or-later
!> Interfaces of the C library and the system that Fortran has no statement for: files by their
!> descriptors, directories, limits, the environment and the end of the program. Texts that are
!> passed end with a null character.
module dd3_base_posix
  use, intrinsic :: iso_c_binding, only : c_char, c_funptr, c_int, c_long, c_ptr, c_size_t
  implicit none
  private
  public :: posix_creat, posix_write, posix_ftruncate, posix_lseek, posix_close, posix_dup, &
      posix_fsync, linux_fallocate, linux_flock, posix_isatty, posix_mkdir, posix_unlink, &
      posix_rename, posix_readlink, posix_getcwd, posix_gethostname, posix_getrlimit, &
      posix_setenv, posix_execv, c_fopen, posix_fileno, c_fclose, c_atexit, c_exit, posix_exit

  interface
    !> creat(2).
    integer(c_int) function posix_creat(path, mode) bind(c, name="creat")
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
    end function posix_creat
    !> write(2).
    integer(c_size_t) function posix_write(descriptor, buffer, count) bind(c, name="write")
      import :: c_char, c_int, c_size_t
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: buffer(*)
      integer(c_size_t), value :: count
    end function posix_write
    !> ftruncate(2).
    integer(c_int) function posix_ftruncate(descriptor, length) bind(c, name="ftruncate")
      import :: c_int, c_long
      integer(c_int), value :: descriptor
      integer(c_long), value :: length
    end function posix_ftruncate
    !> lseek(2).
    integer(c_long) function posix_lseek(descriptor, offset, whence) bind(c, name="lseek")
      import :: c_int, c_long
      !> `whence` is the origin of the offset.
      integer(c_int), value :: descriptor, whence
      integer(c_long), value :: offset
    end function posix_lseek
    !> close(2).
    integer(c_int) function posix_close(descriptor) bind(c, name="close")
      import :: c_int
      integer(c_int), value :: descriptor
    end function posix_close
    !> dup(2).
    integer(c_int) function posix_dup(descriptor) bind(c, name="dup")
      import :: c_int
      integer(c_int), value :: descriptor
    end function posix_dup
    !> fsync(2).
    integer(c_int) function posix_fsync(descriptor) bind(c, name="fsync")
      import :: c_int
      integer(c_int), value :: descriptor
    end function posix_fsync
    !> fallocate(2).
    integer(c_int) function linux_fallocate(descriptor, mode, offset, length) &
        bind(c, name="fallocate")
      import :: c_int, c_long
      integer(c_int), value :: descriptor, mode
      integer(c_long), value :: offset, length
    end function linux_fallocate
    !> flock(2).
    integer(c_int) function linux_flock(descriptor, operation) bind(c, name="flock")
      import :: c_int
      integer(c_int), value :: descriptor, operation
    end function linux_flock
    !> isatty(3).
    integer(c_int) function posix_isatty(descriptor) bind(c, name="isatty")
      import :: c_int
      integer(c_int), value :: descriptor
    end function posix_isatty
    !> mkdir(2).
    integer(c_int) function posix_mkdir(path, mode) bind(c, name="mkdir")
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
    end function posix_mkdir
    !> unlink(2).
    integer(c_int) function posix_unlink(path) bind(c, name="unlink")
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
    end function posix_unlink
    !> rename(2).
    integer(c_int) function posix_rename(from, to) bind(c, name="rename")
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: from(*), to(*)
    end function posix_rename
    !> readlink(2).
    integer(c_size_t) function posix_readlink(path, buffer, size) bind(c, name="readlink")
      import :: c_char, c_int, c_size_t
      character(kind=c_char), intent(in) :: path(*)
      !> Target of the link.
      character(kind=c_char), intent(out) :: buffer(*)
      integer(c_size_t), value :: size
    end function posix_readlink
    !> getcwd(3).
    type(c_ptr) function posix_getcwd(buffer, size) bind(c, name="getcwd")
      import :: c_char, c_ptr, c_size_t
      character(kind=c_char), intent(out) :: buffer(*)
      integer(c_size_t), value :: size
    end function posix_getcwd
    !> gethostname(2).
    integer(c_int) function posix_gethostname(buffer, size) bind(c, name="gethostname")
      import :: c_char, c_int, c_size_t
      character(kind=c_char), intent(out) :: buffer(*)
      integer(c_size_t), value :: size
    end function posix_gethostname
    !> getrlimit(2).
    integer(c_int) function posix_getrlimit(resource, limits) bind(c, name="getrlimit")
      import :: c_int, c_long
      integer(c_int), value :: resource
      !> Soft and hard limit.
      integer(c_long), intent(out) :: limits(2)
    end function posix_getrlimit
    !> setenv(3).
    integer(c_int) function posix_setenv(name, value, overwrite) bind(c, name="setenv")
      import :: c_char, c_int
      !> Ended by a null.
      character(kind=c_char), intent(in) :: name(*), value(*)
      !> Replace an existing value.
      integer(c_int), value :: overwrite
    end function posix_setenv
    !> execv(3): returns only if it fails.
    integer(c_int) function posix_execv(path, argument) bind(c, name="execv")
      import :: c_char, c_int, c_ptr
      character(kind=c_char), intent(in) :: path(*)
      !> Texts ended by a null, and a null pointer at the end.
      type(c_ptr), intent(in) :: argument(*)
    end function posix_execv
    !> fopen(3): unlike open(2), it has no variable arguments.
    type(c_ptr) function c_fopen(path, mode) bind(c, name="fopen")
      import :: c_char, c_ptr
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
    !> atexit(3).
    integer(c_int) function c_atexit(handler) bind(c, name="atexit")
      import :: c_funptr, c_int
      type(c_funptr), value :: handler
    end function c_atexit
    !> exit(3).
    subroutine c_exit(code) bind(c, name="exit")
      import :: c_int
      integer(c_int), value :: code
    end subroutine c_exit
    !> _exit(2): end at once.
    subroutine posix_exit(code) bind(c, name="_exit")
      import :: c_int
      integer(c_int), value :: code
    end subroutine posix_exit
  end interface

end module dd3_base_posix
