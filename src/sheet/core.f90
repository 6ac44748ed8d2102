! SPDX-License-Identifier: GPL-3.0-or-later
!> First step of a cut: the quadrilaterals that stay as they are, and the chains of their edges
!> along the cut, between which and the curves a layer of new quadrilaterals is put. The border of
!> what stays follows the grid in steps.
!> Source: Schneiders, Finite Elem. Anal. Des. 25 (1997) 13-35 (grid-based meshes of hexahedra: a
!> core of the grid and a layer that connects it with the boundary).
module dd3_sheet_core
  use dd3_base_kinds, only : wp
  use dd3_sheet_cut_function, only : cut_function_t
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_location, only : corner_sign
  implicit none
  private
  public :: chain_t, columns_that_stay, select_core, find_chains

  !> Least distance of a corner of the core from the cut along an edge, over its length: the new
  !> layer is at least as wide.
  real(wp), parameter :: least_width = 0.4_wp

  !> Edges along the cut that follow one another; what stays is on their left.
  type :: chain_t
    !> Columns in order; the first is not repeated at the end of a closed chain.
    integer, allocatable :: column(:)
    logical :: closed = .false.
  end type chain_t

contains

  !> Return which columns stay.
  pure function columns_that_stay(cut) result(stays)
    type(cut_function_t), intent(in) :: cut
    logical :: stays(size(cut%plane, 2))

    integer :: c

    do c = 1, size(stays)
      stays(c) = cut%value_at(cut%plane(:, c)) > 0.0_wp
    end do
  end function columns_that_stay

  !> Select the quadrilaterals whose corners stay and are not too close to the cut, without those
  !> that hang on the others by a corner.
  pure subroutine select_core(cut, stays, kept)
    type(cut_function_t), intent(in) :: cut
    logical, intent(in) :: stays(:)
    logical, intent(out) :: kept(:)

    real(wp) :: zero(2)
    logical :: far(cut%grid%n_column), changed
    integer :: c, i, k, q

    associate (grid => cut%grid)
      far = stays
      do q = 1, grid%n_quad
        do i = 1, 4
          k = mod(i, 4) + 1
          if (stays(grid%corner(i, q)) .eqv. stays(grid%corner(k, q))) cycle
          zero = cut%zero_on_edge(q, i)
          if (norm2(zero - corner_sign(:, i)) < 2.0_wp*least_width) far(grid%corner(i, q)) = .false.
          if (norm2(zero - corner_sign(:, k)) < 2.0_wp*least_width) far(grid%corner(k, q)) = .false.
        end do
      end do
      do q = 1, grid%n_quad
        kept(q) = all(far(grid%corner(:, q)))
      end do
      do
        changed = .false.
        do c = 1, grid%n_column
          call drop_fans(grid, c, kept, changed)
        end do
        if (.not. changed) exit
      end do
      call drop_pieces(grid, stays, kept)
    end associate
  end subroutine select_core

  !> Drop all but the largest of the pieces of the core within each part of the sheet that stays.
  pure subroutine drop_pieces(grid, stays, kept)
    type(grid_t), intent(in) :: grid
    logical, intent(in) :: stays(:)
    logical, intent(inout) :: kept(:)

    integer :: part(grid%n_quad), piece(grid%n_quad), number(grid%n_quad), largest(grid%n_quad), q

    call label(grid, [(any(stays(grid%corner(:, q))), q=1, grid%n_quad)], part, stays)
    call label(grid, kept, piece)
    number = 0
    do q = 1, grid%n_quad
      if (kept(q)) number(piece(q)) = number(piece(q)) + 1
    end do
    largest = 0
    do q = 1, grid%n_quad
      if (.not. kept(q)) cycle
      associate (most => largest(part(q)))
        if (most == 0) then
          most = piece(q)
        else if (number(piece(q)) > number(most)) then
          most = piece(q)
        end if
      end associate
    end do
    do q = 1, grid%n_quad
      if (kept(q)) kept(q) = piece(q) == largest(part(q))
    end do
  end subroutine drop_pieces

  !> Label quadrilaterals that are connected by edges.
  pure subroutine label(grid, member, name, stays)
    type(grid_t), intent(in) :: grid
    logical, intent(in) :: member(:)
    !> The number of a quadrilateral of the same piece; 0 for one that is no member.
    integer, intent(out) :: name(:)
    !> If given, only edges with an end that stays connect.
    logical, intent(in), optional :: stays(:)

    integer :: stack(grid%n_quad), across(3), n, q, i, k, first

    name = 0
    do first = 1, grid%n_quad
      if (.not. member(first) .or. name(first) > 0) cycle
      n = 1
      stack(1) = first
      name(first) = first
      do while (n > 0)
        q = stack(n)
        n = n - 1
        do i = 1, 4
          if (present(stays)) then
            if (.not. any(stays(grid%corner([i, mod(i, 4) + 1], q)))) cycle
          end if
          across = [grid%neighbour(i, q), grid%over_bound(:, i, q)]
          do k = 1, 3
            if (across(k) == 0) cycle
            if (.not. member(across(k)) .or. name(across(k)) > 0) cycle
            name(across(k)) = first
            n = n + 1
            stack(n) = across(k)
          end do
        end do
      end do
    end do
  end subroutine label

  !> Drop all but the largest of the groups of quadrilaterals at a column that have no edge in
  !> common.
  pure subroutine drop_fans(grid, column, kept, changed)
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: column
    logical, intent(inout) :: kept(:)
    logical, intent(inout) :: changed

    integer :: group(grid%first(column + 1) - grid%first(column)), i, j, n
    logical :: joined

    associate (quad => grid%quad_at(grid%first(column):grid%first(column + 1) - 1))
      n = size(quad)
      group = merge([(i, i=1, n)], 0, kept(quad))
      do
        joined = .false.
        do i = 1, n
          do j = 1, n
            if (group(i) == 0 .or. group(j) == 0 .or. group(i) >= group(j)) cycle
            if (.not. (any(grid%neighbour(:, quad(i)) == quad(j)) .or. &
                any(grid%over_bound(:, :, quad(i)) == quad(j)))) cycle
            group(j) = group(i)
            joined = .true.
          end do
        end do
        if (.not. joined) exit
      end do
      i = largest_group(group)
      do j = 1, n
        if (group(j) == 0 .or. group(j) == i) cycle
        kept(quad(j)) = .false.
        changed = .true.
      end do
    end associate
  end subroutine drop_fans

  !> Return the number that occurs most often, 0 apart; of several the smallest.
  pure integer function largest_group(group)
    integer, intent(in) :: group(:)

    integer :: i, most

    most = 0
    largest_group = 0
    do i = 1, size(group)
      if (count(group == i) <= most) cycle
      most = count(group == i)
      largest_group = i
    end do
  end function largest_group

  !> Find the chains of edges between quadrilaterals that stay and those that go.
  pure subroutine find_chains(grid, kept, chain)
    type(grid_t), intent(in) :: grid
    logical, intent(in) :: kept(:)
    type(chain_t), allocatable, intent(out) :: chain(:)

    integer :: next(grid%n_column), before(grid%n_column), path(grid%n_column)
    logical :: used(grid%n_column)
    integer :: c, i, q, n, turn

    next = 0
    before = 0
    do q = 1, grid%n_quad
      if (.not. kept(q)) cycle
      do i = 1, 4
        if (grid%neighbour(i, q) == 0) cycle
        if (kept(grid%neighbour(i, q))) cycle
        next(grid%corner(i, q)) = grid%corner(mod(i, 4) + 1, q)
        before(grid%corner(mod(i, 4) + 1, q)) = grid%corner(i, q)
      end do
    end do
    allocate (chain(0))
    used = .false.
    ! Open chains begin where none comes before; the rest are closed.
    do turn = 1, 2
      do c = 1, grid%n_column
        if (next(c) == 0 .or. used(c) .or. (turn == 1 .and. before(c) > 0)) cycle
        n = 0
        i = c
        do
          n = n + 1
          path(n) = i
          used(i) = .true.
          i = next(i)
          if (i == 0 .or. i == c) exit
        end do
        chain = [chain, chain_t(path(:n), turn == 2)]
      end do
    end do
  end subroutine find_chains

end module dd3_sheet_core
