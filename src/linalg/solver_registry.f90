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

  !> Names of the solvers.
  character(len=7), parameter :: solver_names(3) = [character(len=7) :: "cgs", "umfpack", "auto"]

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

    if (.not. any(ordering_names == options%ordering)) then
      call fatal_error(error, "unknown ordering "//trim(options%ordering)//"; known: " &
        //join(ordering_names, ", "))
    else if (options%ilu_level < 0 .or. options%iterations < 1 &
      .or. .not. options%tolerance > 0) then
      call fatal_error(error, &
        "level of fill, iterations and tolerance of the linear solver must be positive")
    end if
    if (allocated(error)) return
    allocate (combined)
    select case (options%method)
    case ("cgs")
      call new_combined_solver(combined, options, iterative=.true., direct=.false., error=error)
    case ("umfpack")
      call new_combined_solver(combined, options, iterative=.false., direct=.true., error=error)
    case ("auto")
      call new_combined_solver(combined, options, iterative=.true., direct=.true., error=error)
    case default
      call fatal_error(error, "unknown solver "//trim(options%method)//"; known: " &
        //join(solver_names, ", "))
    end select
    if (.not. allocated(error)) call move_alloc(combined, solver)
  end subroutine new_linear_solver

end module dd3_linalg_solver_registry
