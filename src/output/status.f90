! SPDX-License-Identifier: GPL-3.0-or-later
!> status.csv: one row per attempt at an increment, accepted or not: its limit, its iterations, the
!> contact status and the reason of a failure.
module dd3_output_status
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t
  use dd3_base_text, only : newline
  use dd3_model_state, only : state_t
  use dd3_output_csv, only : table_t
  implicit none
  private
  public :: status_record_t, status_row_t

  !> Name of the file in the folder of the results.
  character(len=*), parameter :: file_name = "status.csv"
  !> Names of the columns.
  character(len=*), parameter :: names = "increment,attempt,phase,travel,r,limiter,iterations,"// &
    "criterion,solver_iterations,gap,stick,slip,outcome,reason,seconds,limiter_element,"// &
    "limiter_point,limiter_node,limiter_tool,worst_node,worst_residual,worst_element,"// &
    "worst_point,solver,r_force,force_node,force_tool,force_size,shortened,perturbed,"// &
    "eliminated,elements"

  !> Lower bound of values of r that stand for no limit.
  real(wp), parameter :: unlimited = 1.0e99_wp

  !> A row.
  type :: status_row_t
    !> Number of the increment, and of the attempt at it, from 1.
    integer :: increment = 0, attempt = 1
    character(len=64) :: phase = ""
    !> Path of the controlling tools at the end of the increment, mm.
    real(wp) :: travel = 0.0_wp
    !> Factor r; the largest number if the prediction failed before it was limited.
    real(wp) :: r = 0.0_wp
    character(len=16) :: limiter = ""
    !> Iterations of the corrector.
    integer :: iterations = 0
    !> Criterion of convergence after the last iteration; negative for none.
    real(wp) :: criterion = -1.0_wp
    !> Sum of the iterations of the linear solver.
    integer :: solver_iterations = 0
    !> Number of candidates in each contact status.
    integer :: gap = 0, stick = 0, slip = 0
    !> `accepted`, `retry`, `refined` or `failed`.
    character(len=16) :: outcome = ""
    !> Reason of a failure or of a fallback of the linear solver.
    character(len=240) :: reason = ""
    !> Wall-clock time, s.
    real(wp) :: seconds = 0.0_wp
    !> Element, integration point, node and tool that set the limit; 0 and blank for none.
    integer :: limiter_element = 0, limiter_point = 0, limiter_node = 0
    character(len=64) :: limiter_tool = ""
    !> Node with the largest residual, and that residual, N; 0 and negative for none.
    integer :: worst_node = 0
    real(wp) :: worst_residual = -1.0_wp
    !> Element and integration point where the increment failed; 0 for none.
    integer :: worst_element = 0, worst_point = 0
    !> Linear solver used.
    character(len=16) :: solver = ""
    !> Bound by the limiter of contact forces alone, with the node, the tool and the size B of the
    !> force, N, that set it; node 0 if it sets none.
    real(wp) :: r_force = 0.0_wp
    integer :: force_node = 0
    character(len=64) :: force_tool = ""
    real(wp) :: force_size = 0.0_wp
    !> Number of times that iterations of the corrector were shortened.
    integer :: shortened = 0
    !> Number of blocks of pivots that the linear solver perturbed.
    integer :: perturbed = 0
    !> Number of nonlinear eliminations.
    integer :: eliminated = 0
    !> Number of elements.
    integer :: elements = 0
  end type status_row_t

  !> Status table of a run.
  type :: status_record_t
    type(table_t), private :: table
  contains
    procedure :: open => status_open
    procedure :: resume => status_resume
    procedure :: add => status_add
    procedure :: flush => status_flush
    procedure :: close => status_close
  end type status_record_t

contains

  !> Make the file with its heading.
  subroutine status_open(self, directory, error)
    class(status_record_t), intent(inout) :: self
    !> Folder of the results.
    character(len=*), intent(in) :: directory
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%open(directory//"/"//file_name, error)
    if (allocated(error)) return
    call self%table%file%put(names//newline, error)
    if (.not. allocated(error)) call self%table%file%flush(error)
  end subroutine status_open

  !> Add a row.
  subroutine status_add(self, row, error)
    class(status_record_t), intent(inout) :: self
    type(status_row_t), intent(in) :: row
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error
    logical :: limited

    limited = row%r < unlimited
    associate (table => self%table)
      call table%add_integer(row%increment)
      call table%add_integer(row%attempt)
      call table%add_text(row%phase)
      call add_known(table, row%travel, limited)
      call add_known(table, row%r, limited)
      call table%add_text(merge(row%limiter, repeat(" ", len(row%limiter)), limited))
      call table%add_integer(row%iterations)
      call add_known(table, row%criterion, row%criterion >= 0.0_wp)
      call table%add_integer(row%solver_iterations)
      call table%add_integer(row%gap)
      call table%add_integer(row%stick)
      call table%add_integer(row%slip)
      call table%add_text(row%outcome)
      call table%add_text(row%reason)
      call table%add_real(row%seconds)
      call add_number(table, row%limiter_element, limited)
      call add_number(table, row%limiter_point, limited)
      call add_number(table, row%limiter_node, limited)
      call table%add_text(merge(row%limiter_tool, repeat(" ", len(row%limiter_tool)), limited))
      call add_number(table, row%worst_node, .true.)
      call add_known(table, row%worst_residual, row%worst_residual >= 0.0_wp)
      call add_number(table, row%worst_element, .true.)
      call add_number(table, row%worst_point, .true.)
      call table%add_text(row%solver)
      limited = limited .and. row%force_node > 0
      call add_known(table, row%r_force, limited)
      call add_number(table, row%force_node, limited)
      call table%add_text(merge(row%force_tool, repeat(" ", len(row%force_tool)), limited))
      call add_known(table, row%force_size, limited)
      call table%add_integer(row%shortened)
      call table%add_integer(row%perturbed)
      call table%add_integer(row%eliminated)
      call table%add_integer(row%elements)
      call table%end_row(error)
    end associate
  end subroutine status_add

  !> Add a cell with the number of an entity, or an empty one for 0.
  subroutine add_number(table, value, known)
    type(table_t), intent(inout) :: table
    integer, intent(in) :: value
    logical, intent(in) :: known

    if (known .and. value > 0) then
      call table%add_integer(value)
    else
      call table%add_text("")
    end if
  end subroutine add_number

  !> Add a cell with a real number, or an empty one.
  subroutine add_known(table, value, known)
    type(table_t), intent(inout) :: table
    real(wp), intent(in) :: value
    logical, intent(in) :: known

    if (known) then
      call table%add_real(value)
    else
      call table%add_text("")
    end if
  end subroutine add_known

  !> Make the file with the rows of an earlier run up to a restart.
  subroutine status_resume(self, state, source, directory, found, error)
    class(status_record_t), intent(inout) :: self
    !> State of the restart.
    type(state_t), intent(in) :: state
    !> Folders of the earlier results, and of the results.
    character(len=*), intent(in) :: source, directory
    !> The earlier rows are in the file; otherwise it begins with the heading alone.
    logical, intent(out) :: found
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%resume(source//"/"//file_name, directory//"/"//file_name, names//newline, &
        state%increment, found, error)
  end subroutine status_resume

  !> Write what is buffered and close the file.
  subroutine status_close(self, error)
    class(status_record_t), intent(inout) :: self
    !> Set if the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%close(error)
  end subroutine status_close

  !> Write what is buffered.
  subroutine status_flush(self, error)
    class(status_record_t), intent(inout) :: self
    !> Set if the rows cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%file%flush(error)
  end subroutine status_flush

end module dd3_output_status
