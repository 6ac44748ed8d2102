! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of the state that only reports read: how deep tools entered the sheet between its nodes,
!> where it left them over open edges, and what locating pins carried.
module dd3_model_observations
  use dd3_base_kinds, only : wp
  use dd3_model_state_visitor, only : state_visitor_t
  implicit none
  private
  public :: observations_t, new_observations

  !> Observations.
  type :: observations_t
    !> Depth of each tool in the faces of the sheet between the nodes, its largest value in the
    !> running phase, `(n_tool)`, mm, and the face of that value, 0 for none.
    real(wp), allocatable :: depth(:), largest_depth(:)
    integer, allocatable :: deepest_face(:)
    !> Smallest convex radius of each tool near that place, mm; huge for an edge without radius.
    real(wp), allocatable :: deepest_radius(:)
    !> Patch, edge and node where a point under pressure first left each tool over an open edge in
    !> the running phase, `(3, n_tool)`, 0 for none, and the displacement of the tool in the phase
    !> until then, `(n_tool)`, mm.
    integer, allocatable :: open_edge(:, :)
    real(wp), allocatable :: open_edge_displacement(:)
    !> Largest force across each locating pin in the running phase, N, and then the thickness of the
    !> sheet there, mm, and its flow stress, MPa, `(3, n_pin)`.
    real(wp), allocatable :: pin_load(:, :)
  contains
    procedure :: begin_phase
    procedure :: walk
  end type observations_t

contains

  !> Begin without observations.
  subroutine new_observations(self, n_tool, n_pin)
    type(observations_t), intent(out) :: self
    integer, intent(in) :: n_tool, n_pin

    allocate (self%depth(n_tool), self%largest_depth(n_tool), self%deepest_radius(n_tool), &
        self%open_edge_displacement(n_tool), source=0.0_wp)
    allocate (self%deepest_face(n_tool), self%open_edge(3, n_tool), source=0)
    allocate (self%pin_load(3, n_pin), source=0.0_wp)
    call self%begin_phase()
  end subroutine new_observations

  !> Forget what is of a phase.
  pure subroutine begin_phase(self)
    class(observations_t), intent(inout) :: self

    self%largest_depth = 0.0_wp
    self%deepest_face = 0
    self%deepest_radius = huge(1.0_wp)
    self%open_edge = 0
    self%open_edge_displacement = 0.0_wp
    self%pin_load = 0.0_wp
  end subroutine begin_phase

  !> Pass every component to a visitor.
  subroutine walk(self, visitor)
    class(observations_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("tool_depth", size(self%depth), self%depth)
    call visitor%reals("largest_depth", size(self%largest_depth), self%largest_depth)
    call visitor%integers("deepest_face", size(self%deepest_face), self%deepest_face)
    call visitor%reals("deepest_radius", size(self%deepest_radius), self%deepest_radius)
    call visitor%integers("open_edge", size(self%open_edge), self%open_edge)
    call visitor%reals("open_edge_displacement", size(self%open_edge_displacement), &
        self%open_edge_displacement)
    call visitor%reals("pin_load", size(self%pin_load), self%pin_load)
  end subroutine walk

end module dd3_model_observations
