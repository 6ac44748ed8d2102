! SPDX-License-Identifier: GPL-3.0-or-later
!> Identity of files, whatever their names: device and inode, by statx (Linux). Symbolic links are
!> followed.
module dd3_base_identity
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_int16_t, c_int32_t, c_int64_t, &
      c_null_char
  implicit none
  private
  public :: is_same_file, is_at, is_regular

  !> Directory descriptor that stands for the working directory.
  integer(c_int), parameter :: working_directory = -100
  !> Flag for the file of a descriptor: an empty path.
  integer(c_int), parameter :: empty_path = int(z'1000', c_int)
  !> Fields asked for: type, mode, inode.
  integer(c_int), parameter :: wanted = int(z'103', c_int)
  !> Bits of the mode that hold the type, and their value for a regular file.
  integer, parameter :: type_bits = int(o'170000'), regular = int(o'100000')

  !> struct statx of the Linux kernel: the same on all architectures.
  type, bind(c) :: statx_t
    integer(c_int32_t) :: mask, block_size
    integer(c_int64_t) :: attributes
    integer(c_int32_t) :: links, user, group
    integer(c_int16_t) :: mode, padding
    integer(c_int64_t) :: inode, size, blocks, known_attributes
    integer(c_int64_t) :: times(8)
    integer(c_int32_t) :: of_device(2), device(2)
    integer(c_int64_t) :: spare(14)
  end type statx_t

  interface
    !> statx(2).
    integer(c_int) function linux_statx(directory, path, flags, mask, status) bind(c, name="statx")
      import :: c_char, c_int, statx_t
      integer(c_int), value :: directory
      !> Null-terminated.
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: flags, mask
      type(statx_t), intent(out) :: status
    end function linux_statx
  end interface

contains

  !> Whether two paths name the same file; false if one of them does not exist.
  logical function is_same_file(first, second)
    character(len=*), intent(in) :: first, second

    type(statx_t) :: a, b

    is_same_file = .false.
    if (linux_statx(working_directory, first//c_null_char, 0_c_int, wanted, a) /= 0) return
    if (linux_statx(working_directory, second//c_null_char, 0_c_int, wanted, b) /= 0) return
    is_same_file = equal(a, b)
  end function is_same_file

  !> Whether an open file is still the one with a name; true if the system cannot tell.
  logical function is_at(descriptor, path)
    integer(c_int), intent(in) :: descriptor
    character(len=*), intent(in) :: path

    type(statx_t) :: open, named

    is_at = linux_statx(descriptor, c_null_char, empty_path, wanted, open) /= 0
    if (is_at) return
    if (linux_statx(working_directory, path//c_null_char, 0_c_int, wanted, named) /= 0) return
    is_at = equal(open, named)
  end function is_at

  !> Whether an open file is a regular one: no device, no pipe.
  logical function is_regular(descriptor)
    integer(c_int), intent(in) :: descriptor

    type(statx_t) :: status

    is_regular = linux_statx(descriptor, c_null_char, empty_path, wanted, status) == 0
    if (is_regular) is_regular = iand(int(status%mode), type_bits) == regular
  end function is_regular

  !> Whether the data of two files agree in device and inode.
  pure logical function equal(a, b)
    type(statx_t), intent(in) :: a, b

    equal = a%inode == b%inode .and. all(a%device == b%device)
  end function equal

end module dd3_base_identity
