! SPDX-License-Identifier: GPL-3.0-or-later
!> The keyword table: one row for every block, with the rows of its keys. The parser, the checks,
!> the echo, `--help` and the manual's reference derive from it.
module dd3_input_table
  use dd3_base_text, only : same_name, join
  use dd3_base_parameter, only : parameter_t
  use dd3_input_case, only : blank_sets
  use dd3_input_keys, only : blank_keys, region_keys, mesh_keys, start_keys, trim_keys, set_keys, &
      material_keys, tool_keys, drawbead_keys, contact_keys, boundary_keys, limits_keys, &
      newton_keys, solver_keys, history_keys, output_keys, point_keys
  use dd3_input_phase_keys, only : phase_keys
  implicit none
  private
  public :: block_row_t, block_table, find_block, find_key, axis_of

  !> Row of a block.
  type :: block_row_t
    !> Word after the star, in lower case.
    character(len=12) :: keyword = ""
    !> Whether the block has a name of its own.
    logical :: named = .false.
    !> Whether it may occur more than once.
    logical :: repeatable = .false.
    !> Whether an input without it is refused.
    logical :: required = .false.
    !> Whether it is reserved for a later version.
    logical :: later = .false.
    !> One line of help.
    character(len=160) :: help = ""
    type(parameter_t), allocatable :: key(:)
  end type block_row_t

contains

  !> Return all blocks, in the order of the manual.
  function block_table() result(table)
    type(block_row_t), allocatable :: table(:)

    type(parameter_t) :: nothing(0)

    allocate (table(0))
    call add(table, "title", "once", "Free text, line by line; shown in the log.", nothing)
    call add(table, "include", "many", "Inserts another file here.", nothing)
    call add(table, "parameter", "many", "name = value; used as ${name} in later values. "// &
        "--set name=value on the command line overrides it.", nothing)
    call add(table, "blank", "named", "A structured blank. A box (size) has the node sets "// &
        join(blank_sets, " ")//", a round one (radius) x_min y_min rim z_min z_max all.", &
        blank_keys())
    call add(table, "region", "named many", "A part of *BLANK, of another thickness or "// &
        "material: a tailored blank.", region_keys())
    call add(table, "mesh", "named", "A mesh from a file. Its sets become node sets; z_min and "// &
        "z_max are the two faces of the sheet, all has all nodes.", mesh_keys())
    call add(table, "start", "once", "The sheet of another run, in place of *BLANK or *MESH, "// &
        "with its stresses and internal variables. Its sets are those of its blank or mesh.", &
        start_keys())
    call add(table, "trim", "named many", "A cut of the sheet before the first phase. The "// &
        "nodes of the new border are the set of its name.", trim_keys())
    call add(table, "set", "named many", "A node set selected by the initial coordinates.", &
        set_keys())
    call add(table, "material", "named many required", "A material.", material_keys())
    call add(table, "tool", "named many", "A tool made of Bezier patches, rigid without "// &
        "`compliance`.", tool_keys())
    call add(table, "drawbead", "named many", "A draw-bead: a line that restrains the sheet "// &
        "that slides across it.", drawbead_keys())
    call add(table, "contact", "once", "Settings of the contact; required if there are tools.", &
        contact_keys())
    call add(table, "boundary", "named many", "Nodes fixed in all phases.", boundary_keys())
    call add(table, "limits", "once", &
        "Limits of the predictor, which set the size of the next increment.", limits_keys())
    call add(table, "newton", "once", "Settings of the corrector.", newton_keys())
    call add(table, "solver", "once", "Settings of the linear solver.", solver_keys())
    call add(table, "phase", "named many required", "A phase of the process. Tools that it "// &
        "does not name are held, or stay pressed; loads and settings are kept.", phase_keys())
    call add(table, "history", "named many", &
        "Additional columns of history.csv: <name>_ux, _rx, _x and so on.", history_keys())
    call add(table, "output", "once", "What is written, and when.", output_keys())
    call add(table, "point", "named many", "A run of a single material point, without a mesh, "// &
        "driven by control and target, or by gradient.", point_keys())
  end function block_table

  !> Append the row of a block.
  pure subroutine add(table, keyword, properties, help, key)
    type(block_row_t), allocatable, intent(inout) :: table(:)
    character(len=*), intent(in) :: keyword
    !> Any of the words named, many, required, later; see the components of `block_row_t`.
    character(len=*), intent(in) :: properties
    character(len=*), intent(in) :: help
    type(parameter_t), intent(in) :: key(:)

    type(block_row_t), allocatable :: larger(:)
    integer :: n

    n = size(table) + 1
    allocate (larger(n))
    larger(:n - 1) = table
    larger(n)%keyword = keyword
    larger(n)%named = index(properties, "named") > 0
    larger(n)%repeatable = index(properties, "many") > 0
    larger(n)%required = index(properties, "required") > 0
    larger(n)%later = index(properties, "later") > 0
    larger(n)%help = help
    larger(n)%key = key
    call move_alloc(larger, table)
  end subroutine add

  !> Return the position of a block in the table; 0 if not found.
  pure integer function find_block(table, keyword)
    type(block_row_t), intent(in) :: table(:)
    !> Word after the star.
    character(len=*), intent(in) :: keyword

    do find_block = 1, size(table)
      if (same_name(table(find_block)%keyword, keyword)) return
    end do
    find_block = 0
  end function find_block

  !> Return the position of a key among a block's keys; 0 if not found.
  pure integer function find_key(key, name)
    type(parameter_t), intent(in) :: key(:)
    character(len=*), intent(in) :: name

    do find_key = 1, size(key)
      if (same_name(key(find_key)%name, name)) return
    end do
    find_key = 0
  end function find_key

  !> Return the number of an axis, 1 to 3, from its name; 0 for any other text.
  pure integer function axis_of(name)
    character(len=*), intent(in) :: name

    axis_of = 0
    if (len(name) == 1) axis_of = index("xyz", name)
    if (len(name) == 1 .and. axis_of == 0) axis_of = index("XYZ", name)
  end function axis_of

end module dd3_input_table
