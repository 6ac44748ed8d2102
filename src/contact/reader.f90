!> Reads the surface of a tool from its file of Bézier patches.
!>
!> For every patch a line `patch m n` with the degrees along u and v, `rational` behind them where
!> every point has a weight; then (m+1)(n+1) lines `x y z` or `x y z w`, u fastest. All errors of
!> a file are reported.
module dd3_contact_reader
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t, error_list_t, location_t
  use dd3_base_text, only : text_t, newline, to_text, same_name
  use dd3_input_block, only : token_t
  use dd3_input_number, only : parse_real, parse_integer
  use dd3_input_text_file, only : read_lines
  use dd3_input_token, only : line_t, token_list_t, place, split_line
  use dd3_contact_bezier, only : patch_t, new_patch, normal_at, largest_degree
  use dd3_contact_surface, only : surface_t, new_surface
  implicit none
  private
  public :: read_surface

  !> Errors shown of one file.
  integer, parameter :: most_errors = 25
  !> Largest coordinate, mm, and largest ratio of two weights.
  real(wp), parameter :: largest_coordinate = 1.0e7_wp, largest_weight = 1.0e6_wp
  !> What a patch begins with.
  character(len=*), parameter :: header = &
    "patch m n, or patch m n rational: a patch of degrees m and n"

  !> A file being read.
  type :: reading_t
    !> Its name, and the place in the input that names it.
    character(len=:), allocatable :: file
    type(location_t) :: location
    !> The patches that are whole.
    type(patch_t), allocatable :: patch(:)
    !> Their number, and that of all patches begun.
    integer :: n_patch = 0, n_begun = 0
    !> Whether a patch is open; points outside one are skipped after a broken header.
    logical :: open = .false., skipping = .false.
    !> Degrees of the open patch, its points, and how many of them were read.
    integer :: degree(2) = 1, n_point = 0, n_read = 0
    !> Whether its points have weights, whether all its points are sound.
    logical :: rational = .false., sound = .true.
    !> Points and weights of the open patch, `(4, n_point)`.
    real(wp), allocatable :: point(:, :)
    !> Place of the open patch's header.
    type(location_t) :: begun
    !> Errors of this file.
    type(error_list_t) :: errors
  end type reading_t

contains

  !> Reads a surface; it may be used if no error was added.
  subroutine read_surface(surface, file, location, errors)
    !> The surface read.
    type(surface_t), intent(out) :: surface
    !> The file's path.
    character(len=*), intent(in) :: file
    !> Where the input names the file.
    type(location_t), intent(in) :: location
    !> Receives all errors of the file.
    type(error_list_t), intent(inout) :: errors

    type(reading_t) :: reading
    type(text_t), allocatable :: line(:)
    type(error_t), allocatable :: error
    integer :: i

    call read_lines(file, line, error)
    if (allocated(error)) then
      call errors%push_input(location, "the tool surface '"//file//"' cannot be read: "// &
          error%message, "a file of Bézier patches")
      return
    end if
    reading%file = file
    reading%location = location
    allocate (reading%patch(4))
    do i = 1, size(line)
      call read_line(reading, i, line(i)%s)
      if (reading%errors%count > most_errors) exit
    end do
    if (reading%errors%count <= most_errors) call close_patch(reading)
    if (reading%n_begun == 0 .and. reading%errors%count == 0) then
      call errors%push_input(location, "the tool surface '"//file//"' holds no patch", header)
      return
    end if
    if (reading%errors%count == 0) then
      call new_surface(surface, reading%patch(:reading%n_patch))
      call check_orientation(surface, reading)
    end if
    call hand_over(reading, errors)
  end subroutine read_surface

  !> Adds the errors of the file to those of the whole input, at the place where the input names
  !> the file.
  subroutine hand_over(reading, errors)
    !> The file.
    type(reading_t), intent(in) :: reading
    !> The errors of the whole input.
    type(error_list_t), intent(inout) :: errors

    type(error_t), allocatable :: error
    integer :: i

    do i = 1, min(reading%errors%count, most_errors)
      allocate (error, source=reading%errors%item(i))
      error%order = reading%location%order
      error%column = reading%location%column
      if (i == most_errors .and. reading%errors%count > i) then
        error%message = error%message//newline//"  further errors of this file are not shown"
      end if
      call errors%push(error)
      deallocate (error)
    end do
  end subroutine hand_over

  !> Takes one line.
  subroutine read_line(reading, number, text)
    !> The file.
    type(reading_t), intent(inout) :: reading
    !> Number of the line.
    integer, intent(in) :: number
    !> The line.
    character(len=*), intent(in) :: text

    type(line_t) :: line
    type(token_list_t) :: token
    type(location_t) :: here
    logical :: continues

    line%file = reading%file
    line%number = number
    line%text = text
    call split_line(line, token, continues, reading%errors)
    if (continues) then
      call report(reading, place(line, index(text, "&"), 1), &
          "a line of a tool surface does not go on in the next one")
    end if
    if (token%count == 0) return
    here = place(line, 1, len_trim(text))
    if (same_name(token%item(1)%text, "patch")) then
      call close_patch(reading)
      call open_patch(reading, token, here)
    else if (reading%open) then
      call read_point(reading, token, here)
    else if (.not. reading%skipping) then
      reading%skipping = .true.
      call report(reading, token%item(1)%at, "'"//token%item(1)%text//"' stands outside a patch", &
          header)
    end if
  end subroutine read_line

  !> Takes the line that begins a patch.
  subroutine open_patch(reading, token, here)
    !> The file.
    type(reading_t), intent(inout) :: reading
    !> The words of the line.
    type(token_list_t), intent(in) :: token
    !> Its place.
    type(location_t), intent(in) :: here

    logical :: ok
    integer :: i

    reading%n_begun = reading%n_begun + 1
    reading%skipping = .true.
    if (token%count < 3) then
      call report(reading, here, "the degrees of the patch are missing", header)
      return
    end if
    do i = 1, 2
      call parse_integer(token%item(i + 1)%text, reading%degree(i), ok)
      if (ok) ok = reading%degree(i) >= 1 .and. reading%degree(i) <= largest_degree
      if (ok) cycle
      call report(reading, token%item(i + 1)%at, "'"//token%item(i + 1)%text// &
          "' is no degree of a patch", "a whole number from 1 to "//to_text(largest_degree))
      return
    end do
    reading%rational = token%count > 3
    if (reading%rational) then
      i = merge(5, 4, same_name(token%item(4)%text, "rational"))
      if (i <= token%count) then
        call report(reading, token%item(i)%at, "'"//token%item(i)%text// &
            "' is not understood here", header)
        return
      end if
    end if
    reading%open = .true.
    reading%skipping = .false.
    reading%sound = .true.
    reading%n_read = 0
    reading%n_point = product(reading%degree + 1)
    if (allocated(reading%point)) deallocate (reading%point)
    allocate (reading%point(4, reading%n_point), source=1.0_wp)
    reading%begun = here
  end subroutine open_patch

  !> Takes the line of a point.
  subroutine read_point(reading, token, here)
    !> The file.
    type(reading_t), intent(inout) :: reading
    !> The words of the line.
    type(token_list_t), intent(in) :: token
    !> Its place.
    type(location_t), intent(in) :: here

    character(len=:), allocatable :: expected
    integer :: i, n
    logical :: ok

    reading%n_read = reading%n_read + 1
    if (reading%n_read > reading%n_point) then
      reading%sound = .false.
      if (reading%n_read == reading%n_point + 1) then
        call report(reading, here, "patch "//to_text(reading%n_begun)//" of degrees "// &
            degrees(reading)//" has more points than "//to_text(reading%n_point), &
            "the next patch, or the end of the file")
      end if
      return
    end if
    n = merge(4, 3, reading%rational)
    expected = trim(merge("x y z w, the weight last", "x y z                   ", reading%rational))
    if (token%count /= n) then
      reading%sound = .false.
      i = min(n + 1, token%count)
      call report(reading, merge_place(token%item(i)%at, here, token%count > n), &
          "a point of this patch has "//to_text(n)//" numbers, here are "//to_text(token%count), &
          expected)
      return
    end if
    do i = 1, n
      call parse_real(token%item(i)%text, reading%point(i, reading%n_read), ok)
      if (.not. ok) then
        call refuse(reading, token%item(i), "is not a number", "a coordinate in mm, as in " &
                      //expected)
      else if (i < 4 .and. abs(reading%point(i, reading%n_read)) > largest_coordinate) then
        call refuse(reading, token%item(i), "is out of range", "at most 1e7 mm")
      else if (i == 4 .and. (reading%point(i, reading%n_read) < 1.0_wp/largest_weight .or. &
                             reading%point(i, reading%n_read) > largest_weight)) then
        call refuse(reading, token%item(i), "is no weight", "a positive number, from 1e-6 to 1e6")
      end if
    end do
  end subroutine read_point

  !> Notes an error of the file.
  subroutine report(reading, at, message, expected)
    !> The file.
    type(reading_t), intent(inout) :: reading
    !> The place.
    type(location_t), intent(in) :: at
    !> What is wrong.
    character(len=*), intent(in) :: message
    !> What was expected there.
    character(len=*), intent(in), optional :: expected

    call reading%errors%push_input(at, message, expected)
  end subroutine report

  !> Reports one word of a point.
  subroutine refuse(reading, token, message, expected)
    !> The file.
    type(reading_t), intent(inout) :: reading
    !> The word.
    type(token_t), intent(in) :: token
    !> What is wrong with it.
    character(len=*), intent(in) :: message
    !> What was expected.
    character(len=*), intent(in) :: expected

    reading%sound = .false.
    call report(reading, token%at, "'"//token%text//"' "//message, expected)
  end subroutine refuse

  !> One of two places.
  pure function merge_place(a, b, first) result(chosen)
    !> The places.
    type(location_t), intent(in) :: a, b
    !> Whether the first is meant.
    logical, intent(in) :: first
    type(location_t) :: chosen

    chosen = b
    if (first) chosen = a
  end function merge_place

  !> The degrees of the open patch in words.
  pure function degrees(reading) result(text)
    !> The file.
    type(reading_t), intent(in) :: reading
    character(len=:), allocatable :: text

    text = to_text(reading%degree(1))//" and "//to_text(reading%degree(2))
  end function degrees

  !> Ends the open patch: checks it and keeps it.
  subroutine close_patch(reading)
    !> The file.
    type(reading_t), intent(inout) :: reading

    type(patch_t), allocatable :: larger(:)
    type(patch_t) :: patch
    integer :: shape_of(2)

    if (.not. reading%open) return
    reading%open = .false.
    if (reading%n_read < reading%n_point) then
      call report(reading, reading%begun, "patch "//to_text(reading%n_begun)//" ends after "// &
          to_text(reading%n_read)//" of its points", to_text(reading%n_point)// &
          " points for the degrees "//degrees(reading))
      return
    end if
    if (.not. reading%sound) return
    shape_of = reading%degree + 1
    associate (point => reading%point)
      if (reading%rational) then
        call new_patch(patch, reshape(point(1:3, :), [3, shape_of]), &
                       reshape(point(4, :), shape_of), &
                       line=reading%begun%line)
      else
        call new_patch(patch, reshape(point(1:3, :), [3, shape_of]), line=reading%begun%line)
      end if
    end associate
    if (is_degenerate(patch)) then
      call report(reading, reading%begun, "patch "//to_text(reading%n_begun)//" has no area", &
          "control points that span a surface")
      return
    end if
    if (reading%n_patch == size(reading%patch)) then
      allocate (larger(2*reading%n_patch))
      larger(:reading%n_patch) = reading%patch
      call move_alloc(larger, reading%patch)
    end if
    reading%n_patch = reading%n_patch + 1
    reading%patch(reading%n_patch) = patch
  end subroutine close_patch

  !> Whether a patch has no normal at one of nine inner points.
  pure logical function is_degenerate(patch)
    !> The patch.
    type(patch_t), intent(in) :: patch

    real(wp) :: normal(3)
    integer :: i, j
    logical :: regular

    is_degenerate = .true.
    if (patch%size <= 0.0_wp) return
    do j = 1, 3
      do i = 1, 3
        call normal_at(patch, 0.25_wp*real(i, wp), 0.25_wp*real(j, wp), normal, regular)
        if (.not. regular) return
      end do
    end do
    is_degenerate = .false.
  end function is_degenerate

  !> Refuses neighbours of which one is turned inside out.
  subroutine check_orientation(surface, reading)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The file.
    type(reading_t), intent(inout) :: reading

    type(location_t) :: here
    integer :: k, e, next

    here%file = reading%file
    do k = 1, size(surface%patch)
      do e = 1, 4
        next = surface%edge(e, k)%patch
        if (next >= k .or. .not. surface%edge(e, k)%opposite) cycle
        here%line = surface%patch(k)%line
        call report(reading, here, "the normals of patches "//to_text(next)//" and "//to_text(k)// &
            " point to opposite sides of their common edge", &
            "S_u x S_v pointing out of the tool on both")
      end do
    end do
  end subroutine check_orientation

end module dd3_contact_reader
