! SPDX-License-Identifier: GPL-3.0-or-later
!> Growing datasets of an HDF5 file. Its files remain readable after a kill only with the default
!> version of the library's format, and if data, flush, number of steps, flush follow in this order.
module dd3_output_hdf5
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_null_char, c_ptr
  use dd3_base_kinds, only : wp, i8
  use dd3_base_posix, only : posix_setenv
  use hdf5, only : hid_t, hsize_t, size_t, h5open_f, h5eset_auto_f, h5screate_simple_f, &
      h5screate_f, h5sclose_f, h5sselect_hyperslab_f, h5dcreate_f, h5dclose_f, h5dwrite_f, &
      h5dset_extent_f, h5dget_space_f, h5pcreate_f, h5pset_chunk_f, h5pclose_f, h5acreate_f, &
      h5awrite_f, h5aclose_f, h5tcopy_f, h5tset_size_f, h5tclose_f, h5gcreate_f, h5fflush_f, &
      h5iget_name_f, H5S_SELECT_SET_F, H5S_UNLIMITED_F, H5S_SCALAR_F, H5P_DATASET_CREATE_F, &
      H5T_FORTRAN_S1, H5T_STRING, H5T_NATIVE_DOUBLE, H5T_NATIVE_INTEGER, H5T_IEEE_F64LE, &
      H5T_STD_I64LE, H5T_STD_I32LE, H5T_STD_U8LE, H5F_SCOPE_GLOBAL_F, h5kind_to_type, &
      H5_INTEGER_KIND
  implicit none
  private
  public :: series_t, start_hdf5, make_group, flush_hdf5
  public :: text_attribute, integer_attribute, rewrite_attribute
  public :: kind_real, kind_long, kind_int, kind_byte

  !> Types of numbers in the file: reals of 8 bytes, integers of 8, 4 and 1 bytes.
  integer, parameter :: kind_real = 1, kind_long = 2, kind_int = 3, kind_byte = 4
  !> Largest number of rows in a chunk.
  integer, parameter :: largest_chunk = 32768
  !> Largest number of characters of a text attribute in the header of an object, which has 64 kB.
  integer, parameter :: longest_attribute = 60000

  !> Dataset that grows by rows.
  type :: series_t
    !> Identifier; negative when closed.
    integer(hid_t) :: id = -1_hid_t
    !> Values in a row.
    integer :: components = 1
    !> The dataset has rank 2.
    logical :: table = .false.
    !> Rows so far, and rows in a chunk.
    integer(hsize_t) :: rows = 0, chunk = 1
  contains
    procedure :: create => series_create
    procedure :: append_reals => series_append_reals
    procedure :: append_integers => series_append_integers
    procedure :: append_long => series_append_long
    procedure :: describe => series_describe
    procedure :: room => series_room
    procedure :: path => series_path
    procedure :: close => series_close
  end type series_t

  interface
    !> Leave the files alone when the program ends.
    integer(c_int) function h5_dont_atexit() bind(c, name="H5dont_atexit")
      import :: c_int
    end function h5_dont_atexit
  end interface

contains

  !> Initialise the library without error messages and file locks: the results of a running job can
  !> be read. Files that failed are not touched again when the program ends.
  subroutine start_hdf5(ok)
    logical, intent(out) :: ok

    integer :: status
    integer(c_int) :: set

    set = posix_setenv("HDF5_USE_FILE_LOCKING"//c_null_char, "FALSE"//c_null_char, 0_c_int)
    set = h5_dont_atexit()
    call h5open_f(status)
    ok = status >= 0
    if (ok) call h5eset_auto_f(0, status)
  end subroutine start_hdf5

  !> Make a dataset without rows.
  subroutine series_create(self, parent, name, kind, components, table, chunk, ok)
    class(series_t), intent(inout) :: self
    integer(hid_t), intent(in) :: parent
    character(len=*), intent(in) :: name
    !> One of the `kind_*` values; values in a row.
    integer, intent(in) :: kind, components
    !> Rows of one number make a dataset of rank 2 too.
    logical, intent(in) :: table
    !> Rows added at a time.
    integer, intent(in) :: chunk
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: space, plist
    integer(hsize_t) :: size_now(2), size_most(2), size_chunk(2)
    integer :: status, rank, ignored

    if (.not. ok) return
    self%components = components
    self%table = table .or. components > 1
    self%rows = 0
    rank = merge(2, 1, self%table)
    size_now = int(components, hsize_t)
    size_most = size_now
    size_chunk = size_now
    size_now(rank) = 0
    size_most(rank) = H5S_UNLIMITED_F
    self%chunk = int(max(1, min(chunk, largest_chunk)), hsize_t)
    size_chunk(rank) = self%chunk
    call h5screate_simple_f(rank, size_now(:rank), space, status, size_most(:rank))
    ok = status >= 0
    if (ok) call h5pcreate_f(H5P_DATASET_CREATE_F, plist, status)
    ok = ok .and. status >= 0
    if (ok) call h5pset_chunk_f(plist, rank, size_chunk(:rank), status)
    ok = ok .and. status >= 0
    if (ok) call h5dcreate_f(parent, name, file_type(kind), space, self%id, status, plist)
    ok = ok .and. status >= 0
    if (.not. ok) return
    call h5pclose_f(plist, ignored)
    call h5sclose_f(space, ignored)
  end subroutine series_create

  !> Return the type of a kind of number in the file.
  integer(hid_t) function file_type(kind)
    !> One of the `kind_*` values.
    integer, intent(in) :: kind

    select case (kind)
    case (kind_long)
      file_type = H5T_STD_I64LE
    case (kind_int)
      file_type = H5T_STD_I32LE
    case (kind_byte)
      file_type = H5T_STD_U8LE
    case default
      file_type = H5T_IEEE_F64LE
    end select
  end function file_type

  !> Append rows of real numbers.
  subroutine series_append_reals(self, values, ok)
    class(series_t), intent(inout) :: self
    real(wp), intent(in) :: values(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: memory, file
    integer :: status

    call grow(self, size(values), memory, file, ok)
    if (.not. ok) return
    call h5dwrite_f(self%id, H5T_NATIVE_DOUBLE, values, [size(values, kind=hsize_t)], status, &
        memory, file)
    ok = status >= 0
    call close_spaces(memory, file)
  end subroutine series_append_reals

  !> Append rows of integers.
  subroutine series_append_integers(self, values, ok)
    class(series_t), intent(inout) :: self
    integer, intent(in) :: values(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: memory, file
    integer :: status

    call grow(self, size(values), memory, file, ok)
    if (.not. ok) return
    call h5dwrite_f(self%id, H5T_NATIVE_INTEGER, values, [size(values, kind=hsize_t)], status, &
        memory, file)
    ok = status >= 0
    call close_spaces(memory, file)
  end subroutine series_append_integers

  !> Append a row of one long integer.
  subroutine series_append_long(self, value, ok)
    class(series_t), intent(inout) :: self
    integer(i8), intent(in), target :: value
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: memory, file
    integer :: status

    call grow(self, 1, memory, file, ok)
    if (.not. ok) return
    call h5dwrite_f(self%id, h5kind_to_type(i8, H5_INTEGER_KIND), c_loc(value), status, memory, &
        file)
    ok = status >= 0
    call close_spaces(memory, file)
  end subroutine series_append_long

  !> Extend a dataset and select the new rows.
  subroutine grow(self, count, memory, file, ok)
    type(series_t), intent(inout) :: self
    !> Number of values.
    integer, intent(in) :: count
    !> Dataspaces of the values and of the rows.
    integer(hid_t), intent(out) :: memory, file
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hsize_t) :: first(2), more(2), extent(2)
    integer :: status, rank

    memory = -1
    file = -1
    if (.not. ok) return
    rank = merge(2, 1, self%table)
    first = 0
    more(1) = int(self%components, hsize_t)
    first(rank) = self%rows
    more(rank) = int(count/self%components, hsize_t)
    extent = first + more
    call h5dset_extent_f(self%id, extent(:rank), status)
    ok = status >= 0
    if (ok) call h5screate_simple_f(1, [int(count, hsize_t)], memory, status)
    ok = ok .and. status >= 0
    if (ok) call h5dget_space_f(self%id, file, status)
    ok = ok .and. status >= 0
    if (ok) call h5sselect_hyperslab_f(file, H5S_SELECT_SET_F, first(:rank), more(:rank), status)
    ok = ok .and. status >= 0
    self%rows = self%rows + more(rank)
  end subroutine grow

  !> Close two dataspaces.
  subroutine close_spaces(memory, file)
    integer(hid_t), intent(in) :: memory, file

    integer :: ignored

    call h5sclose_f(memory, ignored)
    call h5sclose_f(file, ignored)
  end subroutine close_spaces

  !> Store the unit and the meaning of a dataset as attributes.
  subroutine series_describe(self, unit, description, ok)
    class(series_t), intent(in) :: self
    character(len=*), intent(in) :: unit, description
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    call text_attribute(self%id, "unit", unit, ok)
    call text_attribute(self%id, "description", description, ok)
  end subroutine series_describe

  !> Return an upper bound of the size of new rows on the disk, bytes.
  pure integer(i8) function series_room(self, more)
    class(series_t), intent(in) :: self
    integer, intent(in) :: more

    series_room = ((int(more, i8) - 1)/self%chunk + 2)*self%chunk*int(self%components, i8)*8 + 4096
  end function series_room

  !> Return the path of a dataset in its file.
  function series_path(self) result(path)
    class(series_t), intent(in) :: self
    character(len=:), allocatable :: path

    character(len=256) :: buffer
    integer(size_t) :: length
    integer :: status

    call h5iget_name_f(self%id, buffer, len(buffer, kind=size_t), length, status)
    path = trim(buffer(:length))
  end function series_path

  !> Close a dataset.
  subroutine series_close(self)
    class(series_t), intent(inout) :: self

    integer :: ignored

    if (self%id >= 0) call h5dclose_f(self%id, ignored)
    self%id = -1
  end subroutine series_close

  !> Make a group.
  subroutine make_group(parent, name, group, ok)
    integer(hid_t), intent(in) :: parent
    character(len=*), intent(in) :: name
    integer(hid_t), intent(out) :: group
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: status

    group = -1
    if (.not. ok) return
    call h5gcreate_f(parent, name, group, status)
    ok = status >= 0
  end subroutine make_group

  !> Make a text attribute.
  subroutine text_attribute(object, name, text, ok)
    integer(hid_t), intent(in) :: object
    character(len=*), intent(in) :: name, text
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: space, type, attribute
    integer :: status, ignored

    if (.not. ok) return
    if (len(text) > longest_attribute) then
      call long_text_attribute(object, name, text, ok)
      return
    end if
    call h5tcopy_f(H5T_FORTRAN_S1, type, status)
    ok = status >= 0
    if (ok) call h5tset_size_f(type, max(1_size_t, len(text, kind=size_t)), status)
    ok = ok .and. status >= 0
    if (ok) call h5screate_f(H5S_SCALAR_F, space, status)
    ok = ok .and. status >= 0
    if (ok) call h5acreate_f(object, name, type, space, attribute, status)
    ok = ok .and. status >= 0
    if (ok) call h5awrite_f(attribute, type, text//repeat(" ", merge(1_i8, 0_i8, len(text) == 0)), &
        [1_hsize_t], status)
    ok = ok .and. status >= 0
    if (.not. ok) return
    call h5aclose_f(attribute, ignored)
    call h5sclose_f(space, ignored)
    call h5tclose_f(type, ignored)
  end subroutine text_attribute

  !> Make an attribute of a text that the header of an object cannot hold, as a string of variable
  !> length, which is stored elsewhere in the file.
  subroutine long_text_attribute(object, name, text, ok)
    integer(hid_t), intent(in) :: object
    character(len=*), intent(in) :: name, text
    !> Success flag.
    logical, intent(inout) :: ok

    character(len=1, kind=c_char), allocatable, target :: copy(:)
    type(c_ptr), target :: address(1)
    integer(hid_t) :: space, attribute
    integer :: status, ignored, i

    copy = [(text(i:i), i=1, len(text)), c_null_char]
    address(1) = c_loc(copy)
    call h5screate_f(H5S_SCALAR_F, space, status)
    ok = status >= 0
    if (ok) call h5acreate_f(object, name, H5T_STRING, space, attribute, status)
    ok = ok .and. status >= 0
    if (ok) call h5awrite_f(attribute, H5T_STRING, c_loc(address), status)
    ok = ok .and. status >= 0
    if (.not. ok) return
    call h5aclose_f(attribute, ignored)
    call h5sclose_f(space, ignored)
  end subroutine long_text_attribute

  !> Make an attribute of integers: one as a scalar, several as a list.
  subroutine integer_attribute(object, name, values, attribute, ok)
    integer(hid_t), intent(in) :: object
    character(len=*), intent(in) :: name
    integer, intent(in) :: values(:)
    !> Left open.
    integer(hid_t), intent(out) :: attribute
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: space
    integer :: status, ignored

    attribute = -1
    if (.not. ok) return
    if (size(values) == 1) then
      call h5screate_f(H5S_SCALAR_F, space, status)
    else
      call h5screate_simple_f(1, [size(values, kind=hsize_t)], space, status)
    end if
    ok = status >= 0
    if (ok) call h5acreate_f(object, name, H5T_STD_I64LE, space, attribute, status)
    ok = ok .and. status >= 0
    if (.not. ok) return
    call h5sclose_f(space, ignored)
    call rewrite_attribute(attribute, values, ok)
  end subroutine integer_attribute

  !> Overwrite an attribute.
  subroutine rewrite_attribute(attribute, values, ok)
    integer(hid_t), intent(in) :: attribute
    integer, intent(in) :: values(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: status

    if (.not. ok) return
    call h5awrite_f(attribute, H5T_NATIVE_INTEGER, values, [size(values, kind=hsize_t)], status)
    ok = status >= 0
  end subroutine rewrite_attribute

  !> Write all that is buffered of a file.
  subroutine flush_hdf5(file, ok)
    integer(hid_t), intent(in) :: file
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: status

    if (.not. ok) return
    call h5fflush_f(file, H5F_SCOPE_GLOBAL_F, status)
    ok = status >= 0
  end subroutine flush_hdf5

end module dd3_output_hdf5
