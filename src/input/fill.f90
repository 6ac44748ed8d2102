! SPDX-License-Identifier: GPL-3.0-or-later
!> Fills the case from the checked blocks.
module dd3_input_fill
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : lower_case
  use dd3_settings_accuracy, only : set_by_accuracy
  use dd3_input_block, only : block_t, deck_t
  use dd3_input_case, only : case_t, boundary_spec_t, drawbead_spec_t, history_spec_t, tool_spec_t
  use dd3_input_fill_blank, only : fill_adaptive, fill_blank, fill_mesh, fill_region, &
      fill_set, fill_start, fill_trim
  use dd3_input_fill_material, only : add_law, fill_material
  use dd3_input_fill_phase, only : fill_phase, fill_limits, fill_newton, fill_contact
  use dd3_input_fill_point, only : fill_point
  use dd3_input_table, only : axis_of
  use dd3_input_text_file, only : resolve_path
  use dd3_settings_output, only : output_spec_t, fields_every, fields_at, fields_increments
  use dd3_settings_solver, only : solver_spec_t
  implicit none
  private
  public :: fill_case

contains

  !> Fill the case. Members whose entries did not pass the check keep their values. Of a block that
  !> may be given only once, the first one counts, as in the check of its values.
  subroutine fill_case(case, deck)
    type(case_t), intent(inout) :: case
    type(deck_t), intent(in) :: deck

    integer :: i

    allocate (case%title(0))
    case%solver%method = ""
    case%solver%ordering = ""
    case%solver%factors = ""
    case%output%directory = ""
    allocate (case%output%fields_value(0))
    i = first_block(deck, "title")
    if (i > 0) call fill_title(case, deck%block(i))
    i = first_block(deck, "contact")
    if (i > 0) call fill_contact(case%contact, deck%block(i))
    i = first_block(deck, "limits")
    if (i > 0) call fill_limits(case%limits, deck%block(i))
    call set_by_accuracy(case%limits, case%contact%mixed)
    i = first_block(deck, "newton")
    if (i > 0) call fill_newton(case%newton, deck%block(i))
    i = first_block(deck, "solver")
    if (i > 0) call fill_solver(case%solver, deck%block(i))
    i = first_block(deck, "output")
    if (i > 0) call fill_output(case%output, deck%block(i))
    call fill_model(case, deck)
    call fill_process(case, deck)
    case%deck = deck
  end subroutine fill_case

  !> Return the position of the first block of a kind; 0 if not found.
  pure integer function first_block(deck, keyword) result(i)
    type(deck_t), intent(in) :: deck
    character(len=*), intent(in) :: keyword

    do i = 1, deck%n_block
      if (deck%block(i)%keyword == keyword) return
    end do
    i = 0
  end function first_block

  !> Fill the sheet, its material and the tools.
  subroutine fill_model(case, deck)
    type(case_t), intent(inout) :: case
    type(deck_t), intent(in) :: deck

    integer, allocatable :: at(:)
    integer :: i

    at = positions(deck, "blank")
    allocate (case%blank(size(at)))
    do i = 1, size(at)
      call fill_blank(case%blank(i), deck%block(at(i)))
      call fill_adaptive(case%adaptive, deck%block(at(i)))
      case%blank(i)%material = position(deck, "material", deck%block(at(i))%word("material"))
    end do
    call fill_regions(case, deck)
    call fill_meshes(case, deck)
    at = positions(deck, "start")
    allocate (case%start(size(at)))
    do i = 1, size(at)
      call fill_start(case%start(i), deck%block(at(i)))
      call fill_adaptive(case%adaptive, deck%block(at(i)))
    end do
    at = positions(deck, "trim")
    allocate (case%trim(size(at)))
    do i = 1, size(at)
      call fill_trim(case%trim(i), deck%block(at(i)))
    end do
    at = positions(deck, "set")
    allocate (case%set(size(at)))
    do i = 1, size(at)
      call fill_set(case%set(i), deck%block(at(i)))
    end do
    at = positions(deck, "material")
    allocate (case%material(size(at)))
    do i = 1, size(at)
      call fill_material(case%material(i), deck%block(at(i)))
    end do
    at = positions(deck, "tool")
    allocate (case%tool(size(at)))
    do i = 1, size(at)
      call fill_tool(case%tool(i), deck%block(at(i)))
    end do
    at = positions(deck, "drawbead")
    allocate (case%drawbead(size(at)))
    do i = 1, size(at)
      call fill_drawbead(case%drawbead(i), deck%block(at(i)))
      case%drawbead(i)%tool = position(deck, "tool", deck%block(at(i))%word("tool"))
      case%drawbead(i)%from = max(1, position(deck, "phase", deck%block(at(i))%word("from")))
    end do
    at = positions(deck, "boundary")
    allocate (case%boundary(size(at)))
    do i = 1, size(at)
      call fill_boundary(case%boundary(i), deck%block(at(i)))
    end do
  end subroutine fill_model

  !> Fill the regions of a blank, with the positions of their materials.
  subroutine fill_regions(case, deck)
    type(case_t), intent(inout) :: case
    type(deck_t), intent(in) :: deck

    integer, allocatable :: at(:)
    integer :: i

    at = positions(deck, "region")
    allocate (case%region(size(at)))
    do i = 1, size(at)
      call fill_region(case%region(i), deck%block(at(i)))
      case%region(i)%material = position(deck, "material", deck%block(at(i))%word("material"))
    end do
  end subroutine fill_regions

  !> Fill the meshes from files, with the positions of their materials.
  subroutine fill_meshes(case, deck)
    type(case_t), intent(inout) :: case
    type(deck_t), intent(in) :: deck

    integer, allocatable :: at(:)
    integer :: i, k

    at = positions(deck, "mesh")
    allocate (case%mesh(size(at)))
    do i = 1, size(at)
      associate (mesh => case%mesh(i), block => deck%block(at(i)))
        call fill_mesh(mesh, block)
        call fill_adaptive(case%adaptive, block)
        mesh%material = position(deck, "material", block%word("material"))
        do k = 1, size(mesh%material_of)
          mesh%material_of(k)%material = position(deck, "material", mesh%material_of(k)%name)
        end do
      end associate
    end do
  end subroutine fill_meshes

  !> Fill phases and points, which refer to tools and materials, and the history table's columns.
  subroutine fill_process(case, deck)
    type(case_t), intent(inout) :: case
    type(deck_t), intent(in) :: deck

    integer, allocatable :: at(:)
    integer :: i

    at = positions(deck, "phase")
    allocate (case%phase(size(at)))
    do i = 1, size(at)
      call fill_phase(case, i, deck%block(at(i)))
    end do
    at = positions(deck, "point")
    allocate (case%point(size(at)))
    do i = 1, size(at)
      associate (point => case%point(i), block => deck%block(at(i)))
        point%material = position(deck, "material", block%word("material"))
        if (point%material > 0) point%frame = case%material(point%material)%frame
        call fill_point(point, block)
      end associate
    end do
    at = positions(deck, "history")
    allocate (case%history(size(at)))
    do i = 1, size(at)
      call fill_history(case%history(i), deck%block(at(i)))
    end do
  end subroutine fill_process

  !> Return the positions of all blocks of a kind.
  pure function positions(deck, keyword) result(at)
    type(deck_t), intent(in) :: deck
    character(len=*), intent(in) :: keyword
    integer, allocatable :: at(:)

    integer :: i

    at = pack([(i, i=1, deck%n_block)], [(deck%block(i)%keyword == keyword, i=1, deck%n_block)])
  end function positions

  !> Return the position of a named block among those of its kind; 0 if not found.
  pure integer function position(deck, keyword, name)
    type(deck_t), intent(in) :: deck
    character(len=*), intent(in) :: keyword
    !> The block's own name.
    character(len=*), intent(in) :: name

    integer :: i

    position = 0
    do i = 1, deck%n_block
      if (deck%block(i)%keyword /= keyword) cycle
      position = position + 1
      if (deck%block(i)%name == name) return
    end do
    position = 0
  end function position

  subroutine fill_title(case, block)
    type(case_t), intent(inout) :: case
    type(block_t), intent(in) :: block

    integer :: i

    deallocate (case%title)
    allocate (case%title(block%n_entry))
    do i = 1, block%n_entry
      case%title(i)%s = block%entry(i)%value(1)%text
    end do
  end subroutine fill_title

  subroutine fill_tool(tool, block)
    type(tool_spec_t), intent(inout) :: tool
    type(block_t), intent(in) :: block

    integer :: i

    tool%name = block%name
    tool%source = block
    tool%patches = resolve_path(block%folder, block%word("patches"))
    tool%friction = block%number("friction")
    tool%compliance = block%number("compliance")
    allocate (tool%friction_law(0))
    do i = 1, block%n_entry
      if (block%entry(i)%key /= "friction_law" .or. .not. block%entry(i)%valid) cycle
      call add_law(tool%friction_law, block%entry(i), block%folder)
    end do
    tool%contact = block%word("contact")
    if (block%has("position")) tool%position = block%numbers("position")
  end subroutine fill_tool

  subroutine fill_drawbead(drawbead, block)
    type(drawbead_spec_t), intent(inout) :: drawbead
    type(block_t), intent(in) :: block

    drawbead%source = block
    drawbead%point = block%numbers("points")
    drawbead%file = ""
    if (block%has("file")) drawbead%file = resolve_path(block%folder, block%word("file"))
    drawbead%force = block%number("force")
    drawbead%normal = block%number("normal")
    drawbead%table = block%numbers("table")
    if (size(drawbead%table) > 0) return
    drawbead%table = [0.0_wp, 1.0_wp]
    if (block%number("rise") > 0.0_wp) then
      drawbead%table = [0.0_wp, 0.0_wp, block%number("rise"), 1.0_wp]
    end if
  end subroutine fill_drawbead

  subroutine fill_boundary(boundary, block)
    type(boundary_spec_t), intent(inout) :: boundary
    type(block_t), intent(in) :: block

    integer :: i

    boundary%name = block%name
    boundary%source = block
    boundary%set = block%word("set")
    if (block%has("pin")) boundary%pin = block%number("pin")
    if (.not. block%has("fix")) return
    associate (entry => block%entry(block%find("fix")))
      do i = 1, size(entry%value)
        boundary%fix(axis_of(entry%value(i)%text)) = .true.
      end do
    end associate
  end subroutine fill_boundary

  subroutine fill_solver(solver, block)
    type(solver_spec_t), intent(inout) :: solver
    type(block_t), intent(in) :: block

    solver%method = block%word("method")
    solver%method_at = block%at("method")
    solver%ordering = block%word("ordering")
    solver%factors = block%word("factors")
    solver%factors_at = block%at("factors")
    solver%ilu_level = nint(block%number("ilu_level"))
    solver%tolerance = block%number("tolerance")
    solver%iterations = nint(block%number("iterations"))
  end subroutine fill_solver

  subroutine fill_history(history, block)
    type(history_spec_t), intent(inout) :: history
    type(block_t), intent(in) :: block

    integer :: i

    history%name = block%name
    history%source = block
    history%set = block%word("set")
    if (.not. block%has("quantities")) return
    associate (entry => block%entry(block%find("quantities")))
      do i = 1, size(entry%value)
        select case (lower_case(entry%value(i)%text))
        case ("displacement")
          history%displacement = .true.
        case ("reaction")
          history%reaction = .true.
        case ("position")
          history%position = .true.
        case ("moment")
          history%moment = .true.
        case ("draw_in")
          history%draw_in = .true.
        case default
          ! Refused with the values of the key.
        end select
      end do
    end associate
  end subroutine fill_history

  subroutine fill_output(output, block)
    type(output_spec_t), intent(inout) :: output
    type(block_t), intent(in) :: block

    if (block%has("history")) output%history = nint(block%number("history"))
    if (block%has("directory")) output%directory = resolve_path(block%folder, &
        block%word("directory"))
    if (block%has("restart")) then
      output%restart = block%word("restart") /= "off"
      output%restart_every = nint(block%number("restart"))
    end if
    if (.not. block%has("fields")) return
    output%fields_value = block%numbers("fields")
    select case (block%word("fields"))
    case ("every")
      output%fields = fields_every
    case ("at")
      output%fields = fields_at
    case default
      output%fields = fields_increments
    end select
  end subroutine fill_output

end module dd3_input_fill
