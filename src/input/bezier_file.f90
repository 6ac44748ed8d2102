! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of `.bez` files: the Bézier patches of a tool surface as plain data.
!>
!> Each patch begins with a line `patch m n` giving the degrees along u and v, followed by
!> `rational` if every point has a weight; then (m+1)(n+1) lines `x y z` or `x y z w`, u fastest.
!> All errors of a file are reported.
module dd3_input_bezier_file
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t, error_list_t, location_t
  use dd3_base_text, only : newline, to_text, same_name
  use dd3_input_block, only : token_t
  use dd3_input_decimal, only : is_blank, scan_real
  use dd3_input_number, only : parse_real, parse_integer
  use dd3_input_number_check, only : not_a_number
  use dd3_input_text_file, only : next_line, read_text
  use dd3_input_token, only : line_t, token_list_t, place, split_line
  implicit none
  private
  public :: patch_spec_t, read_patches, push_file_errors

  !> Number of errors shown for one file.
  integer, parameter :: most_errors = 25
  !> Largest coordinate, mm; the weights lie between 1/largest_weight and largest_weight.
  real(wp), parameter :: largest_coordinate = 1.0e7_wp, largest_weight = 1.0e6_wp
  !> Expected first line of a patch.
  character(len=*), parameter :: header = "patch m n, or patch m n rational, with the degrees m n"

  !> A patch as written in the file.
  type :: patch_spec_t
    !> Degrees along u and v.
    integer :: degree(2) = 1
    !> Whether the points have weights.
    logical :: rational = .false.
    !> Control points (mm) and their weights, `(4, n)`, u fastest; the weights are 1 if not given.
    real(wp), allocatable :: point(:, :)
    !> Position among the patches of the file, from 1.
    integer :: number = 0
    !> Header line.
    type(location_t) :: at
  end type patch_spec_t

  !> State of the reader.
  type :: reading_t
    character(len=:), allocatable :: file
    !> Largest degree accepted.
    integer :: largest_degree = 0
    !> Valid patches, `patch(1:n_patch)`.
    type(patch_spec_t), allocatable :: patch(:)
    integer :: n_patch = 0
    !> Number of headers read.
    integer :: n_begun = 0
    !> Whether the next points belong to the patch `current`.
    logical :: open = .false.
    !> Whether points outside a patch are ignored, as after an invalid header.
    logical :: skipping = .false.
    type(patch_spec_t) :: current
    !> Number of points read of the current patch.
    integer :: n_read = 0
    !> Whether all of them are valid.
    logical :: valid = .true.
    type(error_list_t) :: errors
  end type reading_t

contains

  !> Read all patches of a file. Invalid patches are left out and reported.
  subroutine read_patches(patches, file, largest_degree, location, errors)
    type(patch_spec_t), allocatable, intent(out) :: patches(:)
    character(len=*), intent(in) :: file
    !> Largest degree accepted.
    integer, intent(in) :: largest_degree
    !> Where the input names the file.
    type(location_t), intent(in) :: location
    type(error_list_t), intent(inout) :: errors

    type(reading_t) :: self
    character(len=:), allocatable :: text
    type(error_t), allocatable :: error
    integer :: number, next, first, last

    call read_text(file, text, error)
    if (allocated(error)) then
      allocate (patches(0))
      call errors%push_input(location, "cannot read the tool surface '"//file//"': "// &
          error%message, "a file of Bézier patches", code="E101")
      return
    end if
    self%file = file
    self%largest_degree = largest_degree
    allocate (self%patch(4))
    number = 0
    next = 1
    do while (next <= len(text) .and. self%errors%count <= most_errors)
      call next_line(text, next, first, last)
      number = number + 1
      call read_line(self, number, text(first:last))
    end do
    if (self%errors%count <= most_errors) call close_patch(self)
    if (self%n_begun == 0 .and. self%errors%count == 0) then
      allocate (patches(0))
      call errors%push_input(location, "the tool surface '"//file//"' contains no patch", header, &
          code="E102")
      return
    end if
    call push_file_errors(errors, self%errors, location)
    call resize(self, self%n_patch)
    call move_alloc(self%patch, patches)
  end subroutine read_patches

  !> Add the errors of a file to those of the input, sorted at the place that names the file. At
  !> most `most_errors` are added.
  subroutine push_file_errors(errors, found, location)
    type(error_list_t), intent(inout) :: errors
    !> Errors of the file.
    type(error_list_t), intent(in) :: found
    !> Where the input names the file.
    type(location_t), intent(in) :: location

    type(error_t), allocatable :: error
    integer :: i

    do i = 1, min(found%count, most_errors)
      allocate (error, source=found%item(i))
      error%order = location%order
      error%column = location%column
      if (i == most_errors .and. found%count > i) then
        error%message = error%message//newline//"  further errors of this file are not shown"
      end if
      call errors%push(error)
      deallocate (error)
    end do
  end subroutine push_file_errors

  !> Read one line.
  subroutine read_line(self, number, text)
    type(reading_t), intent(inout) :: self
    !> Line number, from 1.
    integer, intent(in) :: number
    character(len=*), intent(in) :: text

    type(line_t) :: line
    type(token_list_t) :: token
    type(location_t) :: here
    logical :: continues, ok

    if (self%open) then
      call read_plain_point(self, text, ok)
      if (ok) return
    end if
    line%file = self%file
    line%number = number
    line%text = text
    call split_line(line, token, continues, self%errors)
    if (continues) then
      call self%errors%push_input(place(line, index(text, "&"), 1), &
          "continuation lines are not allowed in a tool surface", code="E103")
    end if
    if (token%count == 0) return
    here = place(line, 1, len_trim(text))
    if (same_name(token%item(1)%text, "patch")) then
      call close_patch(self)
      call open_patch(self, token, here)
    else if (self%open) then
      call read_point(self, token, here)
    else if (.not. self%skipping) then
      self%skipping = .true.
      call self%errors%push_input(token%item(1)%at, "'"//token%item(1)%text// &
          "' is outside a patch", header, code="E103")
    end if
  end subroutine read_line

  !> Read a control point from a line with nothing but its valid numbers; other lines are left to
  !> the reader of words, which is slower and reports errors.
  subroutine read_plain_point(self, text, ok)
    type(reading_t), intent(inout) :: self
    character(len=*), intent(in) :: text
    !> Whether the point was read.
    logical, intent(out) :: ok

    real(wp) :: value(4)
    integer :: i, n, next

    ok = .false.
    if (self%n_read >= size(self%current%point, 2)) return
    n = merge(4, 3, self%current%rational)
    next = 1
    do i = 1, n
      call scan_real(text, next, value(i), ok)
      if (.not. ok) return
      ok = in_range(value(i), i)
      if (.not. ok) return
    end do
    do next = next, len(text)
      ok = is_blank(text(next:next))
      if (.not. ok) return
    end do
    self%n_read = self%n_read + 1
    self%current%point(:n, self%n_read) = value(:n)
  end subroutine read_plain_point

  !> Whether a component of a point is in its range.
  pure logical function in_range(value, i)
    real(wp), intent(in) :: value
    !> Component of the point: 1 to 3 for a coordinate, 4 for the weight.
    integer, intent(in) :: i

    in_range = abs(value) <= largest_coordinate
    if (i == 4) in_range = value >= 1.0_wp/largest_weight .and. value <= largest_weight
  end function in_range

  !> Read the header of a patch.
  subroutine open_patch(self, token, here)
    type(reading_t), intent(inout) :: self
    !> Words of the line.
    type(token_list_t), intent(in) :: token
    type(location_t), intent(in) :: here

    logical :: ok
    integer :: i

    self%n_begun = self%n_begun + 1
    self%skipping = .true.
    if (token%count < 3) then
      call self%errors%push_input(here, "the degrees of the patch are missing", header, code="E121")
      return
    end if
    self%current = patch_spec_t(number=self%n_begun, rational=token%count > 3)
    do i = 1, 2
      call parse_integer(token%item(i + 1)%text, self%current%degree(i), ok)
      if (ok) ok = self%current%degree(i) >= 1 .and. self%current%degree(i) <= self%largest_degree
      if (ok) cycle
      call self%errors%push_input(token%item(i + 1)%at, "'"//token%item(i + 1)%text// &
          "' is not a valid degree", "an integer from 1 to "//to_text(self%largest_degree), &
          code="E131")
      return
    end do
    if (self%current%rational) then
      i = merge(5, 4, same_name(token%item(4)%text, "rational"))
      if (i <= token%count) then
        call self%errors%push_input(token%item(i)%at, "unexpected '"//token%item(i)%text//"'", &
            header, code="E103")
        return
      end if
    end if
    self%current%at = here
    allocate (self%current%point(4, product(self%current%degree + 1)), source=1.0_wp)
    self%open = .true.
    self%skipping = .false.
    self%valid = .true.
    self%n_read = 0
  end subroutine open_patch

  !> Read a control point.
  subroutine read_point(self, token, here)
    type(reading_t), intent(inout) :: self
    !> Words of the line.
    type(token_list_t), intent(in) :: token
    type(location_t), intent(in) :: here

    character(len=:), allocatable :: expected
    integer :: i, n, n_point

    n_point = size(self%current%point, 2)
    self%n_read = self%n_read + 1
    if (self%n_read > n_point) then
      self%valid = .false.
      if (self%n_read == n_point + 1) then
        call self%errors%push_input(here, "patch "//to_text(self%n_begun)//" of degrees "// &
            degrees(self%current)//" has more than "//to_text(n_point)//" points", &
            "the next patch, or the end of the file", code="E132")
      end if
      return
    end if
    n = merge(4, 3, self%current%rational)
    expected = "x y z"
    if (self%current%rational) expected = "x y z w, with the weight w"
    if (token%count == n) then
      do i = 1, n
        call read_component(self, token%item(i), i, expected)
      end do
    else
      self%valid = .false.
      call self%errors%push_input(misfit(token, n, here), "expected "//to_text(n)// &
          " numbers, got "//to_text(token%count), expected, code="E132")
    end if
  end subroutine read_point

  !> Return the place to show for a line that does not hold n words: the first excess word, or the
  !> line.
  pure function misfit(token, n, here) result(at)
    type(token_list_t), intent(in) :: token
    integer, intent(in) :: n
    type(location_t), intent(in) :: here
    type(location_t) :: at

    at = here
    if (token%count > n) at = token%item(n + 1)%at
  end function misfit

  !> Read and check a coordinate or a weight of the current point.
  subroutine read_component(self, token, i, expected)
    type(reading_t), intent(inout) :: self
    type(token_t), intent(in) :: token
    !> Component of the point: 1 to 3 for a coordinate, 4 for the weight.
    integer, intent(in) :: i
    !> Expected form of the line.
    character(len=*), intent(in) :: expected

    logical :: ok

    associate (value => self%current%point(i, self%n_read))
      call parse_real(token%text, value, ok)
      if (.not. ok) then
        call refuse(self, token, not_a_number(token%text), "coordinates in mm: "//expected)
      else if (in_range(value, i)) then
        return
      else if (i < 4) then
        call refuse(self, token, "'"//token%text//"' is out of range", "at most 1e7 mm")
      else
        call refuse(self, token, "'"//token%text//"' is not a valid weight", &
            "a number from 1e-6 to 1e6")
      end if
    end associate
  end subroutine read_component

  !> Report a word of a point.
  subroutine refuse(self, token, message, expected)
    type(reading_t), intent(inout) :: self
    type(token_t), intent(in) :: token
    character(len=*), intent(in) :: message, expected

    self%valid = .false.
    call self%errors%push_input(token%at, message, expected, code="E141")
  end subroutine refuse

  !> Return the degrees of a patch as text.
  pure function degrees(patch) result(text)
    type(patch_spec_t), intent(in) :: patch
    character(len=:), allocatable :: text

    text = to_text(patch%degree(1))//" and "//to_text(patch%degree(2))
  end function degrees

  !> End the current patch; keep it if it is complete and valid.
  subroutine close_patch(self)
    type(reading_t), intent(inout) :: self

    integer :: n_point

    if (.not. self%open) return
    self%open = .false.
    n_point = size(self%current%point, 2)
    if (self%n_read < n_point) then
      call self%errors%push_input(self%current%at, "patch "//to_text(self%n_begun)// &
          ": expected "//to_text(n_point)//" points, got "//to_text(self%n_read), &
          to_text(n_point)//" points for the degrees "//degrees(self%current), code="E132")
      return
    end if
    if (.not. self%valid) return
    if (self%n_patch == size(self%patch)) call resize(self, 2*self%n_patch)
    self%n_patch = self%n_patch + 1
    call move_patch(self%current, self%patch(self%n_patch))
  end subroutine close_patch

  !> Change the room for patches.
  subroutine resize(self, n)
    type(reading_t), intent(inout) :: self
    !> At least the number of patches.
    integer, intent(in) :: n

    type(patch_spec_t), allocatable :: list(:)
    integer :: i

    allocate (list(n))
    do i = 1, self%n_patch
      call move_patch(self%patch(i), list(i))
    end do
    call move_alloc(list, self%patch)
  end subroutine resize

  !> Move a patch without copying its points.
  subroutine move_patch(from, to)
    type(patch_spec_t), intent(inout) :: from
    type(patch_spec_t), intent(out) :: to

    to%degree = from%degree
    to%rational = from%rational
    to%number = from%number
    call move_alloc(from%point, to%point)
    call move_alloc(from%at%file, to%at%file)
    call move_alloc(from%at%text, to%at%text)
    to%at%line = from%at%line
    to%at%column = from%at%column
    to%at%width = from%at%width
    to%at%order = from%at%order
  end subroutine move_patch

end module dd3_input_bezier_file
