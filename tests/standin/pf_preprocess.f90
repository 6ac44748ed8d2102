! SPDX-License-Identifier: GPL-3.0-or-later
!> Convert a test file `x.pf` to `x.F90`: `pf_preprocess x.pf x.F90`.
!>
!> Part of the stand-in for pFUnit. It reads line by line, as pFUnit's own preprocessor does, and
!> refuses with file and line what pFUnit would refuse, or accept and fail on later.
program pf_preprocess
  use, intrinsic :: iso_fortran_env, only : error_unit
  implicit none

  !> Longest line of a directive or an assert.
  integer, parameter :: max_columns = 100
  !> Names of the asserts, in small letters.
  character(len=18), parameter :: assert_name(16) = [character(len=18) :: "true", "false", "fail", &
      "isfinite", "isnan", "all", "any", "none", "sameshape", "equal", "notequal", "lessthan", &
      "lessthanorequal", "greaterthan", "greaterthanorequal", "relativelyequal"]
  !> Number of arguments before the keywords.
  integer, parameter :: assert_arguments(16) = [1, 1, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2]
  !> First index for which the generated call is `assertEquality(compare_<name>, ...)` or
  !> `assertOrder(...)`.
  integer, parameter :: first_comparison = 10

  !> What the next line that is not a comment must be.
  integer, parameter :: await_nothing = 0, await_test = 1, await_before = 2, await_after = 3

  character(len=512) :: source, target, line
  character(len=64) :: module_name, before, after, suite
  character(len=64), allocatable :: test(:)
  logical :: uses_funit
  integer :: unit_in, unit_out, number, awaited, status, i

  if (command_argument_count() /= 2) call refuse("usage: pf_preprocess x.pf x.F90")
  call get_command_argument(1, source)
  call get_command_argument(2, target)
  open (newunit=unit_in, file=source, action="read", status="old", iostat=status)
  if (status /= 0) call refuse("cannot be read")
  open (newunit=unit_out, file=target, action="write", status="replace", iostat=status)
  if (status /= 0) call refuse("cannot write "//trim(target))

  module_name = ""
  before = ""
  after = ""
  uses_funit = .false.
  awaited = await_nothing
  number = 0
  allocate (test(0))
  suite = base_name(source)
  write (unit_out, '(a)') "# 1 """//trim(source)//""""
  do
    read (unit_in, '(a)', iostat=status) line
    if (status /= 0) exit
    number = number + 1
    call one_line(line)
  end do
  if (awaited /= await_nothing) call refuse("the file ends where a subroutine was expected")
  if (module_name == "") call refuse("no line `module "//trim(suite)//"`, alone on its line")
  if (.not. uses_funit) call refuse("no line `use funit`")
  if (size(test) == 0) call refuse("no test")
  call write_suite()
  close (unit_out)
  deallocate (test)

contains

  !> Check one line and write its replacement.
  subroutine one_line(line)
    !> As read.
    character(len=*), intent(in) :: line

    character(len=len(line)) :: word

    word = lower(adjustl(line))
    if (word == "" .or. word(1:1) == "!") then
      write (unit_out, '(a)') trim(line)
    else if (awaited /= await_nothing) then
      call subroutine_line(adjustl(line))
      write (unit_out, '(a)') trim(line)
    else if (word(1:7) == "@assert") then
      call assert_line(adjustl(line))
    else if (word(1:1) == "@") then
      call directive_line(word)
      write (unit_out, '(a)') "!"//trim(line)
    else
      call plain_line(word)
      write (unit_out, '(a)') trim(line)
    end if
  end subroutine one_line

  !> Read `@test`, `@before` and `@after`.
  subroutine directive_line(word)
    !> In small letters, without leading blanks.
    character(len=*), intent(in) :: word

    select case (word)
    case ("@test")
      awaited = await_test
    case ("@before")
      if (before /= "") call refuse("a second @before")
      awaited = await_before
    case ("@after")
      if (after /= "") call refuse("a second @after")
      awaited = await_after
    case default
      call refuse("unknown directive, or something else on its line: "//trim(word))
    end select
  end subroutine directive_line

  !> Read the name of the subroutine after a directive.
  subroutine subroutine_line(text)
    !> Without leading blanks.
    character(len=*), intent(in) :: text

    character(len=64) :: name
    character(len=:), allocatable :: rest
    integer :: last

    if (lower(text(1:11)) /= "subroutine ") call refuse("a plain `subroutine` was expected here")
    name = adjustl(text(12:))
    last = verify(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") - 1
    name = name(:last)
    rest = adjustl(text(12:))
    rest = adjustl(rest(last + 1:))
    if (rest /= "" .and. rest /= "()") call refuse("the subroutine must have no arguments")
    if (awaited == await_before) then
      before = name
    else if (awaited == await_after) then
      after = name
    else
      if (lower(name(1:5)) /= "test_") call refuse("the name of a test begins with test_")
      call add_test(name)
    end if
    awaited = await_nothing
  end subroutine subroutine_line

  !> Add a name to the list of tests.
  subroutine add_test(name)
    character(len=*), intent(in) :: name

    character(len=64), allocatable :: longer(:)

    allocate (longer(size(test) + 1))
    longer(:size(test)) = test
    longer(size(longer)) = name
    call move_alloc(longer, test)
  end subroutine add_test

  !> Check a line of plain Fortran.
  subroutine plain_line(word)
    !> In small letters, without leading blanks.
    character(len=*), intent(in) :: word

    if (word(1:7) == "module " .and. word(8:17) /= "procedure ") then
      if (module_name /= "") call refuse("a second module")
      module_name = adjustl(word(8:))
      if (module_name /= lower(suite)) call refuse( &
          "the line must be `module "//trim(suite)//"`, the name of the file, and nothing else")
    else if (word(1:4) == "use " .and. index(word, "funit") > 0) then
      if (adjustl(word(5:)) /= "funit") call refuse("the line must be `use funit`")
      uses_funit = .true.
    else if (word(1:11) == "call assert") then
      call refuse("write @assert in place of call assert")
    else if (index(strip_text(word), "@") > 0) then
      call refuse("a directive stands alone on its line")
    end if
  end subroutine plain_line

  !> Write the call of an assert.
  subroutine assert_line(text)
    !> Without leading blanks.
    character(len=*), intent(in) :: text

    character(len=:), allocatable :: name, bare, call_name
    integer :: opening, closing, which, place

    if (len_trim(line) > max_columns) call refuse("an assert is one line of at most 100 columns")
    bare = strip_text(text)
    opening = index(bare, "(")
    if (opening == 0) call refuse("an assert needs its arguments in brackets")
    name = trim(lower(text(8:opening - 1)))
    which = 0
    do place = 1, size(assert_name)
      if (assert_name(place) == name) which = place
    end do
    if (which == 0) call refuse("unknown assert: @assert"//name)
    if (index(bare, "&") > 0) call refuse("an assert is one line, without &")
    closing = closing_bracket(bare, opening)
    if (closing == 0) call refuse("the brackets of the assert do not close")
    if (closing /= len_trim(bare)) call refuse("nothing may follow the assert on its line")
    call check_arguments(bare(opening + 1:closing - 1), which)
    call_name = "assert"//name//"("
    if (which >= first_comparison) then
      call_name = "assertOrder(compare_"//name//", "
      if (name == "equal" .or. name == "notequal") call_name = "assertEquality(compare_"//name//", "
    end if
    write (unit_out, '(a,i0,3a)') "# ", number, " """, trim(source), """"
    write (unit_out, '(4a)') "  call ", call_name, text(opening + 1:closing - 1), ", &"
    write (unit_out, '(a,i0,3a)') "# ", number, " """, trim(source), """"
    write (unit_out, '(3a,i0,a)') "    location=SourceLocation('", trim(suite), ".pf', ", &
        number, "))"
    write (unit_out, '(a)') "  if (anyExceptions()) return"
    write (unit_out, '(a,i0,3a)') "# ", number + 1, " """, trim(source), """"
  end subroutine assert_line

  !> Count the arguments of an assert and check its keywords.
  subroutine check_arguments(list, which)
    !> The text between the brackets, with text constants blanked out.
    character(len=*), intent(in) :: list
    !> Index of the assert in `assert_name`.
    integer, intent(in) :: which

    character(len=:), allocatable :: one
    integer :: first, last, plain
    logical :: tolerance, message

    plain = 0
    tolerance = .false.
    message = .false.
    first = 1
    do while (first <= len(list))
      last = argument_end(list, first)
      one = lower(adjustl(list(first:last)))
      if (is_keyword(one, "tolerance")) then
        tolerance = .true.
      else if (is_keyword(one, "message")) then
        message = .true.
      else if (tolerance .or. (message .and. which /= 3) .or. one == "") then
        call refuse("arguments come before tolerance= and message=")
      else
        plain = plain + 1
      end if
      first = last + 2
    end do
    if (which == 3 .and. plain == 1 .and. .not. message) return
    if (which == 3 .and. .not. message) call refuse("@assertFail needs a message")
    if (plain /= assert_arguments(which)) call refuse( &
        "wrong number of arguments; the tolerance and the message are given by keyword")
    select case (assert_name(which))
    case ("relativelyequal")
      if (.not. tolerance) call refuse("@assertRelativelyEqual needs a tolerance")
    case ("equal")
      continue
    case default
      if (tolerance) call refuse("@assert"//trim(assert_name(which))//" takes no tolerance")
    end select
  end subroutine check_arguments

  !> Check whether an argument is given by this keyword.
  logical function is_keyword(argument, keyword)
    !> The argument is in small letters.
    character(len=*), intent(in) :: argument, keyword

    character(len=:), allocatable :: rest

    is_keyword = .false.
    if (len(argument) <= len(keyword) + 1) return
    if (argument(:len(keyword)) /= keyword) return
    rest = adjustl(argument(len(keyword) + 1:))
    if (rest(1:1) == "=") is_keyword = rest(1:2) /= "=="
  end function is_keyword

  !> Return the last position of the argument that begins at `first`.
  integer function argument_end(list, first)
    !> With text constants blanked out.
    character(len=*), intent(in) :: list
    integer, intent(in) :: first

    integer :: depth

    depth = 0
    do argument_end = first, len(list)
      select case (list(argument_end:argument_end))
      case ("(", "[")
        depth = depth + 1
      case (")", "]")
        depth = depth - 1
      case (",")
        if (depth == 0) exit
      case default
        ! Part of the argument.
      end select
    end do
    argument_end = argument_end - 1
  end function argument_end

  !> Return the position of the bracket that closes the one at `opening`; 0 if there is none.
  integer function closing_bracket(text, opening)
    !> With text constants blanked out.
    character(len=*), intent(in) :: text
    integer, intent(in) :: opening

    integer :: depth, place

    depth = 0
    closing_bracket = 0
    do place = opening, len_trim(text)
      if (text(place:place) == "(") depth = depth + 1
      if (text(place:place) == ")") depth = depth - 1
      if (depth == 0) exit
    end do
    if (depth == 0) closing_bracket = place
  end function closing_bracket

  !> Return the line with its text constants filled with x; the comment of plain code is removed.
  function strip_text(text) result(bare)
    character(len=*), intent(in) :: text
    character(len=len(text)) :: bare

    character(len=1) :: quote
    integer :: place

    bare = text
    quote = " "
    do place = 1, len_trim(text)
      if (quote == " ") then
        if (text(place:place) == "'" .or. text(place:place) == '"') quote = text(place:place)
        if (text(place:place) == "!" .and. text(1:1) /= "@") then
          bare(place:) = ""
          exit
        end if
      else if (text(place:place) == quote) then
        quote = " "
      else
        bare(place:place) = "x"
      end if
    end do
  end function strip_text

  !> Write the module that runs the tests of the file.
  subroutine write_suite()
    character(len=:), allocatable :: fixture

    fixture = ""
    if (before /= "") fixture = fixture//", before="//trim(before)
    if (after /= "") fixture = fixture//", after="//trim(after)
    write (unit_out, '(a)') "module "//trim(suite)//"_suite"
    write (unit_out, '(a)') "  use pf_runner, only : run_t"
    if (before /= "") write (unit_out, '(a)') "  use "//trim(suite)//", only : "//trim(before)
    if (after /= "") write (unit_out, '(a)') "  use "//trim(suite)//", only : "//trim(after)
    do i = 1, size(test)
      write (unit_out, '(a)') "  use "//trim(suite)//", only : "//trim(test(i))
    end do
    write (unit_out, '(a)') "  implicit none", "contains", "  subroutine run_suite(run)", &
        "    type(run_t), intent(inout) :: run"
    do i = 1, size(test)
      write (unit_out, '(a)') "    call run%test('"//trim(suite)//"', '"//trim(test(i))//"', &", &
          "      "//trim(test(i))//fixture//")"
    end do
    write (unit_out, '(a)') "  end subroutine run_suite", "end module "//trim(suite)//"_suite"
  end subroutine write_suite

  !> Return the name of a file without folders and extension.
  function base_name(path) result(name)
    character(len=*), intent(in) :: path
    character(len=64) :: name

    integer :: dot

    name = path(index(path, "/", back=.true.) + 1:)
    dot = index(name, ".", back=.true.)
    if (dot > 0) name = name(:dot - 1)
  end function base_name

  !> Return the text in small letters.
  function lower(text)
    character(len=*), intent(in) :: text
    character(len=len(text)) :: lower

    integer :: place

    lower = text
    do place = 1, len(text)
      if (lge(text(place:place), "A") .and. lle(text(place:place), "Z")) then
        lower(place:place) = achar(iachar(text(place:place)) + 32)
      end if
    end do
  end function lower

  !> Print the error, remove the incomplete result and stop.
  subroutine refuse(message)
    character(len=*), intent(in) :: message

    logical :: opened

    write (error_unit, '(2a,i0,2a)') trim(source), ":", number, ": error: ", message
    inquire (file=target, opened=opened)
    if (opened) close (unit_out, status="delete")
    stop 1
  end subroutine refuse

end program pf_preprocess
