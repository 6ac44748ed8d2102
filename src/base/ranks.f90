! SPDX-License-Identifier: GPL-3.0-or-later
!> Ranks: processes, on one or several machines, that run one job together (MPI). Every rank runs
!> the whole program on the same input. Work that is divided among them is exchanged here, so that
!> all ranks decide on the same data. Only rank 0 writes. The procedures must be called by all ranks
!> in the same order; with one rank, or built without MPI, they change nothing.
module dd3_base_ranks
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: start_ranks, end_ranks, this_rank, n_ranks, ranks_present
  public :: sum_over_ranks, largest_over_ranks, broadcast_integers, broadcast_reals, &
      broadcast_text, exchange_reals, gather_reals, rank_of_smallest

  ! Implemented in src/parallel/ranks.f90 or, without MPI, in cmake/absent/ranks.f90.
  interface
    !> Whether the program was built with MPI and PETSc.
    logical module function ranks_present()
    end function ranks_present

    !> Start MPI and PETSc; no-op if they are started.
    module subroutine start_ranks()
    end subroutine start_ranks

    !> End PETSc and MPI.
    module subroutine end_ranks()
    end subroutine end_ranks

    !> Return the number of this rank, from 0.
    integer module function this_rank()
    end function this_rank

    !> Return the number of ranks.
    integer module function n_ranks()
    end function n_ranks

    !> Replace each value by its sum over the ranks.
    module subroutine sum_over_ranks(n, values)
      integer, intent(in) :: n
      real(wp), intent(inout) :: values(n)
    end subroutine sum_over_ranks

    !> Replace each value by the largest on any rank.
    module subroutine largest_over_ranks(n, values)
      integer, intent(in) :: n
      integer, intent(inout) :: values(n)
    end subroutine largest_over_ranks

    !> Replace integers by those of one rank.
    module subroutine broadcast_integers(rank, n, values)
      integer, intent(in) :: rank, n
      integer, intent(inout) :: values(n)
    end subroutine broadcast_integers

    !> Replace reals by those of one rank.
    module subroutine broadcast_reals(rank, n, values)
      integer, intent(in) :: rank, n
      real(wp), intent(inout) :: values(n)
    end subroutine broadcast_reals

    !> Replace a text by that of one rank.
    module subroutine broadcast_text(rank, text)
      integer, intent(in) :: rank
      !> Has the same length on all ranks.
      character(len=*), intent(inout) :: text
    end subroutine broadcast_text

    !> Send each rank some values and receive some from each.
    module subroutine exchange_reals(n_send, send, n_receive, receive)
      !> Numbers of values for and from each rank, `(n_ranks)`.
      integer, intent(in) :: n_send(:), n_receive(:)
      !> By ranks.
      real(wp), intent(in) :: send(*)
      real(wp), intent(inout) :: receive(*)
    end subroutine exchange_reals

    !> Gather values of all ranks on rank 0.
    module subroutine gather_reals(n, own, all)
      !> Number of values of each rank, `(n_ranks)`.
      integer, intent(in) :: n(:)
      real(wp), intent(in) :: own(*)
      !> By ranks; only set on rank 0.
      real(wp), intent(inout) :: all(*)
    end subroutine gather_reals
  end interface

contains

  !> Return the rank with the smallest value; of equal ones that with the smaller number, and the
  !> lowest of equal ranks.
  integer function rank_of_smallest(value, number) result(rank)
    real(wp), intent(in) :: value
    integer, intent(in) :: number

    real(wp), allocatable :: values(:), numbers(:)

    allocate (values(n_ranks()), numbers(n_ranks()), source=0.0_wp)
    values(this_rank() + 1) = value
    numbers(this_rank() + 1) = real(number, wp)
    call sum_over_ranks(size(values), values)
    call sum_over_ranks(size(numbers), numbers)
    rank = minloc(numbers, dim=1, mask=values <= minval(values)) - 1
  end function rank_of_smallest

end module dd3_base_ranks
