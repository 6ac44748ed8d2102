! SPDX-License-Identifier: GPL-3.0-or-later
!> The keys of *PHASE, one row each.
module dd3_input_phase_keys
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : kind_logical, kind_name, kind_other, kind_real, kind_reals, &
      parameter_t, row
  use dd3_input_keys, only : contact_keys, limits_keys, newton_keys
  implicit none
  private
  public :: phase_keys

  !> Bound of the numbers that must not be negative.
  real(wp), parameter :: zero = 0.0_wp

contains

  !> Keys of a phase: its own, then those of limits, newton and contact, without defaults.
  function phase_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    type(parameter_t), allocatable :: inherited(:)
    integer :: i

    ! The contact points are those of the whole job.
    inherited = [limits_keys(), newton_keys(), contact_keys()]
    inherited = pack(inherited, [(inherited(i)%name /= "points", i=1, size(inherited))])
    inherited%default = "-"
    key = [ &
      row("control", kind_name, "", "", "controlling tool, or load"), &
      row("trial", kind_real, "", "", &
          "trial increment: mm of the controlling tool, or fraction of the phase for load", &
          lower=zero, lower_open=.true.), &
      row("duration", kind_real, "s", "-", "time of the phase, for laws of the strain rate", &
          lower=zero, lower_open=.true.), &
      row("speed", kind_real, "mm/s", "-", "mean speed of the controlling tool, in place of "// &
          "duration", lower=zero, lower_open=.true.), &
      row("hold", kind_other, "", "-", "tool that does not move", repeatable=.true., &
          form="tool"), &
      row("move", kind_other, "mm", "-", "displacement of a tool over the phase", &
          repeatable=.true., form="tool number number number"), &
      row("turn", kind_other, "mm, degrees", "-", "turn of a tool over the phase: point and "// &
          "direction of the axis in the coordinates of the tool's file, angle", &
          repeatable=.true., form="tool number number number number number number number"), &
      row("gap", kind_other, "mm", "-", "tool that moves along z over the phase to a gap from "// &
          "another tool, in mm or thicknesses of the sheet", repeatable=.true., &
          form="tool tool number [thicknesses]"), &
      row("press", kind_other, "N", "-", &
          "force on a tool at the end of the phase; the tool moves only in its direction", &
          repeatable=.true., form="tool number number number"), &
      row("tilt", kind_other, "mm, N.mm/rad", "-", &
          "pressed tool that may tilt about axes across its force: pivot in the coordinates of "// &
          "the tool's file, at which the force acts, and stiffness of its support against tilt", &
          repeatable=.true., &
          form="tool number number number number"), &
      row("pin", kind_other, "mm", "-", "pin that carries a share of the force on a pressed "// &
          "tool, which tilts on its pins: place in the coordinates of the tool's file, share; "// &
          "the sum of the shares of a tool counts as 1", repeatable=.true., &
          form="tool number number number number"), &
      row("stroke_table", kind_other, "mm", "-", "pressed tool, stroke by which it has been "// &
          "pushed back since it is pressed, and factor on its force there, at each pin by its "// &
          "own stroke, in pairs; constant beyond the ends", repeatable=.true., &
          form="tool number..."), &
      row("spacer", kind_other, "mm, N/mm", "-", "spacer between a pressed tool and another "// &
          "one that is not: the gap between the tools along z at which it touches, its "// &
          "stiffness, and x and y of its place in the coordinates of the pressed tool's file", &
          repeatable=.true., form="tool tool number number number number"), &
      row("release", kind_other, "", "-", &
          "tool that is withdrawn from the sheet over the phase, with its contact, and has "// &
          "none afterwards until a later phase names it again", &
          repeatable=.true., &
          form="tool"), &
      row("displace", kind_other, "mm", "-", "displacement of nodes over the phase", &
          repeatable=.true., form="set axis number"), &
      row("place", kind_other, "mm", "-", "coordinate to which the nodes move over the phase, "// &
          "from where they are", repeatable=.true., form="set axis number"), &
      row("free", kind_other, "", "-", &
          "directions that displace has led until now; their reactions turn with the sheet "// &
          "and fall linearly over the phase", &
          repeatable=.true., form="set axis..."), &
      row("load", kind_other, "N", "-", "total force on nodes at the end of the phase", &
          repeatable=.true., form="set number number number"), &
      row("pressure", kind_other, "MPa", "-", "pressure at the end of the phase on the faces "// &
          "with all nodes in the set; follows the faces", repeatable=.true., form="set number"), &
      row("gravity", kind_reals, "mm/s2", "-", "acceleration of gravity at the end of the "// &
          "phase; a sheet that is free is laid down", count=3), &
      row("rotate", kind_other, "mm, degrees", "-", "rotation of nodes over the phase: point "// &
          "and direction of the axis, angle", repeatable=.true., &
          form="set number number number number number number number"), &
      row("bend", kind_other, "mm, degrees", "-", "angle at the end of the phase of the end "// &
          "section of a bar bent to an arc: set, point at its fixed end, direction of the "// &
          "axis, angle", repeatable=.true., &
          form="set number number number number number number number"), &
      row("table", kind_reals, "", "-", "progress and factor on displace, place, rotate, bend, "// &
          "load and pressure, in pairs from 0 0 on; default: 0 0 1 1", count=0), &
      row("move_table", kind_reals, "", "-", "progress and factor on move and gap, in pairs "// &
          "from 0 0 on; default: 0 0 1 1", count=0), &
      row("turn_table", kind_reals, "", "-", "progress and factor on the angles of turn, in "// &
          "pairs from 0 0 on; default: 0 0 1 1", count=0), &
      row("press_table", kind_reals, "", "-", "progress and factor on the forces of press, in "// &
          "pairs to 1; default: 1 1", count=0), &
      row("unload", kind_name, "", "off", "springback; supports are chosen that stop the rigid "// &
          "motions left free. on: all tools are withdrawn at the same time, with contact. "// &
          "at_once: they are taken away at the start of the phase, over which the nodal forces "// &
          "of the stresses at its start fade", choices="off on at_once"), &
      row("keep", kind_logical, "", "-", "on: the state at the end is kept in the folder of "// &
          "the phase's name in that of the results, for from of *START"), &
      row("until", kind_other, "mm or N", "-", &
          "ends the phase early: displacement or force of a tool in its direction", &
          form="displacement|force tool number"), &
      inherited]
    do i = 1, 2
      key(i)%implied_by = "unload"
      key(i)%implied = merge("load", "0.1 ", key(i)%name == "control")
    end do
  end function phase_keys

end module dd3_input_phase_keys
