! SPDX-License-Identifier: GPL-3.0-or-later
!> Tilt of a tool under a prescribed force: it is free to rotate about two axes across the line of
!> the force, through a pivot at which the force acts.
module dd3_model_tilt
  use dd3_base_kinds, only : wp
  use dd3_tools_surface, only : surface_t
  implicit none
  private
  public :: tilt_t, new_tilt

  !> Tilt of a tool over a phase.
  type :: tilt_t
    !> Whether it tilts.
    logical :: free = .false.
    !> Pivot in the frame of the surface, mm.
    real(wp) :: pivot(3) = 0.0_wp
    !> Largest distance of the surface from the pivot, mm: moments over it compare with forces.
    real(wp) :: arm = 1.0_wp
    !> Stiffness of the tool's support against tilt, N.mm/rad.
    real(wp) :: stiffness = 0.0_wp
  end type tilt_t

contains

  !> Make a tilt from the values of the input.
  pure type(tilt_t) function new_tilt(pivot, stiffness, surface) result(self)
    !> mm and N.mm/rad.
    real(wp), intent(in) :: pivot(3), stiffness
    !> Of the tool.
    type(surface_t), intent(in) :: surface

    self%free = .true.
    self%pivot = pivot
    self%stiffness = stiffness
    self%arm = norm2(max(abs(surface%lower - pivot), abs(surface%upper - pivot)))
  end function new_tilt

end module dd3_model_tilt
