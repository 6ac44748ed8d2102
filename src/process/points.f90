!> Runs single material points, without a mesh: stage by stage, step by step, with their history. A
!> deformation gradient is followed with the incremental kinematics of the elements: polar
!> decomposition of the step, logarithmic strain, material axes that turn with the rotation.
module dd3_process_points
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_log, only : log_t
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_element_increment, only : polar_increment
  use dd3_linalg_tensor, only : determinant, identity, inverse, kelvin_factor, &
      kelvin_from_tensor, symmetric_eigen
  use dd3_material_material, only : material_t
  use dd3_material_point, only : material_point_t, apply_strain, drive_to_target, global_stress, &
      new_material_point
  use dd3_model_model, only : model_t
  use dd3_model_point, only : point_t, point_stage_t
  use dd3_output_interrupt, only : interrupted
  use dd3_output_point_history, only : point_record_t, point_row_t
  implicit none
  private
  public :: run_points

  !> Logarithmic strain that is seldom meant: more than seven times the length.
  real(wp), parameter :: notable_strain = 2.0_wp

  !> A point under way.
  type :: traveller_t
    !> Its state.
    type(material_point_t) :: state
    !> Deformation gradient, where it is led by one.
    real(wp) :: gradient(3, 3) = 0.0_wp
    !> Steps taken.
    integer :: increment = 0
    !> The last row was not written, because it was not its turn.
    logical :: waiting = .false.
  end type traveller_t

contains

  !> Runs all points, or says why it stopped; the history is whole either way.
  subroutine run_points(model, directory, log, increments, error)
    !> The model.
    type(model_t), intent(in) :: model
    !> The directory of the results; it exists.
    character(len=*), intent(in) :: directory
    !> Where the run speaks.
    type(log_t), intent(inout) :: log
    !> Steps taken by all points.
    integer, intent(out) :: increments
    !> Set where the run stopped before the end.
    type(error_t), allocatable, intent(out) :: error

    type(point_record_t) :: record
    type(error_t), allocatable :: failure
    integer :: i, taken

    increments = 0
    call record%open(directory, error)
    do i = 1, size(model%point)
      if (allocated(error)) exit
      call run_point(model, model%point(i), record, log, taken, error)
      increments = increments + taken
    end do
    call record%close(failure)
    if (.not. allocated(error)) call move_alloc(failure, error)
  end subroutine run_points

  !> Runs one point.
  subroutine run_point(model, point, record, log, taken, error)
    !> The model.
    type(model_t), intent(in) :: model
    !> The point.
    type(point_t), intent(in) :: point
    !> The history.
    type(point_record_t), intent(inout) :: record
    !> Where the run speaks.
    type(log_t), intent(inout) :: log
    !> Steps taken.
    integer, intent(out) :: taken
    !> Why it stopped before the end.
    type(error_t), allocatable, intent(out) :: error

    type(traveller_t) :: traveller
    type(error_t), allocatable :: late
    real(wp) :: strain
    integer :: i

    strain = 0.0_wp
    associate (material => model%material(point%material))
      call new_material_point(traveller%state, material, point%axes)
      traveller%gradient = identity
      call write_row(traveller, material, point, record, error)
      do i = 1, size(point%stage)
        if (allocated(error)) exit
        call run_stage(traveller, material, point, point%stage(i), model%output%history_every, &
                       record, error)
        strain = max(strain, maxval(abs(traveller%state%strain/kelvin_factor)))
      end do
      taken = traveller%increment
      if (.not. allocated(error)) &
        call log%say("point "//point%name//": "//to_text(taken)//" steps")
      if (strain > notable_strain) call log%say("warning: point "//point%name// &
          ": logarithmic strain of "//to_text(strain, 4)//": unusual; 0.1 is about 10 %")
      if (traveller%waiting) call write_row(traveller, material, point, record, late)
      if (.not. allocated(error)) call move_alloc(late, error)
    end associate
  end subroutine run_point

  !> Runs one stage of a point.
  subroutine run_stage(traveller, material, point, stage, every, record, error)
    !> The point under way.
    type(traveller_t), intent(inout) :: traveller
    !> Its material.
    type(material_t), intent(in) :: material
    !> The point.
    type(point_t), intent(in) :: point
    !> The stage.
    type(point_stage_t), intent(in) :: stage
    !> A row every so many steps.
    integer, intent(in) :: every
    !> The history.
    type(point_record_t), intent(inout) :: record
    !> Why it stopped before the end.
    type(error_t), allocatable, intent(out) :: error

    type(verdict_t) :: verdict
    real(wp) :: start(6), gradient(3, 3), part
    integer :: k

    start = merge(global_stress(traveller%state), traveller%state%strain, point%by_stress)
    gradient = traveller%gradient
    do k = 1, stage%steps
      part = real(k, wp)/real(stage%steps, wp)
      if (point%by_gradient) then
        call follow_gradient(traveller, material, gradient + part*(stage%gradient - gradient), &
                             verdict)
      else
        call drive_to_target(traveller%state, material, point%by_stress, &
            start + part*(stage%goal - start), verdict)
      end if
      if (verdict%outcome /= verdict_converged) then
        call fatal_error(error, "point "//point%name//", step "// &
            to_text(traveller%increment + 1)//": "//trim(verdict%reason))
        return
      end if
      traveller%increment = traveller%increment + 1
      traveller%waiting = mod(traveller%increment, max(1, every)) /= 0
      if (.not. traveller%waiting) call write_row(traveller, material, point, record, error)
      if (allocated(error)) return
      if (interrupted()) then
        call fatal_error(error, "interrupted by the user in point "//point%name//", step "// &
            to_text(traveller%increment))
        return
      end if
    end do
  end subroutine run_stage

  !> Brings a point to a deformation gradient.
  subroutine follow_gradient(traveller, material, gradient, verdict)
    !> The point under way.
    type(traveller_t), intent(inout) :: traveller
    !> Its material.
    type(material_t), intent(in) :: material
    !> The gradient from the start.
    real(wp), intent(in) :: gradient(3, 3)
    !> How it ended.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: back(3, 3), strain(6), rotation(3, 3)
    logical :: regular

    call inverse(traveller%gradient, back, regular)
    regular = regular .and. determinant(gradient) > 0.0_wp
    if (.not. regular) verdict%reason = "det F is not positive"
    if (.not. regular) return
    call polar_increment(matmul(gradient, back), strain, rotation)
    call apply_strain(traveller%state, material, kelvin_factor*strain, rotation, verdict)
    if (verdict%outcome /= verdict_converged) return
    traveller%gradient = gradient
    traveller%state%strain = left_strain(gradient)
  end subroutine follow_gradient

  !> Logarithm of the left stretch, ln V of F = V R, Kelvin: the strain in the axes of the stress.
  function left_strain(gradient) result(strain)
    !> The deformation gradient F.
    real(wp), intent(in) :: gradient(3, 3)
    real(wp) :: strain(6)

    real(wp) :: values(3), vectors(3, 3), logarithm(3, 3)
    integer :: i

    call symmetric_eigen(matmul(gradient, transpose(gradient)), values, vectors)
    do i = 1, 3
      logarithm(:, i) = 0.5_wp*log(values(i))*vectors(:, i)
    end do
    strain = kelvin_from_tensor(matmul(logarithm, transpose(vectors)))
  end function left_strain

  !> Writes the row of a state.
  subroutine write_row(traveller, material, point, record, error)
    !> The point under way.
    type(traveller_t), intent(inout) :: traveller
    !> Its material.
    type(material_t), intent(in) :: material
    !> The point.
    type(point_t), intent(in) :: point
    !> The history.
    type(point_record_t), intent(inout) :: record
    !> Why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(point_row_t) :: row

    row%increment = traveller%increment
    row%point = point%name
    row%strain = traveller%state%strain
    row%stress = global_stress(traveller%state)
    row%plastic = traveller%state%internal_variables(1)
    row%flow_stress = material%flow_stress(traveller%state%internal_variables)
    call record%write(row, error)
    traveller%waiting = .false.
  end subroutine write_row

end module dd3_process_points
