! SPDX-License-Identifier: GPL-3.0-or-later
!> fields.vtkhdf: the deformed sheet and its fields as a series of steps for ParaView.
!> The format is VTKHDF 2.0, temporal UnstructuredGrid (VTK file formats, Kitware); the mesh may be
!> another one from step to step, see dd3_output_field_meshes. A step is added in an order that
!> leaves the file readable whenever the program is killed: data, offsets of the data, flush, number
!> of steps, flush. Readers rely on the number of steps.
module dd3_output_fields
  use dd3_base_error, only : error_t, share_error
  use dd3_base_file_system, only : keep_file, part_of, replace_file
  use dd3_base_kinds, only : wp, i8
  use dd3_base_ranks, only : broadcast_integers, this_rank
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_csv, only : suffix_kept
  use dd3_output_field_series, only : append, count_steps
  use dd3_output_field_table, only : field_table
  use dd3_output_field_values, only : field_values, give_values
  use dd3_output_fields_file, only : append_step, append_time, close_all, copy_steps, &
      fields_file_t, make_grid, make_job
  use dd3_output_forming_fields, only : evaluate_strains
  use dd3_output_hdf5, only : flush_hdf5, rewrite_attribute, start_hdf5
  use dd3_output_hdf5_read, only : close_hdf5, open_hdf5
  use hdf5, only : hid_t, hsize_t, h5fcreate_f, h5fget_filesize_f, H5F_ACC_TRUNC_F
  implicit none
  private
  public :: field_record_t

  !> Name of the file in the folder of the results.
  character(len=*), parameter :: file_name = "fields.vtkhdf"
  !> Upper bounds of the size of the empty file and of the indices of a step, bytes.
  integer(i8), parameter :: first_room = 500000_i8, step_room = 300000_i8

  !> Field file of a run.
  type, extends(fields_file_t) :: field_record_t
  contains
    procedure :: open => fields_open
    procedure :: resume => fields_resume
    procedure :: write => fields_write
    procedure :: close => fields_close
  end type field_record_t

contains

  !> Make the file without steps.
  subroutine fields_open(self, model, directory, error)
    class(field_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Folder of the results.
    character(len=*), intent(in) :: directory
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call create(self, model, directory//"/"//file_name, error)
  end subroutine fields_open

  !> Make the file with the steps of an earlier run up to a restart. If these cannot be read, the
  !> file begins without steps.
  subroutine fields_resume(self, model, state, source, directory, found, error)
    class(field_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> State of the restart.
    type(state_t), intent(in) :: state
    !> Folders of the earlier results, and of the results.
    character(len=*), intent(in) :: source, directory
    !> The earlier steps are in the file.
    logical, intent(out) :: found
    !> Set if the file cannot be written; an earlier one is left as it is.
    type(error_t), allocatable, intent(out) :: error

    character(len=:), allocatable :: path
    integer(hid_t) :: old
    integer(hsize_t) :: length
    integer :: n, status
    logical :: ok

    found = .false.
    path = directory//"/"//file_name
    call open_hdf5(source//"/"//file_name, old, ok)
    call count_steps(old, state%fields_increment, n, ok)
    call create(self, model, part_of(path), error)
    if (.not. allocated(error) .and. n > 0) then
      call h5fget_filesize_f(old, length, status)
      if (status >= 0) call self%guard%reserve(0_i8, int(length, i8) + step_room, error)
      if (.not. allocated(error)) call copy_steps(self, old, n, state%fields_increment, found)
      if (.not. found) call close_all(self, ok)
      if (.not. (found .or. allocated(error))) call create(self, model, part_of(path), error)
    end if
    call close_hdf5(old)
    if (.not. (found .or. allocated(error))) call keep_file(path, suffix_kept(state%increment))
    if (.not. allocated(error)) call replace_file(path, self%guard, error)
  end subroutine fields_resume

  !> Create the file without steps.
  subroutine create(self, model, path, error)
    type(field_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    character(len=*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    integer :: status
    logical :: ok

    self%n_step = 0
    self%last_increment = -1
    self%last_time = -huge(1.0_wp)
    call self%guard%create(path, error)
    if (allocated(error)) return
    call self%guard%reserve(0_i8, first_room, error)
    if (allocated(error)) return
    call start_hdf5(ok)
    if (ok) then
      call h5fcreate_f(path, H5F_ACC_TRUNC_F, self%file, status)
      ok = status >= 0
    end if
    self%field = field_table(model)
    call make_grid(self, model, ok)
    call make_job(self, model, ok)
    call flush_hdf5(self%file, ok)
    if (.not. ok) call give_up(self, error)
  end subroutine create

  !> Add a step, unless the increment is already there, and the model's mesh where it is not that of
  !> the step before.
  subroutine fields_write(self, model, state, error)
    class(field_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    integer :: due(1)
    logical :: ok

    due = merge(0, 1, self%file < 0 .or. state%increment == self%last_increment)
    call broadcast_integers(0, 1, due)
    if (due(1) == 0) return
    if (this_rank() == 0) call reserve_step(self, model, error)
    call share_error(error)
    if (allocated(error)) return
    ok = .true.
    if (this_rank() > 0) then
      call give_values(model, state)
    else
      if (self%meshes%differ(model)) call self%meshes%append(self%file, model, ok)
      call append_values(self, model, state, ok)
      call append_step(self, state, ok)
      call flush_hdf5(self%file, ok)
      call append_time(self, state%travel, ok)
      call rewrite_attribute(self%step_count, [self%n_step + 1], ok)
      call flush_hdf5(self%file, ok)
      if (ok) then
        self%n_step = self%n_step + 1
      else
        call give_up(self, error)
      end if
    end if
    call share_error(error)
  end subroutine fields_write

  !> Append positions and fields.
  subroutine append_values(self, model, state, ok)
    type(field_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    logical, intent(inout) :: ok

    real(wp), allocatable :: nodal(:, :), cell(:, :), strain(:, :, :)
    integer :: i, i_cell

    call append(self%points, reshape(state%x, [size(state%x)]), ok)
    call evaluate_strains(model, state, strain)
    i_cell = 0
    do i = 1, size(self%field)
      call field_values(self%field(i), model, state, strain, nodal, cell)
      call append(self%at_node(i), reshape(nodal, [size(nodal)]), ok)
      if (size(cell) == 0) cycle
      i_cell = i_cell + 1
      call append(self%at_cell(i_cell), reshape(cell, [size(cell)]), ok)
    end do
  end subroutine append_values

  !> Reserve room for a step: a full disk is found before the file is touched.
  subroutine reserve_step(self, model, error)
    type(field_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Set if there is no room.
    type(error_t), allocatable, intent(out) :: error

    integer(hsize_t) :: length
    integer(i8) :: more
    integer :: i, status

    call h5fget_filesize_f(self%file, length, status)
    if (status < 0) return
    more = step_room + self%points%data%room(model%n_node)
    if (self%meshes%differ(model)) more = more + self%meshes%room(model)
    do i = 1, size(self%at_node)
      more = more + self%at_node(i)%data%room(model%n_node)
    end do
    do i = 1, size(self%at_cell)
      more = more + self%at_cell(i)%data%room(model%n_element)
    end do
    call self%guard%reserve(int(length, i8), more, error)
  end subroutine reserve_step

  !> Leave the file on the disk with the steps flushed before. Closing it would write on and might
  !> spoil these.
  subroutine give_up(self, error)
    type(field_record_t), intent(inout) :: self
    type(error_t), allocatable, intent(out) :: error

    self%file = -1
    call self%guard%refuse("cannot write '"//self%guard%path &
        //"': the library HDF5 refuses, most often as the disk is full or cannot be reached", error)
  end subroutine give_up

  !> Close the file.
  subroutine fields_close(self, error)
    class(field_record_t), intent(inout) :: self
    !> Set if the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error

    logical :: ok

    if (self%file < 0) return
    call close_all(self, ok)
    if (.not. ok) call give_up(self, error)
  end subroutine fields_close

end module dd3_output_fields
