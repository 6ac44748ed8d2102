! SPDX-License-Identifier: GPL-3.0-or-later
!> Text utilities.
module dd3_base_text
  use dd3_base_kinds, only : wp, i8
  implicit none
  private
  public :: text_t, text_buffer_t, newline, to_text, lower_case, upper_case, same_name, &
      nearest_name, suggestion, join, slice, axis_name

  character(len=1), parameter :: newline = achar(10)

  !> Names of the axes and of components along them.
  character(len=1), parameter :: axis_name(3) = ["x", "y", "z"]

  !> A string of any length, for lists of strings.
  type :: text_t
    character(len=:), allocatable :: s
  end type text_t

  !> Text that grows at its end.
  type :: text_buffer_t
    integer(i8), private :: length = 0
    character(len=:), allocatable, private :: room
  contains
    procedure :: add => buffer_add
    procedure :: text => buffer_text
  end type text_buffer_t

  !> Return a number or a logical as text without redundant characters.
  interface to_text
    module procedure :: integer_to_text, long_to_text, real_to_text, logical_to_text
  end interface to_text

contains

  pure function integer_to_text(value) result(text)
    integer, intent(in) :: value
    character(len=:), allocatable :: text

    character(len=24) :: buffer

    write (buffer, '(i0)') value
    text = trim(buffer)
  end function integer_to_text

  pure function long_to_text(value) result(text)
    integer(i8), intent(in) :: value
    character(len=:), allocatable :: text

    character(len=24) :: buffer

    write (buffer, '(i0)') value
    text = trim(buffer)
  end function long_to_text

  !> Return a real number as text.
  pure function real_to_text(value, digits) result(text)
    real(wp), intent(in) :: value
    !> Number of significant digits, 6 if not given.
    integer, intent(in), optional :: digits
    character(len=:), allocatable :: text

    character(len=40) :: buffer, form
    integer :: n, mark, e

    n = 6
    if (present(digits)) n = digits
    write (form, '(a,i0,a,i0,a)') "(g", n + 10, ".", n, ")"
    write (buffer, form) value
    if (scan(trim(adjustl(buffer)), "E+-", back=.true.) > 1) then
      write (form, '(a,i0,a,i0,a)') "(es", n + 10, ".", max(1, n - 1), "e3)"
      write (buffer, form) value
    end if
    text = trim(adjustl(buffer))
    mark = index(text, "E")
    if (mark > 0) then
      if (text(mark + 2:mark + 2) == "0") text = text(:mark + 1)//text(mark + 3:)
    end if
    if (index(text, ".") == 0) return
    e = len(text)
    if (mark > 0) e = mark - 1
    do while (text(e:e) == "0")
      text = text(:e - 1)//text(e + 1:)
      e = e - 1
    end do
    if (text(e:e) == ".") text = text(:e - 1)//text(e + 1:)
  end function real_to_text

  !> Return `on` or `off`.
  pure function logical_to_text(value) result(text)
    logical, intent(in) :: value
    character(len=:), allocatable :: text

    text = trim(merge("on ", "off", value))
  end function logical_to_text

  !> Return the text in lower case (ASCII letters).
  pure function lower_case(text) result(lower)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: lower

    integer :: i, c

    lower = text
    do i = 1, len(text)
      c = iachar(text(i:i))
      if (c >= iachar("A") .and. c <= iachar("Z")) lower(i:i) = achar(c + 32)
    end do
  end function lower_case

  !> Return the text in upper case (ASCII letters).
  pure function upper_case(text) result(upper)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: upper

    integer :: i, c

    upper = text
    do i = 1, len(text)
      c = iachar(text(i:i))
      if (c >= iachar("a") .and. c <= iachar("z")) upper(i:i) = achar(c - 32)
    end do
  end function upper_case

  !> Whether two names are equal regardless of case and trailing blanks.
  pure logical function same_name(a, b)
    character(len=*), intent(in) :: a, b

    integer :: i, n

    n = len_trim(a)
    same_name = len_trim(b) == n
    do i = 1, n
      if (.not. same_name) return
      same_name = lower_letter(a(i:i)) == lower_letter(b(i:i))
    end do
  end function same_name

  !> Return a letter in lower case (ASCII); any other character as it is.
  pure character function lower_letter(letter)
    character, intent(in) :: letter

    lower_letter = letter
    if (letter >= "A" .and. letter <= "Z") lower_letter = achar(iachar(letter) + 32)
  end function lower_letter

  !> Return the known name closest to a misspelt one; empty if none is close. Among equally close
  !> names, one that differs in the last character only is preferred, as C6 for C7.
  pure function nearest_name(name, known) result(nearest)
    character(len=*), intent(in) :: name
    character(len=*), intent(in) :: known(:)
    character(len=:), allocatable :: nearest

    integer :: i, most, distance, step, best(2)

    nearest = ""
    most = min(max(1, (len_trim(name) + 1)/3), len_trim(name) - 1)
    best = huge(1)
    do i = 1, size(known)
      if (abs(len_trim(known(i)) - len_trim(name)) > most) cycle
      distance = edit_distance(lower_case(trim(name)), lower_case(trim(known(i))))
      if (distance > most .or. distance > best(1)) cycle
      step = last_step(lower_case(trim(name)), lower_case(trim(known(i))))
      if (distance == best(1) .and. step >= best(2)) cycle
      best = [distance, step]
      nearest = trim(known(i))
    end do
  end function nearest_name

  !> Return the closest known name as the end of a message; empty if none is close.
  pure function suggestion(name, known) result(text)
    character(len=*), intent(in) :: name
    character(len=*), intent(in) :: known(:)
    character(len=:), allocatable :: text

    text = nearest_name(name, known)
    if (text /= "") text = "; did you mean '"//text//"'?"
  end function suggestion

  !> Return the distance in the alphabet of the last characters of two words that differ in nothing
  !> else; a large number for other words.
  pure integer function last_step(a, b)
    character(len=*), intent(in) :: a, b

    last_step = huge(1)
    if (len(a) /= len(b)) return
    if (a(:len(a) - 1) /= b(:len(b) - 1)) return
    last_step = abs(iachar(a(len(a):)) - iachar(b(len(b):)))
  end function last_step

  !> Return the number of insertions, deletions, replacements and transpositions between two words
  !> (optimal string alignment; Damerau 1964).
  pure integer function edit_distance(a, b)
    character(len=*), intent(in) :: a, b

    integer :: cost(0:len(b), 0:2), i, j

    cost = 0
    cost(:, 2) = [(j, j=0, len(b))]
    do i = 1, len(a)
      cost(:, :1) = cost(:, 1:)
      cost(0, 2) = i
      do j = 1, len(b)
        cost(j, 2) = min(cost(j, 1) + 1, cost(j - 1, 2) + 1, &
            cost(j - 1, 1) + merge(0, 1, a(i:i) == b(j:j)))
        if (i == 1 .or. j == 1) cycle
        if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) then
          cost(j, 2) = min(cost(j, 2), cost(j - 2, 0) + 1)
        end if
      end do
    end do
    edit_distance = cost(len(b), 2)
  end function edit_distance

  !> Append a text.
  subroutine buffer_add(self, text)
    class(text_buffer_t), intent(inout) :: self
    character(len=*), intent(in) :: text

    character(len=:), allocatable :: larger
    integer(i8) :: n

    if (.not. allocated(self%room)) allocate (character(len=1000) :: self%room)
    n = self%length + len(text, i8)
    if (n > len(self%room, i8)) then
      allocate (character(len=2*n) :: larger)
      larger(:self%length) = self%room(:self%length)
      call move_alloc(larger, self%room)
    end if
    self%room(self%length + 1:n) = text
    self%length = n
  end subroutine buffer_add

  !> Return the whole text.
  pure function buffer_text(self) result(text)
    class(text_buffer_t), intent(in) :: self
    character(len=:), allocatable :: text

    text = ""
    if (allocated(self%room)) text = self%room(:self%length)
  end function buffer_text

  !> Return part of a text.
  pure function slice(text, first, last)
    character(len=*), intent(in) :: text
    integer, intent(in) :: first, last
    character(len=:), allocatable :: slice

    slice = text(first:last)
  end function slice

  !> Return the words joined by a separator, without trailing blanks.
  pure function join(words, separator) result(text)
    character(len=*), intent(in) :: words(:)
    character(len=*), intent(in) :: separator
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    do i = 1, size(words)
      if (i > 1) text = text//separator
      text = text//trim(words(i))
    end do
  end function join

end module dd3_base_text
