! SPDX-License-Identifier: GPL-3.0-or-later
!> End the program by `exit` if an allocation fails; see `src/app/memory.f90`. gfortran does not
!> check the arrays that an assignment reallocates: they are written through a null pointer. The
!> linker directs `malloc` and `realloc` of the compiled program to the procedures below. Where it
!> cannot, this file is left out, and a failed allocation in an assignment is a segmentation fault.
module dd3_external_checked_malloc
  use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_ptr, c_size_t
  use dd3_base_posix, only : c_exit
  implicit none
  private

  !> Exit code of a run that stopped before its end.
  integer(c_int), parameter :: code_stopped = 3

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

  type(c_ptr) function checked_malloc(bytes) result(memory) bind(c, name="__wrap_malloc")
    integer(c_size_t), value :: bytes

    memory = c_malloc(bytes)
    if (.not. c_associated(memory) .and. bytes > 0) call c_exit(code_stopped)
  end function checked_malloc

  type(c_ptr) function checked_realloc(old, bytes) result(memory) bind(c, name="__wrap_realloc")
    type(c_ptr), value :: old
    integer(c_size_t), value :: bytes

    memory = c_realloc(old, bytes)
    if (.not. c_associated(memory) .and. bytes > 0) call c_exit(code_stopped)
  end function checked_realloc

end module dd3_external_checked_malloc
