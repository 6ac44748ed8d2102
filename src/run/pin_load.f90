! SPDX-License-Identifier: GPL-3.0-or-later
!> Force on locating pins, supports of *BOUNDARY with `pin`, and their bearing pressure on the
!> sheet: the force over diameter and thickness, as of a bolt in a plate. A hole begins to widen
!> where it exceeds the yield stress (Budynas and Nisbett, Shigley's Mechanical Engineering Design,
!> 2015, section 8-12); EN 1993-1-8, table 3.10, gives 1.5 times that as the resistance of the
!> plate.
module dd3_run_pin_load
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_base_text, only : to_text
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_reactions, only : reactions
  use dd3_model_state, only : state_t
  use dd3_output_closing, only : pin_t
  use dd3_run_support_load, only : nodes_of
  implicit none
  private
  public :: add_pin_notes, loaded_pins, observe_pins

contains

  !> Take the forces on the pins that are larger than before in the running phase.
  subroutine observe_pins(case, model, state)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state

    real(wp) :: reaction(3, model%n_node), force
    integer, allocatable :: node(:), place(:)
    integer :: axis, k

    place = places_of_pins(case)
    if (size(place) == 0) return
    reaction = reactions(model, state)
    do k = 1, size(place)
      associate (support => case%boundary(place(k)), load => state%observed%pin_load(:, k))
        node = nodes_of(model, support%set)
        force = norm2([(merge(sum(reaction(axis, node)), 0.0_wp, support%fix(axis)), axis=1, 3)])
        if (load(2) > 0.0_wp .and. force <= load(1)) cycle
        load = [force, thickness_at(model, state, node), flow_stress_at(model, state, node)]
      end associate
    end do
  end subroutine observe_pins

  !> Return the places of the locating pins among the supports.
  pure function places_of_pins(case) result(place)
    type(case_t), intent(in) :: case
    integer, allocatable :: place(:)

    integer :: i

    place = pack([(i, i=1, size(case%boundary))], case%boundary%pin > 0.0_wp)
  end function places_of_pins

  !> Return the pins with the largest forces that they have carried in the running phase, in the
  !> order of the input.
  pure function loaded_pins(case, state) result(pin)
    type(case_t), intent(in) :: case
    type(state_t), intent(in) :: state
    type(pin_t), allocatable :: pin(:)

    integer, allocatable :: place(:)
    integer :: k

    place = places_of_pins(case)
    allocate (pin(size(place)))
    do k = 1, size(place)
      associate (support => case%boundary(place(k)), load => state%observed%pin_load(:, k))
        pin(k)%name = support%source%called()
        pin(k)%diameter = support%pin
        pin(k)%force = load(1)
        pin(k)%thickness = load(2)
        pin(k)%flow_stress = load(3)
      end associate
    end do
  end function loaded_pins

  !> Return the thickness of the sheet at a pin, the mean length of the columns of its nodes, mm.
  pure real(wp) function thickness_at(model, state, node) result(thickness)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: node(:)

    integer :: i

    thickness = sum([(norm2(state%x(:, model%column(2, node(i))) - &
        state%x(:, model%column(1, node(i)))), i=1, size(node))])/real(size(node), wp)
  end function thickness_at

  !> Return the flow stress of the sheet at a pin, the mean over the integration points of the
  !> elements there, MPa.
  real(wp) function flow_stress_at(model, state, node) result(flow_stress)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: node(:)

    real(wp) :: total(2)
    logical :: member(model%n_node)
    integer :: e, i, p

    member = .false.
    member(model%column(1, node)) = .true.
    total = 0.0_wp
    do i = 1, size(model%part%element)
      e = model%part%element(i)
      if (.not. any(member(model%connectivity(:, e)))) cycle
      do p = 1, model%element%n_point
        total = total + [model%material(model%material_of(e))%flow_stress( &
            state%sheet%internal_variables(:, p, i)), 1.0_wp]
      end do
    end do
    call sum_over_ranks(2, total)
    flow_stress = total(1)/max(1.0_wp, total(2))
  end function flow_stress_at

  !> Add a note on each pin that carries a force while tools act, or a warning if the hole yields.
  subroutine add_pin_notes(model, state, pin, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(pin_t), intent(in) :: pin(:)
    type(message_list_t), intent(inout) :: notes

    character(len=:), allocatable :: text
    integer :: k

    if (.not. any(state%tools%touches)) return
    do k = 1, size(pin)
      if (.not. pin(k)%force > 0.0_wp) cycle
      text = "in phase '"//model%phase(state%phase)%name//"' the pin '"//pin(k)%name//"' of "// &
          to_text(pin(k)%diameter, 3)//" mm carries up to "//to_text(pin(k)%force, 3)// &
          " N, a bearing pressure of "//to_text(pin(k)%pressure(), 3)//" MPa on the sheet of "// &
          to_text(pin(k)%thickness, 3)//" mm"
      if (pin(k)%pressure() > pin(k)%flow_stress) then
        call notes%add_new("W122", text//", above its yield stress there, "// &
            to_text(pin(k)%flow_stress, 3)//" MPa: the hole is widened")
      else
        call notes%add_new("N108", text//"; its yield stress there is "// &
            to_text(pin(k)%flow_stress, 3)//" MPa")
      end if
    end do
  end subroutine add_pin_notes

end module dd3_run_pin_load
