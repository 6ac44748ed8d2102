! SPDX-License-Identifier: GPL-3.0-or-later
!> Third step of a cut: quadrilaterals of good shape. The columns near the cut move in the plane,
!> the new ones along the curves, so that the sum of squares of
!>     e = (|u|^2 + |v|^2) / (2 h(det(u, v))),    h(d) = (d + sqrt(d^2 + 4 delta^2))/2,
!> over the corners becomes least, with the edges u and v at a corner as they are in space; e is 1
!> in a square. h keeps e finite for corners that are turned inside out, which are untangled too.
!> Source: Escobar, Rodriguez, Montenegro, Montero and Gonzalez-Yuste, Comput. Methods Appl. Mech.
!> Eng. 192 (2003) 2775-2787.
module dd3_sheet_smoothing
  use dd3_base_kinds, only : wp
  use dd3_sheet_grid, only : list_quads
  use dd3_mesh_plane_curve, only : loop_t
  implicit none
  private
  public :: patch_t, smooth

  !> Passes over the columns; steps of the search of a column, first and least, over its edges.
  integer, parameter :: n_pass = 30
  real(wp), parameter :: first_step = 0.2_wp, least_step = 1.0e-3_wp
  !> delta over the mean area of the corners at a column.
  real(wp), parameter :: relative_delta = 1.0e-2_wp
  !> Directions of the search.
  real(wp), parameter :: diagonal = sqrt(0.5_wp)
  real(wp), parameter :: direction(2, 8) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, -1.0_wp, &
      0.0_wp, 0.0_wp, -1.0_wp, diagonal, diagonal, -diagonal, diagonal, -diagonal, -diagonal, &
      diagonal, -diagonal], [2, 8])

  !> Quadrilaterals in the plane, with the columns that may move.
  type :: patch_t
    !> `(4, n_quad)`.
    integer, allocatable :: corner(:, :)
    !> Positions in the plane, `(2, n_column)`, mm, and the metric there: products of the vectors in
    !> space that belong to the unit vectors of the plane, 11 12 22, `(3, n_column)`.
    real(wp), allocatable :: plane(:, :), metric(:, :)
    !> Whether a column may move in the plane; loop on which it slides, 0 for none, and its arc
    !> length there, mm.
    logical, allocatable :: free(:)
    integer, allocatable :: loop(:)
    real(wp), allocatable :: arc(:)
    !> Quadrilaterals at column c: `quad_at(first(c):first(c + 1) - 1)`.
    integer, allocatable :: first(:), quad_at(:)
  end type patch_t

contains

  !> Move the columns to better places.
  pure subroutine smooth(self, loop)
    type(patch_t), intent(inout) :: self
    type(loop_t), intent(in) :: loop(:)

    integer :: pass, c

    call list_quads(self%corner, size(self%free), self%first, self%quad_at)
    do pass = 1, n_pass
      do c = 1, size(self%free)
        if (self%free(c)) then
          call move_freely(self, c)
        else if (self%loop(c) > 0) then
          call slide(self, loop(self%loop(c)), c)
        end if
      end do
    end do
  end subroutine smooth

  !> Search the best place of a column in the plane.
  pure subroutine move_freely(self, column)
    type(patch_t), intent(inout) :: self
    integer, intent(in) :: column

    real(wp) :: best, value, step, place(2), length, delta
    integer :: d, chosen

    call measure(self, column, length, delta)
    best = distortion(self, column, delta)
    step = first_step*length
    do while (step > least_step*length)
      place = self%plane(:, column)
      chosen = 0
      do d = 1, size(direction, 2)
        self%plane(:, column) = place + step*direction(:, d)
        value = distortion(self, column, delta)
        if (value >= best) cycle
        best = value
        chosen = d
      end do
      self%plane(:, column) = place
      if (chosen > 0) then
        self%plane(:, column) = place + step*direction(:, chosen)
      else
        step = 0.5_wp*step
      end if
    end do
  end subroutine move_freely

  !> Search the best place of a column on its loop.
  pure subroutine slide(self, loop, column)
    type(patch_t), intent(inout) :: self
    type(loop_t), intent(in) :: loop
    integer, intent(in) :: column

    real(wp) :: best, value, step, arc, length, delta
    real(wp) :: moved
    integer :: side
    logical :: better

    call measure(self, column, length, delta)
    best = distortion(self, column, delta)
    step = first_step*length
    do while (step > least_step*length)
      better = .false.
      arc = self%arc(column)
      do side = -1, 1, 2
        moved = arc + real(side, wp)*step
        self%plane(:, column) = loop%at(moved)
        value = distortion(self, column, delta)
        if (value >= best) cycle
        best = value
        self%arc(column) = moved
        better = .true.
      end do
      self%plane(:, column) = loop%at(self%arc(column))
      if (.not. better) step = 0.5_wp*step
    end do
  end subroutine slide

  !> Measure the quadrilaterals at a column: their mean edge length, and delta.
  pure subroutine measure(self, column, length, delta)
    type(patch_t), intent(in) :: self
    integer, intent(in) :: column
    real(wp), intent(out) :: length, delta

    real(wp) :: area
    integer :: k, i, n

    length = 0.0_wp
    area = 0.0_wp
    n = 0
    do k = self%first(column), self%first(column + 1) - 1
      associate (corner => self%corner(:, self%quad_at(k)))
        do i = 1, 4
          length = length + norm2(self%plane(:, corner(mod(i, 4) + 1)) - self%plane(:, corner(i)))
          n = n + 1
        end do
        associate (u => self%plane(:, corner(3)) - self%plane(:, corner(1)), &
            v => self%plane(:, corner(4)) - self%plane(:, corner(2)))
          area = area + abs(u(1)*v(2) - u(2)*v(1))
        end associate
      end associate
    end do
    length = length/real(max(1, n), wp)
    delta = relative_delta*area/real(max(1, n), wp)*4.0_wp
  end subroutine measure

  !> Return the sum of squares of e over the quadrilaterals at a column.
  pure real(wp) function distortion(self, column, delta)
    type(patch_t), intent(in) :: self
    integer, intent(in) :: column
    real(wp), intent(in) :: delta

    real(wp) :: u(2), v(2), determinant, root
    integer :: i, k

    distortion = 0.0_wp
    associate (m => self%metric(:, column))
      root = sqrt(max(tiny(1.0_wp), m(1)*m(3) - m(2)**2))
      do k = self%first(column), self%first(column + 1) - 1
        associate (corner => self%corner(:, self%quad_at(k)))
          do i = 1, 4
            u = self%plane(:, corner(mod(i, 4) + 1)) - self%plane(:, corner(i))
            v = self%plane(:, corner(mod(i + 2, 4) + 1)) - self%plane(:, corner(i))
            determinant = u(1)*v(2) - u(2)*v(1)
            determinant = 0.5_wp*(determinant + sqrt(determinant**2 + 4.0_wp*delta**2))
            distortion = distortion + ((m(1)*(u(1)**2 + v(1)**2) + 2.0_wp*m(2)*(u(1)*u(2) &
                + v(1)*v(2)) + m(3)*(u(2)**2 + v(2)**2))/(2.0_wp*root*determinant))**2
          end do
        end associate
      end do
    end associate
  end function distortion

end module dd3_sheet_smoothing
