!> Internal forces and stiffness of the sheet: the loop over the elements and their integration
!> points.
!>
!> Blocks of elements of one colour share no node, so that threads may add up their forces side by
!> side; the colours come one after the other, which makes every sum the same for any number of
!> threads.
module dd3_system_internal
  !$ use omp_lib, only : omp_get_thread_num
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_element_force, only : element_cauchy, element_force
  use dd3_element_log_strain, only : element_strain
  use dd3_element_kinematics, only : element_gradients, element_kinematics
  use dd3_element_stiffness, only : element_stiffness
  use dd3_element_work, only : element_work_t
  use dd3_linalg_matrix, only : add_element, clear
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: update_material, assemble_stiffness

contains

  !> Integrates the material from the old to the new configuration and adds up the internal forces,
  !> and the stiffness where it is wanted too.
  subroutine update_material(self, model, old, new, with_stiffness, verdict)
    !> Gets the consistent tangents, and the stiffness.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state with its positions set; gets stresses, internal variables, axes and internal
    !> forces.
    type(state_t), intent(inout) :: new
    !> Whether the stiffness is assembled as well.
    logical, intent(in) :: with_stiffness
    !> Whether every element kept its shape and every point found its stress.
    type(verdict_t), intent(out) :: verdict

    type(verdict_t) :: mine
    integer :: colour, k, e, block, thread

    verdict%outcome = verdict_converged
    new%internal_force = 0.0_wp
    if (with_stiffness) call clear(self%stiffness)
    !$omp parallel if (self%parallel) num_threads(self%threads) default(shared) &
    !$omp& private(mine, colour, k, e, block, thread)
    thread = 1
    !$ thread = omp_get_thread_num() + 1
    do colour = 1, size(self%colour_start) - 1
      !$omp do schedule(dynamic)
      do k = self%colour_start(colour), self%colour_start(colour + 1) - 1
        block = self%coloured_block(k)
        do e = self%block_start(block), self%block_start(block + 1) - 1
          call update_element(model, old, new, e, self%element(thread), &
                              self%tangent(:, :, :, e), mine)
          if (mine%outcome == verdict_converged) then
            if (with_stiffness) call add_stiffness(self, model, e, self%element(thread))
          else
            !$omp critical (failed_element)
            if (verdict%outcome == verdict_converged .or. e < verdict%element) verdict = mine
            !$omp end critical (failed_element)
          end if
        end do
      end do
      !$omp end do
    end do
    !$omp end parallel
  end subroutine update_material

  !> One element of `update_material`.
  subroutine update_element(model, old, new, e, work, tangent, verdict)
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state.
    type(state_t), intent(inout) :: new
    !> The element.
    integer, intent(in) :: e
    !> Workspace; left with all that the stiffness needs but the tangents.
    type(element_work_t), intent(inout) :: work
    !> Consistent tangents, `(6, 6, n_point)`, MPa.
    real(wp), intent(inout) :: tangent(:, :, :)
    !> How it ended.
    type(verdict_t), intent(out) :: verdict

    integer :: p, a

    associate (nodes => model%connectivity(:, e), material => model%material(model%material_of(e)))
      work%x_committed(:, :) = old%x(:, nodes)
      work%x_trial(:, :) = new%x(:, nodes)
      call element_kinematics(model%element, work%x_committed, work%x_trial, work, verdict)
      verdict%element = e
      if (verdict%outcome /= verdict_converged) return
      call element_strain(model%element, old%orientation(:, :, :, e), work)
      do p = 1, model%element%n_point
        call material%update(old%stress(:, p, e), old%internal(:material%n_internal, p, e), &
                             work%strain(:, p), new%stress(:, p, e), &
                             new%internal(:material%n_internal, p, e), tangent(:, :, p), &
                             new%plastic(p, e), verdict)
        verdict%element = e
        verdict%point = p
        if (verdict%outcome /= verdict_converged) return
      end do
      new%orientation(:, :, :, e) = work%rotation
      work%stress(:, :) = new%stress(:, :, e)
      call element_cauchy(model%element, work)
      call element_force(model%element, work)
      do a = 1, size(nodes)
        new%internal_force(:, nodes(a)) = new%internal_force(:, nodes(a)) + work%force(:, a)
      end do
    end associate
  end subroutine update_element

  !> Assembles the exact stiffness of the new configuration from the tangents of the last update,
  !> or, without a new one, that of the committed configuration with the tangents already in place:
  !> the predictor's.
  subroutine assemble_stiffness(self, model, old, new)
    !> Gets the stiffness.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state after `update_material`.
    type(state_t), intent(in), optional :: new

    integer :: colour, k, e, block, thread

    call clear(self%stiffness)
    !$omp parallel if (self%parallel) num_threads(self%threads) default(shared) &
    !$omp& private(colour, k, e, block, thread)
    thread = 1
    !$ thread = omp_get_thread_num() + 1
    do colour = 1, size(self%colour_start) - 1
      !$omp do schedule(dynamic)
      do k = self%colour_start(colour), self%colour_start(colour + 1) - 1
        block = self%coloured_block(k)
        do e = self%block_start(block), self%block_start(block + 1) - 1
          call take_element(model, e, self%element(thread), old, new)
          call add_stiffness(self, model, e, self%element(thread))
        end do
      end do
      !$omp end do
    end do
    !$omp end parallel
  end subroutine assemble_stiffness

  !> Brings a workspace to an element's new configuration, or to the committed one.
  subroutine take_element(model, e, work, old, new)
    !> The model.
    type(model_t), intent(in) :: model
    !> The element.
    integer, intent(in) :: e
    !> Gets all that the stiffness needs but the tangents.
    type(element_work_t), intent(inout) :: work
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state, of an element that has kept its shape.
    type(state_t), intent(in), optional :: new

    type(verdict_t) :: verdict

    work%x_committed(:, :) = old%x(:, model%connectivity(:, e))
    if (present(new)) then
      work%x_trial(:, :) = new%x(:, model%connectivity(:, e))
      call element_kinematics(model%element, work%x_committed, work%x_trial, work, verdict)
      call element_strain(model%element, old%orientation(:, :, :, e), work)
      work%stress(:, :) = new%stress(:, :, e)
    else
      call element_gradients(model%element, work%x_committed, work, verdict)
      work%strain = 0.0_wp
      work%rotation(:, :, :) = old%orientation(:, :, :, e)
      work%stress(:, :) = old%stress(:, :, e)
    end if
    call element_cauchy(model%element, work)
  end subroutine take_element

  !> Computes an element's stiffness from what its workspace holds and adds its blocks.
  subroutine add_stiffness(self, model, e, work)
    !> The system.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The element.
    integer, intent(in) :: e
    !> Its workspace with kinematics, strain, axes and stresses.
    type(element_work_t), intent(inout) :: work

    call take_tangents(size(work%tangent), self%tangent(:, :, :, e), work%tangent)
    call element_stiffness(model%element, work)
    call add_element(self%stiffness, model%element%n_node, self%position(:, :, e), work%stiffness)
  end subroutine add_stiffness

  !> Copies an element's tangents in one stretch.
  pure subroutine take_tangents(n, from, to)
    !> Number of values.
    integer, intent(in) :: n
    !> The tangents of the element.
    real(wp), intent(in) :: from(n)
    !> Those of the workspace.
    real(wp), intent(out) :: to(n)

    to = from
  end subroutine take_tangents

end module dd3_system_internal
