! SPDX-License-Identifier: GPL-3.0-or-later
!> Phase of the process as in the input, with all names resolved. It never changes in a run. What it
!> prescribes at nodes (mesh data) and what it does with the tools are inherited.
module dd3_model_phase
  use dd3_base_kinds, only : wp
  use dd3_model_nodal_conditions, only : is_normal_held, is_slip_prescribed
  use dd3_model_phase_tools, only : phase_tools_t
  use dd3_model_progress_table, only : next_place, step, table_slope, table_value
  use dd3_model_terms_drawbead, only : phase_beads_t
  use dd3_model_terms_load_sets, only : phase_loads_t, phase_pressures_t
  use dd3_settings_limits, only : limits_spec_t
  use dd3_settings_newton, only : newton_spec_t
  use dd3_settings_until, only : until_spec_t
  implicit none
  private
  public :: phase_t, is_normal_held, is_slip_prescribed

  !> Phase in which all displacements and loads are linear in the progress, 0 to 1, but for those
  !> with a table.
  type, extends(phase_tools_t) :: phase_t
    character(len=:), allocatable :: name
    !> Controlling tool; 0 if loads control.
    integer :: control = 0
    !> Trial increment as a fraction of the phase.
    real(wp) :: trial = 0.0_wp
    !> Path of the controlling tool over the phase, mm; 0 if loads control.
    real(wp) :: length = 0.0_wp
    !> Time of the whole phase, s; 0 if none is given.
    real(wp) :: duration = 0.0_wp
    !> Whether the phase sets gravity.
    logical :: has_gravity = .false.
    !> Whether this phase or an earlier one unloads the sheet, and no tool acts.
    logical :: unloaded = .false.
    !> Whether the state at the end is kept for other runs.
    logical :: keep = .false.
    !> What the phase does to the sets of loads and of pressures, and with the draw-beads.
    type(phase_loads_t) :: loads
    type(phase_pressures_t) :: pressures
    type(phase_beads_t) :: beads
    !> Progress and the factor on displacements, motions, loads and pressures there, `(2, n)`; not
    !> allocated if the factor is the progress.
    real(wp), allocatable :: table(:, :)
    !> Early end.
    type(until_spec_t) :: until
    type(limits_spec_t) :: limits
    type(newton_spec_t) :: newton
    !> Whether the formulation of the contact is the mixed one.
    logical :: mixed = .false.
    !> Height of the contact layer over the thickness; 0 in the mixed formulation.
    real(wp) :: layer = 0.0_wp
    !> Penalty of the mixed formulation, N/mm; 0 for the automatic one.
    real(wp) :: penalty = 0.0_wp
    !> Distance up to which a tool's surface is looked for, mm.
    real(wp) :: search_distance = 0.0_wp
  contains
    procedure :: factor
    procedure :: slope
    procedure :: fading
    procedure :: fading_rate
    procedure :: next_kink
    procedure :: path
    procedure :: progress_after
  end type phase_t

contains

  !> Return the factor on displacements and loads at a progress.
  pure real(wp) function factor(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    factor = table_value(self%table, progress)
    if (self%opening > 0.0_wp) factor = min(1.0_wp, progress/self%opening)
  end function factor

  !> Return the derivative of the factor behind a progress.
  pure real(wp) function slope(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    slope = table_slope(self%table, progress)
    if (self%opening > 0.0_wp) slope = self%fading_rate(progress)
  end function slope

  !> Return the fraction of the forces of lost constraints that is left at a progress.
  pure real(wp) function fading(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    fading = 1.0_wp - progress
    if (self%opening > 0.0_wp) fading = max(0.0_wp, 1.0_wp - progress/self%opening)
  end function fading

  !> Return the negative derivative of `fading` behind a progress.
  pure real(wp) function fading_rate(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    fading_rate = 1.0_wp
    if (self%opening > 0.0_wp) then
      fading_rate = merge(1.0_wp/self%opening, 0.0_wp, progress < self%opening - step)
    end if
  end function fading_rate

  !> Return the next place of the tables behind a progress; 1 without a table.
  pure real(wp) function next_kink(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    next_kink = min(next_place(self%table, progress), next_place(self%move_table, progress), &
        next_place(self%turn_table, progress), next_place(self%press_table, progress))
    if (progress < self%opening - step) next_kink = min(next_kink, self%opening)
  end function next_kink

  !> Return the path of the controlling tool between two values of the progress, mm; 0 if loads
  !> control.
  pure real(wp) function path(self, from, to)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: from, to

    path = (to - from)*self%length
    if (self%control == 0) return
    associate (tool => self%control)
      if (self%withdrawn(tool)) path = self%opened(tool, to) - self%opened(tool, from)
    end associate
  end function path

  !> Return the progress at which the controlling tool has moved along its path by a length.
  pure real(wp) function progress_after(self, path) result(progress)
    class(phase_t), intent(in) :: self
    !> mm.
    real(wp), intent(in) :: path

    progress = path/self%length
    if (self%withdrawn(self%control)) progress = self%opening + (1.0_wp - self%opening)*progress
  end function progress_after

end module dd3_model_phase
