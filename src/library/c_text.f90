! SPDX-License-Identifier: GPL-3.0-or-later
!> Texts of C.
module dd3_library_c_text
  use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_f_pointer, c_null_char, c_ptr, &
      c_size_t
  implicit none
  private
  public :: from_c, to_c

contains

  !> Return a text of C; empty for a null pointer.
  function from_c(address) result(text)
    type(c_ptr), intent(in) :: address
    character(len=:), allocatable :: text

    character(kind=c_char), pointer :: bytes(:)
    integer :: i, n

    n = 0
    if (c_associated(address)) then
      call c_f_pointer(address, bytes, [huge(0)])
      do while (bytes(n + 1) /= c_null_char)
        n = n + 1
      end do
    end if
    allocate (character(len=n) :: text)
    do i = 1, n
      text(i:i) = bytes(i)
    end do
  end function from_c

  !> Copy a text, cut to the length of the array of C; nothing for a null pointer.
  subroutine to_c(text, address, length)
    character(len=*), intent(in) :: text
    type(c_ptr), intent(in) :: address
    !> Length of the array, with the null character at the end.
    integer(c_size_t), intent(in) :: length

    character(kind=c_char), pointer :: bytes(:)
    integer :: i, n

    if (.not. c_associated(address) .or. length < 1) return
    n = int(min(int(len(text), c_size_t), length - 1))
    call c_f_pointer(address, bytes, [n + 1])
    do i = 1, n
      bytes(i) = text(i:i)
    end do
    bytes(n + 1) = c_null_char
  end subroutine to_c

end module dd3_library_c_text
