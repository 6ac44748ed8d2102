! SPDX-License-Identifier: GPL-3.0-or-later
!> OpenBLAS starts its threads when it is loaded, each with 128 MB of address space. Under a limit
!> of the address space they fail, and the program waits for them at its end for ever. There the
!> program starts itself again with a single one.
module dd3_app_one_blas_thread
  use, intrinsic :: iso_c_binding, only : c_int, c_loc, c_long, c_null_char, c_null_ptr, c_ptr
  use dd3_base_posix, only : posix_execv, posix_getrlimit, posix_setenv
  use dd3_base_text, only : text_t
  implicit none
  private
  public :: use_one_blas_thread_if_limited

  !> Variable that OpenBLAS reads when it is loaded.
  character(len=*), parameter :: variable = "OPENBLAS_NUM_THREADS"
  !> Variable that the Fortran library reads when it is loaded: a backtrace takes memory itself, and
  !> hides the message that there is none.
  character(len=*), parameter :: backtrace = "GFORTRAN_ERROR_BACKTRACE"
  !> Resource number of the address space (Linux).
  integer(c_int), parameter :: rlimit_as = 9

contains

  !> Start the program again with one thread of OpenBLAS if its address space is limited; no-op
  !> otherwise, and if it has one already.
  subroutine use_one_blas_thread_if_limited()
    integer(c_long) :: limits(2)
    character(len=8) :: value
    integer :: status

    if (posix_getrlimit(rlimit_as, limits) /= 0) return
    if (limits(1) < 0) return
    call get_environment_variable(variable, value, status=status)
    if (status == 0 .and. value == "1") return
    if (posix_setenv(variable//c_null_char, "1"//c_null_char, 1_c_int) /= 0) return
    status = int(posix_setenv(backtrace//c_null_char, "n"//c_null_char, 0_c_int))
    call start_again()
  end subroutine use_one_blas_thread_if_limited

  !> Start the program again with the same arguments; no-op if that fails.
  subroutine start_again()
    type(text_t), allocatable, target :: argument(:)
    type(c_ptr), allocatable :: address(:)
    integer :: i, n, length
    integer(c_int) :: ignored

    n = command_argument_count()
    allocate (argument(0:n), address(0:n + 1))
    do i = 0, n
      call get_command_argument(i, length=length)
      allocate (character(len=length + 1) :: argument(i)%s)
      call get_command_argument(i, argument(i)%s)
      argument(i)%s(length + 1:) = c_null_char
      address(i) = c_loc(argument(i)%s)
    end do
    address(n + 1) = c_null_ptr
    ignored = posix_execv("/proc/self/exe"//c_null_char, address)
  end subroutine start_again

end module dd3_app_one_blas_thread
