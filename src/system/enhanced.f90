! SPDX-License-Identifier: GPL-3.0-or-later
!> Parameters of the enhanced strains, internal to the elements, as unknowns of the increment. They
!> are eliminated from the linear system element by element and follow the displacements (stored
!> condensation, Simo & Rifai 1990): da = -(offset + gain : du).
module dd3_system_enhanced
  use dd3_base_kinds, only : wp
  use dd3_element_work, only : element_work_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: enhanced_t, new_enhanced, store_condensation, enhanced_response

  !> Data of the condensation; arrays of size zero for elements without enhanced strains.
  type :: enhanced_t
    !> Forces conjugate to the parameters, zero in equilibrium, `(n_enhanced, n_element)`, N/mm. A
    !> parameter is the motion of a face, across it or along it, times half the thickness.
    real(wp), allocatable :: residual(:, :)
    !> Increments of the parameters without displacement, mm2, and for unit displacements, mm,
    !> `(n_enhanced, n_element)` and `(n_enhanced, 3, n_element_node, n_element)`; their signs are
    !> reversed.
    real(wp), allocatable :: offset(:, :), gain(:, :, :, :)
    !> Forces to be subtracted from the residual beside the condensed stiffness, `(3, n_node)`, N;
    !> of several ranks each has those on its nodes.
    real(wp), allocatable :: force(:, :)
    !> Squares of the forces from a displacement that the parameters do not follow, beside the
    !> condensed stiffness; a force on a parameter counts as in the norm of the residual. `(3,
    !> n_node)`, (N/mm)2; of several ranks each has those of its elements.
    real(wp), allocatable :: unfollowed_square(:, :)
  end type enhanced_t

contains

  !> Allocate the data and set them to zero.
  subroutine new_enhanced(self, model)
    type(enhanced_t), intent(out) :: self
    type(model_t), intent(in) :: model

    associate (m => model%element%n_enhanced, n => size(model%part%element))
      allocate (self%residual(m, n), self%offset(m, n), source=0.0_wp)
      allocate (self%gain(m, 3, model%element%n_node, n), source=0.0_wp)
      allocate (self%force(3, model%n_node), source=0.0_wp)
      allocate (self%unfollowed_square(3, model%n_node), source=0.0_wp)
    end associate
  end subroutine new_enhanced

  !> Store the condensation of an element's stiffness.
  subroutine store_condensation(self, model, e, work)
    type(enhanced_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Number in the part.
    integer, intent(in) :: e
    type(element_work_t), intent(in) :: work

    integer :: a

    self%offset(:, e) = work%enhanced_offset
    self%gain(:, :, :, e) = work%enhanced_gain
    do a = 1, model%element%n_node
      associate (node => model%connectivity(a, model%part%element(e)))
        self%force(:, node) = self%force(:, node) + work%condensed_force(:, a)
        self%unfollowed_square(:, node) = self%unfollowed_square(:, node) &
            + work%unfollowed(:, a, 1) + (0.5_wp*model%thickness)**2*work%unfollowed(:, a, 2)
      end associate
    end do
  end subroutine store_condensation

  !> Return the response of the parameters to the displacements of the linear system's solution; the
  !> offset comes on top.
  pure function enhanced_response(self, model, solution) result(increment)
    type(enhanced_t), intent(in) :: self
    type(model_t), intent(in) :: model
    !> Displacements, `(3*n_row)`, mm.
    real(wp), intent(in) :: solution(:)
    real(wp) :: increment(size(self%offset, 1), size(self%offset, 2))

    integer :: a, e, i, node

    increment = 0.0_wp
    if (size(increment) == 0) return
    do e = 1, size(model%part%element)
      do a = 1, model%element%n_node
        node = model%connectivity(a, model%part%element(e))
        do i = 1, 3
          increment(:, e) = increment(:, e) - self%gain(:, i, a, e)*solution(3*node - 3 + i)
        end do
      end do
    end do
  end function enhanced_response

end module dd3_system_enhanced
