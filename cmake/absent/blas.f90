! SPDX-License-Identifier: GPL-3.0-or-later
!> In place of `src/external/blas.f90` where the BLAS is not OpenBLAS.
module dd3_external_blas
  implicit none
  private
  public :: use_one_blas_thread, use_kernels_of_processor

contains

  !> No-op: the number of threads of this BLAS is that of its own settings.
  subroutine use_one_blas_thread()
  end subroutine use_one_blas_thread

  !> No-op: this BLAS chooses its kernels.
  subroutine use_kernels_of_processor()
  end subroutine use_kernels_of_processor

end module dd3_external_blas
