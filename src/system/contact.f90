! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact of the points of this rank, by the formulation of the phase: in a trial state (corrector)
!> or at the committed state with its stored status (predictor).
module dd3_system_contact
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank
  use dd3_contact_operator, only : round_off, status_gap
  use dd3_model_contact_layer, only : contact_penalty
  use dd3_model_contact_areas, only : contact_areas
  use dd3_model_contact_data, only : all_faces
  use dd3_model_contact_strain, only : strains_below
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : normals_for_tools
  use dd3_model_state, only : state_t
  use dd3_system_compliant_contact, only : compliant_contact_t
  use dd3_system_formulation, only : formulation_t
  use dd3_system_mixed_contact, only : mixed_contact_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: evaluate_contact, predictor_contact

contains

  !> Choose the formulation of a phase.
  subroutine choose(formulation, mixed)
    class(formulation_t), allocatable, intent(inout) :: formulation
    logical, intent(in) :: mixed

    type(mixed_contact_t) :: a_mixed_one

    if (allocated(formulation)) then
      if (same_type_as(formulation, a_mixed_one) .eqv. mixed) return
      deallocate (formulation)
    end if
    if (mixed) then
      allocate (mixed_contact_t :: formulation)
    else
      allocate (compliant_contact_t :: formulation)
    end if
    formulation%balances_tools = mixed
    formulation%eliminates = .not. mixed
  end subroutine choose

  !> Evaluate the contact of the system's points in a trial state: search, status, force and
  !> linearisation. The outward normals are those of the predictor.
  subroutine evaluate_contact(system, model, committed, trial)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    !> Origin of the slip.
    type(state_t), intent(in) :: committed
    !> Gets status, tool and closest points.
    type(state_t), intent(inout) :: trial

    call choose(system%formulation, model%phase(trial%phase)%mixed)
    system%contact%search_distance = model%phase(trial%phase)%search_distance
    if (any_friction(model, .true.)) then
      system%contact%sliding%speed = 0.0_wp
      system%contact%sliding%per_slip = 1.0_wp/max(trial%time - committed%time, tiny(1.0_wp))
    end if
    call system%formulation%evaluate(system%contact, model, committed, trial, &
        system%problem%point)
  end subroutine evaluate_contact

  !> Whether the coefficient of friction of any tool is not constant, or depends on the speed.
  pure logical function any_friction(model, by_speed)
    type(model_t), intent(in) :: model
    logical, intent(in) :: by_speed

    integer :: t

    any_friction = .false.
    do t = 1, model%n_tool
      associate (friction => model%tool(t)%friction)
        any_friction = any_friction .or. merge(friction%needs_time(), friction%varies(), by_speed)
      end associate
    end do
  end function any_friction

  !> Evaluate the contact of the predictor: the committed state with its stored status.
  subroutine predictor_contact(system, model, committed)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed

    logical :: touching(model%n_tool)
    integer :: c, kind, tool

    call choose(system%formulation, model%phase(committed%phase)%mixed)
    associate (contact => system%contact, phase => model%phase(committed%phase))
      contact%outward = normals_for_tools(model, committed%x)
      if (any_friction(model, .false.)) then
        contact%area = reshape([(contact_areas(model, committed%x, kind), kind=1, all_faces)], &
            [model%n_contact, all_faces])
        contact%sliding%strain = strains_below(model, committed)
        contact%sliding%speed = committed%contact%slip_speed
        contact%sliding%per_slip = 0.0_wp
      end if
      contact%turn_limited = .false.
      contact%search_distance = model%tolerance%tool_search
      touching = .false.
      do c = 1, model%n_contact
        if (committed%contact%status(c) == status_gap) cycle
        if (norm2(committed%contact%lambda(:, c)) &
            <= round_off*contact_penalty(model, phase, c)) then
          cycle
        end if
        touching(committed%contact%tool(c)) = .true.
      end do
      touching = [(any_rank(touching(tool)), tool=1, model%n_tool)]
      call system%formulation%predict(contact, model, committed, touching)
    end associate
  end subroutine predictor_contact

end module dd3_system_contact
