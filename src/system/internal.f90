!> Internal forces and stiffness of the sheet: the loop over the elements and their integration points.
module dd3_system_internal
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_element_force, only : element_force
  use dd3_element_increment, only : element_strain
  use dd3_element_kinematics, only : element_gradients, element_kinematics
  use dd3_element_stiffness, only : element_stiffness
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: update_material, assemble_stiffness, assemble_predictor_stiffness

contains

  !> Integrates the material from the old to the new configuration and adds up the internal forces.
  subroutine update_material(self, model, old, new, verdict)
    !> Gets the consistent tangents.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state with its positions set; gets stresses, internal variables, axes and internal forces.
    type(state_t), intent(inout) :: new
    !> Whether every element kept its shape and every point found its stress.
    type(verdict_t), intent(out) :: verdict

    integer :: e, p, a

    new%internal_force = 0.0_wp
    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e), material => model%material(model%material_of(e)))
        call element_kinematics(model%element, old%x(:, nodes), new%x(:, nodes), self%element, verdict)
        if (verdict%outcome == verdict_converged) then
          call element_strain(model%element, old%orientation(:, :, :, e), self%element)
          do p = 1, model%element%n_point
            call material%update(old%stress(:, p, e), old%internal(:, p, e), self%element%strain(:, p), &
                                 new%stress(:, p, e), new%internal(:, p, e), self%tangent(:, :, p, e), &
                                 new%plastic(p, e), verdict)
            if (verdict%outcome /= verdict_converged) exit
          end do
        end if
        if (verdict%outcome /= verdict_converged) then
          verdict%element = e
          return
        end if
        new%orientation(:, :, :, e) = self%element%rotation
        self%element%stress(:, :) = new%stress(:, :, e)
        call element_force(model%element, self%element)
        do a = 1, size(nodes)
          new%internal_force(:, nodes(a)) = new%internal_force(:, nodes(a)) + self%element%force(:, a)
        end do
      end associate
    end do
  end subroutine update_material

  !> Assembles the exact stiffness of the new configuration from the tangents of the last update.
  subroutine assemble_stiffness(self, model, old, new)
    !> Gets the stiffness.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state after `update_material`.
    type(state_t), intent(in) :: new

    type(verdict_t) :: verdict
    integer :: e

    self%stiffness%value = 0.0_wp
    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e))
        call element_kinematics(model%element, old%x(:, nodes), new%x(:, nodes), self%element, verdict)
      end associate
      call element_strain(model%element, old%orientation(:, :, :, e), self%element)
      self%element%stress(:, :) = new%stress(:, :, e)
      self%element%tangent(:, :, :) = self%tangent(:, :, :, e)
      call element_stiffness(model%element, self%element)
      call scatter(self, e)
    end do
  end subroutine assemble_stiffness

  !> Assembles the stiffness at the committed configuration with the tangents already in place: the predictor's.
  subroutine assemble_predictor_stiffness(self, model, old)
    !> Gets the stiffness; its tangents are the continuum ones.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: old

    type(verdict_t) :: verdict
    integer :: e

    self%stiffness%value = 0.0_wp
    do e = 1, model%n_element
      call element_gradients(model%element, old%x(:, model%connectivity(:, e)), self%element, verdict)
      self%element%strain = 0.0_wp
      self%element%rotation(:, :, :) = old%orientation(:, :, :, e)
      self%element%stress(:, :) = old%stress(:, :, e)
      self%element%tangent(:, :, :) = self%tangent(:, :, :, e)
      call element_stiffness(model%element, self%element)
      call scatter(self, e)
    end do
  end subroutine assemble_predictor_stiffness

  !> Adds an element's blocks to the stiffness.
  subroutine scatter(self, e)
    !> The system.
    type(system_t), intent(inout) :: self
    !> The element.
    integer, intent(in) :: e

    integer :: a, b, k

    do a = 1, size(self%position, 1)
      do b = 1, size(self%position, 2)
        k = self%position(a, b, e)
        self%stiffness%value(:, :, k) = self%stiffness%value(:, :, k) + self%element%stiffness(:, :, b, a)
      end do
    end do
  end subroutine scatter

end module dd3_system_internal
