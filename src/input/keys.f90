! SPDX-License-Identifier: GPL-3.0-or-later
!> The keys of every block of the input, one row each.
module dd3_input_keys
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : parameter_t, row, kind_real, kind_integer, kind_logical, &
      kind_name, kind_text, kind_reals, kind_integers, kind_names, kind_law, kind_other
  use dd3_settings_accuracy, only : accuracy_names, default_by_accuracy
  use dd3_settings_adaptive, only : most_levels
  implicit none
  private
  public :: blank_keys, region_keys, mesh_keys, start_keys, trim_keys, set_keys, &
      material_keys, tool_keys, drawbead_keys, contact_keys, boundary_keys, limits_keys, &
      newton_keys, solver_keys, history_keys, output_keys, point_keys

  !> Bound of the numbers that must not be negative.
  real(wp), parameter :: zero = 0.0_wp

contains

  function blank_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("origin", kind_reals, "mm", "0 0 0", "corner with the smallest coordinates", count=3), &
      row("size", kind_reals, "mm", "-", "lengths of a box along x, y and z (thickness)", &
          count=3, lower=zero, lower_open=.true.), &
      row("radius", kind_real, "mm", "-", "radius of a round blank; origin is the centre of "// &
          "its lower face", lower=zero, lower_open=.true.), &
      row("thickness", kind_real, "mm", "-", "thickness of a round blank", lower=zero, &
          lower_open=.true.), &
      row("portion", kind_name, "", "-", "part of a round blank: quarter (x, y >= 0), half "// &
          "(x >= 0) or full; default: quarter", choices="quarter half full"), &
      row("divisions", kind_integers, "", "", "number of elements along x, y and z; of a round "// &
          "blank: along a side of the core in a quarter, from the core to the rim, layers", &
          count=3, lower=1.0_wp, upper=1.0e6_wp), &
      row("grading_x", kind_reals, "", "-", &
          "node abscissae as fractions, one more than divisions, increasing from 0 to 1", count=0, &
          lower=zero, upper=1.0_wp), &
      row("grading_y", kind_reals, "", "-", "the same along y", count=0, lower=zero, &
          upper=1.0_wp), &
      row("grading_z", kind_reals, "", "-", "the same along z", count=0, lower=zero, &
          upper=1.0_wp), &
      row("skew", kind_real, "", "0", &
          "interior node lines across y are shifted along x by skew*(lx/nx)*(y/ly - 1/2)"), &
      row("element", kind_name, "", "-", "element type; dd3imp --help element lists them; "// &
          "default: solid_shell for one layer, hex8 for more"), &
      row("thickness_points", kind_integer, "", "7", &
          "integration points through the thickness of an element solid_shell", lower=2.0_wp, &
          upper=15.0_wp), &
      row("material", kind_name, "", "", "material", form="material")]
    key = [key, adaptive_keys()]
  end function blank_keys

  function region_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("points", kind_reals, "mm", "-", "vertices of a weld line, or of the outline, seen "// &
          "along z, x y in turn", count=0), &
      row("file", kind_text, "", "-", "file of the vertices, x y in each line"), &
      row("side", kind_name, "", "", "place of the region: left or right of the line, which "// &
          "goes on beyond its ends, or inside the outline", choices="left right inside"), &
      row("thickness", kind_real, "mm", "-", "thickness of the region; default: that of the "// &
          "blank", lower=zero, lower_open=.true.), &
      row("step", kind_name, "", "-", "face of the blank with the step of the thickness; "// &
          "default: top", choices="top bottom both"), &
      row("material", kind_name, "", "-", "material of the region; default: that of the blank", &
          form="material")]
  end function region_keys

  function mesh_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("file", kind_text, "", "", "mesh of hexahedra as an Abaqus or CalculiX .inp file; "// &
          "dd3 mesh makes one of other formats"), &
      row("element", kind_name, "", "-", "element type; dd3imp --help element lists them; "// &
          "default: solid_shell for one layer, hex8 for more"), &
      row("thickness_points", kind_integer, "", "7", &
          "integration points through the thickness of an element solid_shell", lower=2.0_wp, &
          upper=15.0_wp), &
      row("material", kind_name, "", "-", "material of the elements without material_of", &
          form="material"), &
      row("material_of", kind_other, "", "-", "material of the elements of a set", &
          repeatable=.true., form="set material")]
    key = [key, adaptive_keys()]
  end function mesh_keys

  function start_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("from", kind_text, "", "", "folder of the results of the run whose sheet goes on"), &
      row("at", kind_name, "", "end", "end: the run must have reached its end; last: its last "// &
          "state, where a phase or the run ended", choices="end last"), &
      row("turn", kind_other, "mm, degrees", "-", "turn of the sheet into its new place: point "// &
          "and direction of the axis, angle; several follow one another", repeatable=.true., &
          form="number number number number number number number"), &
      row("move", kind_reals, "mm", "0 0 0", "displacement of the sheet into its new place, "// &
          "after the turns", count=3)]
    key = [key, adaptive_keys()]
  end function start_keys

  !> Return the keys of the refinement, of each block that gives the sheet.
  function adaptive_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("adaptive", kind_integer, "", "0", "times that an element may be divided into four "// &
          "where it comes to lie on a radius of a tool, or is bent; 0: never", lower=zero, &
          upper=real(most_levels, wp)), &
      row("adaptive_angle", kind_real, "degrees", "15", &
          "angle by which the sheet may turn over an element that may be divided", &
          lower=1.0_wp, upper=60.0_wp), &
      row("adaptive_size", kind_real, "mm", "0", &
          "least length of an element that comes from a division", lower=zero)]
  end function adaptive_keys

  function trim_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("file", kind_text, "", "-", "file of one or more closed curves: a line x y z for "// &
          "each vertex, an empty line between curves; dd3 curve makes one of CAD files"), &
      row("points", kind_reals, "mm", "-", "vertices of one closed curve, x y z in turn", &
          count=0), &
      row("along", kind_reals, "", "0 0 1", "direction along which the curves are projected on "// &
          "the sheet; 0 0 0: normal to the sheet, for curves on it", count=3), &
      row("keep", kind_name, "", "inside", "part of the sheet that stays; inside: within an "// &
          "odd number of curves", choices="inside outside")]
  end function trim_keys

  function set_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("plane", kind_other, "mm", "-", "nodes on a plane normal to an axis", &
          form="axis number"), &
      row("box", kind_reals, "mm", "-", "nodes in a box: x0 x1 y0 y1 z0 z1", count=6), &
      row("nodes", kind_other, "", "-", "nodes by number, for example 1 2 5-9", form="range..."), &
      row("near", kind_reals, "mm", "-", &
          "node closest to a point; if several are, the one with the lowest number", count=3), &
      row("of", kind_name, "", "-", "keep only members of this set", form="set"), &
      row("tolerance", kind_real, "mm", "-", &
          "tolerance of plane, box and near; default: 1e-6 of the model's size", lower=zero)]
  end function set_keys

  function material_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("young", kind_real, "MPa", "", "Young's modulus", lower=zero, lower_open=.true.), &
      row("poisson", kind_real, "", "", "Poisson's ratio", lower=-1.0_wp, upper=0.5_wp, &
          lower_open=.true., upper_open=.true.), &
      row("yield", kind_law, "", "", "yield criterion"), &
      row("hardening", kind_law, "", "", "hardening law"), &
      row("backstress", kind_law, "", "none", &
          "back-stress law; several are summed", repeatable=.true.), &
      row("modulus", kind_law, "", "none", &
          "law of Young's modulus over the plastic strain"), &
      row("rate", kind_law, "", "none", &
          "law of the strain rate: a factor on the flow stress"), &
      row("temperature", kind_law, "", "none", &
          "law of the temperature: a factor on the flow stress"), &
      row("initial_temperature", kind_real, "C", "20", "temperature of the undeformed material"), &
      row("heat_capacity", kind_real, "mJ/(t K)", "-", "heat capacity: plastic work heats each "// &
          "point, with the density; 4.6e8 for steel, 9e8 for aluminium; left out: no heating", &
          lower=1.0e7_wp, upper=1.0e10_wp), &
      row("heat_fraction", kind_real, "", "0.9", "part of the plastic work that heats", &
          lower=zero, upper=1.0_wp, lower_open=.true.), &
      row("density", kind_real, "t/mm3", "-", &
          "density, for gravity and heating; 7.85e-9 for steel", lower=zero, lower_open=.true.), &
      row("rolling_direction", kind_reals, "", "1 0 0", "rolling direction in the initial sheet", &
          count=3), &
      row("normal_direction", kind_reals, "", "-", "normal of the initial sheet; default: that "// &
          "of the mesh of *MESH, else 0 0 1", count=3), &
      row("grade", kind_name, "", "-", "kind of sheet metal, for the estimate of its forming "// &
          "limit curve by dd3 fld and dd3 report", choices="low_carbon_steel"), &
      row("forming_limit", kind_reals, "", "-", "forming limit curve, for warnings, dd3 fld "// &
          "and dd3 report: minor and major logarithmic strain in pairs, the minor one "// &
          "increasing", count=0), &
      row("fracture", kind_law, "", "none", "law of fracture and its parameters: damage "// &
          "without influence on the stress, and a warning at fracture"), &
      row("thinning_limit", kind_real, "", "-", "largest thinning allowed by dd3 fld and dd3 "// &
          "report; default there: 0.25", lower=zero, upper=1.0_wp, lower_open=.true., &
          upper_open=.true.)]
  end function material_keys

  function tool_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("patches", kind_text, "", "", "file of the surface's Bezier patches (.bez)"), &
      row("friction", kind_real, "", "0", "coefficient of friction", lower=zero), &
      row("friction_law", kind_law, "", "-", "factor on `friction` by pressure, speed or "// &
          "strain; several are multiplied", repeatable=.true.), &
      row("compliance", kind_real, "mm/MPa", "0", "deflection of the surface along its "// &
          "normal per contact pressure, by the elasticity of the tool; 0: rigid", &
          lower=zero), &
      row("contact", kind_name, "", "", "node set of the candidates on the sheet", form="set"), &
      row("position", kind_reals, "mm", "0 0 0", "initial offset", count=3)]
  end function tool_keys

  function drawbead_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("points", kind_reals, "mm", "-", "vertices of its line seen along z, x y in turn", &
          count=0), &
      row("file", kind_text, "", "-", "file of the vertices, x y in each line"), &
      row("force", kind_real, "N/mm", "", "restraining force per length of the line", &
          lower=zero), &
      row("rise", kind_real, "mm", "0", "path across the bead over which the force rises "// &
          "from 0", lower=zero), &
      row("table", kind_reals, "mm", "-", "path across the bead and factor on force, in pairs "// &
          "from 0 on, in place of rise", count=0, lower=zero), &
      row("normal", kind_real, "N/mm", "0", "force on the sheet along z per length of the line"), &
      row("tool", kind_name, "", "-", "tool that carries the bead and its forces", form="tool"), &
      row("from", kind_name, "", "-", "phase from which it acts; the first one by default", &
          form="phase")]
  end function drawbead_keys

  function contact_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("formulation", kind_name, "", "-", "compliant: pressure by the gap in a layer on the "// &
          "tools; mixed: no gap, by an augmented Lagrangian; default: compliant, mixed where a "// &
          "penalty is given", choices="compliant mixed"), &
      row("layer", kind_real, "", "-", "height of the layer of the compliant formulation, "// &
          "over the thickness of the sheet; default: 0.02", lower=1.0e-4_wp, upper=0.2_wp), &
      row("points", kind_integer, "", "1", "parts of an element's edge between contact points "// &
          "in the compliant formulation; 1: points at the nodes; more: points between the "// &
          "nodes too, on a surface curved by the columns of nodes", lower=1.0_wp, upper=4.0_wp), &
      row("penalty", kind_real, "N/mm", "-", "penalty of the mixed formulation; default: "// &
          "from stiffness, thickness and mesh", lower=1.0e-3_wp, upper=1.0e9_wp), &
      row("search_distance", kind_real, "mm", "-", &
          "search distance of the tools; default: the thickness of the sheet", lower=zero, &
          lower_open=.true.)]
  end function contact_keys

  function boundary_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("set", kind_name, "", "", "node set", form="set"), &
      row("fix", kind_names, "", "", "fixed directions", count=0, choices="x y z"), &
      row("pin", kind_real, "mm", "-", "diameter of a locating pin in a hole of the sheet, of "// &
          "which the support is a model: its force and bearing pressure are told", lower=zero, &
          lower_open=.true.)]
  end function boundary_keys

  function limits_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    integer :: i

    key = [ &
      row("accuracy", kind_name, "", "standard", "accuracy of the increments; sets strain, "// &
          "rotation, depth and r_max where they are not given", choices=accuracy_names()), &
      row("strain", kind_real, "", "-", "maximum strain increment; "// &
          default_by_accuracy("strain")), &
      row("rotation", kind_real, "degrees", "-", "maximum rotation increment; "// &
          default_by_accuracy("rotation")), &
      row("stress_tangential", kind_real, "", "off", &
          "maximum stress increment tangential to the yield surface, over the flow stress"), &
      row("stress_normal", kind_real, "", "off", &
          "maximum stress increment normal to the yield surface, over the flow stress"), &
      row("force", kind_reals, "", "off", "bounds c d e on the change of the contact forces", &
          count=3), &
      row("force_floor", kind_real, "", "0.1", "floor beta of the reference contact force", &
          lower=zero), &
      row("depth", kind_real, "", "-", "maximum predicted depth of a node in a tool that it "// &
          "meets, over the thickness; "//default_by_accuracy("depth")), &
      row("unloading", kind_real, "", "0.05", "maximum fraction of the plastic points that "// &
          "unload in a prediction that is not repeated", lower=zero), &
      row("r_min", kind_real, "", "0.001", "minimum of the factor r on the trial increment"), &
      row("r_max", kind_real, "", "-", &
          "maximum of the factor r; "//default_by_accuracy("r_max"))]
    do i = 2, size(key)
      key(i)%may_be_off = .true.
      if (key(i)%name == "force_floor" .or. key(i)%name == "unloading") cycle
      key(i)%lower = zero
      key(i)%lower_open = .true.
      if (key(i)%name /= "r_min" .and. key(i)%name /= "r_max") cycle
      key(i)%lower = 1.0e-6_wp
      key(i)%lower_open = .false.
    end do
  end function limits_keys

  function newton_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("tolerance", kind_real, "", "1e-2", "tolerance of the convergence criterion", &
          lower=zero, upper=0.1_wp, lower_open=.true.), &
      row("iterations", kind_integer, "", "30", "maximum number of iterations of an increment", &
          lower=2.0_wp, upper=1000.0_wp), &
      row("cutback", kind_logical, "", "on", &
          "on: repeat a failed increment with a smaller r; off: stop the run"), &
      row("line_search", kind_logical, "", "on", "on: shorten an iteration that inverts "// &
          "an element or overshoots, end iterations that do not approach a solution"), &
      row("elimination", kind_logical, "", "on", "on: with line_search and compliant contact, "// &
          "solve the equilibrium of the few nodes with most of the residual alone")]
  end function newton_keys

  function solver_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("method", kind_name, "", "auto", &
          "linear solver; dd3imp --help method lists them"), &
      row("ilu_level", kind_integer, "", "2", "level of fill of the incomplete factorisation", &
          lower=zero, upper=100.0_wp), &
      row("tolerance", kind_real, "", "1e-10", "relative residual of cgs, also where it "// &
          "refines block_lu", lower=1.0e-15_wp, upper=0.01_wp), &
      row("iterations", kind_integer, "", "500", "maximum number of iterations of cgs, also "// &
          "where it refines block_lu", &
          lower=1.0_wp, upper=1.0e6_wp), &
      row("ordering", kind_name, "", "auto", &
          "ordering of the unknowns; none: as the nodes are numbered; auto: the cheapest one", &
          choices="auto none amd rcm"), &
      row("factors", kind_name, "", "memory", "where MUMPS keeps its factors; disk: in the "// &
          "folder of the results", choices="memory disk")]
  end function solver_keys

  function history_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("set", kind_name, "", "", "node set", form="set"), &
      row("quantities", kind_names, "", "", "mean displacement, sum of reactions, mean "// &
          "position, moment of the reactions about it, mean draw-in of the rim", count=0, &
          choices="displacement reaction position moment draw_in")]
  end function history_keys

  function output_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("history", kind_other, "", "every 1", &
          "interval of the rows of history.csv, in increments", form="every count"), &
      row("fields", kind_other, "", "-", &
          "output of fields: interval of the travel (mm) in a phase, travels, or interval in "// &
          "increments; the initial state and the end of each phase are always written", &
          form="every number [mm]/at number.../increments count"), &
      row("restart", kind_other, "", "-", "interval of the restart file in increments, or "// &
          "off; it is also written at the end of each phase and when a run stops", &
          form="every count/off"), &
      row("directory", kind_text, "", "-", &
          "folder of the results; default: the name of the input file with .out")]
  end function output_keys

  function point_keys() result(key)
    type(parameter_t), allocatable :: key(:)

    key = [ &
      row("material", kind_name, "", "", "material", form="material"), &
      row("angle", kind_real, "degrees", "-", &
          "angle of x from the rolling direction, in the plane of the sheet"), &
      row("control", kind_names, "", "-", &
          "prescribed components, logarithmic strain e or Cauchy stress s: e11 s22 s33 s12 s23 "// &
          "s13", count=6), &
      row("target", kind_other, "", "-", &
          "strains (tensorial shear) and stresses (MPa), reached linearly in the number of steps", &
          repeatable=.true., form="number number number number number number steps = count"), &
      row("gradient", kind_other, "", "-", &
          "deformation gradient F11 F12 F13 F21 ... F33 from the initial state, reached "// &
          "linearly in the number of steps", repeatable=.true., &
          form="number number number number number number number number number steps = count"), &
      row("duration", kind_reals, "s", "-", "time of each target or gradient, or one time for "// &
          "each of them, for laws of the strain rate", count=0, lower=zero, lower_open=.true.)]
  end function point_keys

end module dd3_input_keys
