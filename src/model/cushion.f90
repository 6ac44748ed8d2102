! SPDX-License-Identifier: GPL-3.0-or-later
!> Supports of a pressed tool: the cushion behind it, and spacers between it and another tool.
module dd3_model_cushion
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: cushion_t, spacer_t

  !> Cushion of pins or springs, which share the force on a tool.
  type :: cushion_t
    !> Places of the pins in the frame of the surface, `(3, n)`, mm, and their shares, `(n)`, of sum
    !> 1; not allocated without a cushion.
    real(wp), allocatable :: place(:, :), share(:)
    !> Stroke of a pin, mm, and factor on its force there, `(2, n)`, constant beyond the ends; not
    !> allocated if the force does not depend on the stroke.
    real(wp), allocatable :: table(:, :)
  contains
    procedure :: factor
    procedure :: slope
  end type cushion_t

  !> Spacer between a pressed tool and another one.
  type :: spacer_t
    !> Numbers of the tools.
    integer :: tool = 0, other = 0
    !> N/mm.
    real(wp) :: stiffness = 0.0_wp
    !> Place in the frame of the surface of the pressed tool, mm.
    real(wp) :: place(3) = 0.0_wp
    !> Gap between the tools at which it touches, mm.
    real(wp) :: gap = 0.0_wp
    !> Displacement of the place relative to the other tool, along the force, at which it touches,
    !> mm.
    real(wp) :: limit = 0.0_wp
  end type spacer_t

contains

  !> Return the factor on the force of a pin at a stroke.
  pure real(wp) function factor(self, stroke)
    class(cushion_t), intent(in) :: self
    !> mm.
    real(wp), intent(in) :: stroke

    real(wp) :: s
    integer :: i

    factor = 1.0_wp
    if (.not. allocated(self%table)) return
    i = interval_of(self, stroke)
    associate (x => self%table(1, i:i + 1), y => self%table(2, i:i + 1))
      s = min(x(2), max(x(1), stroke))
      factor = y(1) + (y(2) - y(1))*((s - x(1))/(x(2) - x(1)))
    end associate
  end function factor

  !> Return the derivative of the factor by the stroke, 1/mm.
  pure real(wp) function slope(self, stroke)
    class(cushion_t), intent(in) :: self
    !> mm.
    real(wp), intent(in) :: stroke

    integer :: i

    slope = 0.0_wp
    if (.not. allocated(self%table)) return
    i = interval_of(self, stroke)
    associate (x => self%table(1, i:i + 1), y => self%table(2, i:i + 1))
      if (stroke >= x(1) .and. stroke <= x(2)) slope = (y(2) - y(1))/(x(2) - x(1))
    end associate
  end function slope

  !> Return the interval of the table for a stroke.
  pure integer function interval_of(self, stroke) result(i)
    type(cushion_t), intent(in) :: self
    real(wp), intent(in) :: stroke

    do i = 1, size(self%table, 2) - 2
      if (stroke < self%table(1, i + 1)) return
    end do
  end function interval_of

end module dd3_model_cushion
