! SPDX-License-Identifier: GPL-3.0-or-later
!> The part of the case that describes cushions and spacers of pressed tools.
module dd3_input_cushion_case
  use dd3_base_error, only : location_t
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: tool_pin_t, tool_spacer_t, tool_stroke_t

  !> A pin on which a pressed tool rests.
  type :: tool_pin_t
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Its place in the coordinates of the tool's file, mm, and its share of the force.
    real(wp) :: place(3) = 0.0_wp, share = 1.0_wp
    type(location_t) :: at
  end type tool_pin_t

  !> The force on a pressed tool by its stroke.
  type :: tool_stroke_t
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Stroke, mm, and factor on the force, in pairs.
    real(wp), allocatable :: table(:)
    type(location_t) :: at
  end type tool_stroke_t

  !> A spacer between a pressed tool and another one.
  type :: tool_spacer_t
    !> Positions in `case%tool` of the pressed tool and of the other one.
    integer :: tool = 0, other = 0
    !> Gap between the tools at which it touches, mm; its stiffness, N/mm, and its place in the
    !> coordinates of the pressed tool's file, mm.
    real(wp) :: gap = 0.0_wp, stiffness = 0.0_wp, place(2) = 0.0_wp
    type(location_t) :: at
  end type tool_spacer_t

end module dd3_input_cushion_case
