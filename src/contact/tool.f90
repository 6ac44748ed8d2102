!> A rigid tool: its surface, its friction and where it stands at the start.
module dd3_contact_tool
  use dd3_base_kinds, only : wp
  use dd3_contact_surface, only : surface_t
  implicit none
  private
  public :: tool_t

  !> A rigid tool that can be translated.
  type :: tool_t
    !> Its name in the input.
    character(len=:), allocatable :: name
    !> Its surface, in the frame of its own file.
    type(surface_t) :: surface
    !> Coefficient of Coulomb friction against the sheet.
    real(wp) :: friction = 0.0_wp
    !> Offset of the surface's frame from the global one at the start, mm.
    real(wp) :: position(3) = 0.0_wp
  end type tool_t

end module dd3_contact_tool
