! SPDX-License-Identifier: GPL-3.0-or-later
!> Command line: the options and their errors.
module dd3_app_command_line
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : text_t, nearest_name, newline
  implicit none
  private
  public :: options_t, read_command_line, parse_arguments, usage_text

  !> Known options.
  character(len=14), parameter :: known(9) = [character(len=14) :: "--check", "--initial", &
      "--set", "--output", "--restart", "--threads", "--quiet", "--version", "--help"]

  !> Options of a call.
  type :: options_t
    !> Input file; empty if none is needed.
    character(len=:), allocatable :: file
    !> Parameters given as `name=value`.
    type(text_t), allocatable :: overrides(:)
    !> Folder of the results; empty if not given.
    character(len=:), allocatable :: output
    !> Folder in which a check writes the initial state; empty for none.
    character(len=:), allocatable :: initial
    !> Restart file to continue from; empty for none.
    character(len=:), allocatable :: restart
    !> Largest number of threads; 0 if not given.
    integer :: threads = 0
    !> Read, check, echo and stop; print nothing but errors.
    logical :: check = .false., quiet = .false.
    !> Print the version; print help.
    logical :: version = .false., help = .false.
    !> Topic of the help; empty for all.
    character(len=:), allocatable :: topic
  end type options_t

contains

  !> Read the arguments of the program.
  subroutine read_command_line(options, error)
    type(options_t), intent(out) :: options
    !> Set if an argument is wrong.
    type(error_t), allocatable, intent(out) :: error

    type(text_t), allocatable :: argument(:)
    integer :: i, length

    allocate (argument(command_argument_count()))
    do i = 1, size(argument)
      call get_command_argument(i, length=length)
      allocate (character(len=length) :: argument(i)%s)
      call get_command_argument(i, argument(i)%s)
    end do
    call parse_arguments(options, argument, error)
  end subroutine read_command_line

  !> Set the options from the arguments.
  subroutine parse_arguments(options, argument, error)
    type(options_t), intent(out) :: options
    type(text_t), intent(in) :: argument(:)
    !> Set if an argument is wrong.
    type(error_t), allocatable, intent(out) :: error

    logical :: plain
    integer :: i

    options%file = ""
    options%output = ""
    options%initial = ""
    options%restart = ""
    options%topic = ""
    allocate (options%overrides(0))
    i = 1
    plain = .false.
    do while (i <= size(argument) .and. .not. allocated(error))
      if (argument(i)%s == "--" .and. .not. plain) then
        plain = .true.
      else if (index(argument(i)%s, "-") == 1 .and. len(argument(i)%s) > 1 .and. .not. plain) then
        call read_option(options, argument, i, error)
      else if (options%file /= "") then
        call fatal_error(error, "expected one input file, got '"//options%file//"' and '"// &
            argument(i)%s//"'")
      else if (argument(i)%s == "") then
        call fatal_error(error, "the name of the input file is empty")
      else
        options%file = argument(i)%s
      end if
      i = i + 1
    end do
    if (allocated(error)) return
    if (options%file == "" .and. .not. (options%help .or. options%version)) then
      call fatal_error(error, "an input file is missing")
    else if (options%initial /= "" .and. .not. options%check) then
      call fatal_error(error, "--initial is an option of --check")
    end if
  end subroutine parse_arguments

  !> Parse one option, and its value if it takes one.
  subroutine read_option(options, argument, i, error)
    type(options_t), intent(inout) :: options
    type(text_t), intent(in) :: argument(:)
    !> Position of the option; of its value afterwards.
    integer, intent(inout) :: i
    !> Set if an argument is wrong.
    type(error_t), allocatable, intent(out) :: error

    character(len=:), allocatable :: name, value
    type(text_t) :: override

    call split_option(argument(i)%s, name, value)
    select case (name)
    case ("--check", "--quiet", "--version")
      if (len(value) > 0) call fatal_error(error, name//" takes no value")
      if (name == "--check") options%check = .true.
      if (name == "--quiet") options%quiet = .true.
      if (name == "--version") options%version = .true.
    case ("--set", "--output", "--initial", "--threads", "--restart")
      if (len(value) == 0 .and. i < size(argument)) then
        i = i + 1
        value = argument(i)%s
      end if
      if (len(value) == 0) then
        call fatal_error(error, name//" needs a value")
        return
      end if
      if (name == "--output" .and. options%output /= "") call fatal_error(error, &
          "--output is given twice")
      if (name == "--output") options%output = value
      if (name == "--initial") options%initial = value
      if (name == "--threads") call read_threads(options%threads, value, error)
      if (name == "--restart" .and. options%restart /= "") call fatal_error(error, &
          "--restart is given twice")
      if (name == "--restart") options%restart = value
      if (name == "--set") then
        override%s = value
        options%overrides = [options%overrides, override]
      end if
    case ("--help", "-h")
      options%help = .true.
      options%topic = value
      if (len(value) == 0 .and. i < size(argument)) then
        i = i + 1
        options%topic = argument(i)%s
      end if
    case default
      value = nearest_name(name, known)
      if (value /= "") value = "; did you mean "//value//"?"
      call fatal_error(error, "unknown option "//name//value)
    end select
  end subroutine read_option

  !> Split `--name=value`.
  pure subroutine split_option(argument, name, value)
    character(len=*), intent(in) :: argument
    !> The value is empty if none is attached.
    character(len=:), allocatable, intent(out) :: name, value

    integer :: equals

    equals = index(argument, "=")
    if (equals == 0) equals = len(argument) + 1
    name = argument(:equals - 1)
    value = ""
    if (equals < len(argument)) value = argument(equals + 1:)
  end subroutine split_option

  !> Parse the number of threads.
  subroutine read_threads(threads, value, error)
    integer, intent(inout) :: threads
    character(len=*), intent(in) :: value
    !> Set if it is not a positive integer.
    type(error_t), allocatable, intent(out) :: error

    integer :: status

    status = 1
    if (verify(value, "0123456789") == 0 .and. len(value) < 5) read (value, *, &
        iostat=status) threads
    if (status == 0 .and. threads >= 1) return
    call fatal_error(error, "--threads: expected an integer >= 1, got '"//value//"'")
  end subroutine read_threads

  !> Return the usage of the program.
  function usage_text() result(text)
    character(len=:), allocatable :: text

    text = "usage: dd3imp [options] job.dat"//newline// &
        "  --check              read the input, check it, show all values, stop"//newline// &
        "  --initial DIR        with --check: write the initial state into the folder DIR"// &
        newline// &
        "  --set name=value     gives a *PARAMETER of the input another value; repeatable"// &
        newline// &
        "  --output DIR         folder of the results (default: job.out)"//newline// &
        "  --restart FILE       continue the run that wrote the restart file FILE"//newline// &
        "  --threads N          largest number of threads (the processors there are)"//newline// &
        "  --quiet              print nothing but errors"//newline// &
        "  --version            the program's version"//newline// &
        "  --help [name]        this text, or help on a block, key, law, element or code of a "// &
        "message"//newline// &
        "exit codes: 0 reached the end; 1 usage; 2 input errors; 3 stopped before the end"//newline
  end function usage_text

end module dd3_app_command_line
