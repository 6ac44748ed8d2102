! SPDX-License-Identifier: GPL-3.0-or-later
!> Procedures of the fields that describe the result of forming: thinning, strains in the surface,
!> draw-in and contact.
module dd3_output_forming_fields
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_contact_operator, only : status_gap
  use dd3_model_contact_results, only : contact_gaps, contact_pressures
  use dd3_model_model, only : model_t
  use dd3_model_rim, only : draw_in
  use dd3_model_sheet_thickness, only : sheet_thickness
  use dd3_model_state, only : state_t
  use dd3_model_surface_strain, only : surface_strains
  implicit none
  private
  public :: evaluate_strains
  public :: fill_thickness, fill_thinning, fill_draw_in
  public :: fill_contact_pressure, fill_contact_gap, fill_slip_path, fill_slip_speed, &
      fill_contact_tool

  !> Lower face, middle and upper face of the sheet.
  real(wp), parameter :: height(3) = [0.0_wp, 0.5_wp, 1.0_wp]

contains

  !> Evaluate the thickness.
  subroutine fill_thickness(model, state, nodal, cell)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: nodal(:, :), cell(:, :)

    call sheet_thickness(model, state%x, nodal(1, :), cell(1, :))
  end subroutine fill_thickness

  !> Evaluate the thinning; zero where there is no column of nodes.
  subroutine fill_thinning(model, state, nodal, cell)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: nodal(:, :), cell(:, :)

    real(wp) :: nodal0(model%n_node), cell0(model%n_element)

    call sheet_thickness(model, model%x0, nodal0, cell0)
    call sheet_thickness(model, state%x, nodal(1, :), cell(1, :))
    nodal(1, :) = merge(1.0_wp - nodal(1, :)/max(nodal0, tiny(1.0_wp)), 0.0_wp, nodal0 > 0.0_wp)
    cell(1, :) = merge(1.0_wp - cell(1, :)/max(cell0, tiny(1.0_wp)), 0.0_wp, cell0 > 0.0_wp)
  end subroutine fill_thinning

  !> Evaluate the draw-in.
  subroutine fill_draw_in(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value(1, :) = draw_in(model, state%x)
  end subroutine fill_draw_in

  !> Evaluate the strains in the surface of the sheet.
  subroutine evaluate_strains(model, state, strain)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Major and minor strain of the nodes at the heights, `(2, n_node, size(height))`.
    real(wp), allocatable, intent(out) :: strain(:, :, :)

    integer :: i

    allocate (strain(2, model%n_node, size(height)))
    do i = 1, size(height)
      call surface_strains(model, state%x, height(i), strain(:, :, i))
    end do
  end subroutine evaluate_strains

  !> Evaluate the contact pressure.
  subroutine fill_contact_pressure(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value(1, :) = contact_pressures(model, state)
  end subroutine fill_contact_pressure

  !> Evaluate the gap.
  subroutine fill_contact_gap(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value(1, :) = contact_gaps(model, state)
  end subroutine fill_contact_gap

  !> Evaluate the slip path.
  subroutine fill_slip_path(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value = 0.0_wp
    associate (n => model%n_contact_node)
      if (n > 0) value(1, model%contact_node(:n)) = state%contact%slip_path(:n)
    end associate
    call sum_over_ranks(size(value), value)
  end subroutine fill_slip_path

  !> Evaluate the speed of sliding.
  subroutine fill_slip_speed(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value = 0.0_wp
    associate (n => model%n_contact_node)
      if (n > 0) value(1, model%contact_node(:n)) = state%contact%slip_speed(:n)
    end associate
    call sum_over_ranks(size(value), value)
  end subroutine fill_slip_speed

  !> Evaluate the number of the tool in contact.
  subroutine fill_contact_tool(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value = 0.0_wp
    associate (n => model%n_contact_node)
      if (n > 0) value(1, model%contact_node(:n)) = &
          real(merge(state%contact%tool(:n), 0, state%contact%status(:n) /= status_gap), wp)
    end associate
    call sum_over_ranks(size(value), value)
  end subroutine fill_contact_tool

end module dd3_output_forming_fields
