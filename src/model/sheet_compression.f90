! SPDX-License-Identifier: GPL-3.0-or-later
!> Elements whose sheet can wrinkle: compressed in its plane, and not held by tools on both faces.
module dd3_model_sheet_compression
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks, sum_over_ranks
  use dd3_linalg_tensor, only : symmetric_eigen, tensor_from_kelvin
  use dd3_model_contact_results, only : touching_tools
  use dd3_model_element_columns, only : element_columns_t, new_element_columns
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: find_compressed

  !> Compressive membrane stress of a compressed sheet over its difference of principal stresses,
  !> which is 0 in tension, a half in shear and 1 in compression; and this difference over the flow
  !> stress, below which the sheet is far from yielding: under its weight a sheet is compressed at
  !> many places.
  real(wp), parameter :: of_own = 0.25_wp, of_flow = 0.5_wp

contains

  !> Find the compressed elements that tools do not hold at all nodes of both faces of the sheet.
  !> All elements of a column are or none is.
  subroutine find_compressed(model, state, compressed, yielding)
    type(model_t), intent(in) :: model
    !> Committed state.
    type(state_t), intent(in) :: state
    !> Whether an element is compressed, and whether it yields there, `(n_element)`.
    logical, intent(out) :: compressed(:), yielding(:)

    type(element_columns_t) :: quad
    !> Sums over the points of a column of elements, Kelvin, MPa.
    real(wp), allocatable :: stress(:, :)
    !> Sums of the flow stresses, MPa.
    real(wp), allocatable :: flow(:)
    integer, allocatable :: plastic(:)
    logical, allocatable :: found(:)
    logical :: touches(model%n_node)
    real(wp) :: values(3), vectors(3, 3), difference
    integer :: e, k, p

    call new_element_columns(quad, model)
    allocate (stress(6, quad%n), flow(quad%n), source=0.0_wp)
    allocate (plastic(quad%n), source=0)
    allocate (found(quad%n), source=.false.)
    do e = 1, size(model%part%element)
      k = quad%of_element(model%part%element(e))
      stress(:, k) = stress(:, k) + sum(state%sheet%stress(:, :, e), dim=2)
      if (any(state%sheet%plastic(:, e))) plastic(k) = 1
      associate (material => model%material(model%material_of(model%part%element(e))))
        do p = 1, model%element%n_point
          flow(k) = flow(k) + material%flow_stress(state%sheet%internal_variables(:, p, e))
        end do
      end associate
    end do
    call sum_over_ranks(size(stress), stress)
    call sum_over_ranks(size(flow), flow)
    call largest_over_ranks(size(plastic), plastic)
    touches = touching_tools(model, state) > 0
    do k = 1, quad%n
      call symmetric_eigen(tensor_from_kelvin(stress(:, k)), values, vectors)
      difference = maxval(values) - minval(values)
      if (difference < of_flow*flow(k) .or. -minval(values) <= of_own*difference) cycle
      associate (column => model%column(:, quad%corner(:, k)))
        found(k) = .not. (all(touches(column(1, :))) .and. all(touches(column(2, :))))
      end associate
    end do
    compressed = found(quad%of_element)
    yielding = compressed .and. plastic(quad%of_element) > 0
  end subroutine find_compressed

end module dd3_model_sheet_compression
