! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of the sheet that a rank holds: its elements, with the values at their integration points,
!> and the rows of the linear system of its nodes. Nodes, contact points and tools are on all ranks.
module dd3_model_part
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : gather_reals, n_ranks, this_rank
  use dd3_base_text, only : to_text
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern
  use dd3_linalg_partition, only : divide_rows
  implicit none
  private
  public :: part_t, new_part

  !> Part of a rank. A number of an element "in the part" counts those of this rank.
  type :: part_t
    !> Whether there are several ranks.
    logical :: divided = .false.
    !> Elements of this rank, ascending, and the number of each element in the part, `(n_element)`;
    !> 0 for one of another rank.
    integer, allocatable :: element(:), place(:)
    !> Rank of each element, `(n_element)`, and of each node, `(n_node)`, from 0.
    integer, allocatable :: owner(:), node_owner(:)
  contains
    procedure :: gather => part_gather
    procedure :: holds_node => part_holds_node
    procedure :: report => part_report
  end type part_t

contains

  !> Divide the sheet: the nodes by their graph, each element to the rank of its first node.
  subroutine new_part(self, n_node, connectivity)
    type(part_t), intent(out) :: self
    integer, intent(in) :: n_node
    !> Nodes of each element, `(n_element_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)

    type(block_matrix_t) :: graph
    integer :: e

    self%divided = n_ranks() > 1
    allocate (self%node_owner(n_node), self%place(size(connectivity, 2)), source=0)
    if (self%divided) then
      call new_pattern(graph, n_node, connectivity)
      call divide_rows(graph, self%node_owner)
    end if
    self%owner = self%node_owner(connectivity(1, :))
    self%element = pack([(e, e=1, size(self%owner))], self%owner == this_rank() &
        .or. .not. self%divided)
    self%place(self%element) = [(e, e=1, size(self%element))]
  end subroutine new_part

  !> Whether a node is that of an element of a rank.
  function part_holds_node(self, connectivity, rank) result(holds)
    class(part_t), intent(in) :: self
    !> Of all elements, `(n_element_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    integer, intent(in) :: rank
    !> `(n_node)`.
    logical, allocatable :: holds(:)

    integer :: e

    allocate (holds(size(self%node_owner)), source=.false.)
    do e = 1, size(self%owner)
      if (self%owner(e) == rank) holds(connectivity(:, e)) = .true.
    end do
  end function part_holds_node

  !> Gather values of the elements on rank 0.
  subroutine part_gather(self, n, own, all)
    class(part_t), intent(in) :: self
    !> Number of values of an element.
    integer, intent(in) :: n
    !> Values of the elements of this rank.
    real(wp), intent(in) :: own(n, size(self%element))
    !> Values of all elements, `(n, n_element)`; `(n, 0)` on the other ranks.
    real(wp), allocatable, intent(out) :: all(:, :)

    real(wp), allocatable :: received(:)
    integer, allocatable :: of_rank(:), next(:), from(:)
    integer :: rank, e, i

    if (.not. self%divided) then
      all = own
      return
    end if
    of_rank = [(count(self%owner == rank), rank=0, n_ranks() - 1)]
    next = [(sum(of_rank(:rank - 1)) + 1, rank=1, size(of_rank))]
    allocate (from(size(self%owner)), received(merge(size(self%owner), 0, this_rank() == 0)))
    do e = 1, size(from)
      associate (at => next(self%owner(e) + 1))
        from(e) = at
        at = at + 1
      end associate
    end do
    allocate (all(n, size(received)))
    ! One value of all elements at a time, which needs little memory.
    do i = 1, n
      call gather_reals(of_rank, own(i, :), received)
      if (size(received) > 0) all(i, :) = received(from)
    end do
  end subroutine part_gather

  !> Return the numbers of elements of the ranks as text.
  function part_report(self) result(text)
    class(part_t), intent(in) :: self
    character(len=:), allocatable :: text

    integer :: rank

    text = to_text(n_ranks())//" ranks with"
    do rank = 0, n_ranks() - 1
      text = text//" "//to_text(count(self%owner == rank))
    end do
    text = text//" elements"
  end function part_report

end module dd3_model_part
