! SPDX-License-Identifier: GPL-3.0-or-later
!> Energies of the sheet from the stresses and internal variables at its points.
module dd3_model_energy
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_contact_compliant, only : fraction_of, layer_energy, layer_t
  use dd3_contact_operator, only : status_gap
  use dd3_element_kinematics, only : point_volumes
  use dd3_model_contact_layer, only : border_at, deflection_at, layer_at, offset_at
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : dissipated_work
  use dd3_tools_closest, only : hint_t, hit_t
  use dd3_tools_crossing, only : crossing_t
  use dd3_tools_tool, only : find_crossing_on_tool, find_on_tool
  implicit none
  private
  public :: contact_energy, elastic_energy, energy_error, modulus_energy_increment
  public :: plastic_work_increment

contains

  !> Return the elastic energy of the stresses, mJ.
  real(wp) function elastic_energy(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp) :: volume(model%element%n_point), energy(1)
    integer :: i, p

    energy = 0.0_wp
    do i = 1, size(model%part%element)
      associate (e => model%part%element(i))
        call point_volumes(model%element, state%x(:, model%connectivity(:, e)), volume)
        associate (material => model%material(model%material_of(e)), sheet => state%sheet)
          do p = 1, size(volume)
            energy = energy + 0.5_wp*volume(p)*dot_product(sheet%stress(:, p, i), &
                material%elastic_strain(sheet%stress(:, p, i), sheet%internal_variables(1, p, i)))
          end do
        end associate
      end associate
    end do
    call sum_over_ranks(1, energy)
    elastic_energy = energy(1)
  end function elastic_energy

  !> Return the energy stored in the contact layers and in elastic tools, mJ. The normal force is
  !> that along the tool's normal: along the normal of a face of the sheet, which is not at right
  !> angles to a curved tool, the friction would count too.
  real(wp) function contact_energy(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    type(layer_t) :: layer
    type(hint_t) :: hint
    type(hit_t) :: hit
    type(crossing_t) :: crossing
    real(wp), parameter :: no_direction(3) = 0.0_wp
    real(wp) :: energy(1)
    integer :: c

    contact_energy = 0.0_wp
    if (.not. model%phase(state%phase)%layer > 0.0_wp) return
    energy = 0.0_wp
    do c = 1, model%n_contact
      if (state%contact%status(c) == status_gap .or. state%contact%tool(c) == 0) cycle
      associate (tool => state%contact%tool(c), phase => model%phase(state%phase), &
          offset => offset_at(state, state%contact%tool(c), c))
        layer = layer_at(model, phase, tool, c)
        if (model%contact_point(c)%moves) then
          call find_crossing_on_tool(model%tool(tool), state%placement(tool), &
              state%x(:, model%contact_point(c)%node(:2)), no_direction, &
              border_at(model, phase, c), layer%height + max(0.0_wp, -offset), crossing)
          if (crossing%found) energy = energy + layer_energy(fraction_of(layer, crossing%weight), &
              -dot_product(crossing%normal, state%contact%lambda(:, c)))
          cycle
        end if
        hint = state%contact%hint(tool, c)
        call find_on_tool(model%tool(tool), state%placement(tool), &
            model%contact_point(c)%position(state%x), hint, &
            layer%height + max(0.0_wp, -offset), model%tolerance%committed_depth &
            + deflection_at(model, state, c) + offset, hit, border=border_at(model, phase, c))
      end associate
      energy = energy + layer_energy(layer, -dot_product(hit%normal, state%contact%lambda(:, c)))
    end do
    call sum_over_ranks(1, energy)
    contact_energy = energy(1)
  end function contact_energy

  !> Return the work on the sheet less internal work, friction work, that of draw-beads and viscous
  !> forces and the energy of the contact layers, mJ. It vanishes with the increments and the
  !> tolerance of equilibrium.
  real(wp) function energy_error(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    energy_error = state%work%tools + state%work%external - state%work%internal &
        - state%work%friction - dissipated_work(state%term) - contact_energy(model, state)
  end function energy_error

  !> Return the elastic energy that a falling modulus adds between two states, mJ: the change of
  !> T : C^-1 : T / 2 with C at the mean stress. No work is done for it, but unloading sets it free.
  real(wp) function modulus_energy_increment(model, old, new) result(work)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: old, new

    real(wp) :: volume(model%element%n_point), stress(6), strain(6), energy(1)
    integer :: i, p

    work = 0.0_wp
    if (.not. any(model%material%laws%softens)) return
    energy = 0.0_wp
    do i = 1, size(model%part%element)
      associate (e => model%part%element(i))
        associate (material => model%material(model%material_of(e)))
          if (.not. material%laws%softens) cycle
          call point_volumes(model%element, new%x(:, model%connectivity(:, e)), volume)
          do p = 1, size(volume)
            stress = 0.5_wp*(old%sheet%stress(:, p, i) + new%sheet%stress(:, p, i))
            strain = material%elastic_strain(stress, new%sheet%internal_variables(1, p, i)) &
                - material%elastic_strain(stress, old%sheet%internal_variables(1, p, i))
            energy = energy + 0.5_wp*volume(p)*dot_product(stress, strain)
          end do
        end associate
      end associate
    end do
    call sum_over_ranks(1, energy)
    work = energy(1)
  end function modulus_energy_increment

  !> Return the plastic work between two states, mJ: mean equivalent stress times the increment of
  !> the equivalent plastic strain. What back-stresses store is not included.
  real(wp) function plastic_work_increment(model, old, new) result(work)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: old, new

    real(wp) :: volume(model%element%n_point), strain(model%element%n_point), total(1)
    integer :: e, i, p

    total = 0.0_wp
    do i = 1, size(model%part%element)
      e = model%part%element(i)
      strain = new%sheet%internal_variables(1, :, i) - old%sheet%internal_variables(1, :, i)
      if (all(strain <= 0.0_wp)) cycle
      call point_volumes(model%element, new%x(:, model%connectivity(:, e)), volume)
      do p = 1, size(volume)
        if (strain(p) <= 0.0_wp) cycle
        total = total + 0.5_wp*volume(p)*strain(p)*(equivalent(old) + equivalent(new))
      end do
    end do
    call sum_over_ranks(1, total)
    work = total(1)

  contains

    !> Return the equivalent stress at the point, MPa.
    pure real(wp) function equivalent(state)
      type(state_t), intent(in) :: state

      equivalent = model%material(model%material_of(e))%equivalent_stress( &
          state%sheet%stress(:, p, i), state%sheet%internal_variables(:, p, i))
    end function equivalent

  end function plastic_work_increment

end module dd3_model_energy
