! SPDX-License-Identifier: GPL-3.0-or-later
!> Meshes of fields.vtkhdf. Each mesh of a run is a part of the grid of its own (VTKHDF 2.0,
!> Steps/PartOffsets): its cells are written once, with the first step that has them, and each step
!> tells where those of its mesh begin. The levels of its elements are a field of the cells with the
!> same offsets.
module dd3_output_field_meshes
  use dd3_base_kinds, only : wp, i8
  use dd3_model_model, only : model_t
  use dd3_output_field_series, only : close_target, copy_series, copy_target, step_chunk, target_t
  use dd3_output_hdf5, only : kind_byte, kind_int, kind_long, series_t
  use dd3_output_hdf5_read, only : dataset_size, read_rows
  use hdf5, only : hid_t, hsize_t
  implicit none
  private
  public :: meshes_t

  !> Paths of the levels and of their offsets.
  character(len=*), parameter :: level_path = "/VTKHDF/CellData/level"
  character(len=*), parameter :: level_offset_path = "/VTKHDF/Steps/CellDataOffsets/level"

  !> Datasets of the meshes, and the mesh of the last step.
  type :: meshes_t
    !> Sizes of each mesh, and its cells.
    type(series_t) :: n_node, n_cell, n_connectivity, types, connectivity, offsets
    !> Mesh of each step, from 0, number of its parts, and where its cells begin.
    type(series_t) :: part, parts, first_cell, first_connectivity
    !> Times that each element has been divided; closed while no mesh has had levels.
    type(target_t) :: level
    !> Nodes of the cells of the last mesh in VTK's order, from 0; not allocated before the first.
    integer, allocatable :: node(:)
    !> Number of the last mesh, and where its cells and their nodes begin, all from 0.
    integer(i8) :: last = -1, at_cell = 0, at_connectivity = 0
  contains
    procedure :: create => meshes_create
    procedure :: differ
    procedure :: room
    procedure :: append => meshes_append
    procedure :: append_step => meshes_append_step
    procedure :: copy => meshes_copy
    procedure :: close => meshes_close
  end type meshes_t

contains

  !> Make the datasets without a mesh.
  subroutine meshes_create(self, model, grid, steps, ok)
    class(meshes_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Groups of the grid and of its steps.
    integer(hid_t), intent(in) :: grid, steps
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    self%last = -1
    self%at_cell = 0
    self%at_connectivity = 0
    if (allocated(self%node)) deallocate (self%node)
    call self%n_node%create(grid, "NumberOfPoints", kind_long, 1, .false., 1, ok)
    call self%n_cell%create(grid, "NumberOfCells", kind_long, 1, .false., 1, ok)
    call self%n_connectivity%create(grid, "NumberOfConnectivityIds", kind_long, 1, .false., 1, ok)
    call self%types%create(grid, "Types", kind_byte, 1, .false., model%n_element, ok)
    call self%connectivity%create(grid, "Connectivity", kind_long, 1, .false., &
        size(model%connectivity), ok)
    call self%offsets%create(grid, "Offsets", kind_long, 1, .false., model%n_element + 1, ok)
    call self%part%create(steps, "PartOffsets", kind_long, 1, .false., step_chunk, ok)
    call self%parts%create(steps, "NumberOfParts", kind_long, 1, .false., step_chunk, ok)
    call self%first_cell%create(steps, "CellOffsets", kind_long, 1, .true., step_chunk, ok)
    call self%first_connectivity%create(steps, "ConnectivityIdOffsets", kind_long, 1, .true., &
        step_chunk, ok)
  end subroutine meshes_create

  !> Whether a model has another mesh than the last step.
  pure logical function differ(self, model)
    class(meshes_t), intent(in) :: self
    type(model_t), intent(in) :: model

    differ = .true.
    if (.not. allocated(self%node)) return
    if (size(self%node) /= size(model%connectivity)) return
    differ = any(self%node /= cells_of(model))
  end function differ

  !> Return an upper bound of the size of the mesh of a model on the disk, bytes.
  pure integer(i8) function room(self, model)
    class(meshes_t), intent(in) :: self
    type(model_t), intent(in) :: model

    room = self%types%room(model%n_element) + self%connectivity%room(size(model%connectivity)) &
        + self%offsets%room(model%n_element + 1)
    if (allocated(model%level)) then
      room = room + 8*(int(self%types%rows, i8) + 3*int(model%n_element, i8))
    end if
  end function room

  !> Add the mesh of a model.
  subroutine meshes_append(self, file, model, ok)
    class(meshes_t), intent(inout) :: self
    integer(hid_t), intent(in) :: file
    type(model_t), intent(in) :: model
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: e

    if (allocated(model%level) .and. self%level%data%id < 0) then
      call create_level(self, file, model%n_element, ok)
    end if
    self%last = self%last + 1
    self%at_cell = int(self%types%rows, i8)
    self%at_connectivity = int(self%connectivity%rows, i8)
    self%node = cells_of(model)
    call self%n_node%append_integers([model%n_node], ok)
    call self%n_cell%append_integers([model%n_element], ok)
    call self%n_connectivity%append_integers([size(self%node)], ok)
    call self%types%append_integers(spread(model%element%vtk_type, 1, model%n_element), ok)
    call self%connectivity%append_integers(self%node, ok)
    call self%offsets%append_integers([(e*model%element%n_node, e=0, model%n_element)], ok)
    if (self%level%data%id < 0) return
    if (allocated(model%level)) then
      call self%level%data%append_integers(model%level, ok)
    else
      call self%level%data%append_integers(spread(0, 1, model%n_element), ok)
    end if
  end subroutine meshes_append

  !> Add where the last mesh begins, for a step.
  subroutine meshes_append_step(self, ok)
    class(meshes_t), intent(inout) :: self
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    call self%part%append_long(self%last, ok)
    call self%parts%append_integers([1], ok)
    call self%first_cell%append_long(self%at_cell, ok)
    call self%first_connectivity%append_long(self%at_connectivity, ok)
    if (self%level%data%id >= 0) call self%level%offset%append_long(self%at_cell, ok)
  end subroutine meshes_append_step

  !> Make the datasets of the levels, which are zero in the meshes so far.
  subroutine create_level(self, file, chunk, ok)
    type(meshes_t), intent(inout) :: self
    integer(hid_t), intent(in) :: file
    !> Elements of a mesh.
    integer, intent(in) :: chunk
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    real(wp), allocatable :: first(:)

    call open_level(self, file, chunk, ok)
    call read_rows(file, self%first_cell%path(), 0_hsize_t, self%first_cell%rows, first, ok)
    if (.not. ok .or. self%types%rows == 0) return
    call self%level%data%append_integers(spread(0, 1, int(self%types%rows)), ok)
    if (size(first) > 0) call self%level%offset%append_reals(first, ok)
  end subroutine create_level

  !> Make the datasets of the levels without rows.
  subroutine open_level(self, file, chunk, ok)
    type(meshes_t), intent(inout) :: self
    integer(hid_t), intent(in) :: file
    !> Elements of a mesh.
    integer, intent(in) :: chunk
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    call self%level%data%create(file, level_path, kind_int, 1, .false., chunk, ok)
    call self%level%data%describe("", "times that the element has been divided", ok)
    call self%level%offset%create(file, level_offset_path, kind_long, 1, .false., step_chunk, ok)
  end subroutine open_level

  !> Copy the meshes of the first steps of an older file.
  subroutine meshes_copy(self, file, old, n, n_node, n_cell, ok)
    class(meshes_t), intent(inout) :: self
    !> This file and the older one.
    integer(hid_t), intent(in) :: file, old
    !> Number of steps.
    integer, intent(in) :: n
    !> Nodes and cells of the last of them.
    integer, intent(out) :: n_node, n_cell
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    real(wp), allocatable :: node(:)
    integer(hsize_t) :: n_mesh, cells, nodes
    integer :: levels

    self%last = row_of(old, self%part, n, ok)
    self%at_cell = row_of(old, self%first_cell, n, ok)
    self%at_connectivity = row_of(old, self%first_connectivity, n, ok)
    n_mesh = int(self%last + 1, hsize_t)
    n_node = int(row_of(old, self%n_node, int(n_mesh), ok))
    n_cell = int(row_of(old, self%n_cell, int(n_mesh), ok))
    cells = int(self%at_cell, hsize_t) + int(n_cell, hsize_t)
    nodes = int(row_of(old, self%n_connectivity, int(n_mesh), ok), hsize_t)
    call read_rows(old, self%connectivity%path(), int(self%at_connectivity, hsize_t), nodes, &
        node, ok)
    self%node = nint(node)
    call copy_cells(self, old, n_mesh, cells, int(self%at_connectivity, hsize_t) + nodes, ok)
    call copy_series(self%part, old, int(n, hsize_t), ok)
    call copy_series(self%parts, old, int(n, hsize_t), ok)
    call copy_series(self%first_cell, old, int(n, hsize_t), ok)
    call copy_series(self%first_connectivity, old, int(n, hsize_t), ok)
    call dataset_size(old, level_path, levels)
    if (levels < 0) return
    call open_level(self, file, n_cell, ok)
    call copy_target(self%level, old, n, n_cell, ok)
  end subroutine meshes_copy

  !> Copy the cells of the first meshes of an older file.
  subroutine copy_cells(self, old, n_mesh, cells, nodes, ok)
    type(meshes_t), intent(inout) :: self
    integer(hid_t), intent(in) :: old
    !> Numbers of meshes, of their cells and of the nodes of these.
    integer(hsize_t), intent(in) :: n_mesh, cells, nodes
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    call copy_series(self%n_node, old, n_mesh, ok)
    call copy_series(self%n_cell, old, n_mesh, ok)
    call copy_series(self%n_connectivity, old, n_mesh, ok)
    call copy_series(self%types, old, cells, ok)
    call copy_series(self%connectivity, old, nodes, ok)
    call copy_series(self%offsets, old, cells + n_mesh, ok)
  end subroutine copy_cells

  !> Return a row of one number of an older file; 0 if it cannot be read.
  integer(i8) function row_of(old, series, row, ok)
    integer(hid_t), intent(in) :: old
    !> The dataset of the same path.
    type(series_t), intent(in) :: series
    !> From 1.
    integer, intent(in) :: row
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    real(wp), allocatable :: values(:)

    row_of = 0
    if (ok) call read_rows(old, series%path(), int(row - 1, hsize_t), 1_hsize_t, values, ok)
    if (ok) row_of = nint(values(1), i8)
  end function row_of

  !> Close the datasets.
  subroutine meshes_close(self)
    class(meshes_t), intent(inout) :: self

    call self%n_node%close()
    call self%n_cell%close()
    call self%n_connectivity%close()
    call self%types%close()
    call self%connectivity%close()
    call self%offsets%close()
    call self%part%close()
    call self%parts%close()
    call self%first_cell%close()
    call self%first_connectivity%close()
    call close_target(self%level)
  end subroutine meshes_close

  !> Return the nodes of the elements in VTK's order, from 0.
  pure function cells_of(model) result(node)
    type(model_t), intent(in) :: model
    integer :: node(size(model%connectivity))

    node = reshape(model%connectivity(model%element%vtk_order, :) - 1, [size(node)])
  end function cells_of

end module dd3_output_field_meshes
