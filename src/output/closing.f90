! SPDX-License-Identifier: GPL-3.0-or-later
!> How far the sheet is formed to the tools at the end of a phase: results of the measure in
!> src/report/closing.f90, for run.json.
module dd3_output_closing
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: closing_t, held_t, pin_t, place_t, punch_t, reached_t, support_t

  !> Distance at a node of the sheet.
  type :: place_t
    !> mm.
    real(wp) :: distance = 0.0_wp
    !> Node, 0 for none, and its position, mm.
    integer :: node = 0
    real(wp) :: x(3) = 0.0_wp
    !> Tool to which it is measured; 0 for none.
    integer :: tool = 0
  end type place_t

  !> A tool that has reached the end of its path into the sheet, and the sheet between it and the
  !> tools across.
  type :: punch_t
    integer :: tool = 0
    !> Path that is left until it would pinch the sheet, where that is shortest.
    type(place_t) :: bottom
    !> Largest distance of the sheet from the nearer tool, across the path and in walls, and the
    !> space that the tools leave in the wall at that place, mm.
    type(place_t) :: floor, wall
    real(wp) :: wall_space = 0.0_wp
    !> Least displacement across the path of the sheet under its level faces, and its vector, mm.
    type(place_t) :: slide
    real(wp) :: slide_vector(3) = 0.0_wp
  end type punch_t

  !> Sheet under a holder.
  type :: held_t
    integer :: tool = 0
    !> Height of the waves of the sheet between the holder and the tool across, and its largest
    !> distance from the latter.
    type(place_t) :: wave, lift
    !> Largest distance of the rim from the outer edge of the holder.
    type(place_t) :: beyond
  end type held_t

  !> Support of *BOUNDARY that holds a few nodes, and its reaction along an axis.
  type :: support_t
    !> Its name; not allocated if there is no such support.
    character(len=:), allocatable :: name
    integer :: axis = 0
    !> Reaction, and largest force on a tool, N.
    real(wp) :: reaction = 0.0_wp, tool_force = 0.0_wp
    integer :: tool = 0
  end type support_t

  !> Locating pin in a hole of the sheet, at the largest force that it carries in a phase.
  type :: pin_t
    !> Name of its support.
    character(len=:), allocatable :: name
    !> Diameter, mm, and force across its axis, N.
    real(wp) :: diameter = 0.0_wp, force = 0.0_wp
    !> Thickness of the sheet there, mm, and its flow stress, MPa.
    real(wp) :: thickness = 0.0_wp, flow_stress = 0.0_wp
  contains
    procedure :: pressure
  end type pin_t

  !> Largest value so far of a limit of the material, 1 where it is reached.
  type :: reached_t
    real(wp) :: value = 0.0_wp
    !> Element, 0 for none, and its middle, mm.
    integer :: element = 0
    real(wp) :: x(3) = 0.0_wp
  end type reached_t

  !> Measures at the end of a phase.
  type :: closing_t
    type(punch_t), allocatable :: punch(:)
    type(held_t), allocatable :: holder(:)
    type(support_t) :: support
    type(pin_t), allocatable :: pin(:)
    !> Damage of a law of fracture, and ratio to the forming limit through the whole thickness.
    type(reached_t) :: damage, forming
  end type closing_t

contains

  !> Return the mean bearing pressure of a pin on its hole, MPa.
  pure real(wp) function pressure(self)
    class(pin_t), intent(in) :: self

    pressure = self%force/(self%diameter*self%thickness)
  end function pressure

end module dd3_output_closing
