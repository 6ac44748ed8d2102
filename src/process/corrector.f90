!> The corrector: one Newton-Raphson loop for all non-linearities (plasticity, large rotations,
!> contact, friction).
!> Source: Menezes and Teodosiu 2000; criterion of convergence: Oliveira and Menezes 2004, eq. (19),
!> the norm of the internal forces standing in for that of the contact forces where it is larger
!> (and where there is no contact).
module dd3_process_corrector
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : section_material, section_assembly, section_contact
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_balance, only : balance_tools
  use dd3_process_residual, only : evaluate_forces, lost_tool, pressed_force, tool_force_tolerance
  use dd3_system_internal, only : update_material, assemble_stiffness
  use dd3_system_reduced, only : contact_force_increment
  use dd3_system_solve, only : solve_reduced, solve_info_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: correct, clear_correction, correction_t

  !> Share of the criterion's tolerance below which all but the tools' forces counts as settled.
  real(wp), parameter :: settled = 0.1_wp
  !> The largest displacement an iteration may make, as a multiple of the sheet's thickness.
  real(wp), parameter :: largest_step = 20.0_wp
  !> Forces this strain makes over the square of the thickness are no scale: a free sheet at rest
  !> holds round-off alone.
  real(wp), parameter :: negligible_strain = 1.0e-6_wp
  !> Status patterns remembered to see a cycle.
  integer, parameter :: memory = 3

  !> What the corrector leaves behind for the records.
  type :: correction_t
    !> Criterion of convergence, eq. (19), after each iteration.
    real(wp), allocatable :: criterion(:)
    !> Status of the candidates in the last iterations, the newest first, `(n_contact, memory)`.
    integer, allocatable :: status(:, :)
    !> Largest residual: node and value, N.
    integer :: worst_node = 0
    !> See above.
    real(wp) :: worst_residual = 0.0_wp
    !> Increment of the contact forces in the last iteration, `(3, n_contact)`, N.
    real(wp), allocatable :: lambda_increment(:, :)
  end type correction_t

contains

  !> Corrects a trial state until it is in equilibrium and every contact condition holds.
  subroutine correct(system, model, phase, old, new, info, correction, verdict)
    !> Matrices and solver.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state: predicted at entry, corrected at return.
    type(state_t), intent(inout) :: new
    !> What the linear solver did.
    type(solve_info_t), intent(inout) :: info
    !> The course of the iterations.
    type(correction_t), intent(inout) :: correction
    !> Converged, or retry with the reason.
    type(verdict_t), intent(out) :: verdict

    character(len=:), allocatable :: changes

    call clear_correction(correction, model)
    call iterate(system, model, phase, old, new, info, correction, verdict)
    if (verdict%outcome == verdict_converged) return
    if (len_trim(verdict%reason) == 0) call explain(system, model, phase, new, correction, verdict)
    changes = status_changes(model, correction, len(verdict%reason) - len_trim(verdict%reason) - 2)
    if (len(changes) == 0) return
    if (len_trim(verdict%reason) > 0) changes = trim(verdict%reason)//"; "//changes
    verdict%reason = changes
  end subroutine correct

  !> The iterations of the corrector; where they come to their end, the reason stays empty.
  subroutine iterate(system, model, phase, old, new, info, correction, verdict)
    !> Matrices and solver.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state.
    type(state_t), intent(inout) :: new
    !> What the linear solver did.
    type(solve_info_t), intent(inout) :: info
    !> The course of the iterations.
    type(correction_t), intent(inout) :: correction
    !> Converged, or retry with the reason.
    type(verdict_t), intent(inout) :: verdict

    integer :: j
    logical :: moved

    system%problem%displacement = 0.0_wp
    system%problem%tool_motion = 0.0_wp
    do j = 1, phase%newton%iterations
      verdict%iterations = j
      call evaluate(system, model, phase, old, new, j, verdict)
      if (verdict%outcome /= verdict_converged) return
      correction%status(:, 2:) = correction%status(:, :memory - 1)
      call judge(system, model, phase, new, j, correction, verdict)
      if (verdict%outcome /= verdict_converged .and. j > 1 &
          .and. verdict%norm < settled*phase%newton%tolerance) then
        call balance_tools(system, model, phase, old, new, moved)
        if (moved) call judge(system, model, phase, new, j, correction, verdict)
      end if
      if (verdict%outcome == verdict_converged) then
        new%lambda = system%contact%force
        return
      end if
      call system%profile%start()
      if (j > 1) call assemble_stiffness(system, model, old, new)
      call system%profile%add(section_assembly)
      call solve_reduced(system, model, phase, info, verdict)
      verdict%iterations = j
      verdict%norm = correction%criterion(j)
      if (verdict%outcome /= verdict_converged) return
      call advance(system, model, phase, new, correction, verdict)
      if (verdict%outcome /= verdict_converged) return
    end do
    verdict%outcome = verdict_retry
    verdict%norm = correction%criterion(phase%newton%iterations)
  end subroutine iterate

  !> Says what did not converge in the last iteration: a tool that presses on nothing, a tool's
  !> force, or the residual of a node; nothing where there are nodes that find no status.
  subroutine explain(system, model, phase, new, correction, verdict)
    !> The evaluated system.
    type(system_t), intent(in) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial state.
    type(state_t), intent(in) :: new
    !> The course of the iterations.
    type(correction_t), intent(in) :: correction
    !> Gets the reason and where it is.
    type(verdict_t), intent(inout) :: verdict

    character(len=:), allocatable :: reason
    integer :: tool

    verdict%tool = lost_tool(system, model, phase, new)
    if (verdict%tool > 0) then
      verdict%reason = "nothing resists the pressed tool "//model%tool(verdict%tool)%name
      return
    end if
    verdict%node = correction%worst_node
    if (any(unsettled(correction%status))) return
    reason = "residual "//to_text(correction%worst_residual, 3)//" N at node " &
             //to_text(correction%worst_node)
    if (verdict%norm < phase%newton%tolerance) then
      tool = maxloc(abs(system%problem%tool_residual), dim=1, mask=phase%pressed)
      if (tool > 0) reason = "force on the pressed tool "//model%tool(tool)%name//" off by " &
          //to_text(abs(system%problem%tool_residual(tool)), 3)//" N"
      verdict%node = 0
    end if
    verdict%reason = reason//" after "//to_text(phase%newton%iterations)//" iterations"
  end subroutine explain

  !> Makes the correction ready for a new increment.
  subroutine clear_correction(correction, model)
    !> The correction.
    type(correction_t), intent(inout) :: correction
    !> The model.
    type(model_t), intent(in) :: model

    if (allocated(correction%criterion)) deallocate (correction%criterion)
    allocate (correction%criterion(0))
    if (.not. allocated(correction%status)) allocate (correction%status(model%n_contact, memory))
    if (.not. allocated(correction%lambda_increment)) &
      allocate (correction%lambda_increment(3, model%n_contact))
    correction%status = -1
    correction%lambda_increment = 0.0_wp
    correction%worst_node = 0
    correction%worst_residual = 0.0_wp
  end subroutine clear_correction

  !> Stresses, internal forces and contact of the trial state, and the residuals from them; with the
  !> stiffness in the first iteration, which is never the last.
  subroutine evaluate(system, model, phase, old, new, j, verdict)
    !> The system.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state.
    type(state_t), intent(inout) :: new
    !> The iteration, from 1.
    integer, intent(in) :: j
    !> Whether the material could be integrated.
    type(verdict_t), intent(inout) :: verdict

    call system%profile%start()
    call update_material(system, model, old, new, j == 1, verdict)
    verdict%iterations = j
    call system%profile%add(section_material)
    if (verdict%outcome /= verdict_converged) return
    call evaluate_forces(system, model, phase, old, new)
    call system%profile%add(section_contact)
  end subroutine evaluate

  !> The criterion of convergence, eq. (19), and whether it is met.
  subroutine judge(system, model, phase, new, j, correction, verdict)
    !> The evaluated system.
    type(system_t), intent(in) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial state.
    type(state_t), intent(in) :: new
    !> The iteration, from 1.
    integer, intent(in) :: j
    !> Gets the criterion and the status.
    type(correction_t), intent(inout) :: correction
    !> Converged, or retry.
    type(verdict_t), intent(inout) :: verdict

    real(wp) :: sum_of_squares, scale
    integer :: tool
    logical :: forces_met

    call residual_norm(system, model, phase, correction, sum_of_squares)
    forces_met = .true.
    do tool = 1, model%n_tool
      if (.not. phase%pressed(tool)) cycle
      if (.not. any(system%contact%tool == tool .and. system%contact%status /= status_gap)) then
        forces_met = forces_met .and. norm2(new%tool_load(:, tool)) <= 0.0_wp
        cycle
      end if
      sum_of_squares = sum_of_squares + system%problem%tool_residual(tool)**2
      forces_met = forces_met &
          .and. abs(system%problem%tool_residual(tool)) &
          <= tool_force_tolerance*pressed_force(phase, new, tool)
    end do
    associate (material => model%material(model%material_of(1)))
      scale = max(norm2(new%lambda), norm2(new%internal_force), &
          negligible_strain*material%laws%elasticity%shear*model%thickness**2)
    end associate
    correction%criterion = [correction%criterion(:j - 1), &
        (norm2(correction%lambda_increment) + sqrt(sum_of_squares))/scale]
    correction%status(:, 1) = system%contact%status
    verdict%norm = correction%criterion(j)
    verdict%outcome = verdict_retry
    if (j > 1 .and. forces_met .and. verdict%norm < phase%newton%tolerance) &
      verdict%outcome = verdict_converged
  end subroutine judge

  !> Sum of squares of the residuals of equilibrium and contact at the free degrees of freedom, with
  !> the worst node.
  subroutine residual_norm(system, model, phase, correction, sum_of_squares)
    !> The evaluated system.
    type(system_t), intent(in) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> Gets the worst node.
    type(correction_t), intent(inout) :: correction
    !> The sum, N2.
    real(wp), intent(out) :: sum_of_squares

    real(wp) :: equilibrium(3), share
    integer :: node, c

    sum_of_squares = 0.0_wp
    correction%worst_residual = -1.0_wp
    do node = 1, model%n_node
      c = model%candidate_of(node)
      equilibrium = system%problem%residual(:, node)
      share = 0.0_wp
      if (c > 0) then
        equilibrium = equilibrium + system%problem%excess(:, c)
        share = sum(system%problem%excess(:, c)**2)
      end if
      share = share + sum(equilibrium**2, mask=.not. phase%prescribed(:, node))
      sum_of_squares = sum_of_squares + share
      if (share <= correction%worst_residual) cycle
      correction%worst_residual = share
      correction%worst_node = node
    end do
    correction%worst_residual = sqrt(max(correction%worst_residual, 0.0_wp))
  end subroutine residual_norm

  !> Adds the solution to the trial state.
  subroutine advance(system, model, phase, new, correction, verdict)
    !> The solved system.
    type(system_t), intent(in) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial state.
    type(state_t), intent(inout) :: new
    !> Gets the increment of the contact forces.
    type(correction_t), intent(inout) :: correction
    !> Retry where the solution is out of all proportion.
    type(verdict_t), intent(inout) :: verdict

    real(wp) :: largest
    integer :: node, tool, block

    largest = 0.0_wp
    do node = 1, model%n_node
      if (maxval(abs(system%problem%solution(3*node - 2:3*node))) <= largest) cycle
      largest = maxval(abs(system%problem%solution(3*node - 2:3*node)))
      verdict%node = node
    end do
    if (.not. largest <= largest_step*model%thickness) then
      verdict%outcome = verdict_retry
      verdict%reason = "an iteration moved a node by "//to_text(largest, 3)//" mm"
      return
    end if
    verdict%node = 0
    new%x = new%x + reshape(system%problem%solution(:3*model%n_node), [3, model%n_node])
    call contact_force_increment(model, phase, system%contact, system%stiffness, system%problem, &
        correction%lambda_increment)
    new%lambda = new%lambda + correction%lambda_increment
    do tool = 1, model%n_tool
      block = model%tool_block(tool)
      if (block == 0) cycle
      new%tool_displacement(:, tool) = new%tool_displacement(:, tool) &
          + system%problem%solution(3*block - 2:3*block)
    end do
  end subroutine advance

  !> The nodes whose status did not settle in the last iterations, as far as there is room; empty
  !> where there are none.
  function status_changes(model, correction, room) result(text)
    !> The model.
    type(model_t), intent(in) :: model
    !> The course of the iterations.
    type(correction_t), intent(in) :: correction
    !> The longest text.
    integer, intent(in) :: room
    character(len=:), allocatable :: text

    character(len=5), parameter :: names(0:2) = ["gap  ", "stick", "slip "]
    character(len=:), allocatable :: node
    integer :: c, i, listed
    logical :: changing(model%n_contact)

    text = ""
    changing = unsettled(correction%status)
    if (.not. any(changing)) return
    text = "contact status changes at "//to_text(count(changing))//" nodes: "
    if (count(changing) == 1) text = "contact status changes at 1 node: "
    listed = 0
    do c = 1, model%n_contact
      if (.not. changing(c)) cycle
      node = "node "//to_text(model%contact_node(c))
      do i = memory, 1, -1
        if (correction%status(c, i) >= 0) node = node//" "//trim(names(correction%status(c, i)))
      end do
      if (listed > 0) node = "; "//node
      if (listed == 4 .or. len(text) + len(node) > room) return
      text = text//node
      listed = listed + 1
    end do
  end function status_changes

  !> The candidates whose status did not stay the same in the iterations remembered.
  pure function unsettled(status) result(changing)
    !> Status in the last iterations, the newest first, `(n_contact, memory)`; -1 for none.
    integer, intent(in) :: status(:, :)
    logical :: changing(size(status, 1))

    changing = any(status >= 0 .and. status /= spread(status(:, 1), 2, memory), dim=2)
  end function unsettled

end module dd3_process_corrector
