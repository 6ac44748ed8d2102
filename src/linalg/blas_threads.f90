!> Keeps the BLAS to one thread: the dense blocks of a sheet's factorisation are too small to share,
!> and a thread pool that wakes for each of them costs a third of the time. OpenBLAS is asked where
!> it is the library in use (looked up by name in the running program); with any other BLAS nothing
!> happens.
module dd3_linalg_blas_threads
  use, intrinsic :: iso_c_binding, only : c_int, c_char, c_ptr, c_funptr, c_null_ptr, c_null_char, &
      c_associated, c_f_procpointer
  implicit none
  private
  public :: use_one_blas_thread

  abstract interface
    !> Sets the number of threads.
    subroutine set_threads_interface(count) bind(c)
      import :: c_int
      !> Number of threads.
      integer(c_int), value :: count
    end subroutine set_threads_interface
  end interface

  interface
    !> Address of a symbol of the running program (POSIX); a null handle searches all of it.
    type(c_funptr) function dlsym(handle, name) bind(c, name="dlsym")
      import :: c_ptr, c_funptr, c_char
      !> Where to search.
      type(c_ptr), value :: handle
      !> Name of the symbol, closed by a null character.
      character(kind=c_char), intent(in) :: name(*)
    end function dlsym
  end interface

contains

  !> Sets the threads of OpenBLAS to one.
  subroutine use_one_blas_thread()
    procedure(set_threads_interface), pointer :: set_threads
    type(c_funptr) :: address

    address = dlsym(c_null_ptr, "openblas_set_num_threads"//c_null_char)
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, set_threads)
    call set_threads(1_c_int)
  end subroutine use_one_blas_thread

end module dd3_linalg_blas_threads
