! SPDX-License-Identifier: GPL-3.0-or-later
!> Branches of the tree of fronts for the threads, and the workspace of a branch. A branch is a
!> front with all that comes before it in the tree, a sequence in postorder; branches do not depend
!> on one another. The fronts that are in no branch form the trunk.
module dd3_linalg_front_branches
  use dd3_base_kinds, only : wp, i8
  use dd3_base_sorting, only : ascending
  use dd3_linalg_front_tree, only : front_tree_t, rows_of
  implicit none
  private
  public :: front_work_t, find_branches, front_products, border_size

  !> Number of branches per thread that is aimed at, and the smallest fraction of a branch of that
  !> size that is worth a thread's while.
  real(wp), parameter :: per_thread = 3.0_wp, smallest = 0.05_wp

  !> Workspace of a branch, or of the trunk.
  type :: front_work_t
    !> First and last front.
    integer :: first = 0, last = 0
    !> Borders that wait for their parents, on two stacks that grow towards one another: those of
    !> fronts at an even depth in the tree and those at an odd one, so that a border is made on the
    !> one while those that go into it are on top of the other.
    real(wp), allocatable :: border(:)
    !> Number of fronts shifted in the last factorisation, and front that it failed at; 0 for none.
    integer :: shifted = 0, failed = 0
  end type front_work_t

contains

  !> Find the branches, the largest first, and allocate their workspaces and that of the trunk.
  subroutine find_branches(tree, threads, branch_of, border_at, work)
    type(front_tree_t), intent(in) :: tree
    integer, intent(in) :: threads
    !> Branch of each front, `(n_front)`; 0 for the trunk.
    integer, allocatable, intent(out) :: branch_of(:)
    !> Where the border of each front begins in the workspace of its branch, `(n_front)`.
    integer(i8), allocatable, intent(out) :: border_at(:)
    !> Number 0 is the trunk's.
    type(front_work_t), allocatable, intent(out) :: work(:)

    real(wp), allocatable :: total(:)
    integer, allocatable :: first(:), root(:), side(:)
    real(wp) :: limit
    integer :: f, b

    call sum_up(tree, total, first)
    limit = sum(total, mask=tree%parent == 0)/(per_thread*real(threads, wp))
    root = pack([(f, f=1, tree%n_front)], total <= limit .and. total >= smallest*limit &
        .and. total_above(tree, total) > limit .and. threads > 1)
    root = root(ascending(-total(root)))
    allocate (branch_of(tree%n_front), source=0)
    allocate (border_at(tree%n_front), work(0:size(root)))
    work(0)%first = 1
    work(0)%last = tree%n_front
    do b = 1, size(root)
      work(b)%first = first(root(b))
      work(b)%last = root(b)
      branch_of(first(root(b)):root(b)) = b
    end do
    side = depth_parity(tree)
    do b = 0, size(root)
      call allocate_work(tree, branch_of, b, side, border_at, work(b))
    end do
  end subroutine find_branches

  !> Sum up the block products of each front and of those before it in the tree.
  pure subroutine sum_up(tree, total, first)
    type(front_tree_t), intent(in) :: tree
    real(wp), allocatable, intent(out) :: total(:)
    !> First front before each one in the tree.
    integer, allocatable, intent(out) :: first(:)

    integer :: f

    total = [(front_products(tree, f), f=1, tree%n_front)]
    first = [(f, f=1, tree%n_front)]
    do f = 1, tree%n_front
      associate (above => tree%parent(f))
        if (above == 0) cycle
        total(above) = total(above) + total(f)
        first(above) = min(first(above), first(f))
      end associate
    end do
  end subroutine sum_up

  !> Return the total of each front's parent; zero for a root, which is never a branch.
  pure function total_above(tree, total) result(above)
    type(front_tree_t), intent(in) :: tree
    real(wp), intent(in) :: total(:)
    real(wp) :: above(size(total))

    integer :: f

    above = 0.0_wp
    do f = 1, tree%n_front
      if (tree%parent(f) > 0) above(f) = total(tree%parent(f))
    end do
  end function total_above

  !> Return whether the depth of each front in the tree is odd, 1, or even, 0.
  pure function depth_parity(tree) result(parity)
    type(front_tree_t), intent(in) :: tree
    integer :: parity(tree%n_front)

    integer :: f

    do f = tree%n_front, 1, -1
      parity(f) = 0
      if (tree%parent(f) > 0) parity(f) = 1 - parity(tree%parent(f))
    end do
  end function depth_parity

  !> Place the borders of a branch in its workspace, and allocate that.
  subroutine allocate_work(tree, branch_of, branch, side, border_at, work)
    type(front_tree_t), intent(in) :: tree
    !> Side of each front: parity of its depth.
    integer, intent(in) :: branch_of(:), branch, side(:)
    integer(i8), intent(inout) :: border_at(:)
    type(front_work_t), intent(inout) :: work

    integer(i8) :: top(0:1), largest
    integer :: f, child

    top = 0
    largest = 1
    do f = work%first, work%last
      if (branch_of(f) /= branch) cycle
      associate (own => side(f))
        border_at(f) = top(own)
        top(own) = top(own) + border_size(tree, f)
        largest = max(largest, sum(top))
        child = tree%last_child(f)
        do while (child > 0)
          if (branch_of(child) == branch) top(1 - own) = border_at(child)
          child = tree%previous(child)
        end do
      end associate
    end do
    do f = work%first, work%last
      if (branch_of(f) /= branch) cycle
      border_at(f) = border_at(f) + 1
      if (side(f) == 1) border_at(f) = largest - border_at(f) - border_size(tree, f) + 2
    end do
    allocate (work%border(largest))
  end subroutine allocate_work

  !> Return the number of entries of a front's square border.
  pure integer(i8) function border_size(tree, f)
    type(front_tree_t), intent(in) :: tree
    integer, intent(in) :: f

    border_size = (3*int(tree%border_start(f + 1) - tree%border_start(f), i8))**2
  end function border_size

  !> Return the number of block products that the elimination of a front's pivots takes.
  pure real(wp) function front_products(tree, f)
    type(front_tree_t), intent(in) :: tree
    integer, intent(in) :: f

    real(wp) :: p, u

    p = real(tree%first(f + 1) - tree%first(f), wp)
    u = real(rows_of(tree, f), wp) - p
    front_products = p**3/3.0_wp + p**2*u + p*u**2
  end function front_products

end module dd3_linalg_front_branches
