! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of the closed curves of a cut: a line `x y z` for each vertex, an empty line between
!> curves, comments from `#` on.
module dd3_sheet_curves
  use dd3_base_error, only : error_list_t, error_t, location_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_bezier_file, only : push_file_errors
  use dd3_input_case, only : trim_spec_t
  use dd3_input_number, only : parse_real
  use dd3_input_number_check, only : not_a_number
  use dd3_input_text_file, only : next_line, read_text
  use dd3_input_token, only : line_t, place, split_line, token_list_t
  implicit none
  private
  public :: curve_t, read_curves

  !> Least number of vertices.
  integer, parameter :: least_vertices = 3
  !> Longest last segment of a closed curve, from the last vertex to the first, over the longest of
  !> the others.
  real(wp), parameter :: longest_closure = 2.0_wp

  !> A closed curve in space.
  type :: curve_t
    !> Vertices, `(3, n)`, mm; the first is not repeated at the end.
    real(wp), allocatable :: point(:, :)
    !> Where its first vertex is given.
    type(location_t) :: at
  end type curve_t

contains

  !> Read the curves of a cut. They may be used if no error was added.
  subroutine read_curves(curves, spec, errors)
    type(curve_t), allocatable, intent(out) :: curves(:)
    type(trim_spec_t), intent(in) :: spec
    type(error_list_t), intent(inout) :: errors

    integer :: i, before

    before = errors%count
    if (len(spec%file) > 0) then
      call read_curve_file(curves, spec, errors)
      if (errors%count == before .and. size(curves) == 0) call errors%push_input( &
          spec%source%at("file"), "'"//spec%file//"' has no curve", "lines x y z", code="E102")
    else
      allocate (curves(1))
      curves(1)%at = spec%source%at("points")
      if (mod(size(spec%point), 3) /= 0) then
        call errors%push_input(curves(1)%at, to_text(size(spec%point))//" numbers", &
            "x y z of each vertex in turn", code="E132")
        return
      end if
      curves(1)%point = reshape(spec%point, [3, size(spec%point)/3])
    end if
    if (errors%count > before) return
    do i = 1, size(curves)
      call close_curve(curves(i), errors)
    end do
  end subroutine read_curves

  !> Read a file of curves.
  subroutine read_curve_file(curves, spec, errors)
    type(curve_t), allocatable, intent(out) :: curves(:)
    type(trim_spec_t), intent(in) :: spec
    type(error_list_t), intent(inout) :: errors

    type(error_list_t) :: found
    type(error_t), allocatable :: error
    type(line_t) :: line
    type(token_list_t) :: word
    real(wp), allocatable :: point(:, :)
    real(wp) :: x(3)
    character(len=:), allocatable :: text
    type(location_t) :: begun
    integer :: next, first, last, n, n_curve, order
    logical :: continues

    allocate (curves(0))
    call read_text(spec%file, text, error)
    if (allocated(error)) then
      call errors%push_input(spec%source%at("file"), "cannot read the curves '"//spec%file// &
          "': "//error%message, "a file of closed curves", code="E101")
      return
    end if
    allocate (point(3, count([(text(n:n) == achar(10) .or. text(n:n) == achar(13), &
        n=1, len(text))]) + 1))
    n = 0
    n_curve = 0
    begun = spec%source%at("file")
    order = begun%order
    line%file = spec%file
    line%number = 0
    next = 1
    do while (next <= len(text))
      call next_line(text, next, first, last)
      line%number = line%number + 1
      line%text = text(first:last)
      word = token_list_t()
      call split_line(line, word, continues, found)
      if (word%count == 0) then
        if (len_trim(text(first:last)) == 0) call finish()
        cycle
      end if
      call read_vertex(word, x, found)
      if (n == 0) begun = place(line, 1, max(1, len_trim(line%text)))
      n = n + 1
      point(:, n) = x
    end do
    call finish()
    call push_file_errors(errors, found, spec%source%at("file"))

  contains

    !> Add the curve that has been read.
    subroutine finish()
      type(curve_t), allocatable :: more(:)

      if (n == 0) return
      allocate (more(n_curve + 1))
      more(:n_curve) = curves
      n_curve = n_curve + 1
      more(n_curve)%point = point(:, :n)
      more(n_curve)%at = begun
      more(n_curve)%at%order = order
      call move_alloc(more, curves)
      n = 0
    end subroutine finish

  end subroutine read_curve_file

  !> Read the coordinates of a vertex.
  subroutine read_vertex(word, x, errors)
    type(token_list_t), intent(in) :: word
    real(wp), intent(out) :: x(3)
    type(error_list_t), intent(inout) :: errors

    logical :: ok
    integer :: i

    x = 0.0_wp
    if (word%count /= 3) then
      call errors%push_input(word%item(1)%at, "a line with "//to_text(word%count)//" values", &
          "x y z of a vertex, mm", code="E132")
      return
    end if
    do i = 1, 3
      call parse_real(word%item(i)%text, x(i), ok)
      if (.not. ok) call errors%push_input(word%item(i)%at, not_a_number(word%item(i)%text), &
          "x y z of a vertex, mm", code="E131")
    end do
  end subroutine read_vertex

  !> Drop the last vertex of a curve if it repeats the first; report a curve that is open.
  subroutine close_curve(curve, errors)
    type(curve_t), intent(inout) :: curve
    type(error_list_t), intent(inout) :: errors

    real(wp) :: longest, gap
    integer :: i, n

    n = size(curve%point, 2)
    if (n == 0) return
    longest = maxval([(norm2(curve%point(:, i + 1) - curve%point(:, i)), i=1, n - 1)])
    gap = norm2(curve%point(:, n) - curve%point(:, 1))
    if (gap <= 1.0e-6_wp*longest) then
      n = n - 1
      curve%point = curve%point(:, :n)
    else if (n >= least_vertices .and. gap > longest_closure*longest) then
      call errors%push_input(curve%at, "the curve that begins here is open: "//to_text(gap, 3)// &
          " mm from its last vertex to its first", &
          "a closed curve; its first vertex again at its end, if a straight line closes it", &
          code="E153")
      return
    end if
    if (n < least_vertices) call errors%push_input(curve%at, "a curve of "//to_text(n)// &
        " vertices", "three or more vertices", code="E153")
  end subroutine close_curve

end module dd3_sheet_curves
