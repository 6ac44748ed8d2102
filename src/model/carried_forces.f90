! SPDX-License-Identifier: GPL-3.0-or-later
!> Nodal forces that follow the sections of the sheet: each turns as the fibre through the thickness
!> at its node does, by the smallest rotation, so that a couple on a section stays one while the
!> section turns. Their stiffness is unsymmetric. With v = n0 x n and c = n0 . n for the unit
!> vectors of the fibre before and after, R = c I + [v] + v v^T/(1 + c).
!> Source of the rotation between two directions: Moller and Hughes, Journal of Graphics Tools 4
!> (1999) 1-4.
module dd3_model_carried_forces
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross, identity
  implicit none
  private
  public :: carried_forces, carried_force, carried_stiffness

contains

  !> Return nodal forces after the motion of the sheet, `(3, n_node)`, N.
  pure function carried_forces(fibre_end, before, x, force) result(carried)
    !> Other end of the fibre of each node, `(n_node)`; 0 for a node whose force does not turn.
    integer, intent(in) :: fibre_end(:)
    !> Positions of the nodes where the forces are given, and now, `(3, n_node)`, mm.
    real(wp), intent(in) :: before(:, :), x(:, :)
    !> `(3, n_node)`, N.
    real(wp), intent(in) :: force(:, :)
    real(wp) :: carried(3, size(force, 2))

    integer :: node

    carried = force
    do node = 1, size(force, 2)
      associate (other => fibre_end(node))
        if (other == 0 .or. all(abs(force(:, node)) <= 0.0_wp)) cycle
        carried(:, node) = carried_force(before(:, other) - before(:, node), &
            x(:, other) - x(:, node), force(:, node))
      end associate
    end do
  end function carried_forces

  !> Return a force that turns with a fibre, N.
  pure function carried_force(before, now, force) result(carried)
    !> The fibre, mm.
    real(wp), intent(in) :: before(3), now(3)
    !> On the fibre before, N.
    real(wp), intent(in) :: force(3)
    real(wp) :: carried(3)

    real(wp) :: from(3), to(3), axis(3)

    from = before/norm2(before)
    to = now/norm2(now)
    axis = cross(from, to)
    carried = dot_product(from, to)*force + cross(axis, force) &
        + dot_product(axis, force)/(1.0_wp + dot_product(from, to))*axis
  end function carried_force

  !> Return the derivative of `carried_force` in the fibre now, N/mm.
  pure function carried_stiffness(before, now, force) result(stiffness)
    !> As for `carried_force`.
    real(wp), intent(in) :: before(3), now(3), force(3)
    real(wp) :: stiffness(3, 3)

    real(wp) :: from(3), to(3), axis(3), turn(3), along(3), cosine, part
    integer :: i

    from = before/norm2(before)
    to = now/norm2(now)
    axis = cross(from, to)
    cosine = 1.0_wp + dot_product(from, to)
    part = dot_product(axis, force)/cosine
    do i = 1, 3
      along = (identity(:, i) - to(i)*to)/norm2(now)
      turn = cross(from, along)
      stiffness(:, i) = dot_product(from, along)*force + cross(turn, force) + part*turn &
          + (dot_product(turn, force) - part*dot_product(from, along))/cosine*axis
    end do
  end function carried_stiffness

end module dd3_model_carried_forces
