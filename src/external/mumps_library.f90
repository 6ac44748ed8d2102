! SPDX-License-Identifier: GPL-3.0-or-later
!> Entry and data structure of the library MUMPS, as its header declares them. Where the library is
!> not installed, the build takes `cmake/absent/mumps_library.f90` instead.
module dd3_external_mumps_library
  implicit none
  private
  include "dmumps_struc.h"
  public :: dmumps_struc, dmumps, library_present

  !> Whether the program contains the library.
  logical, parameter :: library_present = .true.

  interface
    !> Do the job that the structure asks for.
    subroutine dmumps(id)
      import :: dmumps_struc
      type(dmumps_struc), intent(inout) :: id
    end subroutine dmumps
  end interface

end module dd3_external_mumps_library
