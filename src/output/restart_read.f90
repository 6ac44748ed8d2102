! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of restart.h5: the state of a run, if the file is of this version and of the same model.
module dd3_output_restart_read
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_model_fingerprint, only : changed_parts, fingerprint_t, model_fingerprint
  use dd3_model_model, only : model_t
  use dd3_model_part_visitor, only : part_visitor_t
  use dd3_model_state, only : new_state, state_t
  use dd3_model_state_walk, only : visit_state
  use dd3_output_hdf5_read, only : close_hdf5, dataset_size, read_integers, read_reals
  use dd3_output_restart_format, only : open_restart
  use hdf5, only : hid_t
  implicit none
  private
  public :: read_restart

  !> Visitor that reads the components from a group.
  type, extends(part_visitor_t) :: reader_t
    integer(hid_t) :: file = -1
    !> What is wrong with the first unreadable component; empty if none is.
    character(len=:), allocatable :: problem
  contains
    procedure :: reals => reader_reals
    procedure :: integers => reader_integers
  end type reader_t

contains

  !> Read a restart file for a model.
  subroutine read_restart(path, model, state, error)
    character(len=*), intent(in) :: path
    type(model_t), intent(in) :: model
    type(state_t), intent(out) :: state
    !> Set if the file cannot be read or is that of another model, with what differs.
    type(error_t), allocatable, intent(out) :: error

    integer(hid_t) :: file

    call open_restart(path, file, error)
    if (allocated(error)) return
    call check_model(path, file, model, error)
    if (.not. allocated(error)) call read_state(path, file, model, state, error)
    call close_hdf5(file)
  end subroutine read_restart

  !> Check that a restart file belongs to a model, up to the phase that it has reached.
  subroutine check_model(path, file, model, error)
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: file
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error

    type(fingerprint_t), allocatable :: before(:)
    integer, allocatable :: code(:, :)
    character(len=:), allocatable :: names
    integer :: phase(1), n_part, n_code, i, k
    logical :: ok

    call dataset_size(file, "model/digest", n_part)
    call dataset_size(file, "model/part", n_code)
    allocate (before(max(0, n_part)))
    ok = n_part > 0 .and. n_code == len(before%part)*n_part
    if (ok) then
      allocate (code(len(before%part), size(before)))
      call read_integers(file, "state/phase", phase, ok)
      call read_integers(file, "model/digest", before%digest, ok)
      call read_codes(file, size(code), code, ok)
    end if
    if (.not. ok) then
      call fatal_error(error, "'"//path//"' has no fingerprint of its model", "E204")
      return
    end if
    do i = 1, size(before)
      do k = 1, len(before%part)
        before(i)%part(k:k) = achar(code(k, i))
      end do
    end do
    names = changed_parts(before, model_fingerprint(model, phase(1)))
    if (len(names) > 0) call fatal_error(error, "'"//path//"' belongs to another model; "// &
      "different: "//names, "E204")
  end subroutine check_model

  !> Read the names of a fingerprint as character codes.
  subroutine read_codes(file, n, code, ok)
    integer(hid_t), intent(in) :: file
    integer, intent(in) :: n
    integer, intent(out) :: code(n)
    logical, intent(inout) :: ok

    call read_integers(file, "model/part", code, ok)
  end subroutine read_codes

  !> Read all components of the state.
  subroutine read_state(path, file, model, state, error)
    character(len=*), intent(in) :: path
    integer(hid_t), intent(in) :: file
    type(model_t), intent(in) :: model
    type(state_t), intent(out) :: state
    type(error_t), allocatable, intent(out) :: error

    type(reader_t) :: reader

    call new_state(state, model)
    reader%file = file
    reader%part = model%part
    reader%problem = ""
    call visit_state(state, reader)
    if (len(reader%problem) > 0) call fatal_error(error, "'"//path//"': "//reader%problem, "E204")
  end subroutine read_state

  !> Read a component of real numbers. Sets with loads that later phases have added or dropped come
  !> last and have no load yet.
  subroutine reader_reals(self, name, n, values)
    class(reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    real(wp), intent(inout) :: values(n)

    real(wp), allocatable :: found(:)
    integer :: there
    logical :: ok

    call dataset_size(self%file, "state/"//name, there)
    if (any(name == [character(len=18) :: "load", "start_load", "final_load", "pressure", &
        "start_pressure", "final_pressure"])) then
      ok = there >= 0
    else
      ok = there == n
    end if
    if (.not. ok) then
      call note_size(self, name, there, n)
      return
    end if
    allocate (found(there))
    call read_reals(self%file, "state/"//name, found, ok)
    if (.not. ok) call note_problem(self, "component '"//name//"' cannot be read")
    there = min(there, n)
    values(:there) = found(:there)
  end subroutine reader_reals

  !> Read a component of integers.
  subroutine reader_integers(self, name, n, values)
    class(reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    integer, intent(inout) :: values(n)

    integer :: there
    logical :: ok

    call dataset_size(self%file, "state/"//name, there)
    ok = there == n
    if (.not. ok) then
      call note_size(self, name, there, n)
      return
    end if
    call read_integers(self%file, "state/"//name, values, ok)
    if (.not. ok) call note_problem(self, "component '"//name//"' cannot be read")
  end subroutine reader_integers

  !> Record a component of the wrong size.
  subroutine note_size(self, name, found, expected)
    type(reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: found, expected

    if (found < 0) then
      call note_problem(self, "component '"//name//"' is missing")
    else
      call note_problem(self, "component '"//name//"': expected "//to_text(expected)// &
          " values, got "//to_text(found))
    end if
  end subroutine note_size

  !> Record the first problem.
  subroutine note_problem(self, text)
    type(reader_t), intent(inout) :: self
    character(len=*), intent(in) :: text

    if (self%problem == "") self%problem = text
  end subroutine note_problem

end module dd3_output_restart_read
