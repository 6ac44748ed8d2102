! SPDX-License-Identifier: GPL-3.0-or-later
!> Configuration of a run: sheet, contact, tools and the place in the process, but for what the
!> terms that act on the sheet own (terms/). Arrays of elements and of contact points have those of
!> the rank's part.
module dd3_model_configuration
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks
  use dd3_contact_operator, only : status_gap
  use dd3_model_contact_state, only : contact_state_t
  use dd3_model_observations, only : observations_t
  use dd3_model_sheet_state, only : sheet_state_t
  use dd3_model_tools_state, only : tools_state_t
  use dd3_model_work_state, only : work_state_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: configuration_t, phase_start_t, no_offset

  !> Offset of the contact layer at points that are not held along the normal, mm.
  real(wp), parameter :: no_offset = -huge(1.0_wp)

  !> Values set at the start of a phase: initial values, and final forces on the tools.
  type :: phase_start_t
    !> Displacement of the tools, `(3, n_tool)`, mm, their rotation, `(3, 3, n_tool)`, and angle,
    !> `(n_tool)`, rad.
    real(wp), allocatable :: tool_displacement(:, :), tool_rotation(:, :, :), tool_angle(:)
    !> Force pressed on the tools at the start and at the end of the phase, `(3, n_tool)`, N.
    real(wp), allocatable :: tool_load(:, :), tool_load_end(:, :)
    !> Distance by which the contact layer of each tool lies behind its place, `(n_tool)`, mm, and
    !> by which it does at points that are held along the normal, `(n_contact)`, `no_offset` for
    !> others.
    real(wp), allocatable :: layer_offset(:), held_offset(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Equivalent plastic strain, `(n_point, n_element)`.
    real(wp), allocatable :: plastic_strain(:, :)
    !> mJ.
    real(wp) :: elastic_energy = 0.0_wp
    !> Whether the force of `until` is approached from below; true for a displacement.
    logical :: until_from_below = .true.
  end type phase_start_t

  !> Sheet, contact and tools at one configuration.
  type :: configuration_t
    !> Accepted increments.
    integer :: increment = 0
    !> Running phase, from 1.
    integer :: phase = 1
    !> Whether the running phase has begun; false only before the first one.
    logical :: begun = .false.
    !> Progress within the phase, 0 to 1.
    real(wp) :: progress = 0.0_wp
    !> Path of the controlling tools since the start of the job, mm.
    real(wp) :: travel = 0.0_wp
    !> Time since the start of the job, s; phases without a duration take none.
    real(wp) :: time = 0.0_wp
    !> Upper bound of r after a cut-back.
    real(wp) :: r_cap = huge(1.0_wp)
    !> Last increments with a row in history.csv and with a step in fields.vtkhdf; -1 for none.
    integer :: history_increment = -1, fields_increment = -1
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> External forces, the sum over the terms, `(3, n_node)`, N.
    real(wp), allocatable :: external_force(:, :)
    type(sheet_state_t) :: sheet
    type(contact_state_t) :: contact
    type(tools_state_t) :: tools
    type(observations_t) :: observed
    type(work_state_t) :: work
    !> Whether the tools that the phase withdraws have all left the sheet.
    logical :: open = .false.
    !> Values fixed at the start of the running phase.
    type(phase_start_t) :: start
  contains
    procedure :: placement
    procedure :: find_touching
  end type configuration_t

contains

  !> Return the placement of a tool.
  pure type(placement_t) function placement(self, tool)
    class(configuration_t), intent(in) :: self
    integer, intent(in) :: tool

    placement = self%tools%placement(tool)
  end function placement

  !> Find the tools that are in contact with the sheet, on any rank.
  subroutine find_touching(self)
    class(configuration_t), intent(inout) :: self

    integer :: touching(size(self%tools%touches)), t

    associate (contact => self%contact)
      touching = [(count(contact%tool == t .and. contact%status /= status_gap), t=1, &
          size(touching))]
    end associate
    call largest_over_ranks(size(touching), touching)
    self%tools%touches = touching > 0
  end subroutine find_touching

end module dd3_model_configuration
