! SPDX-License-Identifier: GPL-3.0-or-later
!> Turn of a rigid tool in a phase about an axis that is fixed in the tool and moves with it. In a
!> phase the place of a point X of the tool's surface is
!>     x = c + u + R (X - c),    R = exp(theta [R_0 a]) R_0,
!> with the point c and the direction a of the axis in the frame of the surface, the displacement u
!> of that point, the angle theta since the start of the phase and the rotation R_0 there.
module dd3_model_turn
  use dd3_base_kinds, only : pi, wp
  implicit none
  private
  public :: turn_t, new_turn

  !> Turn of a tool over a phase.
  type :: turn_t
    !> Point c on the axis, mm, and its direction a, a unit vector.
    real(wp) :: centre(3) = 0.0_wp, axis(3) = 0.0_wp
    !> Angle over the phase, rad; 0 for a tool that does not turn.
    real(wp) :: angle = 0.0_wp
  end type turn_t

contains

  !> Make a turn from the values of the input.
  pure type(turn_t) function new_turn(values) result(self)
    !> Point and direction of the axis in the coordinates of the tool's file, mm, and the angle,
    !> degrees.
    real(wp), intent(in) :: values(7)

    self%centre = values(1:3)
    self%axis = values(4:6)/norm2(values(4:6))
    self%angle = pi/180.0_wp*values(7)
  end function new_turn

end module dd3_model_turn
