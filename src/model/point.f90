!> The run of a single material point: what leads it where.
module dd3_model_point
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: point_t, point_stage_t

  !> A part of the run.
  type :: point_stage_t
    !> Stress (MPa) or logarithmic strain of each component at its end, Kelvin.
    real(wp) :: goal(6) = 0.0_wp
    !> Deformation gradient at its end.
    real(wp) :: gradient(3, 3) = 0.0_wp
    !> Equal steps it is taken in.
    integer :: steps = 1
  end type point_stage_t

  !> The run.
  type :: point_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Number of its material.
    integer :: material = 0
    !> Orthotropy axes at the start, columns RD, TD, ND.
    real(wp) :: axes(3, 3) = 0.0_wp
    !> Whether deformation gradients lead it.
    logical :: by_gradient = .false.
    !> Whether each component is led by stress, in the order of Kelvin vectors.
    logical :: by_stress(6) = .false.
    !> Its parts, in order.
    type(point_stage_t), allocatable :: stage(:)
  end type point_t

end module dd3_model_point
