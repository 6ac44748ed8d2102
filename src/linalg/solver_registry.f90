! SPDX-License-Identifier: GPL-3.0-or-later
!> Registry of the linear solvers.
module dd3_linalg_solver_registry
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : join
  use dd3_linalg_auto_solver, only : make_auto_solver
  use dd3_linalg_block_lu_solver, only : make_block_lu_solver
  use dd3_linalg_cgs_solver, only : make_cgs_solver
  use dd3_linalg_mumps_solver, only : make_mumps_solver, mumps_package
  use dd3_linalg_ordering, only : ordering_names
  use dd3_linalg_petsc_solver, only : make_petsc_gamg_solver, make_petsc_mumps_solver, &
      petsc_package
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  use dd3_linalg_umfpack_solver, only : make_umfpack_solver
  implicit none
  private
  public :: missing_package, new_linear_solver, solver_meaning, solver_names

  abstract interface
    !> Create a solver.
    subroutine constructor_interface(solver, options)
      import :: linear_solver_t, solver_options_t
      class(linear_solver_t), allocatable, intent(out) :: solver
      type(solver_options_t), intent(in) :: options
    end subroutine constructor_interface
  end interface

  !> One row.
  type :: entry_t
    !> Name, as written in the input.
    character(len=16) :: name = ""
    procedure(constructor_interface), pointer, nopass :: make => null()
    character(len=140) :: meaning = ""
    !> Debian package of the library that the program was built without, with the preset that takes
    !> it; empty if it has it or needs none.
    character(len=40) :: package = ""
    !> Whether it solves a system whose rows are divided among ranks.
    logical :: distributed = .false.
  end type entry_t

contains

  !> Return the registry, one row per solver.
  function registry() result(entries)
    type(entry_t), allocatable :: entries(:)

    entries = [ &
        entry_t("cgs", make_cgs_solver, "conjugate gradients squared with an incomplete "// &
            "factorisation of level ilu_level"), &
        entry_t("block_lu", make_block_lu_solver, "complete factorisation on 3 x 3 blocks, by "// &
            "rows or by dense fronts, as counted operations say"), &
        entry_t("umfpack", make_umfpack_solver, "complete factorisation by UMFPACK, which "// &
            "interchanges rows freely"), &
        entry_t("mumps", make_mumps_solver, "complete factorisation by MUMPS, which "// &
            "interchanges rows where pivots are small", mumps_package), &
        entry_t("petsc_mumps", make_petsc_mumps_solver, "complete factorisation by MUMPS "// &
            "through PETSc, on several processes", petsc_package(), .true.), &
        entry_t("petsc_gamg", make_petsc_gamg_solver, "GMRES with multigrid (GAMG) of "// &
            "PETSc on several processes, smoothed by their incomplete factorisations of level "// &
            "ilu_level", petsc_package(), .true.), &
        entry_t("auto", make_auto_solver, "block_lu, or umfpack for a matrix on which that "// &
            "fails; on several processes petsc_mumps")]
  end function registry

  !> Return the names of all solvers, or of those for several ranks.
  function solver_names(distributed) result(names)
    logical, intent(in), optional :: distributed
    character(len=16), allocatable :: names(:)

    type(entry_t), allocatable :: entries(:)

    entries = registry()
    names = entries%name
    if (present(distributed)) names = pack(names, entries%distributed .eqv. distributed)
  end function solver_names

  !> Return the meaning of a solver.
  function solver_meaning(name) result(meaning)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: meaning

    type(entry_t), allocatable :: entries(:)

    entries = registry()
    meaning = trim(entries(findloc(entries%name, name, 1))%meaning)
  end function solver_meaning

  !> Return the Debian package, with the preset, without which this build lacks a solver; empty if
  !> it lacks none, or for an unknown name.
  function missing_package(name) result(package)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: package

    type(entry_t), allocatable :: entries(:)
    integer :: i

    entries = registry()
    package = ""
    i = findloc(entries%name, name, 1)
    if (i > 0) package = trim(entries(i)%package)
  end function missing_package

  !> Create the solver that the options name.
  subroutine new_linear_solver(solver, options, error)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options
    !> Set for a name that is unknown or not in this build, or a value that is out of range or not
    !> set.
    type(error_t), allocatable, intent(out) :: error

    type(entry_t), allocatable :: entries(:)
    integer :: i

    entries = registry()
    i = findloc(entries%name, options%method, 1)
    if (i == 0) then
      call fatal_error(error, "unknown solver "//trim(options%method)//"; known: " &
          //join(solver_names(), ", "))
    else if (entries(i)%package /= "") then
      call fatal_error(error, "the program was built without the linear solver "// &
          trim(options%method)//"; it needs the package "//trim(entries(i)%package))
    else if (all(ordering_names /= options%ordering)) then
      call fatal_error(error, "unknown ordering "//trim(options%ordering)//"; known: " &
          //join(ordering_names, ", "))
    else if (options%ilu_level < 0 .or. options%iterations < 1 &
        .or. .not. options%tolerance > 0) then
      call fatal_error(error, "linear solver: expected a level of fill of at least 0, positive " &
          //"iterations and a positive tolerance")
    else
      call entries(i)%make(solver, options)
    end if
  end subroutine new_linear_solver

end module dd3_linalg_solver_registry
