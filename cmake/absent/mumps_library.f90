! SPDX-License-Identifier: GPL-3.0-or-later
!> In place of `src/external/mumps_library.f90` where MUMPS is not installed: every job fails.
module dd3_external_mumps_library
  use dd3_base_kinds, only : i8, wp
  implicit none
  private
  public :: dmumps_struc, dmumps, library_present

  !> Whether the program contains the library.
  logical, parameter :: library_present = .false.
  !> Error in `infog`, not one of the library.
  integer, parameter :: error_absent = -1000

  !> Members of the library's structure that the program uses.
  type :: dmumps_struc
    integer :: comm = 0, sym = 0, par = 0, job = 0, n = 0
    integer(i8) :: nnz = 0
    integer, pointer :: irn(:) => null(), jcn(:) => null(), perm_in(:) => null(), &
        pivnul_list(:) => null()
    real(wp), pointer :: a(:) => null(), rhs(:) => null()
    real(wp) :: cntl(15) = 0.0_wp
    integer :: icntl(60) = 0, infog(80) = 0
    character(len=255) :: ooc_tmpdir = ""
  end type dmumps_struc

contains

  !> Refuse.
  pure subroutine dmumps(id)
    type(dmumps_struc), intent(inout) :: id

    id%infog(1) = error_absent
  end subroutine dmumps

end module dd3_external_mumps_library
