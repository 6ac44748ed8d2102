!> fields.vtkhdf: the deformed sheet and its fields as a series of steps for ParaView.
!> The form is VTKHDF 2.0, temporal UnstructuredGrid (VTK file formats, Kitware). A step is added in
!> an order that leaves the file readable wherever the program is killed: data, places of the data,
!> flush, number of steps, flush. Readers trust the number of steps.
module dd3_output_fields
  use dd3_base_kinds, only : wp, i8
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_file, only : file_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_field_table, only : field_t, field_table, at_points, at_nodes_and_cells
  use dd3_output_hdf5, only : series_t, start_hdf5, make_group, text_attribute, integer_attribute, &
      rewrite_attribute, flush_hdf5, kind_real, kind_long, kind_int, kind_byte
  use hdf5, only : hid_t, hsize_t, h5fcreate_f, h5fclose_f, h5fget_filesize_f, h5gclose_f, &
                   h5aclose_f, H5F_ACC_TRUNC_F
  implicit none
  private
  public :: field_record_t

  !> Rows of the datasets with a number per step that are stored together.
  integer, parameter :: step_chunk = 64
  !> Steps at equal travel are set apart by this much, mm: readers want times that grow.
  real(wp), parameter :: least_time = 1.0e-6_wp

  !> Bytes that the empty file, and the indices of a step, may take at most.
  integer(i8), parameter :: first_room = 500000_i8, step_room = 300000_i8

  !> Where a field goes: its values, and where each step's begin.
  type :: target_t
    !> The values.
    type(series_t) :: data
    !> The place of each step's first row.
    type(series_t) :: offset
  end type target_t

  !> The field file of a run.
  type :: field_record_t
    !> The table of the fields.
    type(field_t), allocatable, private :: field(:)
    !> Their places at the nodes and at the cells.
    type(target_t), allocatable, private :: at_node(:), at_cell(:)
    !> Positions of the nodes.
    type(target_t), private :: points
    !> Times; parts, cells and connectivity of each step; and what is known of a step in the run.
    type(series_t), private :: time, first_part, parts, first_cell, first_connectivity
    !> Increment, phase, progress and travel of each step.
    type(series_t), private :: increment, phase, progress, travel, tool
    !> The file, and the number of steps in it.
    integer(hid_t), private :: file = -1, step_count = -1
    !> Number of steps; increment of the last one.
    integer, private :: n_step = 0, last_increment = -1
    !> Time of the last one.
    real(wp), private :: last_time = -huge(1.0_wp)
    !> The same file, to reserve room in it.
    type(file_t), private :: guard
    !> Elements that share each node.
    integer, allocatable, private :: sharing(:)
  contains
    procedure :: open => fields_open
    procedure :: write => fields_write
    procedure :: close => fields_close
  end type field_record_t

contains

  !> Makes the file with all that does not change.
  subroutine fields_open(self, model, directory, error)
    !> The record.
    class(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The directory.
    character(len=*), intent(in) :: directory
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: path
    integer :: status
    logical :: ok

    path = directory//"/fields.vtkhdf"
    self%n_step = 0
    self%last_increment = -1
    self%last_time = -huge(1.0_wp)
    call self%guard%create(path, error)
    if (allocated(error)) return
    call self%guard%reserve(0_i8, first_room + 8*size(model%connectivity, kind=i8), error)
    if (allocated(error)) return
    call start_hdf5(ok)
    if (ok) then
      call h5fcreate_f(path, H5F_ACC_TRUNC_F, self%file, status)
      ok = status >= 0
    end if
    self%field = field_table()
    call count_sharing(model, self%sharing)
    call make_grid(self, model, ok)
    call make_job(self, model, ok)
    call flush_hdf5(self%file, ok)
    if (.not. ok) call give_up(self, error)
  end subroutine fields_open

  !> Makes the grid: what does not change, and the places of what does.
  subroutine make_grid(self, model, ok)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer(hid_t) :: root, attribute
    integer :: n

    n = size(model%connectivity)
    call make_group(self%file, "VTKHDF", root, ok)
    call integer_attribute(root, "Version", [2, 0], attribute, ok)
    call close_attribute(attribute)
    call text_attribute(root, "Type", "UnstructuredGrid", ok)
    call put_constant(root, "NumberOfPoints", kind_long, [model%n_node], ok)
    call put_constant(root, "NumberOfCells", kind_long, [model%n_element], ok)
    call put_constant(root, "NumberOfConnectivityIds", kind_long, [n], ok)
    call put_constant(root, "Types", kind_byte, &
                      spread(model%element%vtk_type, 1, model%n_element), ok)
    call put_constant(root, "Connectivity", kind_long, &
                      reshape(model%connectivity(model%element%vtk_order, :) - 1, [n]), ok)
    call put_constant(root, "Offsets", kind_long, cell_offsets(model), ok)
    call self%points%data%create(root, "Points", kind_real, 3, .true., model%n_node, ok)
    call self%points%data%describe("mm", "positions of the nodes", ok)
    call make_steps(self, model, root, ok)
    call close_group(root)
  end subroutine make_grid

  !> Makes the steps and the fields.
  subroutine make_steps(self, model, root, ok)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The grid's group.
    integer(hid_t), intent(in) :: root
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer(hid_t) :: steps, data, offsets

    call make_group(root, "Steps", steps, ok)
    call integer_attribute(steps, "NSteps", [0], self%step_count, ok)
    call self%time%create(steps, "Values", kind_real, 1, .false., step_chunk, ok)
    call self%time%describe("mm", "travel of the controlling tools since the start", ok)
    call self%first_part%create(steps, "PartOffsets", kind_long, 1, .false., step_chunk, ok)
    call self%parts%create(steps, "NumberOfParts", kind_long, 1, .false., step_chunk, ok)
    call self%points%offset%create(steps, "PointOffsets", kind_long, 1, .false., step_chunk, ok)
    call self%first_cell%create(steps, "CellOffsets", kind_long, 1, .true., step_chunk, ok)
    call self%first_connectivity%create(steps, "ConnectivityIdOffsets", kind_long, 1, .true., &
                                        step_chunk, ok)
    call make_group(root, "PointData", data, ok)
    call make_group(steps, "PointDataOffsets", offsets, ok)
    call make_targets(self%field, self%at_node, data, offsets, model%n_node, ok)
    call close_group(data)
    call close_group(offsets)
    call make_group(root, "CellData", data, ok)
    call make_group(steps, "CellDataOffsets", offsets, ok)
    call make_targets(pack(self%field, self%field%location == at_points &
                           .or. self%field%location == at_nodes_and_cells), &
                      self%at_cell, data, offsets, model%n_element, ok)
    call close_group(data)
    call close_group(offsets)
    call close_group(steps)
  end subroutine make_steps

  !> Makes the datasets of fields and of their places.
  subroutine make_targets(field, place, data, offsets, chunk, ok)
    !> The fields.
    type(field_t), intent(in) :: field(:)
    !> Their places.
    type(target_t), allocatable, intent(out) :: place(:)
    !> The groups of the values and of the places.
    integer(hid_t), intent(in) :: data, offsets
    !> Rows of a step.
    integer, intent(in) :: chunk
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer :: i, kind

    allocate (place(size(field)))
    do i = 1, size(field)
      kind = merge(kind_int, kind_real, field(i)%whole)
      call place(i)%data%create(data, trim(field(i)%name), kind, field(i)%components, .false., &
                                chunk, ok)
      call place(i)%data%describe(trim(field(i)%unit), trim(field(i)%description), ok)
      call place(i)%offset%create(offsets, trim(field(i)%name), kind_long, 1, .false., &
                                  step_chunk, ok)
    end do
  end subroutine make_targets

  !> Makes the group beside the grid that says where in the run each step is.
  subroutine make_job(self, model, ok)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer(hid_t) :: job

    call make_group(self%file, "job", job, ok)
    if (allocated(model%title)) call text_attribute(job, "title", model%title, ok)
    call text_attribute(job, "phases", phase_names(model), ok)
    call text_attribute(job, "tools", tool_names(model), ok)
    call self%increment%create(job, "increment", kind_int, 1, .false., step_chunk, ok)
    call self%phase%create(job, "phase", kind_int, 1, .false., step_chunk, ok)
    call self%progress%create(job, "progress", kind_real, 1, .false., step_chunk, ok)
    call self%travel%create(job, "travel", kind_real, 1, .false., step_chunk, ok)
    call self%travel%describe("mm", "travel of the controlling tools since the start", ok)
    if (model%n_tool > 0) then
      call self%tool%create(job, "tool_displacement", kind_real, 3*model%n_tool, .true., &
                            step_chunk, ok)
      call self%tool%describe("mm", "x y z of each tool, from where its file puts it", ok)
    end if
    call close_group(job)
  end subroutine make_job

  !> The phases' names, blanks between them.
  function phase_names(model) result(names)
    !> The model.
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: names
    integer :: i

    names = ""
    do i = 1, size(model%phase)
      names = names//model%phase(i)%name//" "
    end do
    names = trim(names)
  end function phase_names

  !> The tools' names, blanks between them.
  function tool_names(model) result(names)
    !> The model.
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: names
    integer :: i

    names = ""
    do i = 1, model%n_tool
      names = names//trim(model%tool(i)%name)//" "
    end do
    names = trim(names)
  end function tool_names

  !> Makes a dataset that does not change.
  subroutine put_constant(parent, name, kind, values, ok)
    !> The group it stands in.
    integer(hid_t), intent(in) :: parent
    !> Its name.
    character(len=*), intent(in) :: name
    !> One of the `kind_*` values.
    integer, intent(in) :: kind
    !> The numbers.
    integer, intent(in) :: values(:)
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    type(series_t) :: series

    call series%create(parent, name, kind, 1, .false., size(values), ok)
    call series%append_integers(values, ok)
    call series%close()
  end subroutine put_constant

  !> Where each cell's nodes begin in the connectivity, and where the last ones end.
  pure function cell_offsets(model) result(offsets)
    !> The model.
    type(model_t), intent(in) :: model
    integer, allocatable :: offsets(:)
    integer :: e

    allocate (offsets(model%n_element + 1))
    do e = 0, model%n_element
      offsets(e + 1) = e*model%element%n_node
    end do
  end function cell_offsets

  !> Number of elements that share each node.
  subroutine count_sharing(model, sharing)
    !> The model.
    type(model_t), intent(in) :: model
    !> The numbers.
    integer, allocatable, intent(out) :: sharing(:)
    integer :: e, a

    allocate (sharing(model%n_node), source=0)
    do e = 1, model%n_element
      do a = 1, model%element%n_node
        sharing(model%connectivity(a, e)) = sharing(model%connectivity(a, e)) + 1
      end do
    end do
  end subroutine count_sharing

  !> Adds a step; an increment that is already there is left alone.
  subroutine fields_write(self, model, state, error)
    !> The record.
    class(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The state.
    type(state_t), intent(in) :: state
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error
    integer :: i, i_cell
    logical :: ok

    if (self%file < 0 .or. state%increment == self%last_increment) return
    call reserve_step(self, model, error)
    if (allocated(error)) return
    ok = .true.
    call append(self%points, reshape(state%x, [size(state%x)]), ok)
    i_cell = 0
    do i = 1, size(self%field)
      if (self%field(i)%location == at_points) then
        call append_points(self, model, state, i, i_cell, ok)
      else
        call append_nodes(self, model, state, i, i_cell, ok)
      end if
    end do
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
  end subroutine fields_write

  !> Reserves room for a step: a full disk is found before the file is touched, which stays whole.
  subroutine reserve_step(self, model, error)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Says why there is no room.
    type(error_t), allocatable, intent(out) :: error
    integer(hsize_t) :: length
    integer(i8) :: more
    integer :: i, status

    call h5fget_filesize_f(self%file, length, status)
    if (status < 0) return
    more = step_room + self%points%data%room(model%n_node)
    do i = 1, size(self%at_node)
      more = more + self%at_node(i)%data%room(model%n_node)
    end do
    do i = 1, size(self%at_cell)
      more = more + self%at_cell(i)%data%room(model%n_element)
    end do
    call self%guard%reserve(int(length, i8), more, error)
  end subroutine reserve_step

  !> Adds a field of the integration points.
  subroutine append_points(self, model, state, i, i_cell, ok)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The state.
    type(state_t), intent(in) :: state
    !> Number of the field in the table.
    integer, intent(in) :: i
    !> Number of the last field at the cells.
    integer, intent(inout) :: i_cell
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    real(wp), allocatable :: value(:, :), nodal(:, :), cell(:, :)
    integer :: n, e, p, a, node
    real(wp) :: share

    n = model%element%n_point
    allocate (value(self%field(i)%components, n*model%n_element))
    allocate (nodal(self%field(i)%components, model%n_node), source=0.0_wp)
    allocate (cell(self%field(i)%components, model%n_element))
    call self%field(i)%fill(model, state, value)
    do e = 1, model%n_element
      cell(:, e) = sum(value(:, (e - 1)*n + 1:e*n), dim=2)/real(n, wp)
      do p = 1, n
        do a = 1, model%element%n_node
          node = model%connectivity(a, e)
          share = model%element%extrapolation(a, p)/real(self%sharing(node), wp)
          nodal(:, node) = nodal(:, node) + share*value(:, (e - 1)*n + p)
        end do
      end do
    end do
    if (self%field(i)%positive) nodal = max(nodal, 0.0_wp)
    i_cell = i_cell + 1
    call append(self%at_node(i), reshape(nodal, [size(nodal)]), ok)
    call append(self%at_cell(i_cell), reshape(cell, [size(cell)]), ok)
  end subroutine append_points

  !> Adds a field of the nodes.
  subroutine append_nodes(self, model, state, i, i_cell, ok)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The state.
    type(state_t), intent(in) :: state
    !> Number of the field in the table.
    integer, intent(in) :: i
    !> Number of the last field at the cells.
    integer, intent(inout) :: i_cell
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    real(wp), allocatable :: nodal(:, :), cell(:, :)
    integer :: e

    allocate (nodal(self%field(i)%components, model%n_node))
    call self%field(i)%fill(model, state, nodal)
    call append(self%at_node(i), reshape(nodal, [size(nodal)]), ok)
    if (self%field(i)%location /= at_nodes_and_cells) return
    allocate (cell(self%field(i)%components, model%n_element))
    do e = 1, model%n_element
      cell(:, e) = sum(nodal(:, model%connectivity(:, e)), dim=2)/real(model%element%n_node, wp)
    end do
    i_cell = i_cell + 1
    call append(self%at_cell(i_cell), reshape(cell, [size(cell)]), ok)
  end subroutine append_nodes

  !> Adds a step's values and the place of their first row.
  subroutine append(place, values, ok)
    !> Where they go.
    type(target_t), intent(inout) :: place
    !> The values.
    real(wp), intent(in) :: values(:)
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer(i8) :: first

    first = int(place%data%rows, i8)
    call place%data%append_reals(values, ok)
    call place%offset%append_long(first, ok)
  end subroutine append

  !> Adds what is known of the step itself.
  subroutine append_step(self, state, ok)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> The state.
    type(state_t), intent(in) :: state
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok

    call self%first_part%append_integers([0], ok)
    call self%parts%append_integers([1], ok)
    call self%first_cell%append_integers([0], ok)
    call self%first_connectivity%append_integers([0], ok)
    call self%increment%append_integers([state%increment], ok)
    call self%phase%append_integers([state%phase], ok)
    call self%progress%append_reals([state%progress], ok)
    call self%travel%append_reals([state%travel], ok)
    if (size(state%tool_displacement) > 0) then
      call self%tool%append_reals(reshape(state%tool_displacement, &
                                          [size(state%tool_displacement)]), ok)
    end if
    self%last_increment = state%increment
  end subroutine append_step

  !> Adds the step's time. It comes last: readers of VTK 9 take all times there are, into room for
  !> the number of steps they were told.
  subroutine append_time(self, travel, ok)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> Path of the controlling tools, mm.
    real(wp), intent(in) :: travel
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok

    if (self%n_step == 0) then
      self%last_time = travel
    else
      self%last_time = max(travel, self%last_time + least_time)
    end if
    call self%time%append_reals([self%last_time], ok)
  end subroutine append_time

  !> Leaves the file as it is on the disk, with the steps flushed before, and says that it cannot be
  !> written. Closing it would write on and might spoil these.
  subroutine give_up(self, error)
    !> The record.
    type(field_record_t), intent(inout) :: self
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%file = -1
    call fatal_error(error, "cannot write '"//self%guard%path &
                     //"': the disk is full or cannot be reached")
  end subroutine give_up

  !> Closes the file.
  subroutine fields_close(self, error)
    !> The record.
    class(field_record_t), intent(inout) :: self
    !> Says why the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error
    logical :: ok

    if (self%file < 0) return
    call close_all(self, ok)
    if (.not. ok) call give_up(self, error)
  end subroutine fields_close

  !> Closes all datasets and the file.
  subroutine close_all(self, ok)
    !> The record.
    class(field_record_t), intent(inout) :: self
    !> Whether the file is whole.
    logical, intent(out) :: ok
    type(error_t), allocatable :: ignored
    integer :: status

    if (allocated(self%at_node)) call close_targets(self%at_node)
    if (allocated(self%at_cell)) call close_targets(self%at_cell)
    call self%points%data%close()
    call self%points%offset%close()
    call self%time%close()
    call self%first_part%close()
    call self%parts%close()
    call self%first_cell%close()
    call self%first_connectivity%close()
    call self%increment%close()
    call self%phase%close()
    call self%progress%close()
    call self%travel%close()
    call self%tool%close()
    call close_attribute(self%step_count)
    status = 0
    if (self%file >= 0) call h5fclose_f(self%file, status)
    self%file = -1
    ok = status >= 0
    call self%guard%release()
    call self%guard%close(ignored)
  end subroutine close_all

  !> Closes the datasets of fields.
  subroutine close_targets(place)
    !> The datasets.
    type(target_t), intent(inout) :: place(:)
    integer :: i

    do i = 1, size(place)
      call place(i)%data%close()
      call place(i)%offset%close()
    end do
  end subroutine close_targets

  !> Closes a group.
  subroutine close_group(group)
    !> The group.
    integer(hid_t), intent(in) :: group
    integer :: ignored

    if (group >= 0) call h5gclose_f(group, ignored)
  end subroutine close_group

  !> Closes an attribute.
  subroutine close_attribute(attribute)
    !> The attribute.
    integer(hid_t), intent(inout) :: attribute
    integer :: ignored

    if (attribute >= 0) call h5aclose_f(attribute, ignored)
    attribute = -1
  end subroutine close_attribute

end module dd3_output_fields
