! SPDX-License-Identifier: GPL-3.0-or-later
!> Surroundings of the program: time, machine, working directory.
module dd3_base_environment
  use, intrinsic :: iso_c_binding, only : c_char, c_null_char, c_associated, c_size_t
  use dd3_base_posix, only : posix_getcwd, posix_gethostname
  implicit none
  private
  public :: host_name, local_time, working_directory

  !> Longest path and name.
  integer, parameter :: longest = 4096

contains

  !> Return the local time with its offset from UTC: 2026-01-31T12:00:00+01:00.
  function local_time() result(text)
    character(len=:), allocatable :: text

    character(len=12) :: date, time, zone

    call date_and_time(date, time, zone)
    text = date(1:4)//"-"//date(5:6)//"-"//date(7:8)//"T"//time(1:2)//":"//time(3:4)//":"// &
        time(5:6)//zone(1:3)//":"//zone(4:5)
  end function local_time

  !> Return the name of the machine; empty if it is unknown.
  function host_name() result(name)
    character(len=:), allocatable :: name

    character(kind=c_char, len=1) :: buffer(longest)

    name = ""
    if (posix_gethostname(buffer, size(buffer, kind=c_size_t)) == 0) name = text_of(buffer)
  end function host_name

  !> Return the working directory; empty if it is unknown.
  function working_directory() result(path)
    character(len=:), allocatable :: path

    character(kind=c_char, len=1) :: buffer(longest)

    path = ""
    if (c_associated(posix_getcwd(buffer, size(buffer, kind=c_size_t)))) path = text_of(buffer)
  end function working_directory

  !> Return the text before the null character.
  pure function text_of(buffer) result(text)
    character(kind=c_char, len=1), intent(in) :: buffer(:)
    character(len=:), allocatable :: text

    integer :: i, n

    n = findloc(buffer, c_null_char, 1) - 1
    allocate (character(len=max(0, n)) :: text)
    do i = 1, n
      text(i:i) = buffer(i)
    end do
  end function text_of

end module dd3_base_environment
