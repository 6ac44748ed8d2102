! SPDX-License-Identifier: GPL-3.0-or-later
!> Solvers of the library PETSc, which work on matrices distributed among ranks:
!> MUMPS factorises completely; GMRES iterates (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7,
!> 1986; Saad 1993, flexible), preconditioned by multigrid with smoothed aggregation (Vanek, Mandel
!> and Brezina, Computing 56, 1996). The aggregates reproduce the rigid motions of the sheet. A few
!> iterations of GMRES with the ILU(k) of the rows of each rank smooth: point smoothers do not, as
!> bending is far softer than stretching.
module dd3_linalg_petsc_solver
  use dd3_base_ranks, only : ranks_present
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  implicit none
  private
  public :: make_petsc_mumps_solver, make_petsc_gamg_solver, petsc_package

  ! Implemented in src/parallel/petsc_solver.f90 or, without PETSc, in
  ! cmake/absent/petsc_solver.f90, where no solver is created.
  interface
    !> Create the complete factorisation for the registry.
    module subroutine make_petsc_mumps_solver(solver, options)
      class(linear_solver_t), allocatable, intent(out) :: solver
      type(solver_options_t), intent(in) :: options
    end subroutine make_petsc_mumps_solver

    !> Create the iterative solver for the registry.
    module subroutine make_petsc_gamg_solver(solver, options)
      class(linear_solver_t), allocatable, intent(out) :: solver
      type(solver_options_t), intent(in) :: options
    end subroutine make_petsc_gamg_solver
  end interface

contains

  !> Return the Debian package that the program was built without, with the preset that takes it;
  !> empty if it has PETSc.
  function petsc_package() result(package)
    character(len=:), allocatable :: package

    package = "libpetsc-real-dev and the preset petsc"
    if (ranks_present()) package = ""
  end function petsc_package

end module dd3_linalg_petsc_solver
