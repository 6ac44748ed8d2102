! SPDX-License-Identifier: GPL-3.0-or-later
!> Layout of fields.vtkhdf: its groups and datasets, and what is added to them at a step beside the
!> fields.
module dd3_output_fields_file
  use dd3_base_error, only : error_t
  use dd3_base_file, only : file_t
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_turning, only : tool_origins
  use dd3_output_field_meshes, only : meshes_t
  use dd3_output_field_series, only : close_attribute, close_group, close_target, copy_series, &
      copy_target, make_targets, step_chunk, target_t
  use dd3_output_field_table, only : at_nodes_and_cells, at_points, field_t
  use dd3_output_hdf5, only : flush_hdf5, integer_attribute, kind_int, kind_long, kind_real, &
      make_group, rewrite_attribute, series_t, text_attribute
  use dd3_output_hdf5_read, only : read_rows
  use hdf5, only : hid_t, hsize_t, h5fclose_f
  implicit none
  private
  public :: fields_file_t, make_grid, make_job, copy_steps, append_step, append_time, close_all

  !> Least difference of the times of two steps, mm of travel: readers expect increasing times.
  real(wp), parameter :: least_time = 1.0e-6_wp

  !> Datasets of the file, and what is in it.
  type :: fields_file_t
    type(field_t), allocatable :: field(:)
    type(target_t), allocatable :: at_node(:), at_cell(:)
    !> Positions of the nodes.
    type(target_t) :: points
    !> The meshes of the steps.
    type(meshes_t) :: meshes
    !> Time of each step.
    type(series_t) :: time
    !> Place of each step in the run, and the displacement of the tools.
    type(series_t) :: increment, phase, progress, travel, tool, tool_rotation
    !> The file, and the attribute with the number of steps.
    integer(hid_t) :: file = -1, step_count = -1
    !> Number of steps; increment and time of the last one.
    integer :: n_step = 0, last_increment = -1
    real(wp) :: last_time = -huge(1.0_wp)
    !> The same file, to reserve room in it.
    type(file_t) :: guard
  end type fields_file_t

contains

  !> Make the grid without steps.
  subroutine make_grid(self, model, ok)
    class(fields_file_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: root, attribute

    call make_group(self%file, "VTKHDF", root, ok)
    call integer_attribute(root, "Version", [2, 0], attribute, ok)
    call close_attribute(attribute)
    call text_attribute(root, "Type", "UnstructuredGrid", ok)
    call self%points%data%create(root, "Points", kind_real, 3, .true., model%n_node, ok)
    call self%points%data%describe("mm", "positions of the nodes", ok)
    call make_steps(self, model, root, ok)
    call close_group(root)
  end subroutine make_grid

  !> Make the datasets of the steps and of the fields.
  subroutine make_steps(self, model, root, ok)
    class(fields_file_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Group of the grid.
    integer(hid_t), intent(in) :: root
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: steps, data, offsets

    call make_group(root, "Steps", steps, ok)
    call integer_attribute(steps, "NSteps", [0], self%step_count, ok)
    call self%time%create(steps, "Values", kind_real, 1, .false., step_chunk, ok)
    call self%time%describe("mm", "travel of the controlling tools since the start", ok)
    call self%points%offset%create(steps, "PointOffsets", kind_long, 1, .false., step_chunk, ok)
    call self%meshes%create(model, root, steps, ok)
    call make_group(root, "PointData", data, ok)
    call make_group(steps, "PointDataOffsets", offsets, ok)
    call make_targets(self%field, self%at_node, data, offsets, model%n_node, ok)
    call close_group(data)
    call close_group(offsets)
    call make_group(root, "CellData", data, ok)
    call make_group(steps, "CellDataOffsets", offsets, ok)
    call make_targets(pack(self%field, self%field%location == at_points &
        .or. self%field%location == at_nodes_and_cells), self%at_cell, data, offsets, &
        model%n_element, ok)
    call close_group(data)
    call close_group(offsets)
    call close_group(steps)
  end subroutine make_steps

  !> Make the group beside the grid that gives the place of each step in the run.
  subroutine make_job(self, model, ok)
    class(fields_file_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    character(len=:), allocatable :: names
    integer(hid_t) :: job
    integer :: i

    call make_group(self%file, "job", job, ok)
    if (allocated(model%title)) call text_attribute(job, "title", model%title, ok)
    names = ""
    do i = 1, size(model%phase)
      names = names//model%phase(i)%name//" "
    end do
    call text_attribute(job, "phases", trim(names), ok)
    names = ""
    do i = 1, model%n_tool
      names = names//trim(model%tool(i)%name)//" "
    end do
    call text_attribute(job, "tools", trim(names), ok)
    call self%increment%create(job, "increment", kind_int, 1, .false., step_chunk, ok)
    call self%phase%create(job, "phase", kind_int, 1, .false., step_chunk, ok)
    call self%progress%create(job, "progress", kind_real, 1, .false., step_chunk, ok)
    call self%travel%create(job, "travel", kind_real, 1, .false., step_chunk, ok)
    call self%travel%describe("mm", "travel of the controlling tools since the start", ok)
    if (model%n_tool > 0) then
      call self%tool%create(job, "tool_displacement", kind_real, 3*model%n_tool, .true., &
          step_chunk, ok)
      call self%tool%describe("mm", "x y z of the origin of each tool's file", ok)
      call self%tool_rotation%create(job, "tool_rotation", kind_real, 9*model%n_tool, .true., &
          step_chunk, ok)
      call self%tool_rotation%describe("-", "x y z of the three axes of each tool's file", ok)
    end if
    call close_group(job)
  end subroutine make_job

  !> Copy the first steps of an older file.
  subroutine copy_steps(self, old, n, last_increment, ok)
    class(fields_file_t), intent(inout) :: self
    integer(hid_t), intent(in) :: old
    !> Number of steps copied, and increment of the last one.
    integer, intent(in) :: n, last_increment
    !> The steps are there.
    logical, intent(out) :: ok

    real(wp), allocatable :: time(:)
    integer :: n_node, n_cell, i

    ok = .true.
    call self%meshes%copy(self%file, old, n, n_node, n_cell, ok)
    call copy_target(self%points, old, n, n_node, ok)
    do i = 1, size(self%at_node)
      call copy_target(self%at_node(i), old, n, n_node, ok)
    end do
    do i = 1, size(self%at_cell)
      call copy_target(self%at_cell(i), old, n, n_cell, ok)
    end do
    call copy_series(self%increment, old, int(n, hsize_t), ok)
    call copy_series(self%phase, old, int(n, hsize_t), ok)
    call copy_series(self%progress, old, int(n, hsize_t), ok)
    call copy_series(self%travel, old, int(n, hsize_t), ok)
    if (self%tool%id >= 0) then
      call copy_series(self%tool, old, int(n, hsize_t), ok)
      call copy_series(self%tool_rotation, old, int(n, hsize_t), ok)
    end if
    call copy_series(self%time, old, int(n, hsize_t), ok)
    call read_rows(old, self%time%path(), int(n - 1, hsize_t), 1_hsize_t, time, ok)
    call rewrite_attribute(self%step_count, [n], ok)
    call flush_hdf5(self%file, ok)
    if (.not. ok) return
    self%n_step = n
    self%last_increment = last_increment
    self%last_time = time(1)
  end subroutine copy_steps

  !> Add what is known of the step itself.
  subroutine append_step(self, state, ok)
    class(fields_file_t), intent(inout) :: self
    type(state_t), intent(in) :: state
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    call self%meshes%append_step(ok)
    call self%increment%append_integers([state%increment], ok)
    call self%phase%append_integers([state%phase], ok)
    call self%progress%append_reals([state%progress], ok)
    call self%travel%append_reals([state%travel], ok)
    if (self%tool%id >= 0) then
      call self%tool%append_reals(reshape(tool_origins(state), [size(state%tools%displacement)]), &
          ok)
      call self%tool_rotation%append_reals(reshape(state%tools%rotation, &
          [size(state%tools%rotation)]), ok)
    end if
    self%last_increment = state%increment
  end subroutine append_step

  !> Add the time of the step. It comes last: VTK 9 reads all times there are into room for the
  !> number of steps.
  subroutine append_time(self, travel, ok)
    class(fields_file_t), intent(inout) :: self
    !> Path of the controlling tools, mm.
    real(wp), intent(in) :: travel
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    if (self%n_step == 0) then
      self%last_time = travel
    else
      self%last_time = max(travel, self%last_time + least_time)
    end if
    call self%time%append_reals([self%last_time], ok)
  end subroutine append_time

  !> Close all datasets and the file.
  subroutine close_all(self, ok)
    class(fields_file_t), intent(inout) :: self
    !> The file is whole.
    logical, intent(out) :: ok

    type(error_t), allocatable :: ignored
    integer :: status, i

    if (allocated(self%at_node)) then
      do i = 1, size(self%at_node)
        call close_target(self%at_node(i))
      end do
      do i = 1, size(self%at_cell)
        call close_target(self%at_cell(i))
      end do
    end if
    call close_target(self%points)
    call self%time%close()
    call self%meshes%close()
    call self%increment%close()
    call self%phase%close()
    call self%progress%close()
    call self%travel%close()
    call self%tool%close()
    call self%tool_rotation%close()
    call close_attribute(self%step_count)
    status = 0
    if (self%file >= 0) call h5fclose_f(self%file, status)
    self%file = -1
    ok = status >= 0
    call self%guard%release()
    call self%guard%close(ignored)
  end subroutine close_all

end module dd3_output_fields_file
