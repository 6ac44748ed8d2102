!> Growing datasets of an HDF5 file. The default library version is the one whose files outlive a
!> killed program when data, flush, number of steps, flush follow each other in this order.
module dd3_output_hdf5
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_null_char
  use dd3_base_kinds, only : wp, i8
  use hdf5, only : hid_t, hsize_t, size_t, h5open_f, h5eset_auto_f, h5screate_simple_f, &
                   h5screate_f, h5sclose_f, h5sselect_hyperslab_f, h5dcreate_f, h5dclose_f, &
                   h5dwrite_f, h5dset_extent_f, h5dget_space_f, h5pcreate_f, h5pset_chunk_f, &
                   h5pclose_f, h5acreate_f, h5awrite_f, h5aclose_f, h5tcopy_f, h5tset_size_f, &
                   h5tclose_f, h5gcreate_f, h5fflush_f, H5S_SELECT_SET_F, H5S_UNLIMITED_F, &
                   H5S_SCALAR_F, H5P_DATASET_CREATE_F, H5T_FORTRAN_S1, H5T_NATIVE_DOUBLE, &
                   H5T_NATIVE_INTEGER, H5T_IEEE_F64LE, H5T_STD_I64LE, H5T_STD_I32LE, &
                   H5T_STD_U8LE, H5F_SCOPE_GLOBAL_F, h5kind_to_type, H5_INTEGER_KIND
  implicit none
  private
  public :: series_t, start_hdf5, make_group, flush_hdf5
  public :: text_attribute, integer_attribute, rewrite_attribute
  public :: kind_real, kind_long, kind_int, kind_byte

  !> How numbers stand in the file: reals of 8 bytes, whole numbers of 8, 4 and 1 bytes.
  integer, parameter :: kind_real = 1, kind_long = 2, kind_int = 3, kind_byte = 4
  !> Largest number of rows stored together.
  integer, parameter :: largest_chunk = 32768

  !> A dataset that grows by rows.
  type :: series_t
    !> Identifier; negative when closed.
    integer(hid_t) :: id = -1_hid_t
    !> Numbers in a row, and whether the rows stand in a table (rank 2).
    integer :: components = 1
    !> Whether a row of one number still has an index of its own.
    logical :: table = .false.
    !> Rows so far, and rows that are stored together.
    integer(hsize_t) :: rows = 0, chunk = 1
  contains
    procedure :: create => series_create
    procedure :: append_reals => series_append_reals
    procedure :: append_integers => series_append_integers
    procedure :: append_long => series_append_long
    procedure :: describe => series_describe
    procedure :: room => series_room
    procedure :: close => series_close
  end type series_t

  interface
    !> Keeps the library from touching its files once more when the program ends.
    integer(c_int) function h5_dont_atexit() bind(c, name="H5dont_atexit")
      import :: c_int
    end function h5_dont_atexit
    !> setenv(3).
    integer(c_int) function c_setenv(name, value, overwrite) bind(c, name="setenv")
      import :: c_char, c_int
      !> Name and value of the variable, each ended by a null.
      character(kind=c_char), intent(in) :: name(*), value(*)
      !> Whether a value it has already is replaced.
      integer(c_int), value :: overwrite
    end function c_setenv
  end interface

contains

  !> Readies the library: it keeps quiet, and locks no file, so that a run can be looked at. Files
  !> that failed must not be touched when the program ends: that would spoil them, or crash.
  subroutine start_hdf5(ok)
    !> Whether all went well.
    logical, intent(out) :: ok
    integer :: status
    integer(c_int) :: set

    set = c_setenv("HDF5_USE_FILE_LOCKING"//c_null_char, "FALSE"//c_null_char, 0_c_int)
    set = h5_dont_atexit()
    call h5open_f(status)
    ok = status >= 0
    if (ok) call h5eset_auto_f(0, status)
  end subroutine start_hdf5

  !> Makes a dataset without rows.
  subroutine series_create(self, parent, name, kind, components, table, chunk, ok)
    !> The dataset.
    class(series_t), intent(inout) :: self
    !> The group it stands in.
    integer(hid_t), intent(in) :: parent
    !> Its name.
    character(len=*), intent(in) :: name
    !> One of the `kind_*` values; numbers in a row.
    integer, intent(in) :: kind, components
    !> Whether rows of one number still make a table.
    logical, intent(in) :: table
    !> Rows that are added at a time.
    integer, intent(in) :: chunk
    !> Whether all went well so far; nothing is done where not.
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

  !> The library's name for a kind of number.
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

  !> Adds rows of real numbers.
  subroutine series_append_reals(self, values, ok)
    !> The dataset.
    class(series_t), intent(inout) :: self
    !> The rows, one behind the other.
    real(wp), intent(in) :: values(:)
    !> Whether all went well so far; nothing is done where not.
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

  !> Adds rows of whole numbers.
  subroutine series_append_integers(self, values, ok)
    !> The dataset.
    class(series_t), intent(inout) :: self
    !> The rows, one behind the other.
    integer, intent(in) :: values(:)
    !> Whether all went well so far; nothing is done where not.
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

  !> Adds a row of one whole number that may be large.
  subroutine series_append_long(self, value, ok)
    !> The dataset.
    class(series_t), intent(inout) :: self
    !> The number.
    integer(i8), intent(in), target :: value
    !> Whether all went well so far; nothing is done where not.
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

  !> Makes room for new rows.
  subroutine grow(self, count, memory, file, ok)
    !> The dataset.
    type(series_t), intent(inout) :: self
    !> Numbers to come.
    integer, intent(in) :: count
    !> Where the numbers are, and where they go.
    integer(hid_t), intent(out) :: memory, file
    !> Whether all went well so far; nothing is done where not.
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

  !> Gives two dataspaces back.
  subroutine close_spaces(memory, file)
    !> The dataspaces.
    integer(hid_t), intent(in) :: memory, file
    integer :: ignored

    call h5sclose_f(memory, ignored)
    call h5sclose_f(file, ignored)
  end subroutine close_spaces

  !> Says the unit and the meaning of a dataset, for those who open the file by hand.
  subroutine series_describe(self, unit, description, ok)
    !> The dataset.
    class(series_t), intent(in) :: self
    !> The unit, and the meaning.
    character(len=*), intent(in) :: unit, description
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok

    call text_attribute(self%id, "unit", unit, ok)
    call text_attribute(self%id, "description", description, ok)
  end subroutine series_describe

  !> Bytes that new rows may take on the disk at most.
  pure integer(i8) function series_room(self, more)
    !> The dataset.
    class(series_t), intent(in) :: self
    !> Number of rows to come.
    integer, intent(in) :: more

    series_room = ((int(more, i8) - 1)/self%chunk + 2)*self%chunk*int(self%components, i8)*8 + 4096
  end function series_room

  !> Closes a dataset.
  subroutine series_close(self)
    !> The dataset.
    class(series_t), intent(inout) :: self
    integer :: ignored

    if (self%id >= 0) call h5dclose_f(self%id, ignored)
    self%id = -1
  end subroutine series_close

  !> Makes a group.
  subroutine make_group(parent, name, group, ok)
    !> The group or file it stands in.
    integer(hid_t), intent(in) :: parent
    !> Its name.
    character(len=*), intent(in) :: name
    !> The group.
    integer(hid_t), intent(out) :: group
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer :: status

    group = -1
    if (.not. ok) return
    call h5gcreate_f(parent, name, group, status)
    ok = status >= 0
  end subroutine make_group

  !> Gives an object a text of fixed length.
  subroutine text_attribute(object, name, text, ok)
    !> The object.
    integer(hid_t), intent(in) :: object
    !> Name of the attribute, and its text.
    character(len=*), intent(in) :: name, text
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer(hid_t) :: space, type, attribute
    integer :: status, ignored

    if (.not. ok) return
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

  !> Gives an object whole numbers: one as a scalar, several as a list.
  subroutine integer_attribute(object, name, values, attribute, ok)
    !> The object.
    integer(hid_t), intent(in) :: object
    !> Name of the attribute.
    character(len=*), intent(in) :: name
    !> The numbers.
    integer, intent(in) :: values(:)
    !> The attribute, left open.
    integer(hid_t), intent(out) :: attribute
    !> Whether all went well so far; nothing is done where not.
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

  !> Gives an attribute other numbers.
  subroutine rewrite_attribute(attribute, values, ok)
    !> The attribute.
    integer(hid_t), intent(in) :: attribute
    !> The numbers.
    integer, intent(in) :: values(:)
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer :: status

    if (.not. ok) return
    call h5awrite_f(attribute, H5T_NATIVE_INTEGER, values, [size(values, kind=hsize_t)], status)
    ok = status >= 0
  end subroutine rewrite_attribute

  !> Hands everything of a file to the system.
  subroutine flush_hdf5(file, ok)
    !> The file.
    integer(hid_t), intent(in) :: file
    !> Whether all went well so far; nothing is done where not.
    logical, intent(inout) :: ok
    integer :: status

    if (.not. ok) return
    call h5fflush_f(file, H5F_SCOPE_GLOBAL_F, status)
    ok = status >= 0
  end subroutine flush_hdf5

end module dd3_output_hdf5
