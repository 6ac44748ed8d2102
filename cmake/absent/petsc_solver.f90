! SPDX-License-Identifier: GPL-3.0-or-later
!> In place of `src/parallel/petsc_solver.f90` in a build without PETSc: no solver is created.
submodule (dd3_linalg_petsc_solver) dd3_absent_petsc_solver
  implicit none

contains

  module procedure make_petsc_mumps_solver
  end procedure make_petsc_mumps_solver

  module procedure make_petsc_gamg_solver
  end procedure make_petsc_gamg_solver

end submodule dd3_absent_petsc_solver
