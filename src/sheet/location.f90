! SPDX-License-Identifier: GPL-3.0-or-later
!> Places on the grid of a sheet seen in a plane: the quadrilateral of a point and the natural
!> coordinates there.
module dd3_sheet_location
  use dd3_base_kinds, only : wp
  use dd3_sheet_grid, only : grid_t
  implicit none
  private
  public :: place_t, locate, bilinear, natural_coordinates, corner_sign, inside

  !> Natural coordinates of the corners.
  real(wp), parameter :: corner_sign(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, &
      1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
  !> Natural coordinate up to which a point belongs to a quadrilateral.
  real(wp), parameter :: inside = 1.0_wp + 1.0e-8_wp
  !> Largest number of quadrilaterals on the way to a point, and of iterations within one.
  integer, parameter :: most_steps = 200, most_iterations = 30

  !> A place on the grid.
  type :: place_t
    integer :: quad = 0
    !> Natural coordinates.
    real(wp) :: natural(2) = 0.0_wp
    !> Whether the point is inside the quadrilateral; otherwise this is the closest one on the way,
    !> at the border of the sheet.
    logical :: found = .false.
  end type place_t

contains

  !> Return the bilinear shape functions of the corners.
  pure function bilinear(natural) result(shape)
    real(wp), intent(in) :: natural(2)
    real(wp) :: shape(4)

    shape = 0.25_wp*(1.0_wp + corner_sign(1, :)*natural(1))*(1.0_wp + corner_sign(2, :)*natural(2))
  end function bilinear

  !> Find the natural coordinates of a point, by Newton's method.
  pure subroutine natural_coordinates(corner, point, natural, found)
    !> Corners of the quadrilateral, `(2, 4)`.
    real(wp), intent(in) :: corner(2, 4), point(2)
    real(wp), intent(out) :: natural(2)
    logical, intent(out) :: found

    real(wp) :: residual(2), tangent(2, 2), determinant, step(2)
    integer :: i

    natural = 0.0_wp
    found = .false.
    do i = 1, most_iterations
      residual = point - matmul(corner, bilinear(natural))
      tangent(:, 1) = matmul(corner, 0.25_wp*corner_sign(1, :) &
          *(1.0_wp + corner_sign(2, :)*natural(2)))
      tangent(:, 2) = matmul(corner, 0.25_wp*corner_sign(2, :) &
          *(1.0_wp + corner_sign(1, :)*natural(1)))
      determinant = tangent(1, 1)*tangent(2, 2) - tangent(1, 2)*tangent(2, 1)
      if (.not. abs(determinant) > 0.0_wp) return
      step = [tangent(2, 2)*residual(1) - tangent(1, 2)*residual(2), &
          tangent(1, 1)*residual(2) - tangent(2, 1)*residual(1)]/determinant
      step = step/max(1.0_wp, maxval(abs(step)))
      natural = natural + step
      found = maxval(abs(step)) < 1.0e-12_wp
      if (found) return
    end do
    ! Far outside, the mapping may have no inverse; the direction of the way remains right.
    found = all(abs(natural) < huge(1.0_wp))
  end subroutine natural_coordinates

  !> Find a point on the grid, on the way from a quadrilateral over common edges.
  pure type(place_t) function locate(grid, plane, point, start) result(place)
    type(grid_t), intent(in) :: grid
    !> Positions of the columns in the plane, `(2, n_column)`, mm.
    real(wp), intent(in) :: plane(:, :)
    real(wp), intent(in) :: point(2)
    !> Quadrilateral from which the way starts.
    integer, intent(in) :: start

    real(wp) :: natural(2), excess(4)
    integer :: step, i, quad, before
    logical :: found

    quad = start
    before = 0
    do step = 1, most_steps
      call natural_coordinates(plane(:, grid%corner(:, quad)), point, natural, found)
      place = place_t(quad, natural, .false.)
      if (.not. found) return
      place%found = all(abs(natural) <= inside)
      if (place%found) return
      ! Edges 1 to 4: eta = -1, xi = 1, eta = 1, xi = -1.
      excess = [-natural(2), natural(1), natural(2), -natural(1)]
      do i = 1, 4
        if (grid%neighbour(i, quad) == 0 .or. grid%neighbour(i, quad) == before) excess(i) = 0.0_wp
      end do
      i = maxloc(excess, dim=1)
      if (excess(i) <= 1.0_wp) return
      before = quad
      quad = grid%neighbour(i, quad)
    end do
  end function locate

end module dd3_sheet_location
