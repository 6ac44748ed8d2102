! SPDX-License-Identifier: GPL-3.0-or-later
!> Restrict OpenBLAS to one thread, so that only the option --threads starts further ones. With
!> another BLAS the build takes `cmake/absent/blas_threads.f90` instead.
module dd3_external_blas_threads
  use, intrinsic :: iso_c_binding, only : c_int
  implicit none
  private
  public :: use_one_blas_thread

  interface
    !> Set the number of threads.
    subroutine openblas_set_num_threads(count) bind(c)
      import :: c_int
      integer(c_int), value :: count
    end subroutine openblas_set_num_threads
  end interface

contains

  !> Set the number of OpenBLAS threads to one.
  subroutine use_one_blas_thread()
    call openblas_set_num_threads(1_c_int)
  end subroutine use_one_blas_thread

end module dd3_external_blas_threads
