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
      broadcast_text, exchange_reals, gather_reals
  public :: rank_of_smallest, any_rank, count_over_ranks, norm_over_ranks, agreed

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

    !> Replace each integer by the largest on any rank.
    module subroutine largest_integers(n, values)
      integer, intent(in) :: n
      integer, intent(inout) :: values(n)
    end subroutine largest_integers

    !> Replace each real by the largest on any rank.
    module subroutine largest_reals(n, values)
      integer, intent(in) :: n
      real(wp), intent(inout) :: values(n)
    end subroutine largest_reals

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

  !> Replace each value by the largest on any rank.
  interface largest_over_ranks
    procedure :: largest_integers, largest_reals
  end interface largest_over_ranks

contains

  !> Whether a condition holds on any rank.
  logical function any_rank(condition)
    logical, intent(in) :: condition

    integer :: number(1)

    number = merge(1, 0, condition)
    call largest_over_ranks(1, number)
    any_rank = number(1) > 0
  end function any_rank

  !> Return the number of items of all ranks.
  integer function count_over_ranks(n)
    !> Items of this rank.
    integer, intent(in) :: n

    real(wp) :: total(1)

    total = real(n, wp)
    call sum_over_ranks(1, total)
    count_over_ranks = nint(total(1))
  end function count_over_ranks

  !> Return the value of rank 0 of what all ranks evaluate from the same data, before they decide on
  !> it: on processors of different kinds the last bits can differ.
  real(wp) function agreed(value)
    real(wp), intent(in) :: value

    real(wp) :: values(1)

    values = value
    call broadcast_reals(0, 1, values)
    agreed = values(1)
  end function agreed

  !> Return the Euclidean norm of a vector of which each rank has some components.
  real(wp) function norm_over_ranks(own)
    !> Norm of the components of this rank.
    real(wp), intent(in) :: own

    real(wp) :: square(1)

    norm_over_ranks = own
    if (n_ranks() == 1) return
    square = own**2
    call sum_over_ranks(1, square)
    norm_over_ranks = sqrt(square(1))
  end function norm_over_ranks

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
