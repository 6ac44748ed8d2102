! SPDX-License-Identifier: GPL-3.0-or-later
!> The projection of a node on a patch: the closest point and what is known there.
module dd3_tools_projection
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : patch_t, evaluate_relative
  implicit none
  private
  public :: projection_t, evaluate_projection

  !> Closest point of a patch to a node, within bounds of the parameters.
  type :: projection_t
    !> Parameters u, v.
    real(wp) :: uv(2)
    !> Vector from the node to the closest point: S - x, mm.
    real(wp) :: offset(3)
    !> S_u, S_v, mm.
    real(wp) :: first(3, 2)
    !> S_uu, S_vv, S_uv, mm.
    real(wp) :: second(3, 3)
    !> Active bounds: -1 or 1 if u (v) is at its lower or upper bound, else 0.
    integer :: active(2)
    !> Distance of the node from the closest point, mm.
    real(wp) :: distance
  end type projection_t

contains

  !> Evaluate point, derivatives and distance at `projection%uv`; no bound is set active.
  pure subroutine evaluate_projection(patch, x, projection)
    type(patch_t), intent(in) :: patch
    !> Position of the node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    type(projection_t), intent(inout) :: projection

    call evaluate_relative(patch%degree(1), patch%degree(2), patch%rational, patch%homogeneous, &
        projection%uv(1), projection%uv(2), projection%offset, projection%first, projection%second)
    projection%offset = projection%offset - x
    projection%active = 0
    projection%distance = sqrt(dot_product(projection%offset, projection%offset))
  end subroutine evaluate_projection

end module dd3_tools_projection
