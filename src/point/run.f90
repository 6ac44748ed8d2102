! SPDX-License-Identifier: GPL-3.0-or-later
!> Runs of material points, without a mesh: segment by segment, step by step, with their history. A
!> prescribed deformation gradient is integrated with the incremental kinematics of the elements:
!> polar decomposition of the step, logarithmic strain, material axes that turn with the rotation.
module dd3_point_run
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t, fatal_error, keep_first
  use dd3_base_interrupt, only : interrupted, interruption, interruption_code
  use dd3_base_log, only : log_t
  use dd3_base_cause_text, only : cause_code, cause_text
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_converged, verdict_t, cause_gradient
  use dd3_element_log_strain, only : polar_increment
  use dd3_input_case, only : case_t
  use dd3_linalg_tensor, only : determinant, identity, inverse, kelvin_factor, kelvin_from_tensor, &
      symmetric_eigen
  use dd3_material_material, only : material_t
  use dd3_material_point, only : apply_strain, drive_to_target, global_stress, material_point_t, &
      new_material_point
  use dd3_model_internal_variables, only : global_components
  use dd3_model_model, only : model_t
  use dd3_point_history, only : point_record_t, point_row_t
  use dd3_point_path, only : new_path, path_t, segment_t
  implicit none
  private
  public :: run_points

  !> Logarithmic strain above which a warning is given: a stretch of more than seven.
  real(wp), parameter :: notable_strain = 2.0_wp

  !> A material point during its run.
  type :: point_run_t
    type(material_point_t) :: state = material_point_t()
    !> Deformation gradient, if it is prescribed.
    real(wp) :: gradient(3, 3) = 0.0_wp
    !> Steps made.
    integer :: increment = 0
    !> Time since the start, s.
    real(wp) :: time = 0.0_wp
    !> Interval of the rows, in steps.
    integer :: every = 1
    !> The last row was not due and is not written yet.
    logical :: waiting = .false.
    !> Steps in which fracture and the forming limit were reached; 0 if they were not.
    integer :: fractured = 0, necked = 0
  end type point_run_t

contains

  !> Run all material points of a case. The history is whole whether they reach their end or not.
  subroutine run_points(case, model, directory, log, increments, error)
    type(case_t), intent(in) :: case
    !> Holds the materials.
    type(model_t), intent(in) :: model
    !> Folder of the results; it exists.
    character(len=*), intent(in) :: directory
    type(log_t), intent(inout) :: log
    !> Steps made by all points.
    integer, intent(out) :: increments
    !> Set if a run stopped before its end.
    type(error_t), allocatable, intent(out) :: error

    type(point_record_t) :: record
    type(path_t) :: path
    type(point_run_t) :: run
    type(error_t), allocatable :: late
    integer :: i

    increments = 0
    call record%open(directory, model%internal_variable, &
        any([(any(case%point(i)%goal%duration > 0.0_wp), i=1, size(case%point))]), error)
    do i = 1, size(case%point)
      if (allocated(error)) exit
      call new_path(path, case%point(i))
      run = point_run_t(every=max(1, case%output%history))
      call run_point(run, path, model, record, log, error)
      increments = increments + run%increment
    end do
    call record%close(late)
    call keep_first(error, late)
  end subroutine run_points

  !> Run one material point.
  subroutine run_point(run, path, model, record, log, error)
    !> New on entry.
    type(point_run_t), intent(inout) :: run
    type(path_t), intent(in) :: path
    type(model_t), intent(in) :: model
    type(point_record_t), intent(inout) :: record
    type(log_t), intent(inout) :: log
    !> Set if the run stopped before its end.
    type(error_t), allocatable, intent(out) :: error

    type(error_t), allocatable :: late
    real(wp) :: strain
    integer :: i

    strain = 0.0_wp
    call new_material_point(run%state, model%material(path%material), path%axes)
    run%gradient = identity
    call write_row(run, model, path, record, error)
    do i = 1, size(path%segment)
      if (allocated(error)) exit
      call run_segment(run, model, path, path%segment(i), record, error)
      strain = max(strain, maxval(abs(run%state%strain/kelvin_factor)))
    end do
    if (.not. allocated(error)) then
      call log%say("point "//path%name//": "//to_text(run%increment)//" steps"// &
          limits_text(run, model%material(path%material)))
    end if
    log%increment = run%increment
    if (run%fractured > 0) call log%report("W126", "point "//path%name// &
        ": fracture is reached in step "//to_text(run%fractured))
    if (run%necked > 0) call log%report("W127", "point "//path%name// &
        ": the forming limit is reached in step "//to_text(run%necked))
    if (strain > notable_strain) call log%report("W113", "point "//path%name// &
        ": logarithmic strain of "//to_text(strain, 4)//": unusual; 0.1 is about 10 %")
    if (run%waiting) call write_row(run, model, path, record, late)
    call keep_first(error, late)
  end subroutine run_point

  !> Run one segment of a path.
  subroutine run_segment(run, model, path, segment, record, error)
    type(point_run_t), intent(inout) :: run
    type(model_t), intent(in) :: model
    type(path_t), intent(in) :: path
    type(segment_t), intent(in) :: segment
    type(point_record_t), intent(inout) :: record
    !> Set if the run stopped before its end.
    type(error_t), allocatable, intent(out) :: error

    type(verdict_t) :: verdict
    real(wp) :: start(6), gradient(3, 3), fraction
    integer :: k

    start = merge(global_stress(run%state), run%state%strain, path%by_stress)
    gradient = run%gradient
    do k = 1, segment%steps
      fraction = real(k, wp)/real(segment%steps, wp)
      if (path%by_gradient) then
        call apply_gradient(run, model%material(path%material), &
            gradient + fraction*(segment%gradient - gradient), segment%time, verdict)
      else
        call drive_to_target(run%state, model%material(path%material), path%by_stress, &
            start + fraction*(segment%target - start), segment%time, verdict)
      end if
      if (verdict%outcome /= verdict_converged) then
        call fatal_error(error, "point "//path%name//", step "// &
            to_text(run%increment + 1)//": "//cause_text(verdict, ""), cause_code(verdict))
        return
      end if
      run%increment = run%increment + 1
      run%time = run%time + segment%time
      call find_limits(run, model%material(path%material))
      run%waiting = mod(run%increment, run%every) /= 0
      if (.not. run%waiting) call write_row(run, model, path, record, error)
      if (allocated(error)) return
      if (interrupted()) then
        call fatal_error(error, interruption()//" in point "//path%name//", step "// &
            to_text(run%increment), interruption_code)
        return
      end if
    end do
  end subroutine run_segment

  !> Find whether fracture and the forming limit are reached.
  subroutine find_limits(run, material)
    type(point_run_t), intent(inout) :: run
    type(material_t), intent(in) :: material

    associate (laws => material%laws, variables => run%state%internal_variables)
      if (laws%at_damage > 0 .and. run%fractured == 0) then
        if (variables(laws%at_damage) >= 1.0_wp) run%fractured = run%increment
      end if
      if (laws%at_forming_limit > 0 .and. run%necked == 0) then
        if (variables(laws%at_forming_limit) >= 1.0_wp) run%necked = run%increment
      end if
    end associate
  end subroutine find_limits

  !> Return damage and ratio to the forming limit as text; empty without such laws.
  function limits_text(run, material) result(text)
    type(point_run_t), intent(in) :: run
    type(material_t), intent(in) :: material
    character(len=:), allocatable :: text

    text = ""
    associate (laws => material%laws, variables => run%state%internal_variables)
      if (laws%at_damage > 0) text = text//", damage "//to_text(variables(laws%at_damage), 3)
      if (laws%at_forming_limit > 0) text = text//", ratio to the forming limit "// &
          to_text(variables(laws%at_forming_limit), 3)
    end associate
  end function limits_text

  !> Bring a material point to a deformation gradient.
  subroutine apply_gradient(run, material, gradient, time, verdict)
    type(point_run_t), intent(inout) :: run
    type(material_t), intent(in) :: material
    !> Relative to the start.
    real(wp), intent(in) :: gradient(3, 3)
    !> Time of the step, s.
    real(wp), intent(in) :: time
    type(verdict_t), intent(out) :: verdict

    real(wp) :: inverse_before(3, 3), strain(6), rotation(3, 3)
    logical :: regular

    call inverse(run%gradient, inverse_before, regular)
    regular = regular .and. determinant(gradient) > 0.0_wp
    if (.not. regular) verdict%cause = cause_gradient
    if (.not. regular) return
    call polar_increment(matmul(gradient, inverse_before), strain, rotation)
    call apply_strain(run%state, material, kelvin_factor*strain, rotation, time, verdict)
    if (verdict%outcome /= verdict_converged) return
    run%gradient = gradient
    run%state%strain = left_strain(gradient)
  end subroutine apply_gradient

  !> Return the logarithm of the left stretch, ln V of F = V R, Kelvin: the strain in the axes of
  !> the stress.
  function left_strain(gradient) result(strain)
    !> Deformation gradient F.
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

  !> Write the row of a state.
  subroutine write_row(run, model, path, record, error)
    type(point_run_t), intent(inout) :: run
    type(model_t), intent(in) :: model
    type(path_t), intent(in) :: path
    type(point_record_t), intent(inout) :: record
    !> Set if the row cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(point_row_t) :: row
    integer :: i

    row%increment = run%increment
    row%time = run%time
    row%point = path%name
    row%strain = run%state%strain
    row%stress = global_stress(run%state)
    row%plastic = run%state%internal_variables(1)
    row%flow_stress = model%material(path%material)%flow_stress(run%state%internal_variables)
    row%internal_variables = [real(wp) ::]
    do i = 1, size(model%internal_variable)
      row%internal_variables = [row%internal_variables, &
          global_components(model%internal_variable(i), path%material, &
              run%state%internal_variables, run%state%axes)]
    end do
    call record%write(row, error)
    run%waiting = .false.
  end subroutine write_row

end module dd3_point_run
