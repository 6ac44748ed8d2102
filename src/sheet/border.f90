! SPDX-License-Identifier: GPL-3.0-or-later
!> Border of a sheet as a smooth curve: distance of the middle of an edge of the border from its
!> chord. The curvature is that of the circle through an end of the edge and the columns before and
!> after it; of the two ends the smaller one counts, none where they differ in side, so that
!> straight edges stay straight up to a rounded corner. An end at which the border turns by more
!> than `corner` does not count.
module dd3_sheet_border
  use dd3_base_kinds, only : pi, wp
  use dd3_linalg_tensor, only : cross
  use dd3_sheet_grid, only : grid_t
  implicit none
  private
  public :: border_t, new_border, bulge

  !> Angle by which the border turns at a corner, rad.
  real(wp), parameter :: corner = 40.0_wp*pi/180.0_wp
  !> Distance from the chord over its length that is round-off.
  real(wp), parameter :: round_off = 1.0e-9_wp

  !> Neighbours along the border.
  type :: border_t
    !> Columns before and after each column of the border, 0 if there is none or more than one,
    !> `(2, n_column)`.
    integer, allocatable :: beside(:, :)
    !> Whether edge i of a quadrilateral is one of the border, `(4, n_quad)`.
    logical, allocatable :: edge(:, :)
  end type border_t

contains

  !> Find the border of a sheet. Edges beside a bound column are not of the border.
  pure subroutine new_border(self, grid)
    type(border_t), intent(out) :: self
    type(grid_t), intent(in) :: grid

    integer :: i, q
    logical :: several(2, grid%n_column)

    self%edge = grid%neighbour == 0 .and. all(grid%over_bound == 0, dim=1)
    allocate (self%beside(2, grid%n_column), source=0)
    several = .false.
    do q = 1, grid%n_quad
      do i = 1, 4
        if (.not. self%edge(i, q)) cycle
        associate (from => grid%corner(i, q), to => grid%corner(mod(i, 4) + 1, q))
          several(2, from) = several(2, from) .or. self%beside(2, from) > 0
          several(1, to) = several(1, to) .or. self%beside(1, to) > 0
          self%beside(2, from) = to
          self%beside(1, to) = from
        end associate
      end do
    end do
    where (several) self%beside = 0
  end subroutine new_border

  !> Return the vector from the middle of an edge of the border to the curve, mm.
  pure function bulge(x, known) result(vector)
    !> Column before the edge, its ends, column after it, mm.
    real(wp), intent(in) :: x(3, 4)
    !> Whether the columns before and after it are known.
    logical, intent(in) :: known(2)
    real(wp) :: vector(3)

    real(wp) :: curvature(3, 2), along(3), length, half
    logical :: smooth(2)
    integer :: i

    vector = 0.0_wp
    along = x(:, 3) - x(:, 2)
    length = norm2(along)
    along = along/length
    do i = 1, 2
      call measure(x(:, i:i + 2), along, curvature(:, i), smooth(i))
    end do
    smooth = smooth .and. known
    if (.not. any(smooth)) return
    if (.not. all(smooth)) then
      vector = curvature(:, merge(1, 2, smooth(1)))
    else if (dot_product(curvature(:, 1), curvature(:, 2)) > 0.0_wp) then
      vector = curvature(:, minloc(norm2(curvature, dim=1), dim=1))
    end if
    ! Height of the arc over the chord.
    half = 0.5_wp*length
    vector = -vector*half**2/(1.0_wp + sqrt(max(0.0_wp, 1.0_wp - (norm2(vector)*half)**2)))
    if (norm2(vector) <= round_off*length) vector = 0.0_wp
  end function bulge

  !> Measure the curvature at the middle one of three points.
  pure subroutine measure(x, along, curvature, smooth)
    !> mm.
    real(wp), intent(in) :: x(3, 3)
    !> Unit vector along the edge.
    real(wp), intent(in) :: along(3)
    !> Towards the centre of the circle through the points, at right angles to the edge, 1/mm.
    real(wp), intent(out) :: curvature(3)
    !> Whether the points do not form a corner.
    logical, intent(out) :: smooth

    real(wp) :: before(3), after(3), change(3), across

    curvature = 0.0_wp
    smooth = .false.
    if (norm2(x(:, 2) - x(:, 1)) <= 0.0_wp .or. norm2(x(:, 3) - x(:, 2)) <= 0.0_wp) return
    before = (x(:, 2) - x(:, 1))/norm2(x(:, 2) - x(:, 1))
    after = (x(:, 3) - x(:, 2))/norm2(x(:, 3) - x(:, 2))
    smooth = dot_product(before, after) >= cos(corner)
    change = after - before
    change = change - dot_product(change, along)*along
    across = norm2(change)
    if (.not. (smooth .and. across > 0.0_wp)) return
    ! Twice the sine of the turn over the chord of its ends.
    curvature = change/across*2.0_wp*norm2(cross(before, after))/norm2(x(:, 3) - x(:, 1))
  end subroutine measure

end module dd3_sheet_border
