! SPDX-License-Identifier: GPL-3.0-or-later
!> Ranks by MPI, which PETSc starts.
submodule (dd3_base_ranks) dd3_parallel_ranks
  use, intrinsic :: iso_c_binding, only : c_int
  use mpi_f08, only : mpi_allreduce, mpi_alltoallv, mpi_bcast, mpi_character, mpi_comm_rank, &
      mpi_comm_size, mpi_comm_world, mpi_double_precision, mpi_gatherv, mpi_in_place, mpi_integer, &
      mpi_max, mpi_reduce, mpi_sum
  implicit none

  ! Of PETSc; the functions return an error code.
  interface
    !> Set whether PETSc is started.
    integer(c_int) function petsc_initialized(started) bind(c, name="PetscInitialized")
      import :: c_int
      integer(c_int), intent(out) :: started
    end function petsc_initialized

    !> Start PETSc, and MPI.
    integer(c_int) function petsc_initialize() bind(c, name="PetscInitializeNoArguments")
      import :: c_int
    end function petsc_initialize

    !> Restore the signal handlers from before the start.
    integer(c_int) function petsc_pop_signal_handler() bind(c, name="PetscPopSignalHandler")
      import :: c_int
    end function petsc_pop_signal_handler

    !> End PETSc, and MPI.
    integer(c_int) function petsc_finalize() bind(c, name="PetscFinalize")
      import :: c_int
    end function petsc_finalize
  end interface

contains

  module procedure ranks_present
    ranks_present = .true.
  end procedure ranks_present

  module procedure start_ranks
    integer(c_int) :: started, ignored

    ignored = petsc_initialized(started)
    if (started /= 0) return
    ignored = petsc_initialize()
    ignored = petsc_pop_signal_handler()
  end procedure start_ranks

  module procedure end_ranks
    integer(c_int) :: ignored

    ignored = petsc_finalize()
  end procedure end_ranks

  module procedure this_rank
    this_rank = 0
    if (is_started()) call mpi_comm_rank(mpi_comm_world, this_rank)
  end procedure this_rank

  module procedure n_ranks
    n_ranks = 1
    if (is_started()) call mpi_comm_size(mpi_comm_world, n_ranks)
  end procedure n_ranks

  module procedure sum_over_ranks
    real(wp) :: unused(1)

    if (n_ranks() == 1) return
    ! MPI_Allreduce does not promise the same bits on all ranks.
    if (this_rank() == 0) then
      call mpi_reduce(mpi_in_place, values, n, mpi_double_precision, mpi_sum, 0, mpi_comm_world)
    else
      call mpi_reduce(values, unused, n, mpi_double_precision, mpi_sum, 0, mpi_comm_world)
    end if
    call broadcast_reals(0, n, values)
  end procedure sum_over_ranks

  module procedure largest_integers
    if (n_ranks() > 1) call mpi_allreduce(mpi_in_place, values, n, mpi_integer, mpi_max, &
        mpi_comm_world)
  end procedure largest_integers

  module procedure largest_reals
    if (n_ranks() > 1) call mpi_allreduce(mpi_in_place, values, n, mpi_double_precision, mpi_max, &
        mpi_comm_world)
  end procedure largest_reals

  module procedure broadcast_integers
    if (n_ranks() > 1) call mpi_bcast(values, n, mpi_integer, rank, mpi_comm_world)
  end procedure broadcast_integers

  module procedure broadcast_reals
    if (n_ranks() > 1) call mpi_bcast(values, n, mpi_double_precision, rank, mpi_comm_world)
  end procedure broadcast_reals

  module procedure broadcast_text
    if (n_ranks() > 1) call mpi_bcast(text, len(text), mpi_character, rank, mpi_comm_world)
  end procedure broadcast_text

  module procedure exchange_reals
    if (n_ranks() == 1) then
      receive(:n_receive(1)) = send(:n_send(1))
    else
      call mpi_alltoallv(send, n_send, offsets(n_send), mpi_double_precision, receive, n_receive, &
          offsets(n_receive), mpi_double_precision, mpi_comm_world)
    end if
  end procedure exchange_reals

  module procedure gather_reals
    if (n_ranks() == 1) then
      all(:n(1)) = own(:n(1))
    else
      call mpi_gatherv(own, n(this_rank() + 1), mpi_double_precision, all, n, offsets(n), &
          mpi_double_precision, 0, mpi_comm_world)
    end if
  end procedure gather_reals

  !> Return where the values of each rank begin, 0-based.
  pure function offsets(n)
    !> Number of values of each rank.
    integer, intent(in) :: n(:)
    integer :: offsets(size(n))

    integer :: i

    offsets = [(sum(n(:i - 1)), i=1, size(n))]
  end function offsets

  !> Whether MPI is started: unit tests do without.
  logical function is_started()
    integer(c_int) :: started

    is_started = petsc_initialized(started) == 0
    if (is_started) is_started = started /= 0
  end function is_started

end submodule dd3_parallel_ranks
