! SPDX-License-Identifier: GPL-3.0-or-later
!> Second step of a cut: a point on the line of the cut for each column of a chain, in the order of
!> the chain. The corners of the line are points of their own, and so are its ends at the border of
!> the sheet.
module dd3_sheet_fitting
  use dd3_base_kinds, only : wp
  use dd3_sheet_core, only : chain_t
  use dd3_mesh_plane_curve, only : loop_t
  implicit none
  private
  public :: fit_t, fit_chain

  !> Passes that even out the distances along the line.
  integer, parameter :: n_pass = 10

  !> Points of a chain on a line.
  type :: fit_t
    !> Line on which they lie; 0 if the chain does not follow one.
    integer :: loop = 0
    !> Arc length of each, increasing, mm.
    real(wp), allocatable :: arc(:)
    !> Points that do not slide: corners and ends.
    logical, allocatable :: fixed(:)
  end type fit_t

contains

  !> Find the points of a chain.
  pure subroutine fit_chain(fit, chain, loop, plane)
    type(fit_t), intent(out) :: fit
    type(chain_t), intent(in) :: chain
    !> Lines of the cut, with what stays on their left.
    type(loop_t), intent(in) :: loop(:)
    !> Positions of the columns, `(2, n_column)`, mm.
    real(wp), intent(in) :: plane(:, :)

    real(wp) :: arc(size(chain%column)), distance(size(chain%column))
    integer :: n

    n = size(chain%column)
    fit%loop = nearest_loop(chain, loop, plane)
    associate (line => loop(fit%loop))
      call project(chain, line, plane, arc, distance)
      fit%arc = arc
      allocate (fit%fixed(n), source=.false.)
      if (chain%closed .neqv. line%closed) then
        fit%loop = 0
      else if (chain%closed) then
        call unwrap(fit, chain, line, plane, minloc(distance, dim=1))
      else
        fit%arc(1) = 0.0_wp
        fit%arc(n) = line%length()
        fit%fixed([1, n]) = .true.
      end if
      if (fit%loop > 0) call order_points(fit, line)
    end associate
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

  !> Let the arc lengths increase along a closed chain beyond the length of its line.
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
    ! The last column comes back to the start after one round.
    i = merge(n, start - 1, start == 1)
    if (abs(fit%arc(i) - fit%arc(start) - loop%length()) > 0.5_wp*loop%length()) fit%loop = 0
    fit%arc(:start - 1) = fit%arc(:start - 1) - loop%length()
  end subroutine unwrap

  !> Make the arc lengths increase, put the nearest points on the corners of the loop, and even out
  !> the distances between the points that are not fixed.
  pure subroutine order_points(fit, loop)
    type(fit_t), intent(inout) :: fit
    type(loop_t), intent(in) :: loop

    real(wp) :: before, after
    integer :: pass, i, n

    n = size(fit%arc)
    if (n == 1) return
    call make_monotonic(fit%arc)
    call fix_corners(fit, loop)
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
  pure subroutine fix_corners(fit, loop)
    type(fit_t), intent(inout) :: fit
    type(loop_t), intent(in) :: loop

    real(wp) :: corner, first
    integer :: i, k, n, round, rounds

    n = size(fit%arc)
    first = 0.0_wp
    rounds = 0
    if (loop%closed) then
      first = 0.5_wp*(fit%arc(1) + fit%arc(n) - loop%length())
      rounds = 2
    end if
    do k = 1, size(loop%corner)
      do round = -rounds, rounds
        corner = loop%corner(k) + real(round, wp)*loop%length()
        if (corner < first .or. corner >= first + loop%length()) cycle
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
