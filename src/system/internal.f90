! SPDX-License-Identifier: GPL-3.0-or-later
!> Internal forces and stiffness of the sheet: the loops over the elements and their integration
!> points.
!>
!> Batches of elements of one colour share no node, so threads add their forces without conflict;
!> the colours follow one another, which makes every sum independent of the number of threads.
module dd3_system_internal
  !$ use omp_lib, only : omp_get_thread_num
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_base_threads, only : least_points, threads_for
  use dd3_base_verdict, only : cause_inverted, verdict_t, verdict_converged, verdict_retry
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use dd3_linalg_matrix, only : add_element, clear, copy_values
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_partition, only : share_verdict
  use dd3_system_enhanced, only : store_condensation
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: update_material, assemble_stiffness, evaluate_fading

  !> Length of a column over the initial one up to which its nodes count as one place.
  real(wp), parameter :: flat = 1.0e-3_wp

contains

  !> Integrate the material from the committed to the trial configuration, and evaluate the internal
  !> forces and, optionally, the stiffness.
  subroutine update_material(system, model, committed, trial, with_stiffness, verdict)
    !> Gets the consistent tangents and the stiffness.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Positions on entry; gets stresses, internal variables, axes and internal forces.
    type(state_t), intent(inout) :: trial
    logical, intent(in) :: with_stiffness
    !> Retry if an element is inverted or a return mapping fails, with the lowest such element.
    type(verdict_t), intent(out) :: verdict

    trial%sheet%internal_force = 0.0_wp
    call visit_elements(system, model, committed, .true., with_stiffness, verdict, trial)
    call share_verdict(verdict)
    if (verdict%outcome /= verdict_converged) return
    call sum_over_ranks(size(trial%sheet%internal_force), trial%sheet%internal_force)
    if (with_stiffness) call system%partition%complete_forces(model%n_node, system%enhanced%force)
  end subroutine update_material

  !> Assemble the exact stiffness of the trial configuration from the tangents of the last update
  !> or, without a trial state, that of the committed configuration from the tangents in the system.
  subroutine assemble_stiffness(system, model, committed, trial)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> State after `update_material`; unchanged.
    type(state_t), intent(inout), optional :: trial

    type(verdict_t) :: verdict

    call visit_elements(system, model, committed, .false., .true., verdict, trial)
    call system%partition%complete_forces(model%n_node, system%enhanced%force)
  end subroutine assemble_stiffness

  !> Evaluate the nodal forces of fading stresses at their full size, in the present configuration.
  subroutine evaluate_fading(system, model, state)
    !> Provides the workspaces.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    !> Gets `fading_force`.
    type(state_t), intent(inout) :: state

    type(verdict_t) :: verdict
    integer :: e

    if (.not. state%sheet%fades) return
    state%sheet%fading_force = 0.0_wp
    associate (work => system%element(1), element => model%element)
      do e = 1, size(model%part%element)
        associate (nodes => model%connectivity(:, model%part%element(e)))
          work%x_committed(:, :) = state%x(:, nodes)
          work%x_trial(:, :) = state%x(:, nodes)
          work%x_initial(:, :) = model%x0(:, nodes)
        end associate
        work%enhanced(:) = 0.0_wp
        call element%deform(element, state%sheet%orientation(:, :, :, e), work, verdict)
        work%stress(:, :) = state%sheet%fading_stress(:, :, e)
        call element%set_stress(element, work)
        call element%evaluate_force(element, work)
        call add_forces(model, e, work%force, state%sheet%fading_force)
      end do
    end associate
    call sum_over_ranks(size(state%sheet%fading_force), state%sheet%fading_force)
  end subroutine evaluate_fading

  !> Update the elements of the system, or set their workspaces, and add their stiffness.
  subroutine visit_elements(system, model, committed, updates, with_stiffness, verdict, trial)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    logical, intent(in) :: updates, with_stiffness
    !> That of the lowest element that fails in the update.
    type(verdict_t), intent(out) :: verdict
    !> Not present for the stiffness of the committed configuration.
    type(state_t), intent(inout), optional :: trial

    type(verdict_t) :: mine
    integer :: colour, k, i, e, batch, thread

    verdict%outcome = verdict_converged
    if (with_stiffness) then
      call clear(system%matrix)
      system%enhanced%force = 0.0_wp
      system%enhanced%offset = 0.0_wp
      system%enhanced%unfollowed_square = 0.0_wp
    end if
    !$omp parallel default(shared) private(mine, colour, k, i, e, batch, thread) &
    !$omp& num_threads(threads_for(size(system%batches%element)*model%element%n_point, &
    !$omp& least_points))
    thread = 1
    !$ thread = omp_get_thread_num() + 1
    do colour = 1, size(system%batches%colour_start) - 1
      !$omp do schedule(dynamic)
      do k = system%batches%colour_start(colour), system%batches%colour_start(colour + 1) - 1
        batch = system%batches%coloured(k)
        do i = system%batches%start(batch), system%batches%start(batch + 1) - 1
          e = system%batches%element(i)
          mine%outcome = verdict_converged
          if (updates) then
            call update_element(model, committed, trial, e, system%element(thread), &
                system%tangent(:, :, :, e), mine)
            system%enhanced%residual(:, e) = system%element(thread)%enhanced_force
            if (mine%outcome == verdict_converged) then
              call add_forces(model, e, system%element(thread)%force, trial%sheet%internal_force)
            end if
          else
            call set_element(model, e, system%element(thread), committed, trial)
          end if
          if (mine%outcome /= verdict_converged) then
            !$omp critical (failed_element)
            if (verdict%outcome == verdict_converged .or. mine%element < verdict%element) then
              verdict = mine
            end if
            !$omp end critical (failed_element)
          else if (with_stiffness) then
            call add_stiffness(system, model, e, system%element(thread))
          end if
        end do
      end do
      !$omp end do
    end do
    !$omp end parallel
  end subroutine visit_elements

  !> Update one element.
  subroutine update_element(model, committed, trial, e, work, tangent, verdict)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Number in the part.
    integer, intent(in) :: e
    !> Workspace; on return it holds the forces, and all that the stiffness needs but the tangents.
    type(element_work_t), intent(inout) :: work
    !> Consistent tangents, `(6, 6, n_point)`, MPa.
    real(wp), intent(inout) :: tangent(:, :, :)
    type(verdict_t), intent(out) :: verdict

    integer :: number, p

    number = model%part%element(e)
    associate (nodes => model%connectivity(:, number), element => model%element, &
        material => model%material(model%material_of(number)))
      work%x_committed(:, :) = committed%x(:, nodes)
      work%x_trial(:, :) = trial%x(:, nodes)
      work%enhanced(:) = trial%sheet%enhanced(:, e)
      work%x_initial(:, :) = model%x0(:, nodes)
      call element%deform(element, committed%sheet%orientation(:, :, :, e), work, verdict)
      if (verdict%outcome == verdict_converged) call check_columns(element, work, verdict)
      verdict%element = number
      if (verdict%outcome /= verdict_converged) return
      do p = 1, model%element%n_point
        associate (n => material%n_internal)
          call material%update(committed%sheet%stress(:, p, e), &
              committed%sheet%internal_variables(:n, p, e), &
              work%strain(:, p), trial%sheet%stress(:, p, e), trial%sheet%internal_variables(:n, &
              p, e), &
              tangent(:, :, p), trial%sheet%plastic(p, e), verdict, trial%time - committed%time)
        end associate
        verdict%element = number
        verdict%point = p
        if (verdict%outcome /= verdict_converged) return
      end do
      trial%sheet%orientation(:, :, :, e) = work%rotation
      work%stress(:, :) = acting_stress(model, trial, e)
      call element%set_stress(element, work)
      call element%evaluate_force(element, work)
    end associate
  end subroutine update_element

  !> Retry if two nodes of a column of an element have come to one place, where the points inside
  !> the element still have a volume.
  pure subroutine check_columns(element, work, verdict)
    type(element_t), intent(in) :: element
    !> Holds the initial and the trial positions.
    type(element_work_t), intent(in) :: work
    type(verdict_t), intent(inout) :: verdict

    integer :: k

    do k = 1, element%n_pair
      associate (bottom => element%pair(1, k), top => element%pair(2, k))
        if (norm2(work%x_trial(:, top) - work%x_trial(:, bottom)) &
            > flat*norm2(work%x_initial(:, top) - work%x_initial(:, bottom))) cycle
      end associate
      verdict%outcome = verdict_retry
      verdict%cause = cause_inverted
      verdict%point = 0
      return
    end do
  end subroutine check_columns

  !> Return the stresses that the forces of an element belong to: those of its points less what is
  !> left of fading ones, in the material frame, Kelvin, `(6, n_point)`, MPa.
  pure function acting_stress(model, state, e) result(stress)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    !> Number in the part.
    integer, intent(in) :: e
    real(wp) :: stress(6, model%element%n_point)

    stress = state%sheet%stress(:, :, e)
    if (state%sheet%fades) stress = stress &
        - model%phase(state%phase)%fading(state%progress)*state%sheet%fading_stress(:, :, e)
  end function acting_stress

  !> Add the forces of an element to those of its nodes.
  pure subroutine add_forces(model, e, force, sum)
    type(model_t), intent(in) :: model
    !> Number in the part.
    integer, intent(in) :: e
    !> `(3, n_element_node)` and `(3, n_node)`, N.
    real(wp), intent(in) :: force(:, :)
    real(wp), intent(inout) :: sum(:, :)

    integer :: a

    associate (nodes => model%connectivity(:, model%part%element(e)))
      do a = 1, size(nodes)
        sum(:, nodes(a)) = sum(:, nodes(a)) + force(:, a)
      end do
    end associate
  end subroutine add_forces

  !> Set the workspace of an element to its trial configuration, or to the committed one.
  subroutine set_element(model, e, work, committed, trial)
    type(model_t), intent(in) :: model
    !> Number in the part.
    integer, intent(in) :: e
    !> Gets all that the stiffness needs but the tangents.
    type(element_work_t), intent(inout) :: work
    type(state_t), intent(in) :: committed
    !> State in which the element is not inverted.
    type(state_t), intent(in), optional :: trial

    type(verdict_t) :: verdict

    associate (element => model%element, nodes => model%connectivity(:, model%part%element(e)))
      work%x_committed(:, :) = committed%x(:, nodes)
      work%x_initial(:, :) = model%x0(:, nodes)
      if (present(trial)) then
        work%x_trial(:, :) = trial%x(:, nodes)
        work%enhanced(:) = trial%sheet%enhanced(:, e)
        call element%deform(element, committed%sheet%orientation(:, :, :, e), work, verdict)
        work%stress(:, :) = acting_stress(model, trial, e)
      else
        call element%linearise(element, committed%sheet%orientation(:, :, :, e), work, verdict)
        work%stress(:, :) = acting_stress(model, committed, e)
      end if
      call element%set_stress(element, work)
    end associate
  end subroutine set_element

  !> Evaluate the stiffness of an element and add its blocks.
  subroutine add_stiffness(system, model, e, work)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    !> Number in the part.
    integer, intent(in) :: e
    !> Holds kinematics, strain, axes and stresses.
    type(element_work_t), intent(inout) :: work

    call copy_values(size(work%tangent), system%tangent(:, :, :, e), work%tangent)
    call model%element%evaluate_stiffness(model%element, work)
    call add_element(system%matrix, model%element%n_node, system%position(:, :, e), &
        work%stiffness)
    if (model%element%n_enhanced > 0) call store_condensation(system%enhanced, model, e, work)
  end subroutine add_stiffness

end module dd3_system_internal
