! SPDX-License-Identifier: GPL-3.0-or-later
!> Second step of a cut: a point on the curves for each column of a chain, in the order of the chain.
!> The corners of the curves are points of their own, and where a chain ends, at the border of the
!> sheet, so is the crossing of border and curve.
module dd3_sheet_fitting
  use dd3_base_kinds, only : wp
  use dd3_sheet_core, only : chain_t
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_plane_curve, only : is_inside, loop_t, new_loop
  implicit none
  private
  public :: fit_t, fit_chain, orient_loops

  !> Passes that even out the distances along the curve.
  integer, parameter :: n_pass = 10
  !> Distance from a curve at which its sides are told apart, over its length.
  real(wp), parameter :: beside = 1.0e-7_wp

  !> Points of a chain on a curve.
  type :: fit_t
    !> Loop on which they lie; 0 if the chain does not follow a loop.
    integer :: loop = 0
    !> Arc length of each, mm, increasing; decreasing in a mirrored chain.
    real(wp), allocatable :: arc(:)
    !> Points that do not slide: corners and ends.
    logical, allocatable :: fixed(:)
  end type fit_t

contains

  !> Turn the loops so that what stays is on their left.
  pure subroutine orient_loops(loop, keeps_inside)
    type(loop_t), intent(inout) :: loop(:)
    logical, intent(in) :: keeps_inside

    type(loop_t) :: turned
    real(wp) :: side(2), point(2)
    integer :: k, i, n

    do k = 1, size(loop)
      associate (arc => loop(k)%arc)
        i = maxloc(arc(2:) - arc(:size(arc) - 1), dim=1)
      end associate
      n = size(loop(k)%point, 2)
      side = loop(k)%point(:, mod(i, n) + 1) - loop(k)%point(:, i)
      point = loop(k)%point(:, i) + 0.5_wp*side &
          + beside*loop(k)%length()*[-side(2), side(1)]/norm2(side)
      if (is_inside(loop, point) .eqv. keeps_inside) cycle
      call new_loop(turned, loop(k)%point(:, n:1:-1))
      loop(k) = turned
    end do
  end subroutine orient_loops

  !> Find the points of a chain.
  pure subroutine fit_chain(fit, chain_on_sheet, mirrored, grid, kept, loop, plane)
    type(fit_t), intent(out) :: fit
    type(chain_t), intent(in) :: chain_on_sheet
    !> Whether the sheet is seen from below in the plane, where what stays is on the right then.
    logical, intent(in) :: mirrored
    type(grid_t), intent(in) :: grid
    !> Quadrilaterals of the core.
    logical, intent(in) :: kept(:)
    !> Oriented.
    type(loop_t), intent(in) :: loop(:)
    !> Positions of the columns, `(2, n_column)`, mm.
    real(wp), intent(in) :: plane(:, :)

    real(wp) :: arc(size(chain_on_sheet%column)), distance(size(chain_on_sheet%column)), end_arc(2)
    type(chain_t) :: chain
    integer :: ends(2), n
    logical :: found(2)

    chain = chain_on_sheet
    n = size(chain%column)
    if (mirrored) chain%column = chain%column(n:1:-1)
    fit%loop = nearest_loop(chain, loop, plane)
    call project(chain, loop(fit%loop), plane, arc, distance)
    fit%arc = arc
    allocate (fit%fixed(n), source=.false.)
    if (chain%closed) then
      call unwrap(fit, chain, loop(fit%loop), plane, minloc(distance, dim=1))
    else
      ends = chain%column([1, n])
      call find_crossing(grid, kept, loop, plane, ends(1), .not. mirrored, fit%loop, end_arc(1), &
          found(1))
      call find_crossing(grid, kept, loop, plane, ends(2), mirrored, fit%loop, end_arc(2), found(2))
      if (.not. all(found)) then
        fit%loop = 0
        return
      end if
      fit%arc(1) = end_arc(1)
      fit%arc(n) = end_arc(2)
      fit%fixed([1, n]) = .true.
      call unwrap(fit, chain, loop(fit%loop), plane, 1)
    end if
    if (fit%loop > 0) call order_points(fit, chain%closed, loop(fit%loop))
    if (.not. mirrored) return
    fit%arc = fit%arc(n:1:-1)
    fit%fixed = fit%fixed(n:1:-1)
  end subroutine fit_chain

  !> Return the loop that is closest to most columns of a chain.
  pure integer function nearest_loop(chain, loop, plane)
    type(chain_t), intent(in) :: chain
    type(loop_t), intent(in) :: loop(:)
    real(wp), intent(in) :: plane(:, :)

    real(wp) :: arc, distance(size(loop))
    integer :: votes(size(loop)), i, k

    votes = 0
    do i = 1, size(chain%column)
      do k = 1, size(loop)
        call loop(k)%closest(plane(:, chain%column(i)), arc, distance(k))
      end do
      k = minloc(distance, dim=1)
      votes(k) = votes(k) + 1
    end do
    nearest_loop = maxloc(votes, dim=1)
  end function nearest_loop

  !> Project the columns of a chain on a loop.
  pure subroutine project(chain, loop, plane, arc, distance)
    type(chain_t), intent(in) :: chain
    type(loop_t), intent(in) :: loop
    real(wp), intent(in) :: plane(:, :)
    real(wp), intent(out) :: arc(:), distance(:)

    integer :: i

    do i = 1, size(chain%column)
      call loop%closest(plane(:, chain%column(i)), arc(i), distance(i))
    end do
  end subroutine project

  !> Follow the border of the sheet from the end of a chain, through what goes, to its crossing with
  !> a loop.
  pure subroutine find_crossing(grid, kept, loop, plane, column, first, wanted, arc, found)
    type(grid_t), intent(in) :: grid
    logical, intent(in) :: kept(:)
    type(loop_t), intent(in) :: loop(:)
    real(wp), intent(in) :: plane(:, :)
    !> End of the chain, and whether it is its first column.
    integer, intent(in) :: column
    logical, intent(in) :: first
    !> Loop that is crossed.
    integer, intent(in) :: wanted
    real(wp), intent(out) :: arc
    logical, intent(out) :: found

    real(wp) :: fraction
    integer :: here, next, step

    here = column
    found = .false.
    arc = 0.0_wp
    do step = 1, grid%n_quad
      next = beyond(grid, kept, here, first)
      if (next == 0) return
      call loop(wanted)%crossing(plane(:, here), plane(:, next), arc, fraction, found)
      if (found) return
      here = next
    end do
  end subroutine find_crossing

  !> Return the next column on the border of the sheet among the quadrilaterals that go; 0 for none.
  pure integer function beyond(grid, kept, column, forward)
    type(grid_t), intent(in) :: grid
    logical, intent(in) :: kept(:)
    integer, intent(in) :: column
    !> Whether the border is followed counter-clockwise.
    logical, intent(in) :: forward

    integer :: i, k, q

    do k = grid%first(column), grid%first(column + 1) - 1
      q = grid%quad_at(k)
      if (kept(q)) cycle
      i = findloc(grid%corner(:, q), column, dim=1)
      if (.not. forward) i = mod(i + 2, 4) + 1
      if (grid%neighbour(i, q) > 0) cycle
      beyond = grid%corner(merge(mod(i, 4) + 1, i, forward), q)
      return
    end do
    beyond = 0
  end function beyond

  !> Let the arc lengths increase along the chain beyond the length of the loop.
  pure subroutine unwrap(fit, chain, loop, plane, start)
    type(fit_t), intent(inout) :: fit
    type(chain_t), intent(in) :: chain
    type(loop_t), intent(in) :: loop
    real(wp), intent(in) :: plane(:, :)
    !> Position in the chain from which the others are counted.
    integer, intent(in) :: start

    real(wp) :: expected
    integer :: i, j, k, n

    n = size(fit%arc)
    do k = 1, n - 1
      i = mod(start + k - 2, n) + 1
      j = mod(i, n) + 1
      expected = fit%arc(i) + norm2(plane(:, chain%column(j)) - plane(:, chain%column(i)))
      fit%arc(j) = fit%arc(j) + loop%length()*anint((expected - fit%arc(j))/loop%length())
    end do
    if (.not. chain%closed) then
      ! The end lies ahead of the start.
      if (fit%arc(n) <= fit%arc(1)) fit%arc(n) = fit%arc(n) + loop%length()
      if (fit%arc(n) - fit%arc(1) > loop%length()) fit%loop = 0
      return
    end if
    ! The last column comes back to the start after one round.
    i = merge(n, start - 1, start == 1)
    if (abs(fit%arc(i) - fit%arc(start) - loop%length()) > 0.5_wp*loop%length()) fit%loop = 0
    fit%arc(:start - 1) = fit%arc(:start - 1) - loop%length()
  end subroutine unwrap

  !> Make the arc lengths increase, put the nearest points on the corners of the loop, and even out
  !> the distances between the points that are not fixed.
  pure subroutine order_points(fit, closed, loop)
    type(fit_t), intent(inout) :: fit
    logical, intent(in) :: closed
    type(loop_t), intent(in) :: loop

    real(wp) :: before, after
    integer :: pass, i, n

    n = size(fit%arc)
    if (n == 1) return
    call make_monotonic(fit%arc)
    call fix_corners(fit, closed, loop)
    do pass = 1, n_pass
      do i = 1, n
        if (fit%fixed(i)) cycle
        if (i == 1) then
          before = fit%arc(n) - loop%length()
        else
          before = fit%arc(i - 1)
        end if
        if (i == n) then
          after = fit%arc(1) + loop%length()
        else
          after = fit%arc(i + 1)
        end if
        fit%arc(i) = 0.25_wp*before + 0.5_wp*min(after, max(before, fit%arc(i))) + 0.25_wp*after
      end do
    end do
  end subroutine order_points

  !> Replace values by the closest ones that do not decrease: the mean of each block of violators.
  pure subroutine make_monotonic(value)
    real(wp), intent(inout) :: value(:)

    real(wp) :: mean(size(value))
    real(wp) :: number(size(value))
    integer :: i, n, k

    n = 0
    do i = 1, size(value)
      n = n + 1
      mean(n) = value(i)
      number(n) = 1.0_wp
      do while (n > 1)
        if (mean(n) >= mean(n - 1)) exit
        mean(n - 1) = (number(n - 1)*mean(n - 1) + number(n)*mean(n))/(number(n - 1) + number(n))
        number(n - 1) = number(n - 1) + number(n)
        n = n - 1
      end do
    end do
    k = 0
    do i = 1, n
      value(k + 1:k + nint(number(i))) = mean(i)
      k = k + nint(number(i))
    end do
  end subroutine make_monotonic

  !> Fix the point nearest to each corner of the loop there, in the order of the chain.
  pure subroutine fix_corners(fit, closed, loop)
    type(fit_t), intent(inout) :: fit
    logical, intent(in) :: closed
    type(loop_t), intent(in) :: loop

    real(wp) :: corner, first
    integer :: i, k, n, round

    n = size(fit%arc)
    first = fit%arc(1)
    if (closed) first = 0.5_wp*(fit%arc(1) + fit%arc(n) - loop%length())
    do k = 1, size(loop%corner)
      do round = -2, 2
        corner = loop%corner(k) + real(round, wp)*loop%length()
        if (corner < first .or. corner >= first + loop%length() .or. &
            (.not. closed .and. corner > fit%arc(n))) cycle
        i = minloc(abs(fit%arc - corner), dim=1, mask=.not. fit%fixed)
        if (i == 0) return
        fit%fixed(i) = .true.
        fit%arc(i) = corner
        where (fit%arc(:i) > corner) fit%arc(:i) = corner
        where (fit%arc(i:) < corner) fit%arc(i:) = corner
      end do
    end do
  end subroutine fix_corners

end module dd3_sheet_fitting
