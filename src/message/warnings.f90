! SPDX-License-Identifier: GPL-3.0-or-later
!> Warnings and notes.
module dd3_message_warnings
  use dd3_message_row, only : message_row_t, row
  implicit none
  private
  public :: input_warnings, run_warnings, notes

contains

  !> Return the warnings of unusual input.
  function input_warnings() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("W001", "unusual Young's modulus", &
          "It lies outside 1e3 to 1e6 MPa: most often another unit than MPa.", &
          "Check `young` of the material; stresses are in MPa, lengths in mm, forces in N."), &
      row("W002", "unusual yield stress in the rolling direction", &
          "The criterion makes the material yield there at less than 0.8 or more than 1.25 "// &
          "times the flow stress of its hardening law.", &
          "Check the parameters of the criterion, their order and their convention."), &
      row("W003", "unusual initial flow stress", &
          "It is above a tenth or below 1e-5 of Young's modulus: another unit, or a parameter "// &
          "in the wrong place.", &
          "Check the parameters of the hardening law."), &
      row("W004", "unusual thickness of the sheet", &
          "It lies outside 0.01 to 100 mm.", "Check the unit and the order of `size`."), &
      row("W005", "unusual coefficient of friction", &
          "Coulomb's coefficient is below 1 in sheet metal forming.", &
          "Check `friction` of the tool; it is no percentage."), &
      row("W006", "large tolerance of the corrector", &
          "Above 0.02 forces may be inaccurate.", "A smaller `tolerance` in `*NEWTON`."), &
      row("W007", "small search distance of the tools", &
          "Below a tenth of the thickness nodes may pass a tool before it is found.", &
          "Leave `search_distance` out: its default is the thickness of the sheet."), &
      row("W008", "load on nodes that are held", &
          "Supports hold some nodes of the set in the direction of the load and carry their "// &
          "part of it.", &
          "Load a set without these nodes."), &
      row("W009", "elements too long for bending", &
          "Elements `hex8` of this length are too stiff where the sheet bends.", &
          "At most half a thickness there, or the element `solid_shell`."), &
      row("W010", "patches of a tool that nearly join", &
          "The edges of two patches run beside each other without the same control points: a "// &
          "node may fall through the gap between them.", &
          "Edges with the same control points and weights, or one patch in place of the two."), &
      row("W011", "candidates on the wrong face of the sheet", &
          "The faces before the tool whose nodes are its candidates are turned away from it.", &
          "The set of the face that the tool meets, such as `contact = z_max`."), &
      row("W012", "draw-bead beside the sheet", &
          "No part of its line lies on the sheet, seen along z.", "Check the points of the "// &
          "line."), &
      row("W013", "yield surface that may not be convex", &
          "The input takes the law in spite of it; the stress update may fail.", &
          "Parameters of a convex surface."), &
      row("W014", "too little memory", &
          "The job needs more memory than the machine has left.", &
          "A mesh with fewer elements, or `method = cgs` in `*SOLVER`."), &
      row("W020", "axes of the material out of the sheet", &
          "`normal_direction` is not the normal of the sheet, the sheet is curved at the "// &
          "start, or `rolling_direction` does not lie in it.", &
          "`normal_direction` left out, for the normal of the sheet; `rolling_direction` in "// &
          "its plane."), &
      row("W021", "unusual r-value", &
          "It lies outside 0.05 to 25: most often per cent, or parameters in a wrong order.", &
          "Ratios of strains, such as r0=1.79; the convention of the criterion's parameters."), &
      row("W022", "unusual density", &
          "It lies outside 1e-10 to 3e-8 t/mm3: most often another unit.", &
          "`density` in t/mm3: 7.85e-9 for steel, 2.7e-9 for aluminium."), &
      row("W023", "unusual gravity", &
          "It lies outside a tenth to ten times that of the earth: most often another unit.", &
          "`gravity` in mm/s2: 9810 on the earth."), &
      row("W024", "support of a single column", &
          "A direction is held at nodes of one column through the thickness only, and tools "// &
          "are withdrawn: the column cannot turn with the sheet.", "One node of the column in "// &
          "the set, or a row of columns, such as a plane of symmetry."), &
      row("W025", "unusual modulus after plastic strain", &
          "By the law `modulus` less than 0.4 of Young's modulus is left, or more than it.", &
          "Check the law: its moduli are in MPa."), &
      row("W026", "unusual law of the strain rate", &
          "At 1 /s it multiplies the flow stress by more than 3.", &
          "Check its parameters: rates are in 1/s."), &
      row("W027", "unusual law of the temperature", &
          "It does not act up to 250 degrees above `initial_temperature`, or it raises the "// &
          "flow stress.", &
          "One scale for the law and `initial_temperature`, which is 20 by default: kelvin "// &
          "or degrees Celsius."), &
      row("W028", "unusual compliance of a tool", &
          "It lies above 0.01 mm/MPa: the tool deflects by 1 mm at 100 MPa.", &
          "Check `compliance`, mm/MPa, against the geometry of the tool."), &
      row("W029", "plane of symmetry to which the model is not symmetric", &
          "A side of the sheet is held along its normal, as on a plane of symmetry, but the "// &
          "flow stresses of the material, gravity, or a tool that reaches it and moves, turns "// &
          "or tilts across it are not symmetric to it.", &
          "The whole sheet. A grip or another support is no plane of symmetry."), &
      row("W030", "tool that touches side and rim of the sheet", &
          "Where they meet, contact forces act over the areas of both, along their mean normal.", &
          "A set of one: `z_max`, `rim`.")]
  end function input_warnings

  !> Return the warnings during a run.
  function run_warnings() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [process_warnings(), sheet_warnings()]
  end function run_warnings

  !> Return the warnings of supports, tools, restart and solution.
  function process_warnings() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("W101", "records that begin at the restart", &
          "Records of the earlier run are missing or have other columns.", &
          "Keep the records beside the restart file, and `*HISTORY` as it was."), &
      row("W102", "pressed tool without contact", &
          "At the start of the phase the pressed tool does not meet the sheet along its force, "// &
          "or its force points away from it.", &
          "The sign of the force, the place of the tool, its set of candidates."), &
      row("W103", "sheet that nothing holds", &
          "Neither supports nor tools in contact stop a rigid motion of the sheet at the start "// &
          "of the phase.", "Supports, or a tool that is in contact from the start."), &
      row("W104", "forces out of equilibrium in an unloading", &
          "The supports that the program chose carry forces of loads.", &
          "Remove the loads with the tools, or support the sheet by `*BOUNDARY`."), &
      row("W105", "early end not met", &
          "The phase went to its whole end without meeting its `until`, or beyond its value.", &
          "A larger motion or force in the phase, or another value of `until`."), &
      row("W106", "yielding while forces of lost constraints fade", &
          "The plastic strain increased in a phase in which nothing acts but fading forces of "// &
          "lost constraints: the free shape depends on how they fade.", &
          "Let the run that forms the sheet end with `unload = on`; lead nodes back by "// &
          "`displace` before they are freed, and compare."), &
      row("W107", "reactions of chosen supports", &
          "The supports that the program chose carry forces at the end of the unloading: the "// &
          "forces on the sheet are not in equilibrium.", &
          "A smaller tolerance of the corrector; loads that are in equilibrium."), &
      row("W108", "moved tool that has not touched the sheet", &
          "The tool passed the sheet, lies elsewhere, points its normals away from it, or has "// &
          "other candidates.", "Its place, its normals, its set of candidates; a finer mesh if "// &
          "it passed between the nodes."), &
      row("W109", "tool between the nodes of the sheet", &
          "Contact holds at its points: a tool with a small radius enters the faces "// &
          "between them.", &
          "Elements of the length that the message gives, in a run with refinement by the "// &
          "`adaptive` that it gives; `points` in `*CONTACT`."), &
      row("W110", "sheet beyond an open edge of a tool", &
          "The sheet has left the tool under pressure where its surface ends.", &
          "A surface that continues beyond this edge."), &
      row("W111", "tools that crossed each other", &
          "Their surfaces overlap at the end of the phase.", &
          "Motions that leave at least the thickness of the sheet between the tools."), &
      row("W112", "ironing with contact points between the nodes", &
          "Where two tools pinch the sheet, these points thin it too much.", &
          "Compare with `points = 1` in `*CONTACT`."), &
      row("W113", "unusual strain at a single point", &
          "A logarithmic strain of 2 is a stretch of more than seven; 0.1 is about 10 %.", &
          "Check `target`; strains are no percentages."), &
      row("W114", "perturbed pivot", &
          "A pivot of the linear system vanished and was perturbed: hardly anything resists "// &
          "this displacement. `perturbed` in status.csv counts such pivots.", &
          "Supports or contact that hold the part of the sheet, or the tool, that is named."), &
      row("W115", "energy balance that is not closed", &
          "At the end of a forming run `energy_error` is more than 5 % of the work: forces or "// &
          "stresses change too much within the increments.", &
          "`accuracy = fine` in `*LIMITS`, a smaller `trial`; compare the results."), &
      row("W116", "sheet that snaps in a release", &
          "Increments failed without viscous forces, which took more than 0.1 % of the change "// &
          "of the elastic energy: the sheet jumped from one equilibrium to another.", &
          "Compare with `unload = at_once`, or tools withdrawn in another order by `move`.")]
  end function process_warnings

  !> Return the warnings of the refined mesh and of the formed sheet.
  function sheet_warnings() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("W117", "elements divided too late", &
          "An increment was made again on finer meshes as often as allowed and still bends "// &
          "elements that could be divided by more than 1.3 times `adaptive_angle`. It is "// &
          "accepted, and they are divided before the next one.", &
          "Smaller increments (`trial`, `rotation` in `*LIMITS`), or shorter elements at the "// &
          "start."), &
      row("W118", "elements that are not divided further", &
          "The sheet is bent by more than 1.5 times `adaptive_angle` over elements of the "// &
          "highest level, or of the least length, at the end of the phase.", &
          "The `adaptive` or `adaptive_size` that the message gives."), &
      row("W119", "sheet that is not formed to the tools", &
          "At the end of its path a punch is more than 0.2 thicknesses before the place where "// &
          "it would pinch the sheet, or the sheet lies more than 0.1 thicknesses off both "// &
          "tools.", &
          "The whole path of the punch; a tool across that ends where the part does."), &
      row("W120", "sheet beyond the holder", &
          "When the holder begins to press, the rim of the sheet lies more than a thickness "// &
          "beyond its outer edge, where nothing keeps the sheet from wrinkling.", &
          "A larger holder, or a smaller blank."), &
      row("W121", "support that carries a part of the tool force", &
          "A support at a few nodes, which are not all nodes of a plane, carries more than 1 "// &
          "% of the largest force on a tool at the end of the phase, and more than the weight "// &
          "of the sheet: it shapes the sheet.", &
          "Supports at other nodes or in fewer directions; none where tools and friction hold "// &
          "the sheet. `pin`, if it is a locating pin."), &
      row("W122", "pin that widens its hole", &
          "The force of a locating pin over diameter and thickness exceeds the yield stress "// &
          "of the sheet there in some increment of the phase.", &
          "A pad with more force or friction, larger pins, or more of them."), &
      row("W123", "sheet that has necked", &
          "The sheet is thinned by more than 40 %, above the forming limits of sheets in "// &
          "plane strain. The thinning depends on the mesh from there on.", &
          "Larger radii, less restraint and friction, a smaller drawing ratio; for the limit "// &
          "of the material `dd3 report`."), &
      row("W124", "sheet that has slid under a punch", &
          "Every node on the level faces of the punch has moved across its path by more than "// &
          "half the thickness: holes made before lie off their places, and the punch leaves "// &
          "marks.", &
          "A pad against the punch or locating pins; walls of equal height; more restraint on "// &
          "the side from which the sheet is drawn."), &
      row("W125", "curve of a cut beyond the sheet", &
          "A curve of `*TRIM` that bounds what stays goes beyond the border of the sheet, "// &
          "where this stays as it is; or it lies beside the sheet and cuts nothing, as holes "// &
          "of a whole part do beside a quarter of it.", &
          "Curves on the sheet, or a larger blank; nothing for holes beside a quarter."), &
      row("W126", "fracture", &
          "The damage of the law `fracture` reaches 1 at a point of the sheet for the first "// &
          "time. The stress is not reduced: what follows is that of a sheet without a crack.", &
          "Larger radii, less restraint and friction; the field `fracture_damage`."), &
      row("W127", "forming limit", &
          "The plastic strain reaches that of `forming_limit`, in the direction of flow, at "// &
          "all points through the thickness of an element for the first time.", &
          "Larger radii, less restraint and friction; the field `forming_limit_ratio`."), &
      row("W128", "heat of plastic work", &
          "At the end of the run, or where it stops, adiabatic heating leaves less than a "// &
          "tenth of the flow stress at a point: the sheet is near melting.", &
          "Check `heat_capacity`, `density` and the law `temperature`; a slow process is not "// &
          "adiabatic."), &
      row("W129", "spacer that touches from the start", &
          "At the start of a phase the spacers of a pressed tool push it back by more than its "// &
          "force.", &
          "A `position` of the tool above the gap of the spacer, or a smaller gap."), &
      row("W130", "draw-bead over several parts of a blank", &
          "A draw-bead crosses sheet of different thickness or material, and its force per "// &
          "length is the same on all of it.", &
          "A `*DRAWBEAD` for each part, with its own force.")]
  end function sheet_warnings

  !> Return the notes.
  function notes() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("N101", "directions that stay displaced", &
          "Earlier phases displaced nodes, and this one holds them where they are.", &
          "`free` in the phase frees them."), &
      row("N102", "chosen supports", &
          "The unloaded sheet is free to move as a rigid body; the program holds it at some "// &
          "nodes.", &
          "Supports by `*BOUNDARY`, if other nodes should stay in place."), &
      row("N103", "small reactions of chosen supports", &
          "The forces on the sheet are in equilibrium, as they should be.", "None."), &
      row("N104", "mean gap in the contact layers", &
          "The compliant contact keeps the sheet off the tools by this distance.", &
          "A smaller `layer` in `*CONTACT`, if it matters."), &
      row("N106", "forces of a sheet that is taken over", &
          "Forces of what acted on the sheet in the other run; they fade over the first "// &
          "phase.", &
          "A first phase with `unload = on`, if they are large."), &
      row("N105", "phase without increments", &
          "The condition of its early end holds at its start.", "Check `until` of the phase."), &
      row("N107", "sheet that is formed to the tools", &
          "The punch is within 0.2 thicknesses of the place where it would pinch the sheet, "// &
          "which lies on the punch or the tool across.", &
          "None."), &
      row("N108", "force of a locating pin", &
          "The largest force on a support with `pin` in the phase, and its bearing pressure, "// &
          "which is below the yield stress of the sheet.", &
          "None."), &
      row("N110", "deflection of elastic tools", &
          "Largest deflection of a tool with `compliance` at the end of the phase, "// &
          "and its largest contact pressure.", "None."), &
      row("N111", "largest damage and ratio to the forming limit", &
          "At the end of the run, or where it stops, of materials with `fracture` or "// &
          "`forming_limit`; 1 is the limit.", "None.")]
  end function notes

end module dd3_message_warnings
