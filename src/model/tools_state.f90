! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of the state that belongs to the tools.
module dd3_model_tools_state
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: tools_state_t, new_tools_state

  !> State of the tools.
  type :: tools_state_t
    !> Displacement from the coordinates of their files, `(3, n_tool)`, mm; of those that turn or
    !> tilt, of the point `centre` on the axis or the pivot, `(3, n_tool)`, mm.
    real(wp), allocatable :: displacement(:, :), centre(:, :)
    !> Rotation, `(3, 3, n_tool)`, and angle since the start of the job, `(n_tool)`, rad.
    real(wp), allocatable :: rotation(:, :, :), angle(:)
    !> Rotation from which the tilt is measured, `(3, 3, n_tool)`.
    real(wp), allocatable :: untilted(:, :, :)
    !> Displacement at which their cushions have no stroke, `(3, n_tool)`, mm.
    real(wp), allocatable :: rest(:, :)
    !> Force pressed on them, and that of the sheet on them with those of their draw-beads and
    !> fading ones, `(3, n_tool)`, N.
    real(wp), allocatable :: load(:, :), force(:, :)
    !> Distance by which the contact layer lies behind its place, `(n_tool)`, mm.
    real(wp), allocatable :: layer_offset(:)
    !> Whether each is in contact with the sheet, on any rank, and whether it has been since the
    !> start of the job, `(n_tool)`.
    logical, allocatable :: touches(:), touched(:)
  contains
    procedure :: placement
    procedure :: refer_to
    procedure :: walk
  end type tools_state_t

contains

  !> Make the state at the start of the job.
  subroutine new_tools_state(self, model)
    type(tools_state_t), intent(out) :: self
    type(model_t), intent(in) :: model

    integer :: t

    associate (n => model%n_tool)
      allocate (self%displacement(3, n), self%centre(3, n), self%load(3, n), self%force(3, n), &
          source=0.0_wp)
      allocate (self%rest(3, n), source=0.0_wp)
      allocate (self%angle(n), self%layer_offset(n), source=0.0_wp)
      allocate (self%touches(n), self%touched(n), source=.false.)
      self%rotation = spread(identity, 3, n)
      self%untilted = self%rotation
      do t = 1, n
        self%displacement(:, t) = model%tool(t)%position
      end do
    end associate
  end subroutine new_tools_state

  !> Return the placement of a tool.
  pure type(placement_t) function placement(self, tool)
    class(tools_state_t), intent(in) :: self
    integer, intent(in) :: tool

    placement%rotation = self%rotation(:, :, tool)
    associate (centre => self%centre(:, tool))
      placement%translation = self%displacement(:, tool) &
          + (centre - placement%vector_to_global(centre))
    end associate
  end function placement

  !> Refer the displacement of a tool to another point.
  pure subroutine refer_to(self, tool, centre)
    class(tools_state_t), intent(inout) :: self
    integer, intent(in) :: tool
    !> In the coordinates of the tool's file, mm.
    real(wp), intent(in) :: centre(3)

    type(placement_t) :: placement
    real(wp) :: displacement(3)

    placement = self%placement(tool)
    displacement = placement%translation + placement%vector_to_global(centre) - centre
    self%rest(:, tool) = self%rest(:, tool) + displacement - self%displacement(:, tool)
    self%displacement(:, tool) = displacement
    self%centre(:, tool) = centre
  end subroutine refer_to

  !> Pass every component to a visitor.
  subroutine walk(self, visitor)
    class(tools_state_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("tool_displacement", size(self%displacement), self%displacement)
    call visitor%reals("tool_centre", size(self%centre), self%centre)
    call visitor%reals("tool_rotation", size(self%rotation), self%rotation)
    call visitor%reals("tool_untilted", size(self%untilted), self%untilted)
    call visitor%reals("tool_angle", size(self%angle), self%angle)
    call visitor%reals("tool_rest", size(self%rest), self%rest)
    call visitor%reals("tool_load", size(self%load), self%load)
    call visitor%reals("tool_force", size(self%force), self%force)
    call visitor%reals("layer_offset", size(self%layer_offset), self%layer_offset)
    call visitor%logicals("touches", size(self%touches), self%touches)
    call visitor%logicals("touched", size(self%touched), self%touched)
  end subroutine walk

end module dd3_model_tools_state
