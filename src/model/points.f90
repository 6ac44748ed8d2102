!> Runs of single material points from the case: components in the order of Kelvin vectors, shears
!> with their factor, gradients as matrices.
module dd3_model_points
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t, point_spec_t, point_goal_t
  use dd3_linalg_tensor, only : kelvin_factor
  use dd3_model_model, only : model_t
  use dd3_model_point, only : point_t, point_stage_t
  implicit none
  private
  public :: new_points

  !> Where the components 11 22 33 23 31 12 stand in the input.
  integer, parameter :: place(6) = [1, 2, 3, 5, 6, 4]

contains

  !> Takes them all.
  subroutine new_points(model, case)
    !> The model.
    type(model_t), intent(inout) :: model
    !> The case, checked.
    type(case_t), intent(in) :: case

    integer :: i

    allocate (model%point(size(case%point)))
    do i = 1, size(case%point)
      call take_point(model%point(i), case%point(i))
    end do
    if (size(case%point) > 0) model%output%history_every = case%output%history
  end subroutine new_points

  !> Takes one.
  subroutine take_point(point, spec)
    !> The run.
    type(point_t), intent(inout) :: point
    !> The run as written.
    type(point_spec_t), intent(in) :: spec

    integer :: i

    point%name = spec%name
    point%material = spec%material
    point%axes = spec%frame
    point%by_gradient = spec%by_gradient
    point%by_stress = spec%by_stress(place)
    allocate (point%stage(size(spec%goal)))
    do i = 1, size(spec%goal)
      call take_stage(point%stage(i), spec%goal(i), spec%by_gradient)
    end do
  end subroutine take_point

  !> Takes a part of one.
  pure subroutine take_stage(stage, goal, by_gradient)
    !> The part.
    type(point_stage_t), intent(inout) :: stage
    !> The goal as written.
    type(point_goal_t), intent(in) :: goal
    !> Whether it is a gradient.
    logical, intent(in) :: by_gradient

    stage%steps = goal%steps
    if (by_gradient) then
      stage%gradient = transpose(reshape(goal%value, [3, 3]))
    else
      stage%goal = kelvin_factor*goal%value(place)
    end if
  end subroutine take_stage

end module dd3_model_points
