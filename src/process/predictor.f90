! SPDX-License-Identifier: GPL-3.0-or-later
!> Predictor: the tangent explicit method. The trial increment of the controlling tool, or of the
!> loads, is imposed on the tangent system of the committed configuration; the solution is linear in
!> it, and the increment made is r times the trial one.
!> Source: McMeeking and Rice 1975; Teodosiu and Cao 1988; Oliveira and Menezes 2004, eqs (7) and
!> (8).
module dd3_process_predictor
  !$ use omp_lib, only : omp_get_thread_num
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : section_material, section_assembly, section_contact
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_base_verdict, only : verdict_converged, verdict_t
  use dd3_contact_operator, only : status_gap
  use dd3_model_bound_nodes, only : forces_on_bound, give_to_parents
  use dd3_model_contact_layer, only : offset_rate
  use dd3_model_model, only : model_t
  use dd3_model_motions, only : motion_displacement
  use dd3_model_phase, only : phase_t
  use dd3_model_reactions, only : unbalanced_forces
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : add_stiffness, rate_of_forces
  use dd3_model_tool_supports, only : on_spacer, support_matrix, support_rate
  use dd3_system_contact, only : predictor_contact
  use dd3_system_internal, only : assemble_stiffness
  use dd3_system_linear_problem, only : unknowns_t
  use dd3_system_reduced, only : read_step
  use dd3_system_solve, only : solve_info_t, solve_reduced
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: prediction_t, new_prediction, predict

  !> Solution for the trial increment.
  type :: prediction_t
    !> Progress of the phase.
    real(wp) :: progress = 0.0_wp
    !> Increments of the unknowns.
    type(unknowns_t) :: step
    !> Strain increment, Kelvin, material frame, `(6, n_point, n_element)`.
    real(wp), allocatable :: strain(:, :, :)
    !> Rotation increment, rad, `(n_point, n_element)`.
    real(wp), allocatable :: rotation(:, :)
    !> Point taken as plastic, `(n_point, n_element)`.
    logical, allocatable :: plastic(:, :)
  end type prediction_t

  !> Largest number of passes in which unloading plastic points are made elastic.
  integer, parameter :: most_switches = 2

contains

  !> Allocate a prediction and set it to zero.
  subroutine new_prediction(self, model)
    type(prediction_t), intent(out) :: self
    type(model_t), intent(in) :: model

    integer :: n_point, n

    n_point = model%element%n_point
    n = size(model%part%element)
    allocate (self%step%x(3, model%n_node), self%step%lambda(3, model%n_contact), &
        self%step%enhanced(model%element%n_enhanced, n), &
        self%step%tool(3, model%n_tool), self%step%tilt(3, model%n_tool), source=0.0_wp)
    allocate (self%strain(6, n_point, n), source=0.0_wp)
    allocate (self%rotation(n_point, n), source=0.0_wp)
    allocate (self%plastic(n_point, n), source=.false.)
  end subroutine new_prediction

  !> Solve for the trial increment of the running phase.
  subroutine predict(self, model, committed, system, solver, verdict)
    type(prediction_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(system_t), intent(inout) :: system
    !> Work of the linear solver, summed up.
    type(solve_info_t), intent(inout) :: solver
    !> Retry if there is no solution.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: counts(2)
    integer :: switch, switched

    associate (phase => model%phase(committed%phase), &
        unloading => model%phase(committed%phase)%limits%unloading)
      self%progress = phase%trial
      self%plastic(:, :) = committed%sheet%plastic
      call system%profile%start()
      call predictor_contact(system, model, committed)
      call system%profile%add(section_contact)
      call impose_trial(self, model, phase, committed, system)
      do switch = 0, most_switches
        call continuum_tangents(self, model, committed, system)
        call system%profile%add(section_material)
        call assemble_stiffness(system, model, committed)
        call add_stiffness(committed%term, model, committed%configuration_t, system%matrix)
        call system%profile%add(section_assembly)
        call solve_reduced(system, model, committed, solver, verdict)
        if (verdict%outcome /= verdict_converged) return
        call system%profile%start()
        call read_step(system, model, committed, self%step)
        call point_increments(self, model, committed, system)
        call switch_unloading(self, model, committed, switched)
        if (.not. unloading%active) exit
        counts = real([switched, count(committed%sheet%plastic)], wp)
        call sum_over_ranks(2, counts)
        if (counts(1) <= unloading%value*counts(2)) exit
      end do
      where (spread(system%contact%status == status_gap, 1, 3)) self%step%lambda = 0.0_wp
    end associate
  end subroutine predict

  !> Set the right-hand sides of the trial increment: increments of the loads, displacements of the
  !> tools.
  subroutine impose_trial(self, model, phase, committed, system)
    type(prediction_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: committed
    type(system_t), intent(inout) :: system

    real(wp) :: load_rate
    integer :: tool

    associate (problem => system%problem, start => committed%start, &
        factor => self%progress*phase%slope(committed%progress))
      problem%residual = -rate_of_forces(committed%term, model, committed%configuration_t, &
          self%progress)
      problem%bound_force = forces_on_bound(model, unbalanced_forces(model, committed))
      call give_to_parents(model, committed%x, problem%residual)
      call move_contacts(self, model, committed, system)
      problem%prescribed = factor*phase%displacement
      call add_motions(self, model, phase, committed, problem%prescribed)
      do tool = 1, model%n_tool
        problem%tool_prescribed(:, tool) = self%progress &
            *phase%tool_rate(tool, committed%progress, start%tool_displacement)
      end do
      do tool = 1, model%n_tool
        load_rate = self%progress*dot_product(phase%tool_load_rate(tool, committed%progress, &
            start%tool_load(:, tool), start%tool_load_end(:, tool)), phase%direction(:, tool))
        problem%tool_residual(:, tool) = [load_rate, 0.0_wp, 0.0_wp]
        if (.not. phase%pressed(tool)) cycle
        problem%tool_residual(:, tool) = problem%tool_residual(:, tool) &
            + support_rate(phase, committed%tools, tool, load_rate, problem%tool_prescribed)
        problem%tool_stiffness(:, :, tool) = support_matrix(phase, committed%tools, tool)
        problem%supported(tool) = on_spacer(phase, committed%tools, tool)
      end do
    end associate
  end subroutine impose_trial

  !> Set the change of the contact forces by the layers that advance and the tools that turn.
  subroutine move_contacts(self, model, committed, system)
    type(prediction_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(system_t), intent(inout) :: system

    integer :: c

    system%problem%contact_residual = 0.0_wp
    associate (contact => system%contact)
      do c = 1, size(contact%tool)
        if (contact%tool(c) == 0) cycle
        system%problem%contact_residual(:, c) = self%progress*matmul(contact%d(:, :, c), &
            offset_rate(model, committed, contact%tool(c))*contact%normal(:, c) &
            - contact%turning(:, c))
      end do
    end associate
  end subroutine move_contacts

  !> Add the curved motions to the prescribed displacements of the trial increment, along their
  !> tangents.
  subroutine add_motions(self, model, phase, committed, prescribed)
    type(prediction_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: committed
    real(wp), intent(inout) :: prescribed(:, :)

    !> Part of the motion over which the tangent is taken.
    real(wp), parameter :: part = 1.0e-5_wp
    real(wp) :: here, ahead(3, model%n_node), behind(3, model%n_node), &
        undeformed(3, model%n_node)
    integer :: i

    if (size(phase%motion) == 0) return
    here = phase%factor(committed%progress)
    ahead = 0.0_wp
    behind = 0.0_wp
    undeformed = model%undeformed_positions()
    do i = 1, size(phase%motion)
      call motion_displacement(phase%motion(i), undeformed, committed%start%x, here + part, ahead)
      call motion_displacement(phase%motion(i), undeformed, committed%start%x, here - part, behind)
    end do
    prescribed = prescribed + self%progress*phase%slope(committed%progress)/(2.0_wp*part) &
        *(ahead - behind)
  end subroutine add_motions

  !> Evaluate the continuum tangents, elastic where a point is not taken as plastic.
  subroutine continuum_tangents(self, model, committed, system)
    type(prediction_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(system_t), intent(inout) :: system

    integer :: e, p

    !$omp parallel do num_threads(model%element_threads()) private(e, p)
    do e = 1, size(model%part%element)
      associate (material => model%material(model%material_of(model%part%element(e))))
        do p = 1, model%element%n_point
          call material%continuum_tangent(committed%sheet%stress(:, p, e), &
              committed%sheet%internal_variables(:, p, e), self%plastic(p, e), system%tangent(:, &
              :, p, e))
        end do
      end associate
    end do
    !$omp end parallel do
  end subroutine continuum_tangents

  !> Evaluate the strain and rotation increments of the trial displacement.
  subroutine point_increments(self, model, committed, system)
    type(prediction_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Provides the workspaces.
    type(system_t), intent(inout) :: system

    type(verdict_t) :: verdict
    integer :: e, thread

    !$omp parallel num_threads(model%element_threads()) private(e, thread, verdict)
    thread = 1
    !$ thread = omp_get_thread_num() + 1
    !$omp do
    do e = 1, size(model%part%element)
      associate (nodes => model%connectivity(:, model%part%element(e)), &
          element => model%element, work => system%element(thread))
        work%x_committed(:, :) = committed%x(:, nodes)
        work%enhanced(:) = self%step%enhanced(:, e)
        work%x_initial(:, :) = model%x0(:, nodes)
        call element%linearise(element, committed%sheet%orientation(:, :, :, e), work, verdict)
        call element%evaluate_rate(element, self%step%x(:, nodes), &
            committed%sheet%orientation(:, :, :, e), work)
        self%strain(:, :, e) = work%strain_increment
        self%rotation(:, e) = work%rotation_increment
      end associate
    end do
    !$omp end do
    !$omp end parallel
  end subroutine point_increments

  !> Make plastic points elastic if the trial strain unloads them: V : C : D <= 0.
  subroutine switch_unloading(self, model, committed, switched)
    type(prediction_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Number of these points in the part.
    integer, intent(out) :: switched

    real(wp) :: direction(6)
    integer :: e, p

    switched = 0
    !$omp parallel do num_threads(model%element_threads()) &
    !$omp& private(direction, e, p) reduction(+: switched)
    do e = 1, size(model%part%element)
      associate (material => model%material(model%material_of(model%part%element(e))))
        do p = 1, model%element%n_point
          if (.not. self%plastic(p, e)) cycle
          direction = material%plastic_direction(committed%sheet%stress(:, p, e), &
              committed%sheet%internal_variables(:, p, e))
          if (dot_product(direction, matmul(material%laws%elasticity%stiffness, &
              self%strain(:, p, e))) > 0.0_wp) cycle
          self%plastic(p, e) = .false.
          switched = switched + 1
        end do
      end associate
    end do
    !$omp end parallel do
  end subroutine switch_unloading

end module dd3_process_predictor
