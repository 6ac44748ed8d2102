!> The common shape of the outputs of a run: one file each, opened once, written to, closed.
module dd3_output_record
  use dd3_base_error, only : error_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: record_t

  !> One output.
  type, abstract :: record_t
  contains
    !> Makes the file in a directory that exists.
    procedure(open_record), deferred :: open
    !> Adds what belongs to a state.
    procedure(write_record), deferred :: write
    !> Brings everything to the disk; nothing happens where the file is not open.
    procedure(close_record), deferred :: close
  end type record_t

  abstract interface
    !> Makes the file.
    subroutine open_record(self, model, directory, error)
      import :: record_t, model_t, error_t
      !> The record.
      class(record_t), intent(inout) :: self
      !> The model.
      type(model_t), intent(in) :: model
      !> The directory.
      character(len=*), intent(in) :: directory
      !> Says why it cannot be written.
      type(error_t), allocatable, intent(out) :: error
    end subroutine open_record

    !> Adds what belongs to a state.
    subroutine write_record(self, model, state, error)
      import :: record_t, model_t, state_t, error_t
      !> The record.
      class(record_t), intent(inout) :: self
      !> The model.
      type(model_t), intent(in) :: model
      !> The state.
      type(state_t), intent(in) :: state
      !> Says why it cannot be written.
      type(error_t), allocatable, intent(out) :: error
    end subroutine write_record

    !> Brings everything to the disk and closes the file.
    subroutine close_record(self, error)
      import :: record_t, error_t
      !> The record.
      class(record_t), intent(inout) :: self
      !> Says why the rest cannot be written.
      type(error_t), allocatable, intent(out) :: error
    end subroutine close_record
  end interface

end module dd3_output_record
