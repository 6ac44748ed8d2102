!> status.csv: one row for every attempted increment, accepted or not: what limited it, how the
!> iterations went, how the contact stood and why it failed.
module dd3_output_status
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t
  use dd3_base_text, only : newline
  use dd3_output_csv, only : table_t
  implicit none
  private
  public :: status_record_t, status_row_t

  !> The heading.
  character(len=*), parameter :: names = "increment,attempt,phase,travel,r,limiter,iterations,"// &
    "criterion,solver_iterations,gap,stick,slip,outcome,reason,seconds,limiter_at,worst,solver,"// &
    "r_force,force_at"

  !> No factor on a trial increment is as large.
  real(wp), parameter :: unlimited = 1.0e99_wp

  !> What is said of one attempted increment.
  type :: status_row_t
    !> Number of the increment, and of the attempt at it, from 1.
    integer :: increment = 0, attempt = 1
    !> Name of the phase.
    character(len=64) :: phase = ""
    !> Path of the controlling tools at the end of the increment, mm.
    real(wp) :: travel = 0.0_wp
    !> Factor on the trial increment; the largest number there is where nothing limited it, as the
    !> prediction failed.
    real(wp) :: r = 0.0_wp
    !> The limit that set it.
    character(len=16) :: limiter = ""
    !> Iterations of the corrector.
    integer :: iterations = 0
    !> The convergence criterion after the last iteration that had one; negative: none had.
    real(wp) :: criterion = -1.0_wp
    !> Iterations of the linear solver, all together.
    integer :: solver_iterations = 0
    !> Contact candidates in each status.
    integer :: gap = 0, stick = 0, slip = 0
    !> `accepted`, `retry` or `failed`.
    character(len=16) :: outcome = ""
    !> Why it was not accepted, in words.
    character(len=240) :: reason = ""
    !> Wall-clock time it took, s.
    real(wp) :: seconds = 0.0_wp
    !> Where the limit was reached, and where the residual or the trouble was largest.
    character(len=64) :: limiter_at = "", worst = ""
    !> The linear solver that ran.
    character(len=16) :: solver = ""
    !> What the limit on the contact forces alone allows, and where; no place: it says nothing.
    real(wp) :: r_force = 0.0_wp
    !> See above.
    character(len=64) :: force_at = ""
  end type status_row_t

  !> The status table of a run.
  type :: status_record_t
    !> The table.
    type(table_t), private :: table
  contains
    procedure :: open => status_open
    procedure :: add => status_add
    procedure :: close => status_close
  end type status_record_t

contains

  !> Makes the file with its heading.
  subroutine status_open(self, directory, error)
    !> The record.
    class(status_record_t), intent(inout) :: self
    !> The directory.
    character(len=*), intent(in) :: directory
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%open(directory//"/status.csv", error)
    if (allocated(error)) return
    call self%table%file%put(names//newline, error)
    if (.not. allocated(error)) call self%table%file%flush(error)
  end subroutine status_open

  !> Adds a row.
  subroutine status_add(self, row, error)
    !> The record.
    class(status_record_t), intent(inout) :: self
    !> The row.
    type(status_row_t), intent(in) :: row
    !> Says why it cannot be written.
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
      call table%add_text(merge(row%limiter_at, repeat(" ", len(row%limiter_at)), limited))
      call table%add_text(row%worst)
      call table%add_text(row%solver)
      limited = limited .and. len_trim(row%force_at) > 0
      call add_known(table, row%r_force, limited)
      call table%add_text(merge(row%force_at, repeat(" ", len(row%force_at)), limited))
      call table%end_row(error)
    end associate
  end subroutine status_add

  !> Adds a cell with a real number, or an empty one.
  subroutine add_known(table, value, known)
    !> The table.
    type(table_t), intent(inout) :: table
    !> The number.
    real(wp), intent(in) :: value
    !> Whether there is one.
    logical, intent(in) :: known

    if (known) then
      call table%add_real(value)
    else
      call table%add_text("")
    end if
  end subroutine add_known

  !> Writes what waits and closes the file.
  subroutine status_close(self, error)
    !> The record.
    class(status_record_t), intent(inout) :: self
    !> Says why the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%close(error)
  end subroutine status_close

end module dd3_output_status
