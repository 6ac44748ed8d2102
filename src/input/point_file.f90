! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of files of points in plan: x and y in each line; # or ! begins a comment.
module dd3_input_point_file
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, error_t, location_t
  use dd3_base_text, only : text_t, to_text
  use dd3_input_bezier_file, only : push_file_errors
  use dd3_input_number, only : parse_real
  use dd3_input_number_check, only : not_a_number
  use dd3_input_text_file, only : read_lines
  use dd3_input_token, only : line_t, place, split_line, token_list_t
  implicit none
  private
  public :: read_points

  !> Expected form of a line.
  character(len=*), parameter :: form = "x y, in mm"

contains

  !> Read all points of a file.
  subroutine read_points(point, file, location, errors)
    !> x y in turn, mm; valid only if no error was added.
    real(wp), allocatable, intent(out) :: point(:)
    character(len=*), intent(in) :: file
    !> Where the input names the file.
    type(location_t), intent(in) :: location
    type(error_list_t), intent(inout) :: errors

    type(text_t), allocatable :: text(:)
    type(error_list_t) :: found
    type(error_t), allocatable :: error
    type(line_t) :: line
    real(wp) :: new(2)
    logical :: ok
    integer :: i

    allocate (point(0))
    call read_lines(file, text, error)
    if (allocated(error)) then
      call errors%push_input(location, "cannot read the points of '"//file//"': "//error%message, &
          "a file with "//form//", in each line", code="E101")
      return
    end if
    do i = 1, size(text)
      line%file = file
      line%number = i
      line%text = text(i)%s
      call read_point(line, new, ok, found)
      if (ok) point = [point, new]
    end do
    call push_file_errors(errors, found, location)
  end subroutine read_points

  !> Read the point of a line.
  subroutine read_point(line, point, ok, errors)
    type(line_t), intent(in) :: line
    real(wp), intent(out) :: point(2)
    !> Whether the line has a valid point.
    logical, intent(out) :: ok
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: token
    logical :: continues
    integer :: i

    ok = .false.
    point = 0.0_wp
    call split_line(line, token, continues, errors)
    if (token%count == 0) return
    if (token%count /= 2 .or. continues) then
      call errors%push_input(place(line, 1, len_trim(line%text)), "expected 2 numbers, got "// &
          to_text(token%count), form, code="E132")
      return
    end if
    do i = 1, 2
      call parse_real(token%item(i)%text, point(i), ok)
      if (ok) cycle
      call errors%push_input(token%item(i)%at, not_a_number(token%item(i)%text), form, code="E131")
      return
    end do
  end subroutine read_point

end module dd3_input_point_file
