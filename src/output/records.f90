! SPDX-License-Identifier: GPL-3.0-or-later
!> Records of a run: history.csv, status.csv, fields.vtkhdf and restart.h5. Of several ranks only
!> the first writes them, and gives the others its errors.
module dd3_output_records
  use dd3_base_error, only : error_t, keep_first, share_error
  use dd3_base_file, only : make_directory
  use dd3_base_ranks, only : broadcast_integers, this_rank
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_fields, only : field_record_t
  use dd3_output_history, only : history_record_t
  use dd3_output_restart, only : write_restart
  use dd3_output_status, only : status_record_t, status_row_t
  use dd3_settings_output, only : fields_increments
  implicit none
  private
  public :: records_t

  !> Records of a run.
  type :: records_t
    type(history_record_t), private :: history
    type(status_record_t), private :: status
    type(field_record_t), private :: fields
    character(len=:), allocatable, private :: directory
    !> Increment of the last restart file, and of the last fields that it knows of.
    integer, private :: restart_increment = 0, restart_fields = 0
    !> Whether the last phase has ended.
    logical, private :: ended = .false.
  contains
    procedure :: open => records_open
    procedure :: resume => records_resume
    procedure :: add_attempt
    procedure :: write_increment
    procedure :: write_phase_end
    procedure :: keep_state
    procedure :: close => records_close
  end type records_t

contains

  !> Open the records and write the initial state.
  subroutine records_open(self, model, directory, state, error)
    class(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Folder of the results; it exists.
    character(len=*), intent(in) :: directory
    !> Initial state; gets the increments written.
    type(state_t), intent(inout) :: state
    !> Set if a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%directory = directory
    self%restart_increment = state%increment
    call self%history%open(model, directory, error)
    if (this_rank() == 0) then
      if (.not. allocated(error)) call self%status%open(directory, error)
      if (.not. allocated(error)) call self%fields%open(model, directory, error)
    end if
    call share_error(error)
    if (.not. allocated(error)) call self%history%write(model, state, error)
    call share_error(error)
    if (.not. allocated(error)) call write_fields(self, model, state, error)
    self%restart_fields = state%fields_increment
  end subroutine records_open

  !> Continue the records of an earlier run from a restart on. Rows and steps after the restart are
  !> dropped; a record that cannot be continued begins at the restart.
  subroutine records_resume(self, model, source, directory, state, lost, error)
    class(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Folder of the earlier results, and of the results; it exists.
    character(len=*), intent(in) :: source, directory
    !> State of the restart; gets the increments written.
    type(state_t), intent(inout) :: state
    !> Names of the records that begin at the restart, separated by blanks.
    character(len=:), allocatable, intent(out) :: lost
    !> Set if a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    integer :: fields_lost(1)

    self%directory = directory
    self%restart_increment = state%increment
    lost = ""
    call resume_history(self, model, source, state, lost, error)
    if (this_rank() == 0 .and. .not. allocated(error)) then
      call resume_files(self, model, source, state, lost, error)
    end if
    call share_error(error)
    if (allocated(error)) return
    fields_lost = merge(1, 0, index(lost, "fields") > 0)
    call broadcast_integers(0, 1, fields_lost)
    if (fields_lost(1) > 0) call write_fields(self, model, state, error)
    ! In another folder, or from another file, a restart file there would not fit the records.
    if (.not. allocated(error)) call save_state(self, model, state, error)
    self%restart_fields = state%fields_increment
  end subroutine records_resume

  !> Continue history.csv; see `records_resume`.
  subroutine resume_history(self, model, source, state, lost, error)
    type(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    character(len=*), intent(in) :: source
    type(state_t), intent(inout) :: state
    character(len=:), allocatable, intent(inout) :: lost
    !> On all ranks.
    type(error_t), allocatable, intent(out) :: error

    logical :: found

    call self%history%resume(model, state, source, self%directory, found, error)
    if (allocated(error) .or. found) return
    lost = lost//" history.csv"
    call self%history%write(model, state, error)
    call share_error(error)
  end subroutine resume_history

  !> Continue the other files; see `records_resume`.
  subroutine resume_files(self, model, source, state, lost, error)
    type(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    character(len=*), intent(in) :: source
    type(state_t), intent(inout) :: state
    character(len=:), allocatable, intent(inout) :: lost
    type(error_t), allocatable, intent(out) :: error

    logical :: found

    call self%status%resume(state, source, self%directory, found, error)
    if (allocated(error)) return
    if (.not. found) lost = lost//" status.csv"
    call self%fields%resume(model, state, source, self%directory, found, error)
    if (.not. (allocated(error) .or. found)) lost = lost//" fields.vtkhdf"
  end subroutine resume_files

  !> Add the row of an attempt to status.csv.
  subroutine add_attempt(self, row, error)
    class(records_t), intent(inout) :: self
    type(status_row_t), intent(in) :: row
    !> Set if the row cannot be written.
    type(error_t), allocatable, intent(out) :: error

    if (this_rank() == 0) call self%status%add(row, error)
    call share_error(error)
  end subroutine add_attempt

  !> Write an accepted increment to the files that are due.
  subroutine write_increment(self, model, state, fields_due, error)
    class(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Gets the increments written.
    type(state_t), intent(inout) :: state
    !> The progress of the phase asks for fields.
    logical, intent(in) :: fields_due
    !> Set if a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    logical :: due

    call self%history%write(model, state, error)
    call share_error(error)
    if (allocated(error)) return
    due = fields_due
    if (model%output%fields == fields_increments) then
      due = due .or. every(nint(model%output%fields_value(1)), state)
    end if
    if (due) call write_fields(self, model, state, error)
    if (allocated(error)) return
    if (every(model%output%restart_every, state)) call save(self, model, state, error)
  end subroutine write_increment

  !> Whether an output of every n-th increment is due.
  pure logical function every(n, state)
    !> 0 for never.
    integer, intent(in) :: n
    type(state_t), intent(in) :: state

    every = .false.
    if (n > 0) every = mod(state%increment, n) == 0
  end function every

  !> Write the fields and the restart file at the end of a phase.
  subroutine write_phase_end(self, model, state, error)
    class(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Gets the increments written.
    type(state_t), intent(inout) :: state
    !> Set if a record cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call write_fields(self, model, state, error)
    self%ended = state%phase == size(model%phase)
    if (self%ended) self%restart_increment = -1
    if (.not. allocated(error)) call save(self, model, state, error)
    if (.not. allocated(error) .and. model%phase(state%phase)%keep) then
      call keep_phase_end(self, model, state, error)
    end if
  end subroutine write_phase_end

  !> Write the state at the end of a phase into a folder of its name, as that of a run that ends
  !> there: other runs start from it.
  subroutine keep_phase_end(self, model, state, error)
    type(records_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error

    character(len=:), allocatable :: folder

    folder = self%directory//"/"//model%phase(state%phase)%name
    if (this_rank() == 0) call make_directory(folder, error)
    call share_error(error)
    if (.not. allocated(error)) call write_restart(folder, model, state, .true., error)
  end subroutine keep_phase_end

  !> Write the restart file of a state that is about to change without an increment: a run that
  !> stops before the next one is accepted continues from here.
  subroutine keep_state(self, model, state, error)
    class(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Only read, but handed to a visitor.
    type(state_t), intent(inout) :: state
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call save(self, model, state, error)
  end subroutine keep_state

  !> Write the fields of a state that a restart keeps.
  subroutine write_fields(self, model, state, error)
    type(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Gets the increment of the fields.
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error

    call self%fields%write(model, state, error)
    if (.not. allocated(error)) state%fields_increment = state%increment
  end subroutine write_fields

  !> Write the restart file, once per increment and again when its fields have been written since.
  subroutine save(self, model, state, error)
    type(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error

    if (.not. model%output%restart) return
    if (state%increment == self%restart_increment .and. &
        state%fields_increment == self%restart_fields) return
    call save_state(self, model, state, error)
    if (allocated(error)) return
    self%restart_increment = state%increment
    self%restart_fields = state%fields_increment
  end subroutine save

  !> Write the restart file; the rows before it go to the disk first.
  subroutine save_state(self, model, state, error)
    type(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error

    if (this_rank() == 0) call self%history%flush(error)
    if (this_rank() == 0 .and. .not. allocated(error)) call self%status%flush(error)
    call share_error(error)
    if (.not. allocated(error)) then
      call write_restart(self%directory, model, state, self%ended, error)
    end if
  end subroutine save_state

  !> Write the last state and close the records. The fields of the last state are no output that was
  !> asked for: a restart drops them.
  subroutine records_close(self, model, state, error)
    class(records_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    !> Reason of the end of the run; set if it is not yet and a record cannot be closed.
    type(error_t), allocatable, intent(inout) :: error

    type(error_t), allocatable :: late

    call save(self, model, state, late)
    call keep_first(error, late)
    call self%fields%write(model, state, late)
    call keep_first(error, late)
    if (this_rank() == 0) call close_files(self, error)
    call share_error(error)
  end subroutine records_close

  !> Close the files.
  subroutine close_files(self, error)
    type(records_t), intent(inout) :: self
    type(error_t), allocatable, intent(inout) :: error

    type(error_t), allocatable :: late

    call self%history%close(late)
    call keep_first(error, late)
    call self%status%close(late)
    call keep_first(error, late)
    call self%fields%close(late)
    call keep_first(error, late)
  end subroutine close_files

end module dd3_output_records
