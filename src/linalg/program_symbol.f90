! SPDX-License-Identifier: GPL-3.0-or-later
!> Procedures of libraries that may be part of the running program, looked up by name.
module dd3_linalg_program_symbol
  use, intrinsic :: iso_c_binding, only : c_char, c_funptr, c_null_char, c_null_ptr, c_ptr
  implicit none
  private
  public :: program_symbol

  interface
    !> Return the address of a symbol (POSIX).
    type(c_funptr) function dlsym(handle, name) bind(c, name="dlsym")
      import :: c_ptr, c_funptr, c_char
      !> Library to search; null for the whole program.
      type(c_ptr), value :: handle
      !> Null-terminated name.
      character(kind=c_char), intent(in) :: name(*)
    end function dlsym
  end interface

contains

  !> Return the address of a procedure of the program; null if there is none of this name.
  type(c_funptr) function program_symbol(name)
    character(len=*), intent(in) :: name

    program_symbol = dlsym(c_null_ptr, name//c_null_char)
  end function program_symbol

end module dd3_linalg_program_symbol
