! SPDX-License-Identifier: GPL-3.0-or-later
!> Threads (OpenMP) of the loops whose passes do not depend on one another. Every such loop asks
!> here how many threads to take; its results must be the same bits for any number.
module dd3_base_threads
  !$ use omp_lib, only : omp_get_max_threads, omp_get_num_procs, omp_set_num_threads
  implicit none
  private
  public :: set_threads, most_threads, processors, threads_for
  public :: least_points, least_nodes, least_values

  !> Integration points of a loop over elements, passes of one over nodes, candidates or rows, and
  !> of one over the values of a matrix that occupy a thread longer than it waits for the others.
  integer, parameter :: least_points = 128, least_nodes = 256, least_values = 50000

contains

  !> Set the largest number of threads of the loops from now on.
  subroutine set_threads(threads)
    integer, intent(in) :: threads

    !$ call omp_set_num_threads(threads)
  end subroutine set_threads

  !> Return the largest number of threads of a loop: the one set last, else that of the environment
  !> (OMP_NUM_THREADS), else the processors that the program may use.
  integer function most_threads()
    most_threads = 1
    !$ most_threads = omp_get_max_threads()
  end function most_threads

  !> Return the number of processors that the program may use.
  integer function processors()
    processors = 1
    !$ processors = omp_get_num_procs()
  end function processors

  !> Return the number of threads of a loop.
  integer function threads_for(n_pass, least) result(threads)
    integer, intent(in) :: n_pass
    !> Least number of passes for each thread, such as `least_nodes`.
    integer, intent(in) :: least

    threads = max(1, min(most_threads(), n_pass/least))
  end function threads_for

end module dd3_base_threads
