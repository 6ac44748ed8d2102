!> A rigid tool: its surface, friction and initial position.
module dd3_contact_tool
  use dd3_base_kinds, only : wp
  use dd3_contact_surface, only : surface_t
  implicit none
  private
  public :: tool_t

  !> A rigid tool; it moves by translation.
  type :: tool_t
    !> Name in the input.
    character(len=:), allocatable :: name
    !> Surface in the frame of its file.
    type(surface_t) :: surface
    !> Coefficient of Coulomb friction against the sheet.
    real(wp) :: friction = 0.0_wp
    !> Initial offset of the surface's frame from the global one, mm.
    real(wp) :: position(3) = 0.0_wp
  end type tool_t

end module dd3_contact_tool
