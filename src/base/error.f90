!> Errors of the set-up as values: they travel up, gain context on the way and are reported
!> together.
module dd3_base_error
  use dd3_base_kinds, only : i8
  use dd3_base_text, only : newline, same_name, slice
  implicit none
  private
  public :: location_t, error_t, error_list_t, fatal_error, input_error, as_written

  !> Where a piece of input was written.
  type :: location_t
    !> Name of the file, as the user gave it.
    character(len=:), allocatable :: file
    !> Line number, from 1; 0 where there is none (command line, whole file).
    integer :: line = 0
    !> Column of the first character, from 1; 0 where there is none.
    integer :: column = 0
    !> Number of characters it takes.
    integer :: width = 1
    !> The line of text, or the part of it around the column.
    character(len=:), allocatable :: text
    !> Position of the line in the whole text with its included files unfolded; errors are reported
    !> in this order.
    integer :: order = huge(0)
  end type location_t

  !> One error, ready to be shown.
  type :: error_t
    !> What happened, may hold several lines.
    character(len=:), allocatable :: message
    !> Place of its first character in the whole input: position of the line, column.
    integer :: order = huge(0), column = 0
  end type error_t

  !> All errors found so far, in the order they were found.
  type :: error_list_t
    !> Number of errors held.
    integer :: count = 0
    !> The errors: `item(1:count)`.
    type(error_t), allocatable :: item(:)
  contains
    procedure :: push => error_list_push
    procedure :: push_input => error_list_push_input
    procedure :: sort => error_list_sort
  end type error_list_t

contains

  !> Make an error of a plain message.
  subroutine fatal_error(error, message)
    type(error_t), allocatable, intent(out) :: error
    !> What happened.
    character(len=*), intent(in) :: message

    allocate (error)
    error%message = message
  end subroutine fatal_error

  !> A name in the letters, capital or not, that the user wrote it with; as it is where another text
  !> stands at the place.
  pure function as_written(name, at) result(text)
    character(len=*), intent(in) :: name
    !> Where it was written.
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

  !> Make an error that shows the place in the input: file, line, text, caret, what was expected.
  subroutine input_error(error, location, message, expected)
    type(error_t), allocatable, intent(out) :: error
    !> The place it speaks of.
    type(location_t), intent(in) :: location
    character(len=*), intent(in) :: message
    !> What was expected there.
    character(len=*), intent(in), optional :: expected

    character(len=12) :: number
    integer(i8) :: width

    allocate (error)
    width = int(max(1, location%width), i8)
    error%order = location%order
    error%column = location%column
    error%message = "error: "//message
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
    if (present(expected)) error%message = error%message//newline//"  expected: "//expected
  end subroutine input_error

  !> Blanks (tabs kept) up to the caret; the later bytes of a UTF-8 character take no room.
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

  !> Add an error to the list; nothing happens where there is none.
  subroutine error_list_push(self, error)
    class(error_list_t), intent(inout) :: self
    type(error_t), allocatable, intent(in) :: error

    type(error_t), allocatable :: larger(:)

    if (.not. allocated(error)) return
    if (.not. allocated(self%item)) allocate (self%item(8))
    if (self%count == size(self%item)) then
      allocate (larger(2*self%count))
      larger(:self%count) = self%item
      call move_alloc(larger, self%item)
    end if
    self%count = self%count + 1
    self%item(self%count) = error
  end subroutine error_list_push

  !> Make an input error and adds it to the list.
  subroutine error_list_push_input(self, location, message, expected)
    class(error_list_t), intent(inout) :: self
    !> The place it speaks of.
    type(location_t), intent(in) :: location
    character(len=*), intent(in) :: message
    !> What was expected there.
    character(len=*), intent(in), optional :: expected

    type(error_t), allocatable :: error

    call input_error(error, location, message, expected)
    call self%push(error)
  end subroutine error_list_push_input

  !> Brings the errors into the order of the input's lines; those without a place come last, in the
  !> order found.
  subroutine error_list_sort(self)
    class(error_list_t), intent(inout) :: self

    type(error_t) :: moved
    integer :: i, j

    do i = 2, self%count
      moved = self%item(i)
      j = i - 1
      do while (j >= 1)
        if (.not. stands_before(moved, self%item(j))) exit
        self%item(j + 1) = self%item(j)
        j = j - 1
      end do
      self%item(j + 1) = moved
    end do
  end subroutine error_list_sort

  !> Whether the first error's place is before the second's.
  pure logical function stands_before(a, b)
    type(error_t), intent(in) :: a, b

    stands_before = a%order < b%order .or. (a%order == b%order .and. a%column < b%column)
  end function stands_before

end module dd3_base_error
