! SPDX-License-Identifier: GPL-3.0-or-later
!> Limit of the turn of the normal beside the border of a surface.
!>
!> The force on a node that leaves a surface under pressure turns about the rounded border, and the
!> part of it that pushes the node away from the tool grows with F/R. A sheet that is softer in
!> this direction snaps off the tool: there is no equilibrium near the one before. After a failed
!> attempt the normal therefore turns no farther than in the committed state, which resists the
!> snap like a viscous force of the coefficient F/R over the increment, and vanishes with its
!> length.
!>
!> With the unit normal m of the patch at the closest point y, the direction q at right angles to m
!> from the edge to the node and the largest turn b, less than that of the border,
!>     n = m cos(b) + q sin(b).
!> The gap is that of the rounded border; its gradient is no longer n. With the tangent t = m x q,
!>     dn/dx = k t t^T,    k = -n.y_tt/(|y_t|^2 - (x - y).y_tt)
!> along an edge and k = sin(b)/(q.(x - y)) at a corner, exact where m does not turn about the edge.
module dd3_tools_border_turn
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : evaluate, patch_t, unit_normal
  use dd3_tools_hit, only : hit_t
  implicit none
  private
  public :: limit_turn

  !> Sine of a turn below which there is none.
  real(wp), parameter :: no_turn = 1.0e-12_wp
  !> Least part of |y_t|^2 in the denominator of k; below it the node is near the centre of the
  !> edge's curvature.
  real(wp), parameter :: least_stretch = 1.0e-8_wp

contains

  !> Set the turn of the normal of a hit beside the border, and limit it.
  pure subroutine limit_turn(hit, patch, x, largest_turn)
    !> On the border.
    type(hit_t), intent(inout) :: hit
    !> That of the hit.
    type(patch_t), intent(in) :: patch
    !> Position of the node, mm, and largest turn.
    real(wp), intent(in) :: x(3), largest_turn

    real(wp) :: point(3), first(3, 2), second(3, 3), m(3), q(3), t(3), sine, k, square
    integer :: i
    logical :: regular, on_bound(2)

    call evaluate(patch, hit%u, hit%v, point, first, second)
    call unit_normal(patch, first, m, regular)
    if (.not. regular) return
    q = hit%normal - dot_product(hit%normal, m)*m
    sine = norm2(q)
    if (sine <= no_turn) return
    q = q/sine
    hit%turn = atan2(sine, dot_product(hit%normal, m))
    if (largest_turn >= hit%turn) return
    hit%normal = cos(largest_turn)*m + sin(largest_turn)*q
    on_bound = abs([hit%u, hit%v] - 0.5_wp) >= 0.5_wp
    if (all(on_bound)) then
      k = sin(largest_turn)/dot_product(q, x - point)
    else
      i = merge(2, 1, on_bound(1))
      square = dot_product(first(:, i), first(:, i))
      k = -dot_product(hit%normal, second(:, i)) &
          /max(square - dot_product(x - point, second(:, i)), least_stretch*square)
    end if
    t = m([2, 3, 1])*q([3, 1, 2]) - m([3, 1, 2])*q([2, 3, 1])
    do i = 1, 3
      hit%dnormal(:, i) = k*t*t(i)
    end do
  end subroutine limit_turn

end module dd3_tools_border_turn
