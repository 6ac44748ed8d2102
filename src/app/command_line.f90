!> The command line: options as values, and what is wrong with them.
module dd3_app_command_line
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : text_t, nearest_name, newline
  implicit none
  private
  public :: options_t, read_command_line, parse_arguments, usage_text

  !> The options there are.
  character(len=9), parameter :: known(8) = [character(len=9) :: "--check", "--set", "--output", &
      "--restart", "--threads", "--quiet", "--version", "--help"]

  !> What the user asks for.
  type :: options_t
    !> The input file; empty where none is needed.
    character(len=:), allocatable :: file
    !> Parameters given as `name=value`.
    type(text_t), allocatable :: overrides(:)
    !> Folder of the results; empty where not given.
    character(len=:), allocatable :: output
    !> Number of threads.
    integer :: threads = 1
    !> Whether to read, check, echo and stop; whether to keep the screen free.
    logical :: check = .false., quiet = .false.
    !> Whether the version or help is asked for.
    logical :: version = .false., help = .false.
    !> What help is asked on; empty for all.
    character(len=:), allocatable :: topic
  end type options_t

contains

  !> Takes the arguments of the program and reads them.
  subroutine read_command_line(options, error)
    !> What the user asks for.
    type(options_t), intent(out) :: options
    !> What is wrong with it.
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

  !> Reads arguments.
  subroutine parse_arguments(options, argument, error)
    !> What the user asks for.
    type(options_t), intent(out) :: options
    !> The arguments.
    type(text_t), intent(in) :: argument(:)
    !> What is wrong with them.
    type(error_t), allocatable, intent(out) :: error

    logical :: plain
    integer :: i

    options%file = ""
    options%output = ""
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
        call fatal_error(error, "one input file is asked for, not '"//options%file//"' and '"// &
            argument(i)%s//"'")
      else if (argument(i)%s == "") then
        call fatal_error(error, "the input file's name is empty")
      else
        options%file = argument(i)%s
      end if
      i = i + 1
    end do
    if (allocated(error)) return
    if (options%file == "" .and. .not. (options%help .or. options%version)) then
      call fatal_error(error, "an input file is missing")
    end if
  end subroutine parse_arguments

  !> Reads one option, and its value if it takes one.
  subroutine read_option(options, argument, i, error)
    !> What the user asks for.
    type(options_t), intent(inout) :: options
    !> The arguments.
    type(text_t), intent(in) :: argument(:)
    !> Position of the option; of its value afterwards.
    integer, intent(inout) :: i
    !> What is wrong with it.
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
    case ("--set", "--output", "--threads", "--restart")
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
      if (name == "--threads") call read_threads(options%threads, value, error)
      if (name == "--restart") call fatal_error(error, "--restart is not available in this version")
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

  !> Parts `--name=value`.
  pure subroutine split_option(argument, name, value)
    !> The argument.
    character(len=*), intent(in) :: argument
    !> The option's name, and its value; empty where none is attached.
    character(len=:), allocatable, intent(out) :: name, value

    integer :: equals

    equals = index(argument, "=")
    if (equals == 0) equals = len(argument) + 1
    name = argument(:equals - 1)
    value = ""
    if (equals < len(argument)) value = argument(equals + 1:)
  end subroutine split_option

  !> Reads the number of threads.
  subroutine read_threads(threads, value, error)
    !> The number.
    integer, intent(inout) :: threads
    !> The text.
    character(len=*), intent(in) :: value
    !> Says that it is no such number.
    type(error_t), allocatable, intent(out) :: error

    integer :: status

    status = 1
    if (verify(value, "0123456789") == 0 .and. len(value) < 5) read (value, *, &
        iostat=status) threads
    if (status == 0 .and. threads >= 1) return
    call fatal_error(error, "--threads asks for a whole number of 1 or more, not '"//value//"'")
  end subroutine read_threads

  !> How the program is called.
  function usage_text() result(text)
    character(len=:), allocatable :: text

    text = "usage: dd3imp [options] job.dat"//newline// &
           "  --check              read the input, check it, show all values, stop"//newline// &
           "  --set name=value     gives a *PARAMETER of the input another value; repeatable"// &
           newline// &
           "  --output DIR         folder of the results (job.out where nothing else is said)"// &
           newline// &
           "  --threads N          number of threads (1)"//newline// &
           "  --quiet              nothing on the screen but errors"//newline// &
           "  --version            the program's version"//newline// &
           "  --help [name]        this text, or help on a block, key or law, or markdown"// &
           newline// &
           "exit codes: 0 reached the end; 1 usage; 2 input errors; 3 stopped before the end"// &
           newline
  end function usage_text

end module dd3_app_command_line
