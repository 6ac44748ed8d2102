! SPDX-License-Identifier: GPL-3.0-or-later
!> The case: the checked, plain description of a job. Units are those of the input file (mm, N, MPa,
!> degrees), names are in lower case. `source` is the block a part was read from:
!> `part%source%at("key")` is the place to show in an error. Defaults stand in the keyword table
!> only; values here are unset until the table fills them.
module dd3_input_case
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : location_t
  use dd3_base_text, only : text_t
  use dd3_input_block, only : block_t, deck_t
  use dd3_input_cushion_case, only : tool_pin_t, tool_spacer_t, tool_stroke_t
  use dd3_input_point_case, only : gradient_values, point_goal_t, point_spec_t
  use dd3_settings_adaptive, only : adaptive_spec_t
  use dd3_settings_limits, only : limits_spec_t
  use dd3_settings_newton, only : newton_spec_t
  use dd3_settings_output, only : history_quantities_t, output_spec_t
  use dd3_settings_solver, only : solver_spec_t
  use dd3_settings_until, only : until_spec_t
  implicit none
  private
  public :: case_t, blank_spec_t, region_spec_t, mesh_spec_t, start_spec_t, trim_spec_t
  public :: material_of_t, node_set_spec_t
  public :: law_spec_t, law_parameter_t, material_spec_t
  public :: tool_spec_t, drawbead_spec_t, contact_spec_t, boundary_spec_t
  public :: phase_spec_t, history_spec_t
  public :: tool_gap_t, tool_name_t, tool_tilt_t, tool_turn_t, tool_vector_t
  public :: tool_pin_t, tool_spacer_t, tool_stroke_t
  public :: displace_spec_t, free_spec_t
  public :: load_spec_t, motion_spec_t, pressure_spec_t
  public :: blank_sets, set_plane, set_box, set_nodes, set_near
  public :: point_spec_t, point_goal_t, gradient_values

  !> Node sets of a structured blank: first and last nodes along each axis, then all nodes.
  character(len=5), parameter :: blank_sets(7) = [character(len=5) :: "x_min", "x_max", "y_min", &
      "y_max", "z_min", "z_max", "all"]
  !> Selection of a node set.
  integer, parameter :: set_plane = 1, set_box = 2, set_nodes = 3, set_near = 4

  !> A structured blank.
  type :: blank_spec_t
    character(len=:), allocatable :: name
    !> Corner with the smallest coordinates, and edge lengths, mm.
    real(wp) :: origin(3) = 0.0_wp, size(3) = 0.0_wp
    !> Number of elements along x, y, z; of a round blank along a side of the core in a quarter,
    !> from the core to the rim, and through the thickness.
    integer :: divisions(3) = 1
    !> Radius of a round blank, mm; 0 for a box. Its thickness is `size(3)`.
    real(wp) :: radius = 0.0_wp
    !> Part of the circle that is meshed: quarter, half or full.
    character(len=:), allocatable :: portion
    !> Node abscissae as fractions from 0 to 1, `(0:divisions)`; uniform if not given.
    real(wp), allocatable :: grading_x(:), grading_y(:), grading_z(:)
    !> Shift of the interior node lines, in mean element lengths.
    real(wp) :: skew = 0.0_wp
    !> Name of the element type, not yet checked against the element registry; empty for the
    !> default.
    character(len=:), allocatable :: element
    !> Integration points through the thickness of an element with a choice of them.
    integer :: thickness_points = 0
    !> Position in `case%material`.
    integer :: material = 0
    type(block_t) :: source
  end type blank_spec_t

  !> A part of a blank, of another thickness or material.
  type :: region_spec_t
    !> Vertices of its weld line or outline seen along z, x y in turn, mm; size 0 if they are in a
    !> file.
    real(wp), allocatable :: point(:)
    !> Path of the file of vertices, relative to the working directory.
    character(len=:), allocatable :: file
    !> Where it lies: left or right of the line, or inside the outline.
    character(len=:), allocatable :: side
    !> mm; 0 for that of the blank.
    real(wp) :: thickness = 0.0_wp
    !> Face with the step to the thickness of the blank: top, bottom or both.
    character(len=:), allocatable :: step
    !> Position in `case%material`; 0 for that of the blank.
    integer :: material = 0
    type(block_t) :: source
  end type region_spec_t

  !> Material of an element set.
  type :: material_of_t
    character(len=:), allocatable :: set
    !> Name of the material and its position in `case%material`.
    character(len=:), allocatable :: name
    integer :: material = 0
    type(location_t) :: at
  end type material_of_t

  !> A mesh from a file.
  type :: mesh_spec_t
    character(len=:), allocatable :: name
    !> Path relative to the working directory.
    character(len=:), allocatable :: file
    !> Name of the element type, not yet checked against the element registry; empty for the
    !> default.
    character(len=:), allocatable :: element
    !> Integration points through the thickness of an element with a choice of them.
    integer :: thickness_points = 0
    !> Position in `case%material` for the elements of no set below; 0 for none.
    integer :: material = 0
    type(material_of_t), allocatable :: material_of(:)
    type(block_t) :: source
  end type mesh_spec_t

  !> A sheet taken over from another run.
  type :: start_spec_t
    !> Folder of the run, relative to the working directory.
    character(len=:), allocatable :: from
    !> Whether the run must have reached its end; otherwise its last state is taken.
    logical :: at_end = .true.
    !> Turns of the sheet one after another, `(7, n)`: point and direction of the axis, mm, and the
    !> angle, degrees; then its displacement, mm.
    real(wp), allocatable :: turn(:, :)
    real(wp) :: move(3) = 0.0_wp
    type(block_t) :: source
  end type start_spec_t

  !> A cut of the sheet along closed curves.
  type :: trim_spec_t
    character(len=:), allocatable :: name
    !> Vertices of one curve, x y z in turn, mm; size 0 if they are in a file.
    real(wp), allocatable :: point(:)
    !> Path of the file of curves, relative to the working directory.
    character(len=:), allocatable :: file
    !> Direction along which the curves are projected on the sheet; zero: normal to the sheet.
    real(wp) :: along(3) = 0.0_wp
    !> Whether the part inside the curves stays; the part outside otherwise.
    logical :: keeps_inside = .true.
    type(block_t) :: source
  end type trim_spec_t

  !> A node set, selected by the initial coordinates.
  type :: node_set_spec_t
    character(len=:), allocatable :: name
    !> One of the `set_*` values.
    integer :: kind = set_plane
    !> Axis of a plane: 1, 2, 3.
    integer :: axis = 1
    !> Abscissa of a plane; x0 x1 y0 y1 z0 z1 of a box; x y z of a point; mm.
    real(wp), allocatable :: value(:)
    !> First and last node number of each range, `(2, n)`.
    integer, allocatable :: range(:, :)
    !> Set whose members are kept; empty to keep all.
    character(len=:), allocatable :: of
    !> Tolerance, mm; negative for 1e-6 of the model's size.
    real(wp) :: tolerance = -1.0_wp
    type(block_t) :: source
  end type node_set_spec_t

  !> A law's parameter as written.
  type :: law_parameter_t
    character(len=:), allocatable :: key
    character(len=:), allocatable :: text
    !> Value as a number, 0 if it is not one; of a pair `p:Y` the second number.
    real(wp) :: value = 0.0_wp
    !> Whether the value is a number, or two of a pair.
    logical :: numeric = .false.
    !> First number of a pair.
    real(wp) :: abscissa = 0.0_wp
    !> Where the value and the key are written.
    type(location_t) :: at, key_at
  end type law_parameter_t

  !> A law and its parameters as written, not yet checked against the registry: see dd3_input_law.
  type :: law_spec_t
    character(len=:), allocatable :: name
    !> Where the name is written.
    type(location_t) :: at
    !> Folder that paths are relative to, with a slash at the end, or empty.
    character(len=:), allocatable :: folder
    !> Parameters in the order written.
    type(law_parameter_t), allocatable :: parameter(:)
  end type law_spec_t

  !> Material as written, with its axes.
  type :: material_spec_t
    character(len=:), allocatable :: name
    !> Young's modulus (MPa) and Poisson's ratio.
    real(wp) :: young = 0.0_wp, poisson = 0.0_wp
    type(law_spec_t) :: yield, hardening
    !> Law of the modulus; without a name for a constant one.
    type(law_spec_t) :: modulus
    !> Laws of the strain rate and of the temperature; without a name for none.
    type(law_spec_t) :: rate, temperature
    !> Law of fracture, likewise, and points of the forming limit curve, minor and major strain in
    !> pairs; not allocated for none.
    type(law_spec_t) :: fracture
    real(wp), allocatable :: forming_limit(:)
    !> Temperature of the undeformed material.
    real(wp) :: initial_temperature = 20.0_wp
    !> Heat capacity, mJ/(t K), 0 without heating, and the part of plastic work that heats.
    real(wp) :: heat_capacity = 0.0_wp, heat_fraction = 0.9_wp
    !> t/mm3; 0 if not given.
    real(wp) :: density = 0.0_wp
    !> Size 0 without a back-stress.
    type(law_spec_t), allocatable :: backstress(:)
    !> Rolling, transverse and normal direction at the start, in columns; zero if undefined.
    real(wp) :: frame(3, 3) = 0.0_wp
    type(block_t) :: source
  end type material_spec_t

  !> A tool.
  type :: tool_spec_t
    character(len=:), allocatable :: name
    !> Path of its surface file, relative to the working directory.
    character(len=:), allocatable :: patches
    !> Coefficient of friction.
    real(wp) :: friction = 0.0_wp
    !> Factors on it, size 0 for a constant coefficient.
    type(law_spec_t), allocatable :: friction_law(:)
    !> Compliance of the surface, mm/MPa.
    real(wp) :: compliance = 0.0_wp
    !> Node set of the candidates on the sheet.
    character(len=:), allocatable :: contact
    !> Initial offset, mm.
    real(wp) :: position(3) = 0.0_wp
    type(block_t) :: source
  end type tool_spec_t

  !> A draw-bead.
  type :: drawbead_spec_t
    !> Vertices of its line in plan, x y in turn, mm; size 0 if they are in a file.
    real(wp), allocatable :: point(:)
    !> Path of the file of vertices, relative to the working directory.
    character(len=:), allocatable :: file
    !> Largest restraining force, and force on the sheet along z, N/mm.
    real(wp) :: force = 0.0_wp, normal = 0.0_wp
    !> Slip path (mm) and factor on the restraining force, in pairs.
    real(wp), allocatable :: table(:)
    !> Position in `case%tool` of the tool that carries it; 0 for none.
    integer :: tool = 0
    !> Number of the phase from which it acts.
    integer :: from = 1
    type(block_t) :: source
  end type drawbead_spec_t

  !> Settings of the contact.
  type :: contact_spec_t
    !> Whether the formulation is the mixed one; the compliant one otherwise.
    logical :: mixed = .false.
    !> Height of the contact layer of the compliant formulation over the thickness; 0: default.
    real(wp) :: layer = 0.0_wp
    !> Number of parts of an element's edge between contact points.
    integer :: points = 1
    type(location_t) :: points_at
    !> Penalty of the mixed formulation, N/mm.
    real(wp) :: penalty = 0.0_wp
    !> Search distance of the tools, mm; negative for the thickness of the sheet.
    real(wp) :: search_distance = -1.0_wp
  end type contact_spec_t

  !> Fixed nodes.
  type :: boundary_spec_t
    character(len=:), allocatable :: name
    !> Node set.
    character(len=:), allocatable :: set
    !> Whether x, y, z are fixed.
    logical :: fix(3) = .false.
    !> Diameter of the locating pin that the support stands for, mm; 0 for none.
    real(wp) :: pin = 0.0_wp
    type(block_t) :: source
  end type boundary_spec_t

  !> A tool named in a phase.
  type :: tool_name_t
    !> Position in `case%tool`.
    integer :: tool = 0
    type(location_t) :: at
  end type tool_name_t

  !> A displacement of a tool (mm) or a force on it (N) in a phase.
  type :: tool_vector_t
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Displacement over the phase, or force at its end.
    real(wp) :: vector(3) = 0.0_wp
    type(location_t) :: at
  end type tool_vector_t

  !> A turn of a tool about an axis that moves with it.
  type :: tool_turn_t
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Point and direction of the axis in the coordinates of the tool's file, mm, and the angle over
    !> the phase, degrees.
    real(wp) :: value(7) = 0.0_wp
    type(location_t) :: at
  end type tool_turn_t

  !> A pressed tool that tilts.
  type :: tool_tilt_t
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Pivot in the coordinates of the tool's file, mm, and stiffness of its support, N.mm/rad.
    real(wp) :: pivot(3) = 0.0_wp, stiffness = 0.0_wp
    type(location_t) :: at
  end type tool_tilt_t

  !> A gap between two tools at the end of a phase.
  type :: tool_gap_t
    !> Positions in `case%tool` of the tool that moves and of the other one.
    integer :: tool = 0, other = 0
    !> mm, or thicknesses of the sheet.
    real(wp) :: value = 0.0_wp
    logical :: in_thicknesses = .false.
    type(location_t) :: at
  end type tool_gap_t

  !> A prescribed displacement of nodes, or the coordinate to which they move.
  type :: displace_spec_t
    !> Node set.
    character(len=:), allocatable :: set
    !> Axis: 1, 2, 3.
    integer :: axis = 1
    !> Displacement over the phase, or coordinate at its end, mm.
    real(wp) :: value = 0.0_wp
    logical :: is_coordinate = .false.
    type(location_t) :: at
  end type displace_spec_t

  !> Directions of nodes that are free again.
  type :: free_spec_t
    !> Node set.
    character(len=:), allocatable :: set
    !> Whether x, y, z are freed.
    logical :: direction(3) = .false.
    type(location_t) :: at
  end type free_spec_t

  !> A force on nodes.
  type :: load_spec_t
    !> Node set.
    character(len=:), allocatable :: set
    !> Total force at the end of the phase, N.
    real(wp) :: force(3) = 0.0_wp
    type(location_t) :: at
  end type load_spec_t

  !> A rotation of nodes about an axis, or the motion of the end section of a bar that is bent.
  type :: motion_spec_t
    !> Node set.
    character(len=:), allocatable :: set
    !> Whether the set is the end section of a bent bar.
    logical :: bends = .false.
    !> Point and direction of the axis (mm), and the angle (degrees): over the phase, of a bend at
    !> its end.
    real(wp) :: value(7) = 0.0_wp
    type(location_t) :: at
  end type motion_spec_t

  !> A pressure on the faces with all nodes in a set.
  type :: pressure_spec_t
    !> Node set.
    character(len=:), allocatable :: set
    !> Pressure at the end of the phase, MPa.
    real(wp) :: value = 0.0_wp
    type(location_t) :: at
  end type pressure_spec_t

  !> A phase of the process.
  type :: phase_spec_t
    character(len=:), allocatable :: name
    !> Position of the controlling tool in `case%tool`; 0 for `load`.
    integer :: control = 0
    !> Trial increment: mm of the controlling tool, or fraction of the phase for `load`.
    real(wp) :: trial = 0.0_wp
    !> Whether all tools are released and supports are chosen where they are missing.
    logical :: unload = .false.
    !> Whether `unload` takes the tools away at the start, in place of withdrawing them.
    logical :: at_once = .false.
    !> Whether the state at the end is kept for other runs.
    logical :: keep = .false.
    !> Duration, s, and mean speed of the controlling tool, mm/s; 0 if not given.
    real(wp) :: duration = 0.0_wp, speed = 0.0_wp
    !> Tools held, and tools that are withdrawn.
    type(tool_name_t), allocatable :: hold(:), release(:)
    !> Tools moved, and tools pressed.
    type(tool_vector_t), allocatable :: move(:), press(:)
    type(tool_gap_t), allocatable :: gap(:)
    type(tool_turn_t), allocatable :: turn(:)
    type(tool_tilt_t), allocatable :: tilt(:)
    type(tool_pin_t), allocatable :: pin(:)
    type(tool_stroke_t), allocatable :: stroke(:)
    type(tool_spacer_t), allocatable :: spacer(:)
    type(displace_spec_t), allocatable :: displace(:)
    type(free_spec_t), allocatable :: free(:)
    type(load_spec_t), allocatable :: load(:)
    type(motion_spec_t), allocatable :: motion(:)
    type(pressure_spec_t), allocatable :: pressure(:)
    !> Acceleration of gravity at the end of the phase, mm/s2, and whether it is given.
    real(wp) :: gravity(3) = 0.0_wp
    logical :: has_gravity = .false.
    !> Progress and factor on displacements and loads, on the motions and on the turns of tools, in
    !> pairs; size 0 if not given.
    real(wp), allocatable :: table(:), move_table(:), turn_table(:)
    !> Progress and factor on the forces of `press`, in pairs; size 0 if not given.
    real(wp), allocatable :: press_table(:)
    type(until_spec_t) :: until
    !> Settings in this phase, with those inherited from the phases before.
    type(limits_spec_t) :: limits
    type(newton_spec_t) :: newton
    type(contact_spec_t) :: contact
    type(block_t) :: source
  end type phase_spec_t

  !> Additional columns of the history table.
  type, extends(history_quantities_t) :: history_spec_t
    character(len=:), allocatable :: name
    !> Node set.
    character(len=:), allocatable :: set
    type(block_t) :: source
  end type history_spec_t

  !> Input of a job.
  type :: case_t
    !> Name of the input file as given.
    character(len=:), allocatable :: file
    !> Lines of the title.
    type(text_t), allocatable :: title(:)
    type(blank_spec_t), allocatable :: blank(:)
    type(region_spec_t), allocatable :: region(:)
    type(mesh_spec_t), allocatable :: mesh(:)
    type(start_spec_t), allocatable :: start(:)
    type(trim_spec_t), allocatable :: trim(:)
    type(adaptive_spec_t) :: adaptive
    !> Node sets of the input file, in its order.
    type(node_set_spec_t), allocatable :: set(:)
    type(material_spec_t), allocatable :: material(:)
    type(tool_spec_t), allocatable :: tool(:)
    type(drawbead_spec_t), allocatable :: drawbead(:)
    type(boundary_spec_t), allocatable :: boundary(:)
    !> Settings before the first phase.
    type(limits_spec_t) :: limits
    type(newton_spec_t) :: newton
    type(contact_spec_t) :: contact
    type(solver_spec_t) :: solver
    !> Phases in order.
    type(phase_spec_t), allocatable :: phase(:)
    type(point_spec_t), allocatable :: point(:)
    type(history_spec_t), allocatable :: history(:)
    type(output_spec_t) :: output
    !> Checked input with its defaults filled in, for the echo.
    type(deck_t) :: deck
  end type case_t

end module dd3_input_case
