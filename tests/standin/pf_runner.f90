! SPDX-License-Identifier: GPL-3.0-or-later
!> Run tests in sequence, count them and print the failures.
module pf_runner
  use, intrinsic :: iso_fortran_env, only : output_unit, error_unit
  use pf_failure, only : failure_t, pop_failures, anyExceptions
  implicit none
  private
  public :: run_t

  abstract interface
    !> A test, or a procedure called before or after one.
    subroutine test_interface()
    end subroutine test_interface
  end interface

  !> A run of the tests of an executable.
  type :: run_t
    !> Print the name of each test at its start.
    logical :: verbose = .false.
    !> Run only tests whose `suite.name` contains this text.
    character(len=:), allocatable :: filter
    !> Number of tests run, and of those that failed.
    integer :: count = 0, failed = 0
    !> The failures, formatted.
    character(len=:), allocatable :: report
  contains
    procedure :: start => run_start
    procedure :: test => run_test
    procedure :: finish => run_finish
    procedure, private :: note => run_note
  end type run_t

contains

  !> Read the command line.
  subroutine run_start(self)
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

  !> Run one test. If `before` fails, the test and `after` are skipped; otherwise `after` is always
  !> called.
  subroutine run_test(self, suite, name, test, before, after)
    class(run_t), intent(inout) :: self
    !> Names of the suite and the test.
    character(len=*), intent(in) :: suite, name
    procedure(test_interface) :: test
    !> Called before and after it.
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

  !> Add the failures of a test to the report.
  subroutine run_note(self, name)
    class(run_t), intent(inout) :: self
    !> Name of the suite and the test.
    character(len=*), intent(in) :: name

    type(failure_t), allocatable :: failures(:)
    character(len=12) :: line
    integer :: i

    call pop_failures(failures)
    do i = 1, size(failures)
      write (line, '(i0)') failures(i)%location%line
      self%report = self%report//"FAILED "//name//" at "//trim(failures(i)%location%file)//":" &
          //trim(line)//new_line("a")//failures(i)%message//new_line("a")
    end do
  end subroutine run_note

  !> Print the result; stop with exit code 2 if a test failed.
  subroutine run_finish(self)
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
