!> The predictor: the tangent explicit method. The trial increment of the controlling tool, or of
!> the loads, is imposed on the tangent system of the committed configuration; everything found is
!> proportional to it, and the increment taken is r times the trial one.
!> Source: McMeeking and Rice 1975; Teodosiu and Cao 1988; Oliveira and Menezes 2004, eqs (7) and
!> (8).
module dd3_process_predictor
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : section_material, section_assembly, section_contact
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_contact_operator, only : status_gap
  use dd3_element_kinematics, only : element_gradients
  use dd3_element_rate, only : element_rate
  use dd3_model_loads, only : nodal_forces
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_system_contact, only : predictor_contact
  use dd3_system_internal, only : assemble_stiffness
  use dd3_system_reduced, only : contact_force_increment
  use dd3_system_solve, only : solve_reduced, solve_info_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: prediction_t, new_prediction, predict

  !> The trial increment and what it does to the points.
  type :: prediction_t
    !> Progress of the phase in the trial increment.
    real(wp) :: progress = 0.0_wp
    !> Displacement of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: displacement(:, :)
    !> Increment of the contact forces, `(3, n_contact)`, N.
    real(wp), allocatable :: lambda(:, :)
    !> Displacement of the tools, `(3, n_tool)`, mm.
    real(wp), allocatable :: tool_displacement(:, :)
    !> Strain increment, Kelvin, material frame, `(6, n_point, n_element)`.
    real(wp), allocatable :: strain(:, :, :)
    !> Rotation increment, rad, `(n_point, n_element)`.
    real(wp), allocatable :: rotation(:, :)
    !> Points taken as plastic, `(n_point, n_element)`.
    logical, allocatable :: plastic(:, :)
  end type prediction_t

  !> Times the plastic points that unload are switched to elastic before the prediction is taken as
  !> it is.
  integer, parameter :: most_switches = 2

contains

  !> Allocates a prediction.
  subroutine new_prediction(self, model)
    !> The prediction.
    type(prediction_t), intent(out) :: self
    !> The model.
    type(model_t), intent(in) :: model

    integer :: n_point

    n_point = model%element%n_point
    allocate (self%displacement(3, model%n_node), self%lambda(3, model%n_contact), source=0.0_wp)
    allocate (self%tool_displacement(3, model%n_tool), source=0.0_wp)
    allocate (self%strain(6, n_point, model%n_element), source=0.0_wp)
    allocate (self%rotation(n_point, model%n_element), source=0.0_wp)
    allocate (self%plastic(n_point, model%n_element), source=.false.)
  end subroutine new_prediction

  !> Finds the trial increment.
  subroutine predict(self, system, model, phase, state, info, verdict)
    !> The prediction.
    type(prediction_t), intent(inout) :: self
    !> Matrices and solver.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state
    !> What the linear solver did.
    type(solve_info_t), intent(inout) :: info
    !> Whether the linear system could be solved.
    type(verdict_t), intent(out) :: verdict

    integer :: switch
    logical :: switched

    self%progress = phase%trial
    self%plastic(:, :) = state%plastic
    call system%profile%start()
    call predictor_contact(system%contact, model, phase, state)
    call system%profile%add(section_contact)
    call impose_trial(self, system, model, phase)
    do switch = 0, most_switches
      call continuum_tangents(self, system, model, state)
      call system%profile%add(section_material)
      call assemble_stiffness(system, model, state)
      call system%profile%add(section_assembly)
      call solve_reduced(system, model, phase, info, verdict)
      if (verdict%outcome /= verdict_converged) return
      call system%profile%start()
      self%displacement(:, :) = reshape(system%problem%solution(:3*model%n_node), [3, model%n_node])
      call point_increments(self, system, model, state)
      call switch_unloading(self, model, state, switched)
      if (.not. switched) exit
    end do
    call contact_force_increment(model, phase, system%contact, system%stiffness, system%problem, &
        self%lambda)
    where (spread(system%contact%status == status_gap, 1, 3)) self%lambda = 0.0_wp
    call tool_increments(self, system, model, phase)
  end subroutine predict

  !> Right-hand sides of the trial increment: rates of the loads and motion of the tools.
  subroutine impose_trial(self, system, model, phase)
    !> The prediction.
    type(prediction_t), intent(in) :: self
    !> Gets the linear problem.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase

    integer :: tool

    associate (problem => system%problem)
      call nodal_forces(model%load_set, -self%progress*(phase%load_end - phase%load_start), &
          model%contact_node, self%progress*phase%fading, problem%residual)
      problem%excess = 0.0_wp
      problem%displacement = self%progress*phase%displacement
      problem%tool_motion = self%progress*phase%move
      do tool = 1, model%n_tool
        problem%tool_residual(tool) = self%progress &
          *dot_product(phase%press_end(:, tool) - phase%press_start(:, tool), phase%direction(:, &
          tool))
      end do
    end associate
  end subroutine impose_trial

  !> Continuum tangents at the points, elastic where a point is not taken as plastic.
  subroutine continuum_tangents(self, system, model, state)
    !> The prediction.
    type(prediction_t), intent(in) :: self
    !> Gets the tangents.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state

    integer :: e, p

    do e = 1, model%n_element
      associate (material => model%material(model%material_of(e)))
        do p = 1, model%element%n_point
          call material%continuum_tangent(state%stress(:, p, e), state%internal(:, p, e), &
                                          self%plastic(p, e), system%tangent(:, :, p, e))
        end do
      end associate
    end do
  end subroutine continuum_tangents

  !> Strain and rotation increments of the trial displacement.
  subroutine point_increments(self, system, model, state)
    !> The prediction.
    type(prediction_t), intent(inout) :: self
    !> Workspace.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state

    type(verdict_t) :: verdict
    integer :: e

    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e), work => system%element(1))
        work%x_committed(:, :) = state%x(:, nodes)
        call element_gradients(model%element, work%x_committed, work, verdict)
        call element_rate(model%element, self%displacement(:, nodes), &
                          state%orientation(:, :, :, e), work)
        self%strain(:, :, e) = work%strain_increment
        self%rotation(:, e) = work%rotation_increment
      end associate
    end do
  end subroutine point_increments

  !> Makes plastic points elastic whose trial strain unloads them: V : C : D <= 0.
  subroutine switch_unloading(self, model, state, switched)
    !> The prediction.
    type(prediction_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state
    !> Whether a point changed.
    logical, intent(out) :: switched

    real(wp) :: direction(6)
    integer :: e, p

    switched = .false.
    do e = 1, model%n_element
      associate (material => model%material(model%material_of(e)))
        do p = 1, model%element%n_point
          if (.not. self%plastic(p, e)) cycle
          direction = material%plastic_direction(state%stress(:, p, e), state%internal(:, p, e))
          if (dot_product(direction, matmul(material%laws%elasticity%stiffness, self%strain(:, p, &
              e))) > 0.0_wp) cycle
          self%plastic(p, e) = .false.
          switched = .true.
        end do
      end associate
    end do
  end subroutine switch_unloading

  !> Displacement of the tools: as solved for the pressed ones, as imposed for the others.
  subroutine tool_increments(self, system, model, phase)
    !> The prediction.
    type(prediction_t), intent(inout) :: self
    !> The solved system.
    type(system_t), intent(in) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase

    integer :: tool, block

    do tool = 1, model%n_tool
      self%tool_displacement(:, tool) = self%progress*phase%move(:, tool)
      if (.not. phase%pressed(tool)) cycle
      block = model%tool_block(tool)
      self%tool_displacement(:, tool) = system%problem%solution(3*block - 2:3*block)
    end do
  end subroutine tool_increments

end module dd3_process_predictor
