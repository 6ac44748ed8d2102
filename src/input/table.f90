!> The keyword tables: every block and every key the input knows, one row each. The parser, the
!> checks, the echo, `--help` and the manual's reference all derive from them.
module dd3_input_table
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : same_name
  use dd3_base_parameter, only : parameter_t, row, kind_real, kind_integer, kind_logical, &
      kind_name, kind_text, kind_reals, kind_integers, kind_names, kind_law, kind_other
  implicit none
  private
  public :: block_row_t, block_table, find_block, find_key, axis_of

  !> A block.
  type :: block_row_t
    !> The word after the star, in small letters.
    character(len=12) :: keyword = ""
    !> Whether a name of its own follows.
    logical :: named = .false.
    !> Whether there may be several.
    logical :: repeatable = .false.
    !> Whether an input without it is refused.
    logical :: required = .false.
    !> Whether this version does not provide it.
    logical :: later = .false.
    !> One line of help.
    character(len=160) :: help = ""
    !> Its keys.
    type(parameter_t), allocatable :: key(:)
  end type block_row_t

  !> The smallest number a value that must not be zero is compared with.
  real(wp), parameter :: zero = 0.0_wp
  !> Names of the three axes.
  character(len=*), parameter :: axes = "x y z"

contains

  !> All blocks, in the order of the manual.
  function block_table() result(table)
    type(block_row_t), allocatable :: table(:)

    type(parameter_t) :: nothing(0)

    allocate (table(17))
    call describe(table(1), "title", "once", "Free text, line by line; shown in the log.", &
        nothing)
    call describe(table(2), "include", "many", "Reads another file in this place.", nothing)
    call describe(table(3), "parameter", "many", &
        "name = value; used as ${name} in later values. --set name=value on the command line "// &
          "overrides it.", nothing)
    call describe(table(4), "blank", "named", &
        "A structured blank. Defines the node sets x_min x_max y_min y_max z_min z_max all.", &
        blank_keys())
    call describe(table(5), "mesh", "named later", &
        "A mesh from a file; its groups become node sets.", mesh_keys())
    call describe(table(6), "set", "named many", &
        "A node set chosen from the initial coordinates.", set_keys())
    call describe(table(7), "material", "named many required", "A material.", material_keys())
    call describe(table(8), "tool", "named many", "A rigid tool made of Bezier patches.", &
        tool_keys())
    call describe(table(9), "contact", "once", &
        "Settings of the contact; needed where there are tools.", contact_keys())
    call describe(table(10), "boundary", "named many", "Nodes held in every phase.", &
        boundary_keys())
    call describe(table(11), "limits", "once", &
        "Limits of the predictor, which choose the size of the next increment.", limits_keys())
    call describe(table(12), "newton", "once", "Settings of the corrector.", newton_keys())
    call describe(table(13), "solver", "once", "Settings of the linear solver.", solver_keys())
    call describe(table(14), "phase", "named many required", &
        "A stage of the process. What it does not name stays as it is: tools held, forces and "// &
          "loads kept.", phase_keys())
    call describe(table(15), "history", "named many", &
        "Further columns of history.csv: <name>_ux, _rx, _x and so on.", history_keys())
    call describe(table(16), "output", "once", "What is written when.", output_keys())
    call describe(table(17), "point", "named many", &
        "A run of a single material point, without a mesh, by control and target, or by "// &
          "gradient.", point_keys())
  end function block_table

  !> Fills the row of a block.
  pure subroutine describe(row, keyword, properties, help, key)
    !> The row.
    type(block_row_t), intent(inout) :: row
    !> The word after the star, in small letters.
    character(len=*), intent(in) :: keyword
    !> Any of the words: named, many (there may be several), required, later (not in this version).
    character(len=*), intent(in) :: properties
    !> One line of help.
    character(len=*), intent(in) :: help
    !> Its keys.
    type(parameter_t), intent(in) :: key(:)

    row%keyword = keyword
    row%named = index(properties, "named") > 0
    row%repeatable = index(properties, "many") > 0
    row%required = index(properties, "required") > 0
    row%later = index(properties, "later") > 0
    row%help = help
    row%key = key
  end subroutine describe

  !> Keys of `*BLANK`.
  function blank_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("origin", kind_reals, "mm", "0 0 0", "corner with the smallest coordinates", count=3), &
      row("size", kind_reals, "mm", "", "lengths along x, y and z (thickness)", count=3, &
          lower=zero, lower_open=.true.), &
      row("divisions", kind_integers, "", "", "number of elements along x, y and z", count=3, &
          lower=1.0_wp, upper=1.0e6_wp), &
      row("grading_x", kind_reals, "", "-", &
          "node abscissae as fractions, one more than divisions, rising from 0 to 1", count=0, &
          lower=zero, upper=1.0_wp), &
      row("grading_y", kind_reals, "", "-", "the same along y", count=0, lower=zero, &
          upper=1.0_wp), &
      row("grading_z", kind_reals, "", "-", "the same along z", count=0, lower=zero, &
          upper=1.0_wp), &
      row("skew", kind_real, "", "0", &
          "interior node lines across y are shifted along x by skew*(lx/nx)*(y/ly - 1/2)"), &
      row("element", kind_name, "", "hex8", "element type", choices="hex8 hex20 hex27", &
          later="hex20 hex27"), &
      row("material", kind_name, "", "", "its material", form="material")]
  end function blank_keys

  !> Keys of `*MESH`.
  function mesh_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("file", kind_text, "", "", &
          "mesh file: Gmsh .msh 2.2 or 4.1, Abaqus or CalculiX .inp, GiD .msh"), &
      row("element", kind_name, "", "hex8", "element type", choices="hex8 hex20 hex27"), &
      row("material", kind_name, "", "-", "its material", form="material"), &
      row("material_of", kind_other, "", "-", "material of the elements of a set", &
          repeatable=.true., form="set material")]
  end function mesh_keys

  !> Keys of `*SET`.
  function set_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("plane", kind_other, "mm", "-", "nodes on a plane across an axis", form="axis number"), &
      row("box", kind_reals, "mm", "-", "nodes in a box: x0 x1 y0 y1 z0 z1", count=6), &
      row("nodes", kind_other, "", "-", "nodes by number, as in 1 2 5-9", form="range..."), &
      row("near", kind_reals, "mm", "-", &
          "the node closest to a point; the lowest number of equals", count=3), &
      row("of", kind_name, "", "-", "only members of this set are kept", form="set"), &
      row("tolerance", kind_real, "mm", "-", &
          "tolerance of plane, box and near; left out: 1e-6 of the model's size", lower=zero)]
  end function set_keys

  !> Keys of `*MATERIAL`.
  function material_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("young", kind_real, "MPa", "", "Young's modulus", lower=zero, lower_open=.true.), &
      row("poisson", kind_real, "", "", "Poisson's ratio", lower=-1.0_wp, upper=0.5_wp, &
          lower_open=.true., upper_open=.true.), &
      row("yield", kind_law, "", "", "yield criterion and its parameters"), &
      row("hardening", kind_law, "", "", "hardening law and its parameters"), &
      row("backstress", kind_law, "", "none", &
          "back-stress law and its parameters, or none; several add up", repeatable=.true.), &
      row("rolling_direction", kind_reals, "", "1 0 0", "rolling direction in the initial sheet", &
          count=3), &
      row("normal_direction", kind_reals, "", "0 0 1", "normal of the initial sheet", count=3)]
  end function material_keys

  !> Keys of `*TOOL`.
  function tool_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("patches", kind_text, "", "", "file of the surface's Bezier patches (.bez)"), &
      row("friction", kind_real, "", "0", "coefficient of friction", lower=zero), &
      row("contact", kind_name, "", "", "node set of the candidates on the sheet", form="set"), &
      row("position", kind_reals, "mm", "0 0 0", "initial offset", count=3)]
  end function tool_keys

  !> Keys of `*CONTACT`.
  function contact_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("penalty", kind_real, "N/mm", "", "penalty of the augmented Lagrangian", lower=zero, &
          lower_open=.true.), &
      row("search_distance", kind_real, "mm", "-", &
          "distance within which tools are searched; left out: the sheet's thickness", lower=zero, &
          lower_open=.true.)]
  end function contact_keys

  !> Keys of `*BOUNDARY`.
  function boundary_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("set", kind_name, "", "", "node set", form="set"), &
      row("fix", kind_names, "", "", "directions held, any of x y z", count=0, choices=axes)]
  end function boundary_keys

  !> Keys of `*LIMITS`.
  function limits_keys() result(key)
    type(parameter_t), allocatable :: key(:)
    integer :: i

    key = [ &
      row("strain", kind_real, "", "0.005", "largest strain increment"), &
      row("rotation", kind_real, "degrees", "0.05", "largest rotation increment"), &
      row("stress_tangential", kind_real, "", "3.0", &
          "largest stress increment along the yield surface, in flow stresses"), &
      row("stress_normal", kind_real, "", "1.0", &
          "largest stress increment normal to the yield surface, in flow stresses"), &
      row("force", kind_reals, "", "off", "bounds c d e on the change of the contact forces", &
          count=3), &
      row("force_floor", kind_real, "", "0.1", "floor beta of the reference contact force", &
          lower=zero), &
      row("r_min", kind_real, "", "0.001", "smallest factor r"), &
      row("r_max", kind_real, "", "1.0", "largest factor r")]
    do i = 1, size(key)
      key(i)%may_be_off = .true.
      if (key(i)%name == "force_floor") cycle
      key(i)%lower = zero
      key(i)%lower_open = .true.
    end do
  end function limits_keys

  !> Keys of `*NEWTON`.
  function newton_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("tolerance", kind_real, "", "1e-2", "tolerance of the convergence criterion", &
          lower=zero, lower_open=.true.), &
      row("iterations", kind_integer, "", "30", "most iterations of an increment", lower=2.0_wp, &
          upper=1.0e6_wp), &
      row("cutback", kind_logical, "", "off", &
          "on: try a failed increment again with a smaller r; off: the run ends there"), &
      row("cutback_factor", kind_real, "", "0.5", "factor on r at each new attempt", lower=zero, &
          upper=1.0_wp, lower_open=.true., upper_open=.true.), &
      row("cutback_min", kind_real, "", "1e-5", "smallest r before the run is given up", &
          lower=zero, lower_open=.true.)]
  end function newton_keys

  !> Keys of `*SOLVER`.
  function solver_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("method", kind_name, "", "auto", &
          "linear solver; auto: cgs, and umfpack where it breaks down", &
          choices="cgs umfpack auto"), &
      row("ilu_level", kind_integer, "", "2", "level of fill of the incomplete factorisation", &
          lower=zero, upper=100.0_wp), &
      row("tolerance", kind_real, "", "1e-10", "relative residual of cgs", lower=zero, &
          upper=1.0_wp, lower_open=.true., upper_open=.true.), &
      row("iterations", kind_integer, "", "500", "most iterations of cgs", lower=1.0_wp, &
          upper=1.0e9_wp), &
      row("ordering", kind_name, "", "none", &
          "ordering of the unknowns; none: section by section as numbered", &
          choices="none amd rcm")]
  end function solver_keys

  !> Keys of `*PHASE`: its own, then those of the limits, the corrector and the contact.
  function phase_keys() result(key)
    type(parameter_t), allocatable :: key(:)
    type(parameter_t), allocatable :: inherited(:)

    inherited = [limits_keys(), newton_keys(), contact_keys()]
    inherited%default = "-"
    key = [ &
      row("control", kind_name, "", "", "the controlling tool, or load"), &
      row("trial", kind_real, "", "", &
          "trial increment: mm of the controlling tool, or fraction of the phase for load", &
          lower=zero, lower_open=.true.), &
      row("hold", kind_other, "", "-", "a tool that stays where it is", repeatable=.true., &
          form="tool"), &
      row("move", kind_other, "mm", "-", "a tool's displacement over the phase", &
          repeatable=.true., form="tool number number number"), &
      row("press", kind_other, "N", "-", &
          "force on a tool, reached at the end of the phase; it moves along that line only", &
          repeatable=.true., form="tool number number number"), &
      row("release", kind_other, "", "-", "a tool whose contact is switched off for good", &
          repeatable=.true., form="tool"), &
      row("displace", kind_other, "mm", "-", "displacement of nodes over the phase", &
          repeatable=.true., form="set axis number"), &
      row("load", kind_other, "N", "-", "total force on nodes, reached at the end of the phase", &
          repeatable=.true., form="set number number number"), &
      row("pressure", kind_other, "MPa", "-", &
          "pressure on the faces whose nodes are all in the set", repeatable=.true., &
          form="set number", later="*"), &
      row("unload", kind_logical, "", "-", "springback: all tools released", later="*"), &
      row("until", kind_other, "mm or N", "-", &
          "ends the phase early: travel or force of a tool along its line", &
          form="displacement|force tool number"), &
      inherited]
  end function phase_keys

  !> Keys of `*HISTORY`.
  function history_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("set", kind_name, "", "", "node set", form="set"), &
      row("quantities", kind_names, "", "", "mean displacement, sum of reactions, mean position", &
          count=0, choices="displacement reaction position")]
  end function history_keys

  !> Keys of `*OUTPUT`.
  function output_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("history", kind_other, "", "every 1", "a row of history.csv every so many increments", &
          form="every count"), &
      row("fields", kind_other, "", "-", &
          "fields every so many mm of travel in the phase, at given travels, or every so many "// &
            "increments; always the first state and each phase's last", &
          form="every number [mm]/at number.../increments count"), &
      row("restart", kind_other, "", "-", "a restart file every so many increments", &
          form="every count", later="*"), &
      row("directory", kind_text, "", "-", &
          "folder of the results; left out: the input file's name with .out")]
  end function output_keys

  !> Keys of `*POINT`.
  function point_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("material", kind_name, "", "", "its material", form="material"), &
      row("angle", kind_real, "degrees", "-", &
          "x lies at this angle from the rolling direction, in the plane of the sheet"), &
      row("control", kind_names, "", "-", &
          "each component by logarithmic strain e or Cauchy stress s, as e11 s22 s33 s12 s23 s13", &
          count=6), &
      row("target", kind_other, "", "-", &
          "strains (shears tensorial) and stresses (MPa) at the end, reached linearly in n steps", &
          repeatable=.true., form="number number number number number number steps = count"), &
      row("gradient", kind_other, "", "-", &
          "deformation gradient F11 F12 F13 F21 ... F33 from the start, reached linearly in n "// &
            "steps", repeatable=.true., &
          form="number number number number number number number number number steps = count")]
  end function point_keys

  !> Position of a block in the table; 0 if there is none.
  pure integer function find_block(table, keyword)
    !> The table.
    type(block_row_t), intent(in) :: table(:)
    !> The word after the star.
    character(len=*), intent(in) :: keyword

    do find_block = 1, size(table)
      if (same_name(table(find_block)%keyword, keyword)) return
    end do
    find_block = 0
  end function find_block

  !> Position of a key among a block's keys; 0 if there is none.
  pure integer function find_key(key, name)
    !> The keys.
    type(parameter_t), intent(in) :: key(:)
    !> The name.
    character(len=*), intent(in) :: name

    do find_key = 1, size(key)
      if (same_name(key(find_key)%name, name)) return
    end do
    find_key = 0
  end function find_key

  !> Number of an axis from its name; 0 if it is none.
  pure integer function axis_of(name)
    !> x, y or z.
    character(len=*), intent(in) :: name

    axis_of = 0
    if (len(name) == 1) axis_of = index("xyz", name)
    if (len(name) == 1 .and. axis_of == 0) axis_of = index("XYZ", name)
  end function axis_of

end module dd3_input_table
