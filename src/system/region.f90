! SPDX-License-Identifier: GPL-3.0-or-later
!> Region of the sheet: a few free nodes with their elements and contact points. All other nodes and
!> the tools are held. Evaluates its residual in a trial state, and solves its linear system, for
!> the compliant formulation of the contact.
!>
!> Of several ranks each evaluates its elements and points; matrix and forces are summed, and all
!> get the solution of one.
module dd3_system_region
  !$ use omp_lib, only : omp_get_thread_num
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_reals, sum_over_ranks, this_rank
  use dd3_base_threads, only : least_points, threads_for
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_linalg_matrix, only : add_element, block_matrix_t, clear, find_positions, new_pattern, &
      set_unit_row
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_solver_registry, only : new_linear_solver
  use dd3_contact_operator, only : status_gap
  use dd3_model_contact_point, only : contact_point_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_contact, only : evaluate_contact
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_internal, only : set_element, update_element
  use dd3_system_linear_problem, only : unknowns_t
  use dd3_system_partition, only : share_verdict
  use dd3_system_point_rows, only : add_point, force_change
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: region_t, new_region

  !> The region; arrays of nodes are those of its elements, in ascending order.
  type :: region_t
    !> Nodes, and their numbers in the region, `(model%n_node)`, 0 for others.
    integer, allocatable :: node(:), number(:)
    !> Whether a displacement is free, `(3, n)`.
    logical, allocatable :: free(:, :)
    !> Elements of this rank, by their numbers in the part, and its contact points.
    integer, allocatable :: element(:), point(:)
    !> Internal forces of the elements, and residual with the forces of the contact law, zero where
    !> a displacement is held, `(3, n)`, N.
    real(wp), allocatable :: force(:, :), residual(:, :)
    !> Solution of the linear system: displacements `(3, n)`, enhanced strains and contact forces of
    !> the elements and points.
    type(unknowns_t) :: step
    !> Nodes of the elements by their numbers in the region, and the positions of their blocks.
    integer, allocatable, private :: connectivity(:, :), position(:, :, :)
    type(block_matrix_t), private :: matrix
    class(linear_solver_t), allocatable, private :: solver
  contains
    procedure :: evaluate
    procedure :: solve
  end type region_t

contains

  !> Make the region of some free nodes.
  subroutine new_region(self, model, chosen, prescribed)
    type(region_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> The free nodes, `(n_node)`.
    logical, intent(in) :: chosen(:)
    !> Supports of the nodes, `(3, n_node)`.
    logical, intent(in) :: prescribed(:, :)

    type(error_t), allocatable :: error
    integer, allocatable :: touching(:), numbers(:, :)
    logical, allocatable :: own(:)
    integer :: e, i

    touching = pack([(e, e=1, model%n_element)], &
        [(any(chosen(model%connectivity(:, e))), e=1, model%n_element)])
    allocate (self%number(model%n_node), source=0)
    do i = 1, size(touching)
      self%number(model%connectivity(:, touching(i))) = 1
    end do
    self%node = pack([(i, i=1, model%n_node)], self%number > 0)
    self%number(self%node) = [(i, i=1, size(self%node))]
    self%free = spread(chosen(self%node), 1, 3) .and. .not. prescribed(:, self%node)
    allocate (numbers(size(model%connectivity, 1), size(touching)))
    do i = 1, size(touching)
      numbers(:, i) = self%number(model%connectivity(:, touching(i)))
    end do
    own = model%part%place(touching) > 0
    self%element = pack(model%part%place(touching), own)
    self%connectivity = numbers(:, pack([(i, i=1, size(touching))], own))
    self%point = points_of(model, chosen)
    call new_pattern(self%matrix, size(self%node), numbers)
    call find_positions(self%matrix, self%connectivity, self%position)
    call new_linear_solver(self%solver, solver_options_t(method="umfpack", ilu_level=0, &
        tolerance=1.0e-10_wp, iterations=1, ordering="none"), error)
    call self%solver%setup(self%matrix)
    allocate (self%force(3, size(self%node)), self%residual(3, size(self%node)), source=0.0_wp)
    allocate (self%step%x(3, size(self%node)), self%step%lambda(3, size(self%point)), &
        self%step%enhanced(model%element%n_enhanced, size(self%element)), source=0.0_wp)
  end subroutine new_region

  !> Return the contact points of this rank whose forces act on chosen nodes.
  pure function points_of(model, chosen) result(points)
    type(model_t), intent(in) :: model
    logical, intent(in) :: chosen(:)
    integer, allocatable :: points(:)

    logical :: acts(model%n_contact)
    integer :: c

    do c = 1, model%n_contact
      associate (point => model%contact_point(c))
        acts(c) = any(chosen(point%node(:point%n_node)))
      end associate
    end do
    points = pack([(c, c=1, model%n_contact)], acts)
  end function points_of

  !> Evaluate stresses, contact and residual of the region in a trial state.
  subroutine evaluate(self, model, committed, trial, system, verdict)
    class(region_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Its internal forces stay as they are.
    type(state_t), intent(inout) :: trial
    !> Gets tangents, enhanced residuals and contact of the region.
    type(system_t), intent(inout) :: system
    !> Failed if an element is inverted or a return mapping fails.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: force(3, model%element%n_node, size(self%element))
    real(wp) :: contact_force(3, size(self%node))
    type(verdict_t) :: own(size(self%element))
    integer :: k, thread

    !$omp parallel do num_threads(threads_of(self, model)) private(k, thread)
    do k = 1, size(self%element)
      thread = 1
      !$ thread = omp_get_thread_num() + 1
      associate (e => self%element(k), work => system%element(thread))
        call update_element(model, committed, trial, e, work, system%tangent(:, :, :, e), own(k))
        force(:, :, k) = work%force
        system%enhanced%residual(:, e) = work%enhanced_force
      end associate
    end do
    !$omp end parallel do
    verdict%outcome = verdict_converged
    do k = size(own), 1, -1
      if (own(k)%outcome /= verdict_converged) verdict = own(k)
    end do
    call share_verdict(verdict)
    if (verdict%outcome /= verdict_converged) return
    self%force = 0.0_wp
    do k = 1, size(self%element)
      associate (nodes => self%connectivity(:, k))
        self%force(:, nodes) = self%force(:, nodes) + force(:, :, k)
      end associate
    end do
    call sum_over_ranks(size(self%force), self%force)
    call evaluate_contact(system, model, committed, trial, self%point)
    contact_force = point_forces(self, model, trial%x, system%contact%force, trial%contact%place)
    call sum_over_ranks(size(contact_force), contact_force)
    self%residual = merge(self%force - trial%external_force(:, self%node) + contact_force, &
        0.0_wp, self%free)
  end subroutine evaluate

  !> Number of threads for the elements.
  integer function threads_of(self, model)
    type(region_t), intent(in) :: self
    type(model_t), intent(in) :: model

    threads_of = threads_for(size(self%element)*model%element%n_point, least_points)
  end function threads_of

  !> Return the forces of the contact points of this rank on the nodes, `(3, n)`, N.
  pure function point_forces(self, model, x, point_force, place) result(force)
    type(region_t), intent(in) :: self
    type(model_t), intent(in) :: model
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_contact)`, N.
    real(wp), intent(in) :: point_force(:, :)
    !> Of the points that move, `(n_contact)`.
    real(wp), intent(in) :: place(:)
    real(wp) :: force(3, size(self%node))

    type(contact_point_t) :: point
    real(wp), allocatable :: nodal(:, :)
    integer :: k

    allocate (nodal(3, model%n_node), source=0.0_wp)
    do k = 1, size(self%point)
      associate (c => self%point(k))
        point = model%contact_point(c)%at_place(place(c))
        call point%add_nodal_forces(x, point_force(:, c), nodal)
      end associate
    end do
    force = nodal(:, self%node)
  end function point_forces

  !> Linearise at the trial state evaluated last, and solve for the step.
  subroutine solve(self, model, committed, trial, system, verdict)
    class(region_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Provides workspaces and tangents.
    type(system_t), intent(inout) :: system
    !> Retry if there is no solution.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: stiffness(9*model%element%n_node**2, size(self%element))
    real(wp) :: condensed(3, model%element%n_node, size(self%element))
    real(wp) :: offset(model%element%n_enhanced, size(self%element))
    real(wp) :: gain(model%element%n_enhanced, 3*model%element%n_node, size(self%element))
    real(wp) :: residual(3, size(self%node)), rhs(3*size(self%node)), solution(3*size(self%node))
    type(solver_report_t) :: report
    integer :: k, thread

    !$omp parallel do num_threads(threads_of(self, model)) private(k, thread)
    do k = 1, size(self%element)
      thread = 1
      !$ thread = omp_get_thread_num() + 1
      associate (e => self%element(k), work => system%element(thread))
        call set_element(model, e, work, committed, trial)
        work%tangent(:, :, :) = system%tangent(:, :, :, e)
        call model%element%evaluate_stiffness(model%element, work)
        stiffness(:, k) = reshape(work%stiffness, [size(stiffness, 1)])
        condensed(:, :, k) = 0.0_wp
        if (model%element%n_enhanced > 0) then
          condensed(:, :, k) = work%condensed_force
          offset(:, k) = work%enhanced_offset
          gain(:, :, k) = reshape(work%enhanced_gain, shape(gain(:, :, k)))
        end if
      end associate
    end do
    !$omp end parallel do
    call clear(self%matrix)
    residual = point_forces(self, model, trial%x, trial%contact%lambda, trial%contact%place)
    if (this_rank() == 0) residual = residual + self%force - trial%external_force(:, self%node)
    do k = 1, size(self%element)
      call add_element(self%matrix, model%element%n_node, self%position(:, :, k), stiffness(:, k))
      associate (nodes => self%connectivity(:, k))
        residual(:, nodes) = residual(:, nodes) - condensed(:, :, k)
      end associate
    end do
    rhs = -reshape(residual, shape(rhs))
    call add_contact(self, model, trial, system%contact, rhs)
    call sum_over_ranks(size(rhs), rhs)
    call sum_over_ranks(size(self%matrix%value), self%matrix%value)
    call hold(self, rhs)
    call self%solver%factor(self%matrix, verdict)
    if (verdict%row > 0) verdict%node = self%node(verdict%row)
    verdict%row = 0
    call share_verdict(verdict)
    if (verdict%outcome /= verdict_converged) return
    call self%solver%solve(rhs, solution, report)
    if (.not. report%converged) verdict%outcome = verdict_retry
    call share_verdict(verdict)
    call broadcast_reals(0, size(solution), solution)
    self%step%x = reshape(solution, shape(self%step%x))
    do k = 1, size(self%element)
      self%step%enhanced(:, k) = -offset(:, k) - matmul(gain(:, :, k), &
          reshape(self%step%x(:, self%connectivity(:, k)), [size(gain, 2)]))
    end do
    call set_forces(self, model, trial, system%contact)
  end subroutine solve

  !> Add the contributions of the contact points of this rank.
  subroutine add_contact(self, model, trial, contact, rhs)
    class(region_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(contact_work_t), intent(in) :: contact
    real(wp), intent(inout) :: rhs(:)

    real(wp), parameter :: no_motion(3) = 0.0_wp
    integer :: k, e

    e = 0
    do k = 1, size(self%point)
      associate (c => self%point(k), point => model%contact_point(self%point(k)))
        if (point%n_node > 1) e = findloc(self%element, model%part%place(point%element), dim=1)
        call add_point(point%at_place(contact%place(c)), contact, c, contact%force(:, c) &
            - trial%contact%lambda(:, c), no_motion, &
            trial%x, self%number(point%node(:point%n_node)), self%position, e, self%matrix, rhs)
      end associate
    end do
  end subroutine add_contact

  !> Make the rows of held displacements unit rows.
  pure subroutine hold(self, rhs)
    class(region_t), intent(inout) :: self
    real(wp), intent(inout) :: rhs(:)

    integer :: n, i

    do n = 1, size(self%node)
      do i = 1, 3
        if (self%free(i, n)) cycle
        rhs(3*n - 3 + i) = 0.0_wp
        call set_unit_row(self%matrix, n, i)
      end do
    end do
  end subroutine hold

  !> Set the increments of the contact forces from the displacements.
  subroutine set_forces(self, model, trial, contact)
    class(region_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    type(contact_work_t), intent(in) :: contact

    real(wp), parameter :: no_motion(3) = 0.0_wp
    real(wp), allocatable :: displacement(:, :)
    integer :: k

    allocate (displacement(3, model%n_node), source=0.0_wp)
    displacement(:, self%node) = self%step%x
    do k = 1, size(self%point)
      associate (c => self%point(k))
        self%step%lambda(:, k) = -trial%contact%lambda(:, c)
        if (contact%status(c) /= status_gap) self%step%lambda(:, k) = force_change(contact, c, &
            contact%force(:, c) - trial%contact%lambda(:, c), model%contact_point(c), trial%x, &
            displacement, no_motion)
      end associate
    end do
  end subroutine set_forces

end module dd3_system_region
