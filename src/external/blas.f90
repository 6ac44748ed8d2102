! SPDX-License-Identifier: GPL-3.0-or-later
!> OpenBLAS: its threads and its kernels. With another BLAS the build takes `cmake/absent/blas.f90`
!> instead.
module dd3_external_blas
  use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_f_pointer, c_int, c_loc, &
      c_null_char, c_null_ptr, c_ptr, c_size_t
  use dd3_base_posix, only : posix_execv, posix_readlink, posix_setenv
  implicit none
  private
  public :: use_one_blas_thread, use_kernels_of_processor

  !> Kernels with AVX2 and AVX-512, the kernels that OpenBLAS takes in their place for a processor
  !> that is newer than the library, and the flags of the processors that they need.
  character(len=*), parameter :: avx2 = "Haswell", avx512 = "SkylakeX"
  character(len=*), parameter :: below_avx2(5) = [character(len=9) :: "Prescott", "Core2", &
      "Nehalem", "Barcelona", "Generic"]
  character(len=*), parameter :: below_avx512(7) = [character(len=9) :: "Prescott", "Core2", &
      "Nehalem", "Barcelona", "Generic", "Haswell", "Zen"]
  character(len=*), parameter :: avx2_flag(2) = [character(len=8) :: "avx2", "fma"]
  character(len=*), parameter :: avx512_flag(4) = [character(len=8) :: "avx512f", "avx512dq", &
      "avx512bw", "avx512vl"]
  character(len=*), parameter :: variable = "OPENBLAS_CORETYPE"

  interface
    !> Set the number of threads.
    subroutine openblas_set_num_threads(count) bind(c)
      import :: c_int
      integer(c_int), value :: count
    end subroutine openblas_set_num_threads
    !> Return the name of the kernels.
    type(c_ptr) function openblas_get_corename() bind(c)
      import :: c_ptr
    end function openblas_get_corename
  end interface

contains

  !> Set the number of OpenBLAS threads to one.
  subroutine use_one_blas_thread()
    call openblas_set_num_threads(1_c_int)
  end subroutine use_one_blas_thread

  !> Begin the program again with the kernels of the processor, if OpenBLAS has chosen those of an
  !> older one: they are chosen as the library is loaded. A value of `OPENBLAS_CORETYPE` in the
  !> environment is kept.
  subroutine use_kernels_of_processor()
    character(len=:), allocatable :: flags, used, kernels
    integer :: length
    integer(c_int) :: ignored

    call get_environment_variable(variable, length=length)
    if (length > 0) return
    used = kernels_in_use()
    flags = processor_flags()
    if (any(used == below_avx512) .and. has_all(flags, avx512_flag)) then
      kernels = avx512
    else if (any(used == below_avx2) .and. has_all(flags, avx2_flag)) then
      kernels = avx2
    else
      return
    end if
    ignored = posix_setenv(variable//c_null_char, kernels//c_null_char, 0_c_int)
    call begin_again()
  end subroutine use_kernels_of_processor

  !> Return the name of the kernels that OpenBLAS uses.
  function kernels_in_use() result(name)
    character(len=len(below_avx2)) :: name

    character(kind=c_char), pointer :: letter(:)
    type(c_ptr) :: text
    integer :: i

    name = ""
    text = openblas_get_corename()
    if (.not. c_associated(text)) return
    call c_f_pointer(text, letter, [len(name)])
    do i = 1, len(name)
      if (letter(i) == c_null_char) exit
      name(i:i) = letter(i)
    end do
  end function kernels_in_use

  !> Return the flags of the first processor, each between blanks; empty if unknown (Linux).
  function processor_flags() result(flags)
    character(len=:), allocatable :: flags

    character(len=8192) :: line
    integer :: unit, status

    flags = ""
    open (newunit=unit, file="/proc/cpuinfo", action="read", status="old", iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, "flags") /= 1) cycle
      flags = line(index(line, ":") + 1:len_trim(line) + 1)
      exit
    end do
    close (unit)
  end function processor_flags

  !> Whether all of some flags are among those of a processor.
  pure logical function has_all(flags, flag)
    character(len=*), intent(in) :: flags, flag(:)

    integer :: i

    has_all = .true.
    do i = 1, size(flag)
      has_all = has_all .and. index(flags, " "//trim(flag(i))//" ") > 0
    end do
  end function has_all

  !> Begin the program again with its arguments; without effect if that is not possible.
  subroutine begin_again()
    !> Longest path.
    integer, parameter :: longest_path = 4096
    character(len=1, kind=c_char), allocatable, target :: text(:, :)
    character(len=1, kind=c_char) :: path(longest_path)
    character(len=:), allocatable :: word
    type(c_ptr), allocatable :: argument(:)
    integer :: i, j, n, longest
    integer(c_int) :: ignored

    longest = 0
    do i = 0, command_argument_count()
      call get_command_argument(i, length=n)
      longest = max(longest, n)
    end do
    allocate (argument(command_argument_count() + 2))
    argument(:) = c_null_ptr
    allocate (text(longest + 1, size(argument)), source=c_null_char)
    allocate (character(len=longest) :: word)
    do i = 1, size(argument) - 1
      call get_command_argument(i - 1, word, n)
      do j = 1, n
        text(j, i) = word(j:j)
      end do
      argument(i) = c_loc(text(1, i))
    end do
    path = c_null_char
    if (posix_readlink("/proc/self/exe"//c_null_char, path, size(path, kind=c_size_t) - 1) > 0) then
      ignored = posix_execv(path, argument)
    end if
  end subroutine begin_again

end module dd3_external_blas
