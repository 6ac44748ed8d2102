! SPDX-License-Identifier: GPL-3.0-or-later
!> Partition of the work among the ranks. Each evaluates the elements at the nodes whose rows it
!> holds, so that these rows and the forces on these nodes are complete without an exchange;
!> elements between the nodes of two ranks are evaluated by both, with the same result.
module dd3_system_partition
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_integers, broadcast_reals, largest_over_ranks, n_ranks, &
      rank_of_smallest, sum_over_ranks, this_rank
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_impossible, &
      cause_ranks_differ
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: partition_t, new_partition, partition_report, share_state, share_verdict

  !> Partition of the work.
  type :: partition_t
    !> Whether there are several ranks.
    logical :: divided = .false.
    !> Whether this rank holds each block row, `(n_row)`; whether it evaluates each element and is
    !> the one that hands its results on, `(n_element)`.
    logical, allocatable :: own_row(:), evaluated(:), own_element(:)
  contains
    procedure :: share_nodes
    procedure :: share_elements
    procedure :: check_agreement
  end type partition_t

contains

  !> Derive the partition from that of the rows.
  subroutine new_partition(self, model, matrix)
    type(partition_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(block_matrix_t), intent(in) :: matrix

    integer :: e

    self%divided = allocated(matrix%owner)
    allocate (self%own_row(matrix%n), self%evaluated(model%n_element), &
        self%own_element(model%n_element), source=.true.)
    if (.not. self%divided) return
    self%own_row = matrix%owner == this_rank()
    do e = 1, model%n_element
      self%evaluated(e) = any(self%own_row(model%connectivity(:, e)))
      self%own_element(e) = self%own_row(model%connectivity(1, e))
    end do
  end subroutine new_partition

  !> Return the numbers of elements of the ranks as text.
  function partition_report(self) result(text)
    type(partition_t), intent(in) :: self
    character(len=:), allocatable :: text

    real(wp), allocatable :: counts(:)
    integer :: i

    allocate (counts(n_ranks()), source=0.0_wp)
    counts(this_rank() + 1) = real(count(self%evaluated), wp)
    call sum_over_ranks(size(counts), counts)
    text = to_text(n_ranks())//" ranks, which evaluate of "//to_text(size(self%evaluated))// &
        " elements"
    do i = 1, size(counts)
      text = text//" "//to_text(nint(counts(i)))
    end do
  end function partition_report

  !> Give all ranks the values at the nodes, each from the rank that holds its row.
  subroutine share_nodes(self, values)
    class(partition_t), intent(in) :: self
    !> `(:, n_node)`; size 0 is allowed.
    real(wp), intent(inout) :: values(:, :)

    if (.not. self%divided .or. size(values) == 0) return
    call share(size(values, 1), size(values, 2), self%own_row, values)
  end subroutine share_nodes

  !> Give all ranks the values of the elements, each from one rank that evaluates it.
  subroutine share_elements(self, n, values)
    class(partition_t), intent(in) :: self
    !> Number of values.
    integer, intent(in) :: n
    !> Those of an element are consecutive.
    real(wp), intent(inout) :: values(n)

    if (.not. self%divided .or. n == 0) return
    associate (n_element => size(self%own_element))
      call share(n/n_element, n_element, self%own_element, values)
    end associate
  end subroutine share_elements

  !> Give all ranks values in groups, of which each rank owns some.
  subroutine share(n_value, n_group, own, values)
    integer, intent(in) :: n_value, n_group
    logical, intent(in) :: own(n_group)
    real(wp), intent(inout) :: values(n_value, n_group)

    integer :: i

    do i = 1, n_group
      if (.not. own(i)) values(:, i) = 0.0_wp
    end do
    call sum_over_ranks(size(values), values)
  end subroutine share

  !> Check that all ranks have the same value, to the bit: they have evaluated the contact of their
  !> copies of the same positions, and processors of different kinds can differ.
  subroutine check_agreement(self, value, verdict)
    class(partition_t), intent(in) :: self
    real(wp), intent(in) :: value
    !> Impossible if they differ; unchanged otherwise.
    type(verdict_t), intent(inout) :: verdict

    real(wp) :: first(1)
    integer :: differs(1)

    if (.not. self%divided) return
    first = value
    call broadcast_reals(0, 1, first)
    differs = merge(1, 0, abs(value - first(1)) > 0.0_wp)
    call largest_over_ranks(1, differs)
    if (differs(1) == 0) return
    verdict%outcome = verdict_impossible
    verdict%cause = cause_ranks_differ
  end subroutine check_agreement

  !> Give all ranks the state at the integration points of all elements.
  subroutine share_state(self, state)
    type(partition_t), intent(in) :: self
    type(state_t), intent(inout) :: state

    real(wp), allocatable :: plastic(:, :)

    if (.not. self%divided) return
    call self%share_elements(size(state%stress), state%stress)
    call self%share_elements(size(state%internal_variables), state%internal_variables)
    call self%share_elements(size(state%orientation), state%orientation)
    plastic = merge(1.0_wp, 0.0_wp, state%plastic)
    call self%share_elements(size(plastic), plastic)
    state%plastic = plastic > 0.5_wp
  end subroutine share_state

  !> Give all ranks the verdict of the failed element with the lowest number; converged if none
  !> failed.
  subroutine share_verdict(self, verdict)
    type(partition_t), intent(in) :: self
    type(verdict_t), intent(inout) :: verdict

    integer, allocatable :: bits(:)
    integer :: rank

    if (.not. self%divided) return
    rank = rank_of_smallest(merge(1.0_wp, 0.0_wp, verdict%outcome == verdict_converged), &
        verdict%element)
    bits = transfer(verdict, [0])
    call broadcast_integers(rank, size(bits), bits)
    verdict = transfer(bits, verdict)
  end subroutine share_verdict

end module dd3_system_partition
