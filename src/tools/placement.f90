! SPDX-License-Identifier: GPL-3.0-or-later
!> Placement of a tool: the rigid transformation x = R X + t from the frame of its surface to the
!> global one.
module dd3_tools_placement
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: placement_t, point_displacement, relative_displacement

  !> Rotation R, orthogonal, and translation t, mm.
  type :: placement_t
    real(wp) :: rotation(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
        0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    real(wp) :: translation(3) = 0.0_wp
  contains
    procedure :: to_tool
    procedure :: vector_to_tool
    procedure :: vector_to_global
    procedure :: tensor_to_global
  end type placement_t

contains

  !> Return a point in the tool's frame, mm.
  pure function to_tool(self, x)
    class(placement_t), intent(in) :: self
    !> mm.
    real(wp), intent(in) :: x(3)
    real(wp) :: to_tool(3)

    to_tool = self%vector_to_tool(x - self%translation)
  end function to_tool

  !> Return a vector in the tool's frame.
  pure function vector_to_tool(self, vector)
    class(placement_t), intent(in) :: self
    real(wp), intent(in) :: vector(3)
    real(wp) :: vector_to_tool(3)

    vector_to_tool = matmul(vector, self%rotation)
  end function vector_to_tool

  !> Return a vector of the tool's frame in the global one.
  pure function vector_to_global(self, vector)
    class(placement_t), intent(in) :: self
    real(wp), intent(in) :: vector(3)
    real(wp) :: vector_to_global(3)

    vector_to_global = matmul(self%rotation, vector)
  end function vector_to_global

  !> Return a tensor of the tool's frame in the global one.
  pure function tensor_to_global(self, tensor)
    class(placement_t), intent(in) :: self
    real(wp), intent(in) :: tensor(3, 3)
    real(wp) :: tensor_to_global(3, 3)

    tensor_to_global = matmul(self%rotation, matmul(tensor, transpose(self%rotation)))
  end function tensor_to_global

  !> Return the displacement of the tool's material point that arrives at a place, mm.
  pure function point_displacement(from, to, x) result(displacement)
    !> Placements of the tool before and after.
    type(placement_t), intent(in) :: from, to
    !> Place of the point after, mm.
    real(wp), intent(in) :: x(3)
    real(wp) :: displacement(3)

    displacement = to%translation - from%translation + by_rotation(from, to, x)
  end function point_displacement

  !> Return the displacement of a point of the sheet less that of the tool's material point under
  !> it, mm.
  pure function relative_displacement(from, to, before, after) result(displacement)
    !> Placements of the tool before and after.
    type(placement_t), intent(in) :: from, to
    !> Positions of the point, mm.
    real(wp), intent(in) :: before(3), after(3)
    real(wp) :: displacement(3)

    displacement = after - before - to%translation + from%translation - by_rotation(from, to, after)
  end function relative_displacement

  !> Return the part of the rotation in the displacement of a tool's material point, mm.
  pure function by_rotation(from, to, x) result(displacement)
    type(placement_t), intent(in) :: from, to
    !> Place of the point after, mm.
    real(wp), intent(in) :: x(3)
    real(wp) :: displacement(3)

    displacement = matmul(to%rotation - from%rotation, to%to_tool(x))
  end function by_rotation

end module dd3_tools_placement
