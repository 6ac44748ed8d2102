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
  use dd3_linalg_petsc_solver, only : make_petsc_bicgstab_solver, make_petsc_mumps_solver, &
      petsc_package
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  use dd3_linalg_umfpack_solver, only : make_umfpack_solver
  implicit none
  private
  public :: missing_package, new_linear_solver, solver_names

  abstract interface
    !> Create a solver.
    subroutine constructor_interface(solver, options)
      import :: linear_solver_t, solver_options_t
      class(linear_solver_t), allocatable, intent(out) :: solver
      type(solver_options_t), intent(in) :: options
    end subroutine constructor_interface
  end interface

  !> One row: name, as written in the input, constructor, and the Debian package of the library that
  !> the program was built without, with the preset that takes it; empty if it has it or needs none.
  type :: entry_t
    character(len=16) :: name = ""
    procedure(constructor_interface), pointer, nopass :: make => null()
    character(len=40) :: package = ""
  end type entry_t

contains

  !> Return the registry, one row per solver.
  function registry() result(entries)
    type(entry_t), allocatable :: entries(:)

    entries = [entry_t("cgs", make_cgs_solver), &
               entry_t("block_lu", make_block_lu_solver), &
               entry_t("umfpack", make_umfpack_solver), &
               entry_t("mumps", make_mumps_solver, mumps_package), &
               entry_t("petsc_mumps", make_petsc_mumps_solver, petsc_package()), &
               entry_t("petsc_bicgstab", make_petsc_bicgstab_solver, petsc_package()), &
               entry_t("auto", make_auto_solver)]
  end function registry

  !> Return the names of all solvers.
  function solver_names() result(names)
    character(len=16), allocatable :: names(:)

    type(entry_t), allocatable :: entries(:)

    entries = registry()
    names = entries%name
  end function solver_names

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
