! SPDX-License-Identifier: GPL-3.0-or-later
!> Restrict OpenBLAS to one thread, so that only the option --threads starts further ones. The call
!> is looked up by name in the running program; no-op with any other BLAS.
module dd3_linalg_blas_threads
  use, intrinsic :: iso_c_binding, only : c_int, c_funptr, c_associated, c_f_procpointer
  use dd3_linalg_program_symbol, only : program_symbol
  implicit none
  private
  public :: use_one_blas_thread

  abstract interface
    !> Set the number of threads.
    subroutine set_threads_interface(count) bind(c)
      import :: c_int
      integer(c_int), value :: count
    end subroutine set_threads_interface
  end interface

contains

  !> Set the number of OpenBLAS threads to one.
  subroutine use_one_blas_thread()
    procedure(set_threads_interface), pointer :: set_threads
    type(c_funptr) :: address

    address = program_symbol("openblas_set_num_threads")
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, set_threads)
    call set_threads(1_c_int)
  end subroutine use_one_blas_thread

end module dd3_linalg_blas_threads
