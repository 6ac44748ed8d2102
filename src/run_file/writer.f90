! SPDX-License-Identifier: GPL-3.0-or-later
!> run.json: description of a run beside its results, see docs/run.schema.json. It is written as a
!> whole, at the start and at the end of the run; of several ranks the first writes it.
module dd3_run_file_writer
  use dd3_base_clock, only : section_names, wall_time
  use dd3_base_environment, only : local_time
  use dd3_base_error, only : error_t, error_list_t, most_kept
  use dd3_base_file_system, only : write_file
  use dd3_base_interrupt, only : interruption_code
  use dd3_base_json, only : json_t
  use dd3_base_kinds, only : wp
  use dd3_base_log, only : log_t
  use dd3_base_message, only : message_t
  use dd3_base_ranks, only : this_rank
  use dd3_base_text, only : newline
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_run_summary, only : phase_summary_t, run_summary_t
  use dd3_report_job_size, only : job_size_t
  use dd3_run_file_head, only : add_head, command_t, is_whole
  use dd3_run_file_input, only : add_input, add_location
  use dd3_run_file_material, only : add_materials, add_points
  use dd3_run_file_phase, only : add_phases
  use dd3_run_file_sheet, only : add_refinements, add_sets, add_sheet
  use dd3_run_file_tool, only : add_drawbeads, add_tools
  use dd3_settings_solver, only : solver_spec_t
  implicit none
  private
  public :: run_file_t, run_file_name

  character(len=*), parameter :: run_file_name = "run.json"

  !> run.json of a run.
  type :: run_file_t
    character(len=:), allocatable :: path
    !> What does not change in the run.
    type(json_t), private :: fixed
    !> Start of the run, s.
    real(wp), private :: began = 0.0_wp
    !> State of the outcome of a run without an error, and exit code; negative while it runs.
    character(len=:), allocatable :: state
    integer :: exit_code = -1
  contains
    procedure :: start => run_file_start
    procedure :: add_solver
    procedure :: add_size
    procedure :: add_new
    procedure :: add_continued
    procedure :: compose
    procedure :: write => run_file_write
  end type run_file_t

contains

  !> Begin the description of a run.
  subroutine run_file_start(self, command, case, model, folder)
    class(run_file_t), intent(inout) :: self
    type(command_t), intent(in) :: command
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Folder in which it is written.
    character(len=*), intent(in) :: folder

    self%began = wall_time()
    self%path = folder//"/"//run_file_name
    self%state = "running"
    if (this_rank() > 0) return
    associate (json => self%fixed)
      call add_head(json, command)
      call json%add("title", model%title)
      call add_input(json, case)
      call add_sheet(json, case, model)
      call add_sets(json, model)
      call add_materials(json, case, model)
      call add_tools(json, case, model)
      call add_drawbeads(json, case, model)
      call add_points(json, case)
    end associate
  end subroutine run_file_start

  !> Add the settings of the linear solver.
  subroutine add_solver(self, solver, description)
    class(run_file_t), intent(inout) :: self
    type(solver_spec_t), intent(in) :: solver
    !> Of the solver in use; empty without one.
    character(len=*), intent(in) :: description

    associate (json => self%fixed)
      call json%begin_object("solver", flat=.true.)
      call json%add("method", solver%method)
      call json%add_optional("description", description)
      call json%add("ilu_level", solver%ilu_level)
      call json%add("tolerance", solver%tolerance)
      call json%add("iterations", solver%iterations)
      call json%add("ordering", solver%ordering)
      call json%add("factors", solver%factors)
      call json%end_object()
    end associate
  end subroutine add_solver

  !> Add the size of the job; null if it is not known.
  subroutine add_size(self, job)
    class(run_file_t), intent(inout) :: self
    type(job_size_t), intent(in) :: job

    if (job%unknowns == 0) then
      call self%fixed%add_null("size")
      return
    end if
    call self%fixed%begin_object("size", flat=.true.)
    call self%fixed%add("unknowns", job%unknowns)
    call add_known("matrix_entries", 9.0_wp*real(job%blocks, wp))
    call add_known("factors", job%factors)
    call self%fixed%add("memory", job%total)
    call self%fixed%end_object()

  contains

    !> Add a number; null for 0.
    subroutine add_known(name, value)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value

      if (value > 0.0_wp) then
        call self%fixed%add(name, value)
      else
        call self%fixed%add_null(name)
      end if
    end subroutine add_known

  end subroutine add_size

  !> Add that the run is a new one.
  subroutine add_new(self)
    class(run_file_t), intent(inout) :: self

    call self%fixed%add_null("continued")
  end subroutine add_new

  !> Add where the run is continued.
  subroutine add_continued(self, restart, phase, state, earlier)
    class(run_file_t), intent(inout) :: self
    !> Restart file, and name of its phase.
    character(len=*), intent(in) :: restart, phase
    type(state_t), intent(in) :: state
    !> run.json of the run that is continued; empty without one.
    character(len=*), intent(in) :: earlier

    associate (json => self%fixed)
      call json%begin_object("continued")
      call json%add("file", restart)
      call json%add("phase", phase)
      call json%add("progress", state%progress)
      call json%add("increment", state%increment)
      call json%add("travel", state%travel)
      if (is_whole(earlier)) then
        call json%add_written("earlier", earlier(:len(earlier) - 1))
      else
        call json%add_null("earlier")
      end if
      call json%end_object()
    end associate
  end subroutine add_continued

  !> Write the file; an older one is replaced.
  subroutine run_file_write(self, case, model, summary, log, stop_error, errors, error)
    class(run_file_t), intent(in) :: self
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> See `compose` for this and the following.
    type(run_summary_t), intent(in) :: summary
    type(log_t), intent(in) :: log
    type(error_t), allocatable, intent(in) :: stop_error
    type(error_list_t), intent(in) :: errors
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    if (this_rank() == 0) call write_file(self%path, &
        self%compose(case, model, summary, log, stop_error, errors), error)
  end subroutine run_file_write

  !> Return the content of the file.
  function compose(self, case, model, summary, log, stop_error, errors) result(text)
    class(run_file_t), intent(in) :: self
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(run_summary_t), intent(in) :: summary
    !> Warnings and notes so far.
    type(log_t), intent(in) :: log
    !> What stopped the run, if allocated.
    type(error_t), allocatable, intent(in) :: stop_error
    !> Errors of the input.
    type(error_list_t), intent(in) :: errors
    character(len=:), allocatable :: text

    type(json_t) :: json
    integer :: i

    json = self%fixed
    call add_outcome(json, self, stop_error)
    if (allocated(summary%phase)) then
      call add_phases(json, case, model, summary%phase)
    else
      call json%begin_array("phases", flat=.true.)
      call json%end_array()
    end if
    call add_refinements(json, model)
    call add_counts(json, summary, size(case%point) > 0)
    call add_messages(json, "warnings", log, .true.)
    call add_messages(json, "notes", log, .false.)
    call json%begin_array("errors")
    if (allocated(stop_error)) call add_error(json, stop_error, log)
    do i = 1, min(errors%count, most_kept)
      call add_error(json, errors%item(i), log)
    end do
    call json%end_array()
    call json%add("seconds", wall_time() - self%began)
    call json%begin_object("sections", flat=.true.)
    do i = 1, size(section_names)
      call json%add(trim(section_names(i)), summary%profile%seconds(i))
    end do
    call json%end_object()
    call json%end_object()
    text = json%text()//newline
  end function compose

  !> Add when and how the run ended.
  subroutine add_outcome(json, self, stop_error)
    type(json_t), intent(inout) :: json
    type(run_file_t), intent(in) :: self
    type(error_t), allocatable, intent(in) :: stop_error

    character(len=:), allocatable :: state, code, message

    state = self%state
    code = ""
    message = ""
    if (allocated(stop_error)) then
      state = "stopped"
      if (stop_error%code == interruption_code) state = "interrupted"
      code = stop_error%code
      message = stop_error%message
    end if
    if (self%exit_code < 0) call json%add_null("ended")
    if (self%exit_code >= 0) call json%add("ended", local_time())
    call json%begin_object("outcome", flat=.true.)
    call json%add("state", state)
    if (self%exit_code < 0) call json%add_null("exit_code")
    if (self%exit_code >= 0) call json%add("exit_code", self%exit_code)
    call json%add_optional("code", code)
    call json%add_optional("message", message)
    call json%end_object()
  end subroutine add_outcome

  !> Add the totals.
  subroutine add_counts(json, summary, is_point)
    type(json_t), intent(inout) :: json
    type(run_summary_t), intent(in) :: summary
    !> Single points, whose steps are no increments of phases.
    logical, intent(in) :: is_point

    type(phase_summary_t) :: total

    total = summary%total()
    if (is_point) total%increments = summary%increments
    call json%begin_object("counts", flat=.true.)
    call json%add("increments", total%increments)
    call json%add("attempts", total%attempts)
    call json%add("cutbacks", total%retries)
    call json%add("iterations", total%iterations)
    call json%add("solver_iterations", total%solver_iterations)
    call json%end_object()
  end subroutine add_counts

  !> Add the warnings or the notes.
  subroutine add_messages(json, name, log, warnings)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    type(log_t), intent(in) :: log
    logical, intent(in) :: warnings

    integer :: i

    call json%begin_array(name)
    do i = 1, log%told%count
      if (log%told%item(i)%is_warning() .eqv. warnings) call add_message(json, log%told%item(i))
    end do
    call json%end_array()
  end subroutine add_messages

  subroutine add_message(json, message)
    type(json_t), intent(inout) :: json
    type(message_t), intent(in) :: message

    call json%begin_object("", flat=.true.)
    call json%add_optional("code", message%code)
    call json%add("text", message%text)
    call add_location(json, "at", message%at)
    call add_moment(json, message%phase, message%increment)
    call json%end_object()
  end subroutine add_message

  !> Add an error.
  subroutine add_error(json, error, log)
    type(json_t), intent(inout) :: json
    type(error_t), intent(in) :: error
    type(log_t), intent(in) :: log

    character(len=:), allocatable :: phase

    phase = ""
    if (allocated(log%phase)) phase = log%phase
    call json%begin_object("", flat=.true.)
    call json%add_optional("code", error%code)
    if (allocated(error%text)) then
      call json%add("text", error%text)
    else
      call json%add("text", error%message)
    end if
    call add_location(json, "at", error%at)
    call add_moment(json, phase, log%increment)
    call json%end_object()
  end subroutine add_error

  !> Add when a message was given; null before the first phase.
  subroutine add_moment(json, phase, increment)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: phase
    integer, intent(in) :: increment

    call json%add_optional("phase", phase)
    if (phase == "") then
      call json%add_null("increment")
    else
      call json%add("increment", increment)
    end if
  end subroutine add_moment

end module dd3_run_file_writer
