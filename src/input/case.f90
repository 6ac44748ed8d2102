!> The case: the checked, plain description of a job. Units as in the input file (mm, N, MPa,
!> degrees).
!> Names are in small letters. Every part keeps the block it was read from: `part%source%at("key")`
!> is the place to show
!> in an error.
module dd3_input_case
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : location_t
  use dd3_base_text, only : text_t
  use dd3_input_block, only : block_t, deck_t
  implicit none
  private
  public :: case_t, blank_spec_t, node_set_spec_t, law_spec_t, law_parameter_t, material_spec_t
  public :: tool_spec_t, contact_spec_t, boundary_spec_t, limits_spec_t, limit_spec_t, newton_spec_t
  public :: solver_spec_t, phase_spec_t, history_spec_t, output_spec_t
  public :: tool_name_t, tool_vector_t, displace_spec_t, load_spec_t, until_spec_t
  public :: set_plane, set_box, set_nodes, set_near
  public :: until_never, until_displacement, until_force
  public :: point_spec_t, point_goal_t, gradient_values
  public :: fields_ends, fields_every, fields_at, fields_increments

  !> How a node set is chosen.
  integer, parameter :: set_plane = 1, set_box = 2, set_nodes = 3, set_near = 4
  !> What ends a phase early.
  integer, parameter :: until_never = 0, until_displacement = 1, until_force = 2
  !> Number of the components of a deformation gradient.
  integer, parameter :: gradient_values = 9
  !> When fields are written: first and last state only, every so many mm, at given travels, every
  !> so many increments.
  integer, parameter :: fields_ends = 0, fields_every = 1, fields_at = 2, fields_increments = 3

  !> A structured blank.
  type :: blank_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Corner with the smallest coordinates and edge lengths, mm.
    real(wp) :: origin(3) = 0.0_wp, size(3) = 0.0_wp
    !> Number of elements along x, y, z.
    integer :: divisions(3) = 1
    !> Node abscissae as fractions from 0 to 1, uniform where nothing was given: (0:divisions).
    real(wp), allocatable :: grading_x(:), grading_y(:), grading_z(:)
    !> Shift of the interior node lines, in mean element lengths.
    real(wp) :: skew = 0.0_wp
    !> Name of the element.
    character(len=:), allocatable :: element
    !> Position in `case%material`.
    integer :: material = 0
    !> The block it was read from.
    type(block_t) :: source
  end type blank_spec_t

  !> A node set chosen from the initial coordinates.
  type :: node_set_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> One of the `set_*` values.
    integer :: kind = set_plane
    !> Axis of a plane: 1, 2, 3.
    integer :: axis = 1
    !> Abscissa of a plane; x0 x1 y0 y1 z0 z1 of a box; x y z of a point, mm.
    real(wp), allocatable :: value(:)
    !> First and last node number of each range: (2, n).
    integer, allocatable :: range(:, :)
    !> The set whose members alone are kept; empty for all nodes.
    character(len=:), allocatable :: of
    !> Tolerance, mm; negative for 1e-6 of the model's size.
    real(wp) :: tolerance = -1.0_wp
    !> The block it was read from.
    type(block_t) :: source
  end type node_set_spec_t

  !> A law's parameter as written.
  type :: law_parameter_t
    !> Its name as written.
    character(len=:), allocatable :: key
    !> The value as written.
    character(len=:), allocatable :: text
    !> The value as a number, 0 if it is none.
    real(wp) :: value = 0.0_wp
    !> Whether it is a number.
    logical :: numeric = .false.
    !> Of a point `p:Y`, what stands before the colon.
    real(wp) :: abscissa = 0.0_wp
    !> Where the value was written.
    type(location_t) :: at
    !> Where the name was written.
    type(location_t) :: key_at
  end type law_parameter_t

  !> A law's name and its parameters, not yet checked against the laws there are: see dd3_input_law.
  type :: law_spec_t
    !> Name of the law, in small letters.
    character(len=:), allocatable :: name
    !> Where the name was written.
    type(location_t) :: at
    !> Folder that paths are relative to, with a slash at the end, or empty.
    character(len=:), allocatable :: folder
    !> Its parameters, in the order written.
    type(law_parameter_t), allocatable :: parameter(:)
  end type law_spec_t

  !> A material.
  type :: material_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Young's modulus (MPa) and Poisson's ratio.
    real(wp) :: young = 0.0_wp, poisson = 0.0_wp
    !> The yield criterion and the hardening law.
    type(law_spec_t) :: yield, hardening
    !> The back-stress laws; none of them where there is no back-stress.
    type(law_spec_t), allocatable :: backstress(:)
    !> Columns: rolling, transverse and normal direction at the start, unit vectors, right-handed.
    real(wp) :: frame(3, 3) = 0.0_wp
    !> The block it was read from.
    type(block_t) :: source
  end type material_spec_t

  !> A rigid tool.
  type :: tool_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Path of its surface file, relative to the working directory.
    character(len=:), allocatable :: patches
    !> Coefficient of friction.
    real(wp) :: friction = 0.0_wp
    !> Node set of the candidates on the sheet.
    character(len=:), allocatable :: contact
    !> Initial offset, mm.
    real(wp) :: position(3) = 0.0_wp
    !> The block it was read from.
    type(block_t) :: source
  end type tool_spec_t

  !> Settings of the contact.
  type :: contact_spec_t
    !> Penalty, N/mm.
    real(wp) :: penalty = 1000.0_wp
    !> Distance within which tools are searched, mm; negative for the sheet's thickness.
    real(wp) :: search_distance = -1.0_wp
  end type contact_spec_t

  !> Fixed nodes.
  type :: boundary_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Node set.
    character(len=:), allocatable :: set
    !> Whether x, y, z are held.
    logical :: fix(3) = .false.
    !> The block it was read from.
    type(block_t) :: source
  end type boundary_spec_t

  !> A number that may be switched off.
  type :: limit_spec_t
    !> Whether it is on.
    logical :: active = .false.
    !> The number; where off, a value that never limits.
    real(wp) :: value = huge(1.0_wp)
  end type limit_spec_t

  !> Limits of the predictor.
  type :: limits_spec_t
    !> Largest strain increment.
    type(limit_spec_t) :: strain = limit_spec_t(.true., 0.005_wp)
    !> Largest rotation increment, degrees.
    type(limit_spec_t) :: rotation = limit_spec_t(.true., 0.05_wp)
    !> Largest stress increments along (a) and normal to (b) the yield surface, in flow stresses.
    type(limit_spec_t) :: stress_tangential = limit_spec_t(.true., 3.0_wp)
    !> See above.
    type(limit_spec_t) :: stress_normal = limit_spec_t(.true., 1.0_wp)
    !> c, d, e of the contact force limit.
    type(limit_spec_t) :: force(3)
    !> Floor of the contact force limit; 0 where off.
    type(limit_spec_t) :: force_floor = limit_spec_t(.true., 0.1_wp)
    !> Smallest factor r; 0 where off.
    type(limit_spec_t) :: r_min = limit_spec_t(.true., 0.001_wp)
    !> Largest factor r.
    type(limit_spec_t) :: r_max = limit_spec_t(.true., 1.0_wp)
  end type limits_spec_t

  !> Settings of the corrector.
  type :: newton_spec_t
    !> Tolerance of the convergence criterion.
    real(wp) :: tolerance = 1.0e-2_wp
    !> Most iterations of an increment.
    integer :: iterations = 30
    !> Whether an increment that fails is tried again with a smaller r.
    logical :: cutback = .false.
    !> Factor on r at each new attempt.
    real(wp) :: cutback_factor = 0.5_wp
    !> Smallest r before the run is given up.
    real(wp) :: cutback_min = 1.0e-5_wp
  end type newton_spec_t

  !> Settings of the linear solver.
  type :: solver_spec_t
    !> cgs, umfpack or auto.
    character(len=:), allocatable :: method
    !> Level of fill of the incomplete factorisation.
    integer :: ilu_level = 2
    !> Tolerance of the relative residual.
    real(wp) :: tolerance = 1.0e-10_wp
    !> Most iterations.
    integer :: iterations = 500
    !> none, amd or rcm.
    character(len=:), allocatable :: ordering
  end type solver_spec_t

  !> A tool named in a phase.
  type :: tool_name_t
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Where it was written.
    type(location_t) :: at
  end type tool_name_t

  !> A tool's displacement (mm) or the force on it (N) in a phase.
  type :: tool_vector_t
    !> Position in `case%tool`.
    integer :: tool = 0
    !> The displacement over the phase, or the force at its end.
    real(wp) :: vector(3) = 0.0_wp
    !> Where it was written.
    type(location_t) :: at
  end type tool_vector_t

  !> A prescribed displacement of nodes.
  type :: displace_spec_t
    !> Node set.
    character(len=:), allocatable :: set
    !> Axis: 1, 2, 3.
    integer :: axis = 1
    !> Displacement over the phase, mm.
    real(wp) :: value = 0.0_wp
    !> Where it was written.
    type(location_t) :: at
  end type displace_spec_t

  !> A force on nodes.
  type :: load_spec_t
    !> Node set.
    character(len=:), allocatable :: set
    !> Total force at the end of the phase, N.
    real(wp) :: force(3) = 0.0_wp
    !> Where it was written.
    type(location_t) :: at
  end type load_spec_t

  !> What ends a phase early.
  type :: until_spec_t
    !> One of the `until_*` values.
    integer :: kind = until_never
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Magnitude along the tool's line of motion, mm or N.
    real(wp) :: value = huge(1.0_wp)
    !> Where it was written.
    type(location_t) :: at
  end type until_spec_t

  !> A phase of the process.
  type :: phase_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Position of the controlling tool in `case%tool`; 0 for `load`.
    integer :: control = 0
    !> Trial increment: mm of the controlling tool, or fraction of the phase for `load`.
    real(wp) :: trial = 1.0_wp
    !> Tools held, and tools whose contact is switched off.
    type(tool_name_t), allocatable :: hold(:), release(:)
    !> Tools moved, and tools pressed.
    type(tool_vector_t), allocatable :: move(:), press(:)
    !> Prescribed displacements.
    type(displace_spec_t), allocatable :: displace(:)
    !> Forces on nodes.
    type(load_spec_t), allocatable :: load(:)
    !> What ends it early.
    type(until_spec_t) :: until
    !> The limits that hold in this phase, whole.
    type(limits_spec_t) :: limits
    !> The corrector's settings that hold in this phase, whole.
    type(newton_spec_t) :: newton
    !> The contact's settings that hold in this phase, whole.
    type(contact_spec_t) :: contact
    !> The block it was read from.
    type(block_t) :: source
  end type phase_spec_t

  !> Columns of the history table.
  type :: history_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Node set.
    character(len=:), allocatable :: set
    !> Which quantities are wanted.
    logical :: displacement = .false., reaction = .false., position = .false.
    !> The block it was read from.
    type(block_t) :: source
  end type history_spec_t

  !> What is written when.
  type :: output_spec_t
    !> A row of the history table every so many increments.
    integer :: history = 1
    integer :: restart_every = 0
    logical :: restart = .true.
    !> One of the `fields_*` values.
    integer :: fields = fields_ends
    !> Interval (mm, or increments), or the travels at which fields are written.
    real(wp), allocatable :: fields_value(:)
    !> Folder of the results; empty for the default beside the input file.
    character(len=:), allocatable :: directory
  end type output_spec_t

  !> What a single point is led to.
  type :: point_goal_t
    !> Strains and stresses (MPa) 11 22 33 12 23 13, shear strains tensorial; or the deformation
    !> gradient row by row.
    real(wp), allocatable :: value(:)
    !> Number of equal steps.
    integer :: steps = 1
    !> Where it was written.
    type(location_t) :: at
  end type point_goal_t

  !> A run of a single material point.
  type :: point_spec_t
    !> Its name.
    character(len=:), allocatable :: name
    !> Position in `case%material`.
    integer :: material = 0
    !> Columns: rolling, transverse and normal direction at the start.
    real(wp) :: frame(3, 3) = 0.0_wp
    !> Whether the goals are deformation gradients.
    logical :: by_gradient = .false.
    !> Whether 11 22 33 12 23 13 is led by stress.
    logical :: by_stress(6) = .false.
    !> The goals in order.
    type(point_goal_t), allocatable :: goal(:)
    !> The block it was read from.
    type(block_t) :: source
  end type point_spec_t

  !> The whole job.
  type :: case_t
    !> Name of the input file as given.
    character(len=:), allocatable :: file
    !> Lines of the title.
    type(text_t), allocatable :: title(:)
    !> The sheet.
    type(blank_spec_t), allocatable :: blank(:)
    !> Node sets of the input file, in its order.
    type(node_set_spec_t), allocatable :: set(:)
    !> Materials.
    type(material_spec_t), allocatable :: material(:)
    !> Tools.
    type(tool_spec_t), allocatable :: tool(:)
    !> Contact at the start.
    type(contact_spec_t) :: contact
    !> Fixed nodes.
    type(boundary_spec_t), allocatable :: boundary(:)
    !> Limits of the predictor at the start.
    type(limits_spec_t) :: limits
    !> Corrector at the start.
    type(newton_spec_t) :: newton
    !> Linear solver.
    type(solver_spec_t) :: solver
    !> Phases in order.
    type(phase_spec_t), allocatable :: phase(:)
    !> Runs of single points in order.
    type(point_spec_t), allocatable :: point(:)
    !> Columns of the history table.
    type(history_spec_t), allocatable :: history(:)
    !> What is written when.
    type(output_spec_t) :: output
    !> The checked input with its defaults filled in, for the echo.
    type(deck_t) :: deck
  end type case_t

end module dd3_input_case
