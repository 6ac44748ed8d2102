! SPDX-License-Identifier: GPL-3.0-or-later
!> Errors in the input, by kind.
module dd3_message_input_errors
  use dd3_message_row, only : message_row_t, row
  implicit none
  private
  public :: input_errors

contains

  !> Return the errors in the input.
  function input_errors() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [of_text(), of_names(), of_keys(), of_values(), of_job()]
  end function input_errors

  !> Return the errors in the text of the input.
  function of_text() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E101", "file that cannot be read", "It does not exist, is a folder or is no text.", &
          "The path; relative paths belong to the file that names them."), &
      row("E102", "nothing in a file", "The file has no block, patch, node or element.", "The "// &
          "file that was meant; its format."), &
      row("E103", "line of no known form", "The line is neither a block nor a key with a "// &
          "value, or has words that do not belong there.", "The form that the message gives."), &
      row("E104", "nested *INCLUDE", "A file includes itself, or the files are nested too deep.", &
          "Each file once.")]
  end function of_text

  !> Return the errors in names.
  function of_names() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E111", "unknown block", "No block has this name.", "One of the blocks listed; "// &
          "`dd3imp --help` describes them."), &
      row("E112", "unknown key or parameter of a law", "The block, or the law, has none of "// &
          "this name.", "One of those listed; `dd3imp --help NAME` describes them."), &
      row("E113", "unknown name", "There is no set, tool, material, law, element or solver of "// &
          "this name.", "One of those listed, or the block that defines it."), &
      row("E114", "unknown word", "The key takes other words.", "One of those listed."), &
      row("E115", "unknown parameter", "`${name}` or `--set name=value` names a parameter that "// &
          "no `*PARAMETER` defines.", "One of those listed."), &
      row("E116", "not in this program", "The feature is reserved for a later version, or the "// &
          "program was built without it.", "Another choice, or the package that the message "// &
          "names.")]
  end function of_names

  !> Return the errors in the set of blocks, keys and values.
  function of_keys() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E121", "something is missing", "A block, key, name or value that the job needs is "// &
          "not given.", "What the message expects."), &
      row("E122", "given twice", "A block, key, word or action may be given only once here.", &
          "One of the two."), &
      row("E123", "name that cannot be used", "It has characters that are not allowed, is "// &
          "reserved, or is that of something else.", "Another name."), &
      row("E124", "cannot be combined", "Two blocks, keys or actions exclude each other.", &
          "One of the two."), &
      row("E125", "without effect", "The job would be the same without it: most often "// &
          "something else was meant.", "Remove it, or add what it belongs to.")]
  end function of_keys

  !> Return the errors in values.
  function of_values() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E131", "no number", "The word is not a number, or not an integer.", "A number as in "// &
          "Fortran or C, with a decimal point."), &
      row("E132", "wrong number of values", "The key takes another number of values.", "The "// &
          "number that the message gives."), &
      row("E133", "out of range", "The value lies outside its bounds.", "The bounds are in the "// &
          "message; check the unit."), &
      row("E134", "wrong order of values", "The values must increase, or begin and end at "// &
          "certain values.", "The order that the message gives."), &
      row("E135", "direction or determinant of zero", "A direction is zero or parallel to "// &
          "another one, a gradient has no volume.", "Vectors with a direction.")]
  end function of_values

  !> Return the errors in the job.
  function of_job() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E141", "tool surface", "A patch has no area, points the wrong way or lies on "// &
          "another one; a value in its file is not valid.", "Patches that cover the surface "// &
          "once, with S_u x S_v pointing out of the tool."), &
      row("E142", "place of a tool", "The tool starts inside the sheet, or its normals point "// &
          "away from it.", "`position` of the tool; patches whose normals point to the sheet."), &
      row("E143", "nothing holds the sheet", "The sheet, or a part of it, is free to move as a "// &
          "rigid body in a phase without tools.", "Supports, a tool that is not released, or "// &
          "`unload = on`."), &
      row("E144", "motion in a phase", "The phase has no action, its controlling tool does not "// &
          "move, or a motion is not known beforehand.", "What the message expects."), &
      row("E145", "motion of held nodes", "Nodes are displaced where `*BOUNDARY` holds them, "// &
          "or freed where nothing displaces them.", "Other nodes, or another direction."), &
      row("E146", "set without nodes or faces", "The selection finds no node, or a pressure no "// &
          "face.", "Initial coordinates and `tolerance` of the set."), &
      row("E147", "mesh file", "A line of the mesh file is not valid, or its elements do not "// &
          "suit the sheet.", "The subset of Abaqus and CalculiX that the manual describes; "// &
          "`dd3 mesh`."), &
      row("E148", "element and job", "The element cannot do what the job asks of it.", &
          "Another element, as the message says."), &
      row("E149", "parameters of a law together", "Each parameter is valid, but not all of "// &
          "them together: most often a yield surface that is not convex.", "The published set "// &
          "of parameters and its convention."), &
      row("E150", "line or table of a draw-bead", "Points of the line coincide, or the force "// &
          "falls too fast.", "Points that differ; a slower fall."), &
      row("E151", "results over an input file", "A result would replace a file that the job "// &
          "reads.", "Another folder of results, by `--output`."), &
      row("E152", "sheet of another run", "`*START` finds no sheet in the folder, its run has "// &
          "not reached its end, or its material is another one.", "The folder of a finished "// &
          "run; `at = last`; the `*MATERIAL` of that run."), &
      row("E153", "cut of the sheet", "A curve of `*TRIM` is open, crosses another one, misses "// &
          "the sheet or is too small for its elements.", "Closed curves that are larger than "// &
          "the elements; a finer mesh; `along`, `keep`."), &
      row("E154", "region of a blank", "A region has no elements, or its section and that "// &
          "beside it have too little in common.", "A weld line within the blank; one `step` "// &
          "for all regions."), &
      row("E156", "friction law without a coefficient", "`friction_law` is a factor on "// &
          "`friction`, which is zero or not given.", "`friction`; 1 if the factors of a table "// &
          "are coefficients."), &
      row("E157", "friction law", "The values of a table do not rise, or the friction "// &
          "stress falls where the pressure rises.", "Values in order; factors of the "// &
          "pressure that fall more slowly than 1/p."), &
      row("E163", "strain rate without a time", "The flow stress depends on the strain "// &
          "rate, or the friction on the speed, but a phase, or a point, has no time.", &
          "`duration` or `speed` in each `*PHASE`, also in those of springback; `duration` "// &
          "in `*POINT`."), &
      row("E164", "times", "The time of a phase or of a point is given twice, or for "// &
          "something it does not have.", "`duration`; or `speed` where the controlling "// &
          "tool has a `move`."), &
      row("E165", "heating", "A key of the heating of a material is missing, or has no effect.", &
          "`heat_capacity` with `density`; a law `temperature`."), &
      row("E250", "elastic tool in the mixed formulation", "`compliance` is a spring in series "// &
          "with the contact layer; the mixed formulation has no layer.", &
          "`formulation = compliant`, or no `compliance`.")]
  end function of_job

end module dd3_message_input_errors
