!> The solvers of linear systems there are, by name.
module dd3_linalg_solver_registry
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : join
  use dd3_linalg_combined_solver, only : combined_solver_t, new_combined_solver
  use dd3_linalg_ordering, only : ordering_names
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  implicit none
  private
  public :: new_linear_solver, solver_names

  !> One row: a solver's name, and which of the two ways to solve it uses.
  type :: row_t
    !> Name as written in the input.
    character(len=7) :: name
    !> Whether it iterates, and whether it has direct factors (to fall back on, where it iterates).
    logical :: iterative, direct
  end type row_t

  !> The solvers.
  type(row_t), parameter :: rows(3) = [row_t("cgs", .true., .false.), &
                                       row_t("umfpack", .false., .true.), &
                                       row_t("auto", .true., .true.)]
  !> Their names.
  character(len=*), parameter :: solver_names(size(rows)) = rows%name

contains

  !> Makes the solver that the options ask for.
  subroutine new_linear_solver(solver, options, error)
    !> The solver made.
    class(linear_solver_t), allocatable, intent(out) :: solver
    !> The choices.
    type(solver_options_t), intent(in) :: options
    !> An unknown name or a value out of range.
    type(error_t), allocatable, intent(out) :: error
    type(combined_solver_t), allocatable :: combined
    integer :: i

    i = findloc(solver_names, options%method, 1)
    if (i == 0) then
      call fatal_error(error, "unknown solver "//trim(options%method)//"; known: " &
        //join(solver_names, ", "))
    else if (.not. any(ordering_names == options%ordering)) then
      call fatal_error(error, "unknown ordering "//trim(options%ordering)//"; known: " &
        //join(ordering_names, ", "))
    else if (options%ilu_level < 0 .or. options%iterations < 1 &
      .or. .not. options%tolerance > 0) then
      call fatal_error(error, "level of fill of the linear solver must not be negative, its "// &
        "iterations and tolerance must be positive")
    end if
    if (allocated(error)) return
    allocate (combined)
    call new_combined_solver(combined, options, rows(i)%iterative, rows(i)%direct)
    call move_alloc(combined, solver)
  end subroutine new_linear_solver

end module dd3_linalg_solver_registry
