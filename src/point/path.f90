! SPDX-License-Identifier: GPL-3.0-or-later
!> Path of a material point: the segments of a `*POINT` run, components in the order of Kelvin
!> vectors, shears with their factor, deformation gradients as matrices.
module dd3_point_path
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : point_goal_t, point_spec_t
  use dd3_linalg_tensor, only : kelvin_factor
  implicit none
  private
  public :: path_t, segment_t, new_path

  !> Position in the input of the components 11 22 33 23 31 12.
  integer, parameter :: place(6) = [1, 2, 3, 5, 6, 4]

  !> Segment of a path.
  type :: segment_t
    !> Stress (MPa) or logarithmic strain at its end, Kelvin.
    real(wp) :: target(6) = 0.0_wp
    !> Deformation gradient at its end.
    real(wp) :: gradient(3, 3) = 0.0_wp
    !> Number of equal steps.
    integer :: steps = 1
    !> Time of a step, s; 0 if none is given.
    real(wp) :: time = 0.0_wp
  end type segment_t

  !> Path of a material point.
  type :: path_t
    character(len=:), allocatable :: name
    !> Number of the material.
    integer :: material = 0
    !> Orthotropy axes at the start, columns RD, TD, ND.
    real(wp) :: axes(3, 3) = 0.0_wp
    !> The deformation gradient is prescribed.
    logical :: by_gradient = .false.
    !> The stress component is prescribed, not the strain component; Kelvin order.
    logical :: by_stress(6) = .false.
    type(segment_t), allocatable :: segment(:)
  end type path_t

contains

  !> Make the path of a checked run.
  subroutine new_path(self, spec)
    type(path_t), intent(out) :: self
    type(point_spec_t), intent(in) :: spec

    integer :: i

    self%name = spec%name
    self%material = spec%material
    self%axes = spec%frame
    self%by_gradient = spec%by_gradient
    self%by_stress = spec%by_stress(place)
    allocate (self%segment(size(spec%goal)))
    do i = 1, size(spec%goal)
      self%segment(i) = new_segment(spec%goal(i), spec%by_gradient)
    end do
  end subroutine new_path

  !> Make a segment.
  pure type(segment_t) function new_segment(goal, by_gradient) result(segment)
    type(point_goal_t), intent(in) :: goal
    logical, intent(in) :: by_gradient

    segment%steps = goal%steps
    segment%time = goal%duration/real(goal%steps, wp)
    if (by_gradient) then
      segment%gradient = transpose(reshape(goal%value, [3, 3]))
    else
      segment%target = kelvin_factor*goal%value(place)
    end if
  end function new_segment

end module dd3_point_path
