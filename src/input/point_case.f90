! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of the case: runs of single material points.
module dd3_input_point_case
  use dd3_base_error, only : location_t
  use dd3_base_kinds, only : wp
  use dd3_input_block, only : block_t
  implicit none
  private
  public :: gradient_values, point_goal_t, point_spec_t

  !> Number of components of a deformation gradient.
  integer, parameter :: gradient_values = 9

  !> A target of a single-point run.
  type :: point_goal_t
    !> Strains (tensorial shear) and stresses (MPa) 11 22 33 12 23 13; or the deformation gradient
    !> row by row.
    real(wp), allocatable :: value(:)
    !> Number of equal steps.
    integer :: steps = 1
    !> Time of all steps, s; 0 if not given.
    real(wp) :: duration = 0.0_wp
    type(location_t) :: at
  end type point_goal_t

  !> A run of a single material point.
  type :: point_spec_t
    character(len=:), allocatable :: name
    !> Position in `case%material`.
    integer :: material = 0
    !> Rolling, transverse and normal direction at the start, in columns.
    real(wp) :: frame(3, 3) = 0.0_wp
    !> Whether the targets are deformation gradients.
    logical :: by_gradient = .false.
    !> Whether the stress is prescribed, 11 22 33 12 23 13; the strain otherwise.
    logical :: by_stress(6) = .false.
    !> Targets in order.
    type(point_goal_t), allocatable :: goal(:)
    type(block_t) :: source
  end type point_spec_t

end module dd3_input_point_case
