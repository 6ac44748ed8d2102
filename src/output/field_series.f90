! SPDX-License-Identifier: GPL-3.0-or-later
!> Datasets of fields.vtkhdf: those of a field with the offsets of its steps, and their copies from
!> an earlier file.
module dd3_output_field_series
  use dd3_base_kinds, only : wp, i8
  use dd3_output_field_table, only : field_t
  use dd3_output_hdf5, only : kind_int, kind_long, kind_real, series_t
  use dd3_output_hdf5_read, only : dataset_size, read_integers, read_rows
  use hdf5, only : hid_t, hsize_t, h5aclose_f, h5gclose_f
  implicit none
  private
  public :: target_t, step_chunk, make_targets, append, copy_target, copy_series, count_steps
  public :: close_target, close_group, close_attribute

  !> Rows per chunk of the datasets with one row per step.
  integer, parameter :: step_chunk = 64
  !> Most rows copied at a time.
  integer(hsize_t), parameter :: copy_rows = 100000

  !> Datasets of a field: its values, and the position of the first row of each step.
  type :: target_t
    type(series_t) :: data, offset
  end type target_t

contains

  !> Make the datasets of fields and of their offsets.
  subroutine make_targets(field, place, data, offsets, chunk, ok)
    type(field_t), intent(in) :: field(:)
    type(target_t), allocatable, intent(out) :: place(:)
    !> Groups of the values and of the offsets.
    integer(hid_t), intent(in) :: data, offsets
    !> Rows of a step.
    integer, intent(in) :: chunk
    !> Success flag; no-op if false.
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

  !> Add the values of a step and the position of their first row.
  subroutine append(place, values, ok)
    type(target_t), intent(inout) :: place
    real(wp), intent(in) :: values(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(i8) :: first

    first = int(place%data%rows, i8)
    call place%data%append_reals(values, ok)
    call place%offset%append_long(first, ok)
  end subroutine append

  !> Return the number of steps of an older file up to an increment; 0 if it has none for that
  !> increment.
  subroutine count_steps(old, last_increment, n, ok)
    integer(hid_t), intent(in) :: old
    integer, intent(in) :: last_increment
    integer, intent(out) :: n
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer, allocatable :: increment(:)

    n = 0
    if (ok) call dataset_size(old, "/job/increment", n)
    allocate (increment(max(0, n)))
    if (size(increment) > 0) call read_integers(old, "/job/increment", increment, ok)
    n = 0
    if (ok .and. any(increment == last_increment)) n = count(increment <= last_increment)
  end subroutine count_steps

  !> Copy the datasets of a field for some steps.
  subroutine copy_target(place, old, n, rows, ok)
    type(target_t), intent(inout) :: place
    integer(hid_t), intent(in) :: old
    !> Number of steps, and rows of the last one.
    integer, intent(in) :: n, rows
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    real(wp), allocatable :: first(:)

    call copy_series(place%offset, old, int(n, hsize_t), ok)
    if (ok) call read_rows(old, place%offset%path(), int(n - 1, hsize_t), 1_hsize_t, first, ok)
    if (ok) call copy_series(place%data, old, nint(first(1), hsize_t) + int(rows, hsize_t), ok)
  end subroutine copy_target

  !> Copy the first rows of a dataset.
  subroutine copy_series(series, old, rows, ok)
    type(series_t), intent(inout) :: series
    integer(hid_t), intent(in) :: old
    integer(hsize_t), intent(in) :: rows
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    real(wp), allocatable :: values(:)

    do while (ok .and. series%rows < rows)
      call read_rows(old, series%path(), series%rows, min(copy_rows, rows - series%rows), &
          values, ok)
      call series%append_reals(values, ok)
    end do
  end subroutine copy_series

  !> Close the datasets of a field.
  subroutine close_target(place)
    type(target_t), intent(inout) :: place

    call place%data%close()
    call place%offset%close()
  end subroutine close_target

  !> Close a group.
  subroutine close_group(group)
    integer(hid_t), intent(in) :: group

    integer :: ignored

    if (group >= 0) call h5gclose_f(group, ignored)
  end subroutine close_group

  !> Close an attribute.
  subroutine close_attribute(attribute)
    integer(hid_t), intent(inout) :: attribute

    integer :: ignored

    if (attribute >= 0) call h5aclose_f(attribute, ignored)
    attribute = -1
  end subroutine close_attribute

end module dd3_output_field_series
