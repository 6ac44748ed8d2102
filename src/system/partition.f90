! SPDX-License-Identifier: GPL-3.0-or-later
!> Rows of the system among the ranks. Each rank adds its elements and contact points to the rows of
!> their nodes; the rows of nodes that belong to another rank are sent there and added.
module dd3_system_partition
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_integers, broadcast_reals, exchange_reals, n_ranks, &
      rank_of_smallest, sum_over_ranks, this_rank
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_matrix, only : block_matrix_t, lists_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: partition_t, new_partition, rows_held, share_verdict

  !> Exchange of rows: a list for each rank, of its rows to which this one adds, and of the rows of
  !> this rank to which it adds. Not allocated if there is one rank.
  type :: partition_t
    type(lists_t), private :: sent, received
    !> Whether every rank gets all rows and solves the whole system, as that of a region.
    logical :: gathers = .false.
  contains
    procedure :: complete_rows
    procedure :: complete_forces
    procedure :: share_solution
  end type partition_t

contains

  !> Return the rows that this rank holds: those of its nodes and of the nodes to whose rows it
  !> adds, and those of the pressed tools, to which all ranks add.
  function rows_held(model, n_row) result(held)
    type(model_t), intent(in) :: model
    integer, intent(in) :: n_row
    !> `(n_row)`.
    logical, allocatable :: held(:)

    integer :: rank

    allocate (held(n_row), source=.true.)
    if (.not. model%part%divided) return
    rank = this_rank()
    held(:model%n_node) = model%part%node_owner == rank
    held(:model%n_node) = held(:model%n_node) .or. &
        model%part%holds_node(model%coupling, model%n_bound > 0, rank)
  end function rows_held

  !> Find the rows to be exchanged.
  subroutine new_partition(self, model)
    type(partition_t), intent(out) :: self
    type(model_t), intent(in) :: model

    logical, allocatable :: mine(:), theirs(:)
    integer :: rank, this

    if (.not. model%part%divided) return
    self%sent%start = [1]
    self%received%start = [1]
    allocate (self%sent%item(0), self%received%item(0))
    this = this_rank()
    mine = model%part%holds_node(model%coupling, model%n_bound > 0, this)
    do rank = 0, n_ranks() - 1
      theirs = model%part%holds_node(model%coupling, model%n_bound > 0, rank)
      associate (owner => model%part%node_owner)
        call add_list(self%sent, mine .and. owner == rank .and. rank /= this)
        call add_list(self%received, theirs .and. owner == this .and. rank /= this)
      end associate
    end do
  end subroutine new_partition

  !> Add the list of the rows marked.
  subroutine add_list(lists, marked)
    type(lists_t), intent(inout) :: lists
    logical, intent(in) :: marked(:)

    integer :: i

    lists%item = [lists%item, pack([(i, i=1, size(marked))], marked)]
    lists%start = [lists%start, size(lists%item) + 1]
  end subroutine add_list

  !> Add to the rows of this rank what the other ranks hold of them. The rows of other ranks are not
  !> complete, and not to be used.
  subroutine complete_rows(self, matrix)
    class(partition_t), intent(in) :: self
    type(block_matrix_t), intent(inout) :: matrix

    real(wp), allocatable :: sent(:, :, :), received(:, :, :)
    integer, allocatable :: n_sent(:), n_received(:)
    integer :: i, n, at

    if (self%gathers) call sum_over_ranks(size(matrix%value), matrix%value)
    if (.not. allocated(self%sent%item)) return
    n_sent = counts(self%sent, matrix)
    n_received = counts(self%received, matrix)
    allocate (sent(3, 3, sum(n_sent)), received(3, 3, sum(n_received)))
    at = 0
    do i = 1, size(self%sent%item)
      associate (first => matrix%row_start(self%sent%item(i)), &
          last => matrix%row_start(self%sent%item(i) + 1) - 1)
        n = last - first + 1
        sent(:, :, at + 1:at + n) = matrix%value(:, :, first:last)
      end associate
      at = at + n
    end do
    call exchange_reals(9*n_sent, sent, 9*n_received, received)
    at = 0
    do i = 1, size(self%received%item)
      associate (first => matrix%row_start(self%received%item(i)), &
          last => matrix%row_start(self%received%item(i) + 1) - 1)
        n = last - first + 1
        matrix%value(:, :, first:last) = matrix%value(:, :, first:last) &
            + received(:, :, at + 1:at + n)
      end associate
      at = at + n
    end do
  end subroutine complete_rows

  !> Return the number of blocks in the rows of each rank's list.
  pure function counts(lists, matrix)
    type(lists_t), intent(in) :: lists
    type(block_matrix_t), intent(in) :: matrix
    integer :: counts(size(lists%start) - 1)

    integer :: i

    do i = 1, size(counts)
      associate (row => lists%item(lists%start(i):lists%start(i + 1) - 1))
        counts(i) = sum(matrix%row_start(row + 1) - matrix%row_start(row))
      end associate
    end do
  end function counts

  !> Add to the forces on the nodes of this rank what the other ranks hold of them. Those on other
  !> nodes are not complete, and not to be used.
  subroutine complete_forces(self, n_node, force)
    class(partition_t), intent(in) :: self
    integer, intent(in) :: n_node
    !> What of a node's force no element or contact point has, its rank alone holds.
    real(wp), intent(inout) :: force(3, n_node)

    real(wp), allocatable :: received(:, :)
    integer :: i

    if (self%gathers) call sum_over_ranks(size(force), force)
    if (.not. allocated(self%sent%item)) return
    allocate (received(3, size(self%received%item)))
    associate (sent => self%sent%start, from => self%received%start)
      call exchange_reals(3*(sent(2:) - sent(:size(sent) - 1)), force(:, self%sent%item), &
          3*(from(2:) - from(:size(from) - 1)), received)
    end associate
    do i = 1, size(received, 2)
      associate (node => self%received%item(i))
        force(:, node) = force(:, node) + received(:, i)
      end associate
    end do
  end subroutine complete_forces

  !> Give all ranks the solution of the first one where each has solved the whole system.
  subroutine share_solution(self, solution)
    class(partition_t), intent(in) :: self
    real(wp), intent(inout) :: solution(:)

    if (self%gathers) call broadcast_reals(0, size(solution), solution)
  end subroutine share_solution

  !> Give all ranks the verdict of the failed element with the lowest number; converged if none
  !> failed.
  subroutine share_verdict(verdict)
    type(verdict_t), intent(inout) :: verdict

    integer, allocatable :: bits(:)
    integer :: rank

    if (n_ranks() == 1) return
    rank = rank_of_smallest(merge(1.0_wp, 0.0_wp, verdict%outcome == verdict_converged), &
        verdict%element)
    bits = transfer(verdict, [0])
    call broadcast_integers(rank, size(bits), bits)
    verdict = transfer(bits, verdict)
  end subroutine share_verdict

end module dd3_system_partition
