! SPDX-License-Identifier: GPL-3.0-or-later
!> Operations on whole files: read, replace by another, synchronise with the disk.
module dd3_base_file_system
  use, intrinsic :: iso_c_binding, only : c_int, c_null_char
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_file, only : file_t, remove_file
  use dd3_base_kinds, only : i8
  use dd3_base_posix, only : posix_fsync, posix_rename
  use dd3_base_system_error, only : errno, system_message
  implicit none
  private
  public :: read_file, replace_file, keep_file, sync_file, write_file, part_of

contains

  !> Read a file.
  subroutine read_file(path, text, error)
    character(len=*), intent(in) :: path
    !> Content with the line ends.
    character(len=:), allocatable, intent(out) :: text
    !> Set if the file cannot be read.
    type(error_t), allocatable, intent(out) :: error

    character(len=256) :: message
    integer(i8) :: length
    integer :: unit, status

    text = ""
    open (newunit=unit, file=path, access="stream", status="old", action="read", iostat=status, &
        iomsg=message)
    if (status == 0) then
      inquire (unit, size=length)
      deallocate (text)
      allocate (character(len=max(0_i8, length)) :: text)
      read (unit, iostat=status, iomsg=message) text
      close (unit)
    end if
    if (status /= 0) call fatal_error(error, "cannot read '"//path//"': "//trim(message), "E203")
  end subroutine read_file

  !> Return the temporary name under which a file is written before it replaces the old one.
  pure function part_of(path) result(part)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: part

    part = path//".part"
  end function part_of

  !> Replace a file by its temporary one, atomically.
  subroutine replace_file(path, part, error)
    character(len=*), intent(in) :: path
    !> The temporary file, open; it gets the path.
    type(file_t), intent(inout) :: part
    !> Set if the file cannot be replaced.
    type(error_t), allocatable, intent(out) :: error

    integer(c_int) :: cause

    if (posix_rename(part%path//c_null_char, path//c_null_char) == 0) then
      part%path = path
    else
      cause = errno()
      call part%refuse("cannot replace '"//path//"' by '"//part%path//"': "// &
          system_message(cause), error)
    end if
  end subroutine replace_file

  !> Write a file as a whole: aside, synced and renamed. A program that is killed leaves the old
  !> one.
  subroutine write_file(path, text, error)
    character(len=*), intent(in) :: path
    !> Content with the line ends.
    character(len=*), intent(in) :: text
    !> Set if the file cannot be written; an older one is left as it is.
    type(error_t), allocatable, intent(out) :: error

    type(file_t) :: part
    type(error_t), allocatable :: ignored
    logical :: removed

    call part%create(part_of(path), error)
    if (allocated(error)) return
    call part%put(text, error)
    if (.not. allocated(error)) call part%flush(error)
    if (.not. allocated(error)) then
      call sync_file(part)
      call replace_file(path, part, error)
    end if
    call part%close(ignored)
    if (allocated(error)) call remove_file(part_of(path), removed)
  end subroutine write_file

  !> Keep a file that is about to be replaced under its name with a suffix; no-op if there is none.
  subroutine keep_file(path, suffix)
    character(len=*), intent(in) :: path, suffix

    integer(c_int) :: ignored

    ignored = posix_rename(path//c_null_char, path//suffix//c_null_char)
  end subroutine keep_file

  !> Wait until the content of an open file is on the disk. Errors are ignored: not all file systems
  !> support this.
  subroutine sync_file(file)
    type(file_t), intent(in) :: file

    integer(c_int) :: ignored

    ignored = posix_fsync(file%descriptor)
  end subroutine sync_file

end module dd3_base_file_system
