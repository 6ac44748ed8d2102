! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of the sheet that a rank holds: its elements, with the values at their integration points,
!> its contact points, and the rows of the linear system of its nodes. The vectors at the nodes,
!> mesh and tools are on all ranks.
module dd3_model_part
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : gather_reals, n_ranks, this_rank
  use dd3_base_text, only : to_text
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern
  use dd3_linalg_partition, only : divide_rows
  implicit none
  private
  public :: part_t, new_part, of_elements, of_points

  !> What an item of values is.
  integer, parameter :: of_elements = 1, of_points = 2

  !> Part of a rank. A number of an element "in the part" counts those of this rank.
  type :: part_t
    !> Whether there are several ranks.
    logical :: divided = .false.
    !> Elements of this rank, ascending, and the number of each element in the part, `(n_element)`;
    !> 0 for one of another rank.
    integer, allocatable :: element(:), place(:)
    !> Rank of each element, `(n_element)`, and of each node, `(n_node)`, from 0.
    integer, allocatable :: owner(:), node_owner(:)
    !> Number of contact points of the sheet, and the rank of each.
    integer :: n_point = 0
    integer, allocatable :: point_owner(:)
  contains
    procedure :: divide => part_divide
    procedure :: ranks_of => part_ranks_of
    procedure :: own => part_own
    procedure :: gather => part_gather
    procedure :: holds_node => part_holds_node
    procedure :: report => part_report
  end type part_t

contains

  !> Make the part that is the whole sheet.
  subroutine new_part(self, n_node, n_element)
    type(part_t), intent(out) :: self
    integer, intent(in) :: n_node, n_element

    integer :: e

    allocate (self%node_owner(n_node), self%owner(n_element), source=0)
    self%element = [(e, e=1, n_element)]
    self%place = self%element
  end subroutine new_part

  !> Divide the sheet, if there are several ranks: the nodes by their graph, each element to the
  !> rank of its first node.
  subroutine part_divide(self, connectivity)
    !> Whole.
    class(part_t), intent(inout) :: self
    !> Nodes that the forces of each element act on, its own first, `(n, n_element)`.
    integer, intent(in) :: connectivity(:, :)

    type(block_matrix_t) :: graph
    integer :: e

    if (n_ranks() == 1) return
    self%divided = .true.
    call new_pattern(graph, size(self%node_owner), connectivity)
    call divide_rows(graph, self%node_owner)
    self%owner = self%node_owner(connectivity(1, :))
    self%element = self%own(of_elements)
    self%place = 0
    self%place(self%element) = [(e, e=1, size(self%element))]
  end subroutine part_divide

  !> Whether a rank adds to the row of a node: it is a node of its elements, or, in a mesh with
  !> bound nodes, of an element with a node of its own, from where rows and columns go to the
  !> parents.
  function part_holds_node(self, connectivity, has_bound, rank) result(holds)
    class(part_t), intent(in) :: self
    !> Nodes that the forces of each element act on, `(n, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    !> Whether there are bound nodes.
    logical, intent(in) :: has_bound
    integer, intent(in) :: rank
    !> `(n_node)`.
    logical, allocatable :: holds(:)

    logical :: adds
    integer :: e

    allocate (holds(size(self%node_owner)), source=.false.)
    do e = 1, size(self%owner)
      adds = self%owner(e) == rank
      if (has_bound) adds = adds .or. any(self%node_owner(connectivity(:, e)) == rank)
      if (adds) holds(connectivity(:, e)) = .true.
    end do
  end function part_holds_node

  !> Return the rank of each of all elements or contact points.
  pure function part_ranks_of(self, item) result(owner)
    class(part_t), intent(in) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    integer, allocatable :: owner(:)

    if (item == of_elements) then
      owner = self%owner
    else
      owner = self%point_owner
    end if
  end function part_ranks_of

  !> Return the elements or contact points of this rank, ascending, in the numbering of all.
  function part_own(self, item) result(own)
    class(part_t), intent(in) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    integer, allocatable :: own(:)

    integer :: i, rank

    rank = this_rank()
    associate (owner => self%ranks_of(item))
      own = pack([(i, i=1, size(owner))], owner == rank .or. .not. self%divided)
    end associate
  end function part_own

  !> Gather values of the elements or contact points on rank 0.
  subroutine part_gather(self, item, n, n_own, own, all)
    class(part_t), intent(in) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    !> Number of values of an item, and of the items of this rank.
    integer, intent(in) :: n, n_own
    !> Values of the items of this rank.
    real(wp), intent(in) :: own(n, n_own)
    !> Values of all items, `(n, n_item)`; `(n, 0)` on the other ranks.
    real(wp), allocatable, intent(out) :: all(:, :)

    real(wp), allocatable :: received(:)
    integer, allocatable :: owner(:), of_rank(:), next(:), from(:)
    integer :: rank, e, i

    if (.not. self%divided) then
      all = own
      return
    end if
    owner = self%ranks_of(item)
    of_rank = [(count(owner == rank), rank=0, n_ranks() - 1)]
    next = [(sum(of_rank(:rank - 1)) + 1, rank=1, size(of_rank))]
    allocate (from(size(owner)), received(merge(size(owner), 0, this_rank() == 0)))
    do e = 1, size(from)
      associate (at => next(owner(e) + 1))
        from(e) = at
        at = at + 1
      end associate
    end do
    allocate (all(n, size(received)))
    ! One value of all items at a time, which needs little memory.
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
