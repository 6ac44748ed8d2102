! SPDX-License-Identifier: GPL-3.0-or-later
!> The last error of a system call: its number and its message.
module dd3_base_system_error
  use, intrinsic :: iso_c_binding, only : c_associated, c_f_pointer, c_char, c_int, c_ptr, c_size_t
  use dd3_base_kinds, only : i8
  implicit none
  private
  public :: errno, system_message

  interface
    !> Address of errno.
    type(c_ptr) function errno_location() bind(c, name="__errno_location")
      import :: c_ptr
    end function errno_location
    !> strerror(3).
    type(c_ptr) function c_strerror(number) bind(c, name="strerror")
      import :: c_int, c_ptr
      integer(c_int), value :: number
    end function c_strerror
    !> strlen(3).
    integer(c_size_t) function c_strlen(text) bind(c, name="strlen")
      import :: c_ptr, c_size_t
      !> Address of a null-terminated text.
      type(c_ptr), value :: text
    end function c_strlen
  end interface

contains

  !> Return the number of the last system error.
  integer(c_int) function errno()
    integer(c_int), pointer :: number

    call c_f_pointer(errno_location(), number)
    errno = number
  end function errno

  !> Return the message of a system error.
  function system_message(number) result(message)
    integer(c_int), intent(in) :: number
    character(len=:), allocatable :: message

    character(kind=c_char), pointer :: letter(:)
    type(c_ptr) :: address
    integer :: i

    message = "unknown cause"
    address = c_strerror(number)
    if (.not. c_associated(address)) return
    call c_f_pointer(address, letter, [c_strlen(address)])
    message = repeat(" ", size(letter, kind=i8))
    do i = 1, size(letter)
      message(i:i) = letter(i)
    end do
  end function system_message

end module dd3_base_system_error
