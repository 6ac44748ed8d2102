! SPDX-License-Identifier: GPL-3.0-or-later
!> In place of `src/external/blas_threads.f90` where the BLAS is not OpenBLAS.
module dd3_external_blas_threads
  implicit none
  private
  public :: use_one_blas_thread

contains

  !> No-op: the number of threads of this BLAS is that of its own settings.
  subroutine use_one_blas_thread()
  end subroutine use_one_blas_thread

end module dd3_external_blas_threads
