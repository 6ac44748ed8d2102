!> Runs tests one after the other, counts them and prints what failed.
module pf_runner
  use, intrinsic :: iso_fortran_env, only : output_unit, error_unit
  use pf_failure, only : failure_t, take_failures, anyExceptions
  implicit none
  private
  public :: run_t

  abstract interface
    !> A test, or what is done before and after one.
    subroutine test_interface()
    end subroutine test_interface
  end interface

  !> One run of the tests of an executable.
  type :: run_t
    !> Whether each test is named when it starts.
    logical :: verbose = .false.
    !> Only tests whose `suite.name` holds this text are run.
    character(len=:), allocatable :: filter
    !> Tests run, and tests that failed.
    integer :: count = 0, failed = 0
    !> What failed, ready to be printed.
    character(len=:), allocatable :: report
  contains
    procedure :: start => run_start
    procedure :: test => run_test
    procedure :: finish => run_finish
    procedure, private :: note => run_note
  end type run_t

contains

  !> Reads the command line.
  subroutine run_start(self)
    !> The run.
    class(run_t), intent(inout) :: self

    character(len=256) :: argument
    integer :: i

    self%filter = ""
    self%report = ""
    i = 1
    do while (i <= command_argument_count())
      call get_command_argument(i, argument)
      select case (argument)
      case ("-v", "-d", "--verbose", "--debug")
        self%verbose = .true.
      case ("-f", "--filter")
        i = i + 1
        call get_command_argument(i, argument)
        self%filter = trim(argument)
      case default
        write (error_unit, '(a)') "options: --verbose, --filter TEXT; not: "//trim(argument)
        stop 1
      end select
      i = i + 1
    end do
  end subroutine run_start

  !> Runs one test; it is skipped where `before` fails, and `after` runs in any case but that.
  subroutine run_test(self, suite, name, test, before, after)
    !> The run.
    class(run_t), intent(inout) :: self
    !> Names of the suite and the test.
    character(len=*), intent(in) :: suite, name
    !> The test.
    procedure(test_interface) :: test
    !> What is done before and after it.
    procedure(test_interface), optional :: before, after

    if (index(suite//"."//name, self%filter) == 0) return
    self%count = self%count + 1
    if (self%verbose) write (output_unit, '(a)') "start: "//suite//"."//name
    flush (output_unit)
    if (present(before)) call before()
    if (.not. anyExceptions()) then
      call test()
      if (present(after)) call after()
    end if
    if (anyExceptions()) then
      self%failed = self%failed + 1
      call self%note(suite//"."//name)
    end if
  end subroutine run_test

  !> Adds the failures of a test to the report.
  subroutine run_note(self, name)
    !> The run.
    class(run_t), intent(inout) :: self
    !> Name of the suite and the test.
    character(len=*), intent(in) :: name

    type(failure_t), allocatable :: failures(:)
    character(len=12) :: line
    integer :: i

    call take_failures(failures)
    do i = 1, size(failures)
      write (line, '(i0)') failures(i)%location%line
      self%report = self%report//"FAILED "//name//" at "//trim(failures(i)%location%file)//":" &
                    //trim(line)//new_line("a")//failures(i)%message//new_line("a")
    end do
  end subroutine run_note

  !> Prints the result; stops with exit code 2 where a test failed.
  subroutine run_finish(self)
    !> The run.
    class(run_t), intent(in) :: self

    if (self%failed > 0) then
      write (output_unit, '(a)') self%report
      write (output_unit, '(a,i0,a,i0,a)') "FAILURES (", self%failed, " of ", self%count, " tests)"
      flush (output_unit)
      stop 2
    end if
    write (output_unit, '(a,i0,a)') "OK (", self%count, " tests)"
  end subroutine run_finish

end module pf_runner
