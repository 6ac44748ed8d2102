! SPDX-License-Identifier: GPL-3.0-or-later
!> Oriented bounding boxes of patches: along the mean directions of u and v and their normal. On an
!> inclined patch they are much smaller than the boxes along the coordinate axes.
!> Source: Gottschalk, Lin and Manocha, SIGGRAPH (1996) 171-180.
module dd3_tools_oriented_box
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : patch_t
  implicit none
  private
  public :: oriented_box_t, new_oriented_box, oriented_distance

  !> Shortest second direction, relative to the first one, before it is made normal to it.
  real(wp), parameter :: shortest_direction = 1.0e-3_wp

  !> An oriented box.
  type :: oriented_box_t
    !> Middle, mm; unit directions, one a column; half lengths, mm.
    real(wp) :: centre(3) = 0.0_wp, axis(3, 3) = 0.0_wp, half(3) = huge(1.0_wp)
  end type oriented_box_t

contains

  !> Make the box of the control points of a patch, which contains the patch; without bounds if the
  !> corners span no plane.
  pure subroutine new_oriented_box(self, patch)
    type(oriented_box_t), intent(out) :: self
    type(patch_t), intent(in) :: patch

    real(wp) :: u(3), v(3), lower(3), upper(3), along(3)
    integer :: i, j, m, n

    m = patch%degree(1)
    n = patch%degree(2)
    associate (p => patch%control)
      u = p(:, m, 0) - p(:, 0, 0) + p(:, m, n) - p(:, 0, n)
      v = p(:, 0, n) - p(:, 0, 0) + p(:, m, n) - p(:, m, 0)
      if (norm2(u) <= 0.0_wp) return
      self%axis(:, 1) = u/norm2(u)
      v = v - dot_product(v, self%axis(:, 1))*self%axis(:, 1)
      if (norm2(v) <= shortest_direction*norm2(u)) return
      self%axis(:, 2) = v/norm2(v)
      associate (a => self%axis(:, 1), b => self%axis(:, 2))
        self%axis(:, 3) = cshift(a, 1)*cshift(b, 2) - cshift(a, 2)*cshift(b, 1)
      end associate
      lower = huge(1.0_wp)
      upper = -huge(1.0_wp)
      do j = 0, n
        do i = 0, m
          along = matmul(p(:, i, j) - patch%centre, self%axis)
          lower = min(lower, along)
          upper = max(upper, along)
        end do
      end do
    end associate
    self%centre = patch%centre + matmul(self%axis, 0.5_wp*(lower + upper))
    self%half = 0.5_wp*(upper - lower)
  end subroutine new_oriented_box

  !> Return the distance of a point from a box, mm; 0 inside.
  pure real(wp) function oriented_distance(self, x) result(distance)
    type(oriented_box_t), intent(in) :: self
    real(wp), intent(in) :: x(3)

    real(wp) :: r(3), outside(3)
    integer :: i

    r = x - self%centre
    do i = 1, 3
      outside(i) = max(abs(dot_product(r, self%axis(:, i))) - self%half(i), 0.0_wp)
    end do
    distance = sqrt(dot_product(outside, outside))
  end function oriented_distance

end module dd3_tools_oriented_box
