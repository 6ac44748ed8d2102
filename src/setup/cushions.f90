! SPDX-License-Identifier: GPL-3.0-or-later
!> Cushions and spacers of the pressed tools in a phase.
module dd3_setup_cushions
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t, phase_spec_t
  use dd3_model_cushion, only : cushion_t, spacer_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_setup_gaps, only : check_place, offset_of_gap
  implicit none
  private
  public :: set_cushions, place_spacers

contains

  !> Set the cushions and the spacers that a phase names; those of other tools stay.
  subroutine set_cushions(spec, phase)
    type(phase_spec_t), intent(in) :: spec
    !> With its motion of the tools.
    type(phase_t), intent(inout) :: phase

    type(spacer_t) :: spacer
    integer, allocatable :: own(:)
    integer :: t, i

    do t = 1, size(phase%cushion)
      associate (cushion => phase%cushion(t))
        own = pack([(i, i=1, size(spec%pin))], spec%pin%tool == t)
        if (size(own) > 0) then
          cushion%place = reshape([(spec%pin(own(i))%place, i=1, size(own))], [3, size(own)])
          cushion%share = spec%pin(own)%share/sum(spec%pin(own)%share)
        end if
        do i = 1, size(spec%stroke)
          if (spec%stroke(i)%tool /= t) cycle
          cushion%table = reshape(spec%stroke(i)%table, [2, size(spec%stroke(i)%table)/2])
          if (allocated(cushion%share)) cycle
          cushion%place = reshape(phase%tilt(t)%pivot, [3, 1])
          cushion%share = [1.0_wp]
        end do
      end associate
    end do
    phase%spacer = pack(phase%spacer, [(all(spec%spacer%tool /= phase%spacer(i)%tool), i=1, &
        size(phase%spacer))])
    do i = 1, size(spec%spacer)
      associate (given => spec%spacer(i))
        spacer = spacer_t(given%tool, given%other, given%stiffness, [given%place, 0.0_wp], &
            given%gap)
        phase%spacer = [phase%spacer, spacer]
      end associate
    end do
  end subroutine set_cushions

  !> Set the displacements at which the spacers of all phases touch.
  subroutine place_spacers(model, case, errors)
    !> With its tools and phases.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(location_t) :: at
    real(wp) :: offset
    logical :: found
    integer :: i, k, before

    do i = 1, size(case%phase)
      do k = 1, size(model%phase(i)%spacer)
        associate (spacer => model%phase(i)%spacer(k))
          at = case%phase(i)%source%opened
          if (size(case%phase(i)%spacer) > 0) at = case%phase(i)%spacer(1)%at
          before = errors%count
          call check_place(model, i - 1, spacer%tool, "spacer", at, errors)
          call check_place(model, i, spacer%other, "spacer", at, errors)
          if (errors%count > before) cycle
          call offset_of_gap(model, i, spacer%tool, spacer%other, spacer%gap, offset, found)
          spacer%limit = model%phase(i)%direction(3, spacer%tool)*offset
          if (model%phase(i)%pressed(spacer%other) .and. size(case%phase(i)%spacer) == 0) call &
              errors%push_input(case%phase(i)%source%opened, "tool '"// &
              model%tool(spacer%other)%name//"' has a spacer from an earlier phase and is "// &
              "pressed", "a spacer to a tool that is held or moved", code="E144")
          if (has_turned(model, i, spacer%other)) call errors%push_input( &
              case%phase(i)%source%opened, "tool '"//model%tool(spacer%other)%name// &
              "' has a spacer of tool '"//model%tool(spacer%tool)%name//"' and has turned or "// &
              "tilted", "a spacer to a tool that does not turn", code="E144")
          if (found .or. size(case%phase(i)%spacer) == 0) cycle
          call errors%push_input(case%phase(i)%spacer(1)%at, "no displacement along z gives "// &
              "this gap between '"//model%tool(spacer%tool)%name//"' and '"// &
              model%tool(spacer%other)%name//"'", "two tools whose surfaces face each other "// &
              "along z", code="E144")
        end associate
      end do
    end do
  end subroutine place_spacers

  !> Whether a tool has turned or tilted at the end of a phase.
  pure logical function has_turned(model, phase, tool)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: phase, tool

    integer :: i

    has_turned = any([(model%phase(i)%turns(tool) .or. model%phase(i)%tilts(tool), i=1, phase)])
  end function has_turned

end module dd3_setup_cushions
