! SPDX-License-Identifier: GPL-3.0-or-later
!> Reading of HDF5 files: datasets of numbers as one-dimensional arrays, attributes.
module dd3_output_hdf5_read
  use dd3_base_kinds, only : wp, i8
  use dd3_output_hdf5, only : start_hdf5
  use hdf5, only : hid_t, hsize_t, size_t, h5aclose_f, h5aget_type_f, h5aopen_f, h5aread_f, &
      h5dclose_f, h5dget_space_f, h5dopen_f, h5dread_f, h5fclose_f, h5fopen_f, h5screate_simple_f, &
      h5sclose_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
      h5sselect_hyperslab_f, h5tclose_f, h5tget_size_f, H5F_ACC_RDONLY_F, H5S_SELECT_SET_F, &
      H5T_NATIVE_DOUBLE, H5T_NATIVE_INTEGER
  implicit none
  private
  public :: open_hdf5, close_hdf5, dataset_size, read_reals, read_integers, read_rows
  public :: read_text_attribute, read_integer_attribute

  !> Largest rank of a dataset that is read.
  integer, parameter :: max_rank = 2

contains

  !> Open a file for reading.
  subroutine open_hdf5(path, file, ok)
    character(len=*), intent(in) :: path
    integer(hid_t), intent(out) :: file
    !> False if it is not an HDF5 file, or truncated.
    logical, intent(out) :: ok

    integer :: status

    file = -1
    call start_hdf5(ok)
    if (.not. ok) return
    call h5fopen_f(path, H5F_ACC_RDONLY_F, file, status)
    ok = status >= 0
  end subroutine open_hdf5

  !> Close a file opened for reading.
  subroutine close_hdf5(file)
    integer(hid_t), intent(inout) :: file

    integer :: ignored

    if (file >= 0) call h5fclose_f(file, ignored)
    file = -1
  end subroutine close_hdf5

  !> Return the number of values of a dataset; -1 if there is none of the name.
  subroutine dataset_size(parent, name, n)
    integer(hid_t), intent(in) :: parent
    character(len=*), intent(in) :: name
    integer, intent(out) :: n

    integer(hid_t) :: dataset, space
    integer(hsize_t) :: extent(max_rank), largest(max_rank)
    integer :: status, rank, ignored

    n = -1
    call h5dopen_f(parent, name, dataset, status)
    if (status < 0) return
    call h5dget_space_f(dataset, space, status)
    if (status >= 0) call h5sget_simple_extent_ndims_f(space, rank, status)
    if (status >= 0 .and. rank <= max_rank) then
      call h5sget_simple_extent_dims_f(space, extent(:rank), largest(:rank), status)
      if (status >= 0) n = int(product(extent(:rank)))
    end if
    call h5sclose_f(space, ignored)
    call h5dclose_f(dataset, ignored)
  end subroutine dataset_size

  !> Read a dataset whose size is known.
  subroutine read_reals(parent, name, values, ok)
    integer(hid_t), intent(in) :: parent
    character(len=*), intent(in) :: name
    real(wp), intent(out) :: values(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: dataset
    integer :: status, ignored

    values = 0.0_wp
    if (.not. ok) return
    call h5dopen_f(parent, name, dataset, status)
    ok = status >= 0
    if (.not. ok) return
    call h5dread_f(dataset, H5T_NATIVE_DOUBLE, values, [size(values, kind=hsize_t)], status)
    ok = status >= 0
    call h5dclose_f(dataset, ignored)
  end subroutine read_reals

  !> Read a dataset whose size is known.
  subroutine read_integers(parent, name, values, ok)
    integer(hid_t), intent(in) :: parent
    character(len=*), intent(in) :: name
    integer, intent(out) :: values(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: dataset
    integer :: status, ignored

    values = 0
    if (.not. ok) return
    call h5dopen_f(parent, name, dataset, status)
    ok = status >= 0
    if (.not. ok) return
    call h5dread_f(dataset, H5T_NATIVE_INTEGER, values, [size(values, kind=hsize_t)], status)
    ok = status >= 0
    call h5dclose_f(dataset, ignored)
  end subroutine read_integers

  !> Read consecutive rows of a dataset of rank 1 or 2; integers are converted.
  subroutine read_rows(parent, name, first, rows, values, ok)
    integer(hid_t), intent(in) :: parent
    character(len=*), intent(in) :: name
    !> First row, from 0, and their number.
    integer(hsize_t), intent(in) :: first, rows
    real(wp), allocatable, intent(out) :: values(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: dataset, space, memory
    integer(hsize_t) :: extent(max_rank), largest(max_rank), start(max_rank), number(max_rank)
    integer :: status, rank, ignored

    allocate (values(0))
    if (.not. ok) return
    call h5dopen_f(parent, name, dataset, status)
    ok = status >= 0
    if (.not. ok) return
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    ok = status >= 0 .and. rank >= 1 .and. rank <= max_rank
    extent = 1
    if (ok) call h5sget_simple_extent_dims_f(space, extent(:rank), largest(:rank), status)
    start = 0
    start(rank) = first
    number = extent
    number(rank) = rows
    ok = ok .and. first + rows <= extent(rank)
    if (ok) then
      deallocate (values)
      allocate (values(product(number(:rank))))
      call h5sselect_hyperslab_f(space, H5S_SELECT_SET_F, start(:rank), number(:rank), status)
      call h5screate_simple_f(1, [size(values, kind=hsize_t)], memory, status)
      call h5dread_f(dataset, H5T_NATIVE_DOUBLE, values, [size(values, kind=hsize_t)], status, &
          memory, space)
      ok = status >= 0
      call h5sclose_f(memory, ignored)
    end if
    call h5sclose_f(space, ignored)
    call h5dclose_f(dataset, ignored)
  end subroutine read_rows

  !> Read a text attribute; empty if there is none.
  subroutine read_text_attribute(object, name, text)
    integer(hid_t), intent(in) :: object
    character(len=*), intent(in) :: name
    character(len=:), allocatable, intent(out) :: text

    integer(hid_t) :: attribute, type
    integer(size_t) :: length
    integer :: status, ignored

    text = ""
    call h5aopen_f(object, name, attribute, status)
    if (status < 0) return
    call h5aget_type_f(attribute, type, status)
    if (status >= 0) call h5tget_size_f(type, length, status)
    if (status >= 0) then
      text = repeat(" ", int(length, i8))
      call h5aread_f(attribute, type, text, [1_hsize_t], status)
      if (status < 0) text = ""
      call h5tclose_f(type, ignored)
    end if
    text = trim(text)
    call h5aclose_f(attribute, ignored)
  end subroutine read_text_attribute

  !> Read an integer attribute; -1 if there is none.
  integer function read_integer_attribute(object, name) result(value)
    integer(hid_t), intent(in) :: object
    character(len=*), intent(in) :: name

    integer(hid_t) :: attribute
    integer :: values(1), status, ignored

    value = -1
    call h5aopen_f(object, name, attribute, status)
    if (status < 0) return
    call h5aread_f(attribute, H5T_NATIVE_INTEGER, values, [1_hsize_t], status)
    if (status >= 0) value = values(1)
    call h5aclose_f(attribute, ignored)
  end function read_integer_attribute

end module dd3_output_hdf5_read
