! SPDX-License-Identifier: GPL-3.0-or-later
!> Motions of node sets over a phase that depend on where the nodes are: rotation about an axis, the
!> motion of the end section of a bar that is bent to an arc while its middle line keeps its length
!> (at the angle phi of the section the arc has the radius L/phi), and the motion to a coordinate.
module dd3_model_motions
  use dd3_base_kinds, only : wp, pi
  use dd3_linalg_tensor, only : cross
  implicit none
  private
  public :: motion_t, motion_displacement, new_motion, new_placement

  !> Components of a unit vector below this count as zero.
  real(wp), parameter :: aligned = 1.0e-12_wp
  !> Whole turns of a section at most; how far the end of the arc is off, over its length, that
  !> weighs as much as a difference of 1 rad from the angle after the earlier phases.
  integer, parameter :: most_turns = 2
  real(wp), parameter :: weight_of_before = 1.0e-3_wp

  !> Motion of a node set in a phase.
  type :: motion_t
    !> Nodes of the set, and those by which the section of a bent bar is known: without the nodes of
    !> refinement, which would shift its centre.
    integer, allocatable :: node(:), first(:)
    !> Whether the set is the end section of a bent bar.
    logical :: bends = .false.
    !> Point on the axis, or on the middle line at the fixed end of the bar, mm; unit vector along
    !> the axis of the rotation.
    real(wp) :: point(3) = 0.0_wp, axis(3) = 0.0_wp
    !> Angle of a rotation, or of a bend at the end of the phase, and that of a bend which earlier
    !> phases have given it, unless they ended early, rad.
    real(wp) :: angle = 0.0_wp, before = 0.0_wp
    !> Middle line of the straight bar: its direction, and its length, mm.
    real(wp) :: along(3) = 0.0_wp, length = 0.0_wp
    !> Whether the nodes move to a coordinate, mm, along the direction that is prescribed.
    logical :: places = .false.
    real(wp) :: coordinate = 0.0_wp
    !> Directions that the motion prescribes: all, but for that of the axis if it is x, y or z.
    logical :: prescribes(3) = .true.
  end type motion_t

contains

  !> Make the motion of a set.
  pure subroutine new_motion(self, node, first, x, bends, values, before)
    type(motion_t), intent(out) :: self
    !> Nodes of the set, and those that were there before refinement.
    integer, intent(in) :: node(:), first(:)
    !> Positions of the nodes without deformation, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    logical, intent(in) :: bends
    !> Point, axis, and the angle, degrees, of a bend that at the end of the phase.
    real(wp), intent(in) :: values(7)
    !> Angle of a bend after the earlier phases, rad.
    real(wp), intent(in) :: before

    self%node = node
    self%first = first
    self%bends = bends
    self%point = values(1:3)
    self%axis = values(4:6)/norm2(values(4:6))
    self%prescribes = 1.0_wp - abs(self%axis) > aligned
    self%angle = pi/180.0_wp*values(7)
    if (.not. bends) return
    self%before = before
    self%along = centre_of(x(:, first)) - self%point
    self%along = self%along - dot_product(self%along, self%axis)*self%axis
    self%length = norm2(self%along)
    self%along = self%along/max(self%length, tiny(1.0_wp))
  end subroutine new_motion

  !> Make the motion of a set to a coordinate.
  pure subroutine new_placement(self, node, axis, coordinate)
    type(motion_t), intent(out) :: self
    integer, intent(in) :: node(:), axis
    !> mm.
    real(wp), intent(in) :: coordinate

    self%node = node
    self%places = .true.
    self%coordinate = coordinate
    self%prescribes = .false.
    self%prescribes(axis) = .true.
  end subroutine new_placement

  !> Add the displacement since the start of the phase to nodal vectors. A section that is not where
  !> a bend takes it, as it was free or comes from another run, approaches the arc in proportion.
  pure subroutine motion_displacement(self, x0, x_start, fraction, displacement)
    type(motion_t), intent(in) :: self
    !> Positions of the nodes: without deformation, and at the start of the phase, `(3, n_node)`,
    !> mm.
    real(wp), intent(in) :: x0(:, :), x_start(:, :)
    !> Fraction of the motion.
    real(wp), intent(in) :: fraction
    !> `(3, n_node)`, mm.
    real(wp), intent(inout) :: displacement(:, :)

    real(wp) :: change(3), start
    integer :: i

    start = 0.0_wp
    if (self%bends) start = angle_of(self, x0(:, self%first), x_start(:, self%first))
    do i = 1, size(self%node)
      associate (node => self%node(i))
        if (self%places) then
          change = fraction*(self%coordinate - x_start(:, node))
        else if (self%bends) then
          change = bent(self, x0(:, node), start + fraction*(self%angle - start)) &
              - (1.0_wp - fraction)*bent(self, x0(:, node), start) - fraction*x_start(:, node)
        else
          change = rotated(self, x_start(:, node) - self%point, fraction*self%angle) &
              - (x_start(:, node) - self%point)
        end if
        where (self%prescribes) displacement(:, node) = displacement(:, node) + change
      end associate
    end do
  end subroutine motion_displacement

  !> Return the angle of the end section of a bent bar: that by which it has turned or, if one line
  !> of nodes along the axis shows no turn, that of the arc to it. Of the whole turns that the arc
  !> may have besides, those which its end and the earlier phases show.
  pure real(wp) function angle_of(self, x0, x) result(angle)
    type(motion_t), intent(in) :: self
    !> Positions of the nodes of the set, without deformation and now, `(3, :)`, mm.
    real(wp), intent(in) :: x0(:, :), x(:, :)

    real(wp) :: before(3), now(3), chord(3), sine, cosine, missed, least, turned
    integer :: i, turns

    before = centre_of(x0)
    now = centre_of(x)
    sine = 0.0_wp
    cosine = 0.0_wp
    do i = 1, size(x, 2)
      associate (a => x0(:, i) - before, b => x(:, i) - now)
        sine = sine + dot_product(self%axis, cross(a, b))
        cosine = cosine + dot_product(a, b) - dot_product(self%axis, a)*dot_product(self%axis, b)
      end associate
    end do
    chord = now - self%point
    if (hypot(sine, cosine) > aligned*self%length**2) then
      turned = atan2(sine, cosine)
    else
      turned = 2.0_wp*atan2(dot_product(cross(self%axis, self%along), chord), &
          dot_product(self%along, chord))
    end if
    angle = turned
    least = huge(1.0_wp)
    do turns = -most_turns, most_turns
      associate (possible => turned + 2.0_wp*pi*real(turns, wp))
        chord = now - bent(self, before, possible)
        missed = norm2(chord - dot_product(self%axis, chord)*self%axis)/self%length &
            + weight_of_before*abs(possible - self%before)
        if (missed < least) angle = possible
      end associate
      least = min(least, missed)
    end do
  end function angle_of

  !> Return the mean of positions `(3, :)`, mm.
  pure function centre_of(x) result(centre)
    real(wp), intent(in) :: x(:, :)
    real(wp) :: centre(3)

    centre = sum(x, dim=2)/real(size(x, 2), wp)
  end function centre_of

  !> Return a vector turned about the axis (Rodrigues).
  pure function rotated(self, vector, angle)
    type(motion_t), intent(in) :: self
    real(wp), intent(in) :: vector(3)
    !> rad.
    real(wp), intent(in) :: angle
    real(wp) :: rotated(3)

    rotated = cos(angle)*vector + sin(angle)*cross(self%axis, vector) &
        + (1.0_wp - cos(angle))*dot_product(self%axis, vector)*self%axis
  end function rotated

  !> Return the position of a point of the end section of the bent bar.
  pure function bent(self, x, angle)
    type(motion_t), intent(in) :: self
    !> Initial position, mm.
    real(wp), intent(in) :: x(3)
    !> rad.
    real(wp), intent(in) :: angle
    real(wp) :: bent(3)

    real(wp) :: centre(3), chord(2)

    centre = self%point + self%length*self%along
    chord = [1.0_wp - angle**2/6.0_wp, 0.5_wp*angle]
    if (abs(angle) > 1.0e-4_wp) chord = [sin(angle), 1.0_wp - cos(angle)]/angle
    bent = self%point + self%length*(chord(1)*self%along + chord(2)*cross(self%axis, self%along)) &
        + rotated(self, x - centre, angle)
  end function bent

end module dd3_model_motions
