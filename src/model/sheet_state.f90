! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of the state that belongs to the sheet: stresses and internal variables at the integration
!> points of the rank's elements, and the internal forces.
module dd3_model_sheet_state
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_part, only : of_elements
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: sheet_state_t, new_sheet_state

  !> State of the sheet.
  type :: sheet_state_t
    !> Internal forces, `(3, n_node)`, N; without those of fading stresses.
    real(wp), allocatable :: internal_force(:, :)
    !> Cauchy stress in the material frame, Kelvin, `(6, n_point, n_element)`, MPa.
    real(wp), allocatable :: stress(:, :, :)
    !> Internal variables of the material, `(n_internal, n_point, n_element)`; the first is the
    !> equivalent plastic strain.
    real(wp), allocatable :: internal_variables(:, :, :)
    !> Orthotropy axes as columns in the global frame, `(3, 3, n_point, n_element)`.
    real(wp), allocatable :: orientation(:, :, :, :)
    !> Whether nodal forces of the stresses at the start of the phase fade over it as external
    !> forces.
    logical :: fades = .false.
    !> These stresses, as `stress`; allocated where they fade.
    real(wp), allocatable :: fading_stress(:, :, :)
    !> These forces at their full size, in the committed configuration, `(3, n_node)`, N.
    real(wp), allocatable :: fading_force(:, :)
    !> Parameters of the elements' enhanced strains in the increment, `(n_enhanced, n_element)`;
    !> zero in the committed state.
    real(wp), allocatable :: enhanced(:, :)
    !> Whether the last increment was plastic, `(n_point, n_element)`.
    logical, allocatable :: plastic(:, :)
  contains
    procedure :: begin_fading
    procedure :: end_fading
    procedure :: walk
  end type sheet_state_t

contains

  !> Make the state at the start of the job.
  subroutine new_sheet_state(self, model, sheet)
    type(sheet_state_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> That another run has left; unstressed if it is left out, or has no state.
    type(sheet_t), intent(in), optional :: sheet

    integer :: e, p

    associate (n_point => model%element%n_point, element => model%part%element)
      allocate (self%internal_force(3, model%n_node), source=0.0_wp)
      allocate (self%stress(6, n_point, size(element)), source=0.0_wp)
      allocate (self%internal_variables(model%n_internal, n_point, size(element)), source=0.0_wp)
      allocate (self%orientation(3, 3, n_point, size(element)), source=0.0_wp)
      allocate (self%enhanced(model%element%n_enhanced, size(element)), source=0.0_wp)
      allocate (self%plastic(n_point, size(element)), source=.false.)
      do e = 1, size(element)
        do p = 1, n_point
          self%orientation(:, :, p, e) = model%axes(:, :, model%material_of(element(e)))
        end do
      end do
      if (.not. present(sheet)) return
      if (.not. sheet%has_state) return
      associate (n => min(model%n_internal, size(sheet%internal_variables, 1)))
        self%stress(:, :, :) = sheet%stress(:, :, element)
        self%orientation(:, :, :, :) = sheet%orientation(:, :, :, element)
        self%internal_variables(:n, :, :) = sheet%internal_variables(:n, :, element)
      end associate
    end associate
  end subroutine new_sheet_state

  !> Let the present stresses fade over the phase, from their full size.
  subroutine begin_fading(self)
    class(sheet_state_t), intent(inout) :: self

    self%fades = .true.
    self%fading_stress = self%stress
    self%fading_force = self%internal_force
    self%internal_force = 0.0_wp
  end subroutine begin_fading

  !> End the fading.
  subroutine end_fading(self, left)
    class(sheet_state_t), intent(inout) :: self
    !> Fraction of the stresses that is left.
    real(wp), intent(in) :: left

    if (.not. self%fades) return
    self%fades = .false.
    self%internal_force = self%internal_force + left*self%fading_force
    deallocate (self%fading_stress, self%fading_force)
  end subroutine end_fading

  !> Pass every component to a visitor.
  subroutine walk(self, visitor)
    class(sheet_state_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("internal_force", size(self%internal_force), self%internal_force)
    associate (n => size(self%plastic, 2), n_point => size(self%plastic, 1), &
        n_variable => size(self%internal_variables, 1))
      call visitor%reals_of_items(of_elements, "stress", 6*n_point, n, self%stress)
      call visitor%reals_of_items(of_elements, "internal_variables", n_variable*n_point, n, &
          self%internal_variables)
      call visitor%reals_of_items(of_elements, "orientation", 9*n_point, n, self%orientation)
      call visitor%reals_of_items(of_elements, "enhanced", size(self%enhanced, 1), n, self%enhanced)
      call visitor%logicals_of_items(of_elements, "plastic", n_point, n, self%plastic)
      call visitor%one_logical("fades", self%fades)
      if (.not. self%fades) return
      if (.not. allocated(self%fading_stress)) then
        allocate (self%fading_stress, mold=self%stress)
        allocate (self%fading_force, mold=self%internal_force)
      end if
      call visitor%reals_of_items(of_elements, "fading_stress", 6*n_point, n, self%fading_stress)
      call visitor%reals("fading_force", size(self%fading_force), self%fading_force)
    end associate
  end subroutine walk

end module dd3_model_sheet_state
