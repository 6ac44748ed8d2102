! SPDX-License-Identifier: GPL-3.0-or-later
!> Count what processes exchange: parts of a square sheet in one layer of elements, from 1 to 64.
!>
!>     benchmark_parts [elements along an edge]
!>
!> Columns: parts; largest number of elements in a part over the mean; edges of the graph of nodes
!> that are cut, per cent; nodes of the elements of a part that belong to other parts, on average
!> and at most; neighbours at most; bytes of rows that a part sends in an iteration at most, MB;
!> bytes of all values at the nodes that are summed over the parts in an iteration, MB (internal
!> forces, solution). Then the complete factorisation: largest front,
!> operations, and how often the operations on the longest path of the tree of fronts are contained
!> in all: a bound of the speed-up where each front is on one process.
program benchmark_parts
  use dd3_base_kinds, only : i8, wp
  use dd3_linalg_front_tree, only : front_tree_t, new_front_tree, rows_of
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern
  use dd3_linalg_metis, only : partition_graph
  implicit none

  !> Sums over the parts of values at all nodes in an iteration.
  integer, parameter :: sums = 2
  real(wp), parameter :: megabyte = 1.0e6_wp
  type(block_matrix_t) :: graph
  integer, allocatable :: connectivity(:, :), owner(:)
  character(len=20) :: argument
  integer :: n, parts
  logical :: found

  n = 447
  call get_command_argument(1, argument)
  if (argument /= "") read (argument, *) n
  call make_sheet(n, connectivity)
  call new_pattern(graph, 2*(n + 1)**2, connectivity)
  print '(a, i0, a, i0, a)', "sheet of ", size(connectivity, 2), " elements, ", graph%n, " nodes"
  print '(a)', "parts  imbalance  cut %  ghosts mean  most  neighbours  rows MB  sums MB"
  allocate (owner(graph%n), source=0)
  parts = 1
  do while (parts <= 64)
    ! METIS divides by the logarithm of the number of parts.
    if (parts > 1) call partition_graph(graph, parts, owner, found)
    if (parts > 1 .and. .not. found) error stop "this benchmark needs METIS"
    call count_part(parts)
    parts = 2*parts
  end do
  call count_fronts()

contains

  !> Make the elements of a square sheet.
  subroutine make_sheet(n, connectivity)
    integer, intent(in) :: n
    integer, allocatable, intent(out) :: connectivity(:, :)

    integer :: i, j, a

    allocate (connectivity(8, n*n))
    do j = 1, n
      do i = 1, n
        a = (j - 1)*(n + 1) + i
        associate (lower => [a, a + 1, a + n + 2, a + n + 1])
          connectivity(:, (j - 1)*n + i) = [lower, lower + (n + 1)**2]
        end associate
      end do
    end do
  end subroutine make_sheet

  !> Print the counts of a partition.
  subroutine count_part(parts)
    integer, intent(in) :: parts

    logical :: holds(graph%n), beside(0:parts - 1)
    integer :: elements(0:parts - 1), ghosts(0:parts - 1), part, e, i, neighbours
    integer(i8) :: cut, blocks(0:parts - 1)

    cut = 0
    do i = 1, graph%n
      associate (column => graph%column(graph%row_start(i):graph%row_start(i + 1) - 1))
        cut = cut + count(owner(column) /= owner(i))
      end associate
    end do
    neighbours = 0
    do part = 0, parts - 1
      holds = .false.
      elements(part) = 0
      do e = 1, size(connectivity, 2)
        if (owner(connectivity(1, e)) /= part) cycle
        elements(part) = elements(part) + 1
        holds(connectivity(:, e)) = .true.
      end do
      holds = holds .and. owner /= part
      ghosts(part) = count(holds)
      beside = .false.
      blocks(part) = 0
      do i = 1, graph%n
        if (.not. holds(i)) cycle
        beside(owner(i)) = .true.
        blocks(part) = blocks(part) + graph%row_start(i + 1) - graph%row_start(i)
      end do
      neighbours = max(neighbours, count(beside))
    end do
    print '(i5, f11.3, f7.2, f13.0, i6, i12, f9.2, f9.1)', parts, &
        real(maxval(elements), wp)*real(parts, wp)/real(sum(elements), wp), &
        100.0_wp*real(cut, wp)/real(size(graph%column), wp), &
        real(sum(ghosts), wp)/real(parts, wp), maxval(ghosts), neighbours, &
        72.0_wp*real(maxval(blocks), wp)/megabyte, &
        real(sums, wp)*24.0_wp*real(graph%n, wp)/megabyte
  end subroutine count_part

  !> Print the counts of the factorisation.
  subroutine count_fronts()
    type(front_tree_t) :: tree
    real(wp), allocatable :: longest(:)
    real(wp) :: p, u, total
    integer :: f, largest

    call new_front_tree(tree, graph)
    allocate (longest(size(tree%parent)), source=0.0_wp)
    total = 0.0_wp
    largest = 0
    do f = 1, size(tree%parent)
      p = 3.0_wp*real(tree%first(f + 1) - tree%first(f), wp)
      u = 3.0_wp*real(rows_of(tree, f), wp) - p
      associate (operations => 2.0_wp/3.0_wp*p**3 + 2.0_wp*p**2*u + 2.0_wp*p*u**2, &
          parent => tree%parent(f))
        total = total + operations
        longest(f) = longest(f) + operations
        if (parent > 0) longest(parent) = max(longest(parent), longest(f))
      end associate
      largest = max(largest, rows_of(tree, f))
    end do
    print '(a, i0, a, f0.1, a, f0.1)', "largest front ", 3*largest, " rows, ", total/1.0e9_wp, &
        "e9 operations, over those of the longest path: ", total/maxval(longest)
  end subroutine count_fronts

end program benchmark_parts
