! SPDX-License-Identifier: GPL-3.0-or-later
!> Set-up errors as values: passed to the caller, collected in a list, and reported together.
module dd3_base_error
  use dd3_base_kinds, only : i8, wp
  use dd3_base_ranks, only : broadcast_integers, broadcast_text, n_ranks, rank_of_smallest, &
      this_rank
  use dd3_base_text, only : newline, same_name, slice
  implicit none
  private
  public :: most_kept, location_t, error_t, error_list_t, fatal_error, input_error, as_written, &
      keep_first, share_error

  !> Location of a piece of input.
  type :: location_t
    !> Name of the file as given by the user.
    character(len=:), allocatable :: file
    !> Line number, from 1; 0 for the command line and the whole file.
    integer :: line = 0
    !> Column of the first character, from 1; 0 if unknown.
    integer :: column = 0
    !> Number of characters.
    integer :: width = 1
    !> Text of the line, or the part of it around the column.
    character(len=:), allocatable :: text
    !> Position of the line in the whole text with included files inserted; errors are reported in
    !> this order.
    integer :: order = huge(0)
  end type location_t

  !> An error, ready to be shown.
  type :: error_t
    !> May contain several lines.
    character(len=:), allocatable :: message
    !> Code of the message, see docs/messages.md; blank if it has none.
    character(len=4) :: code = ""
    !> Message on the input without place and severity, and its place; otherwise not allocated.
    character(len=:), allocatable :: text
    type(location_t) :: at
    !> Position in the whole input: line (see `location_t`) and column.
    integer :: order = huge(0), column = 0
  end type error_t

  !> Number of errors of a list that are kept; further ones are only counted.
  integer, parameter :: most_kept = 1000

  !> A list of errors.
  type :: error_list_t
    integer :: count = 0
    !> Errors in the order found, `item(1:min(count, most_kept))`.
    type(error_t), allocatable :: item(:)
  contains
    procedure :: push => error_list_push
    procedure :: push_input => error_list_push_input
    procedure :: sort => error_list_sort
  end type error_list_t

contains

  !> Create an error with a plain message.
  subroutine fatal_error(error, message, code)
    type(error_t), allocatable, intent(out) :: error
    character(len=*), intent(in) :: message
    character(len=*), intent(in), optional :: code

    allocate (error)
    error%message = message
    if (present(code)) error%code = code
  end subroutine fatal_error

  !> Give all ranks the error of the lowest rank that has one.
  subroutine share_error(error)
    type(error_t), allocatable, intent(inout) :: error

    character(len=:), allocatable :: text
    character(len=4) :: code
    integer :: length(1), rank

    if (n_ranks() == 1) return
    rank = rank_of_smallest(merge(0.0_wp, 1.0_wp, allocated(error)), 0)
    length = -1
    if (allocated(error)) length = len(error%message)
    call broadcast_integers(rank, 1, length)
    if (length(1) < 0) return
    allocate (character(len=length(1)) :: text)
    text(:) = ""
    code = ""
    if (this_rank() == rank) then
      text = error%message
      code = error%code
    end if
    call broadcast_text(rank, text)
    call broadcast_text(rank, code)
    call fatal_error(error, text, code)
  end subroutine share_error

  !> Return a name with the upper and lower case of the input; unchanged if the input has another
  !> text at this location.
  pure function as_written(name, at) result(text)
    character(len=*), intent(in) :: name
    type(location_t), intent(in) :: at
    character(len=:), allocatable :: text

    integer :: first, last

    text = name
    if (.not. allocated(at%text) .or. at%column < 1) return
    first = at%column
    last = min(len(at%text), first + at%width - 1)
    if (first > last) return
    if (scan(at%text(first:first), "'""") > 0) then
      first = first + 1
      last = last - 1
    end if
    if (same_name(slice(at%text, first, last), name)) text = slice(at%text, first, last)
  end function as_written

  !> Create an error that shows a location in the input: file, line, text, caret, expectation.
  subroutine input_error(error, location, message, expected, code)
    type(error_t), allocatable, intent(out) :: error
    type(location_t), intent(in) :: location
    character(len=*), intent(in) :: message
    !> What was expected at the location.
    character(len=*), intent(in), optional :: expected
    !> Kind of the error, see docs/messages.md.
    character(len=*), intent(in), optional :: code

    character(len=12) :: number
    integer(i8) :: width

    allocate (error)
    width = int(max(1, location%width), i8)
    error%order = location%order
    error%column = location%column
    error%at = location
    error%text = shortened(message)
    if (present(expected)) error%text = error%text//"; expected: "//shortened(expected)
    if (present(code)) error%code = code
    error%message = trim("error "//error%code)//": "//shortened(message)
    if (allocated(location%file)) then
      write (number, '(i0)') location%line
      if (location%line > 0) then
        error%message = location%file//":"//trim(number)//": "//error%message
      else
        error%message = location%file//": "//error%message
      end if
    end if
    if (allocated(location%text) .and. location%line > 0) then
      error%message = error%message//newline//"  "//location%text
      if (location%column > 0) then
        error%message = error%message//newline//"  "//caret_indent(location) &
            //repeat("^", width)
      end if
    end if
    if (present(expected)) error%message = error%message//newline//"  expected: "// &
        shortened(expected)
  end subroutine input_error

  !> Return a text without its middle if it is very long, as one that quotes a very long word.
  pure function shortened(text)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: shortened

    integer, parameter :: longest = 4000, ends = 1000

    shortened = text
    if (len(text) > longest) shortened = text(:ends)//" ... "//text(len(text) - ends + 1:)
  end function shortened

  !> Return the blanks before the caret. Tabs are kept; a UTF-8 character has a width of one.
  pure function caret_indent(location) result(indent)
    type(location_t), intent(in) :: location
    character(len=:), allocatable :: indent

    integer :: i, byte

    indent = ""
    do i = 1, min(location%column - 1, len(location%text))
      byte = ichar(location%text(i:i))
      if (byte == 9) then
        indent = indent//achar(9)
      else if (byte < 128 .or. byte > 191) then
        indent = indent//" "
      end if
    end do
  end function caret_indent

  !> Append an error if there is one; beyond `most_kept` errors it is only counted.
  subroutine error_list_push(self, error)
    class(error_list_t), intent(inout) :: self
    type(error_t), allocatable, intent(in) :: error

    type(error_t), allocatable :: larger(:)

    if (.not. allocated(error)) return
    self%count = self%count + 1
    if (self%count > most_kept) return
    if (.not. allocated(self%item)) allocate (self%item(8))
    if (self%count > size(self%item)) then
      allocate (larger(2*size(self%item)))
      larger(:size(self%item)) = self%item
      call move_alloc(larger, self%item)
    end if
    self%item(self%count) = error
  end subroutine error_list_push

  !> Append an input error.
  subroutine error_list_push_input(self, location, message, expected, code)
    class(error_list_t), intent(inout) :: self
    type(location_t), intent(in) :: location
    character(len=*), intent(in) :: message
    !> What was expected at the location.
    character(len=*), intent(in), optional :: expected
    !> Kind of the error, see docs/messages.md.
    character(len=*), intent(in), optional :: code

    type(error_t), allocatable :: error

    if (self%count >= most_kept) then
      self%count = self%count + 1
    else
      call input_error(error, location, message, expected, code)
      call self%push(error)
    end if
  end subroutine error_list_push_input

  !> Sort the errors kept by their position in the input; those without one come last, in the order
  !> found.
  subroutine error_list_sort(self)
    class(error_list_t), intent(inout) :: self

    type(error_t) :: moved
    integer :: i, j

    do i = 2, min(self%count, most_kept)
      moved = self%item(i)
      j = i - 1
      do while (j >= 1)
        if (.not. is_before(moved, self%item(j))) exit
        self%item(j + 1) = self%item(j)
        j = j - 1
      end do
      self%item(j + 1) = moved
    end do
  end subroutine error_list_sort

  !> Whether error a is located before error b.
  pure logical function is_before(a, b)
    type(error_t), intent(in) :: a, b

    is_before = a%order < b%order .or. (a%order == b%order .and. a%column < b%column)
  end function is_before

  !> Keep the first of two errors.
  subroutine keep_first(error, late)
    type(error_t), allocatable, intent(inout) :: error
    !> Later error; it is moved.
    type(error_t), allocatable, intent(inout) :: late

    if (.not. allocated(error)) call move_alloc(late, error)
  end subroutine keep_first

end module dd3_base_error
