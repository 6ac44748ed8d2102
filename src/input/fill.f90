!> Fills the case from the checked blocks.
module dd3_input_fill
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : pair_name
  use dd3_base_text, only : lower_case
  use dd3_input_block, only : block_t, deck_t, entry_t
  use dd3_input_case, only : case_t, blank_spec_t, node_set_spec_t, law_parameter_t, law_spec_t, &
      material_spec_t, tool_spec_t, boundary_spec_t, history_spec_t, set_plane, set_box, &
      set_nodes, set_near, fields_every, fields_at, fields_increments
  use dd3_input_fill_point, only : fill_point
  use dd3_input_fill_phase, only : fill_phase, fill_limits, fill_newton, fill_contact
  use dd3_input_number, only : parse_pair, parse_real
  use dd3_input_table, only : axis_of
  use dd3_input_text_file, only : resolve_path
  use dd3_input_value, only : is_point
  implicit none
  private
  public :: fill_case

contains

  !> Fills the case; entries that did not pass the check leave their members as they are.
  subroutine fill_case(case, deck)
    !> The case.
    type(case_t), intent(inout) :: case
    !> The checked blocks.
    type(deck_t), intent(in) :: deck

    integer :: i

    call allocate_case(case, deck)
    do i = 1, deck%n_block
      associate (block => deck%block(i))
        select case (block%keyword)
        case ("title")
          call fill_title(case, block)
        case ("contact")
          call fill_contact(case%contact, block)
        case ("limits")
          call fill_limits(case%limits, block)
        case ("newton")
          call fill_newton(case%newton, block)
        case ("solver")
          call fill_solver(case, block)
        case ("output")
          call fill_output(case, block)
        end select
      end associate
    end do
    call fill_named(case, deck)
    case%deck = deck
  end subroutine fill_case

  !> Makes room for the blocks that may be there several times.
  subroutine allocate_case(case, deck)
    !> The case.
    type(case_t), intent(inout) :: case
    !> The checked blocks.
    type(deck_t), intent(in) :: deck

    allocate (case%title(0))
    allocate (case%blank(count_blocks(deck, "blank")))
    allocate (case%set(count_blocks(deck, "set")))
    allocate (case%material(count_blocks(deck, "material")))
    allocate (case%tool(count_blocks(deck, "tool")))
    allocate (case%boundary(count_blocks(deck, "boundary")))
    allocate (case%phase(count_blocks(deck, "phase")))
    allocate (case%point(count_blocks(deck, "point")))
    allocate (case%history(count_blocks(deck, "history")))
    case%solver%method = "auto"
    case%solver%ordering = "none"
    case%output%directory = ""
    allocate (case%output%fields_value(0))
  end subroutine allocate_case

  !> Number of blocks of a kind.
  pure integer function count_blocks(deck, keyword)
    !> The blocks.
    type(deck_t), intent(in) :: deck
    !> The word after the star.
    character(len=*), intent(in) :: keyword

    integer :: i

    count_blocks = 0
    do i = 1, deck%n_block
      if (deck%block(i)%keyword == keyword) count_blocks = count_blocks + 1
    end do
  end function count_blocks

  !> Fills the blocks that bear names; phases and points last, as they refer to tools and
  !> materials.
  subroutine fill_named(case, deck)
    !> The case.
    type(case_t), intent(inout) :: case
    !> The checked blocks.
    type(deck_t), intent(in) :: deck

    integer :: i, n(6)

    n = 0
    do i = 1, deck%n_block
      associate (block => deck%block(i))
        select case (block%keyword)
        case ("blank")
          n(1) = n(1) + 1
          call fill_blank(case%blank(n(1)), block)
          case%blank(n(1))%material = position(deck, "material", block%word("material"))
        case ("set")
          n(2) = n(2) + 1
          call fill_set(case%set(n(2)), block)
        case ("material")
          n(3) = n(3) + 1
          call fill_material(case%material(n(3)), block)
        case ("tool")
          n(4) = n(4) + 1
          call fill_tool(case%tool(n(4)), block)
        case ("boundary")
          n(5) = n(5) + 1
          call fill_boundary(case%boundary(n(5)), block)
        case ("history")
          n(6) = n(6) + 1
          call fill_history(case%history(n(6)), block)
        end select
      end associate
    end do
    n(1) = 0
    n(2) = 0
    do i = 1, deck%n_block
      if (deck%block(i)%keyword == "phase") then
        n(1) = n(1) + 1
        call fill_phase(case, n(1), deck%block(i))
      else if (deck%block(i)%keyword == "point") then
        n(2) = n(2) + 1
        associate (point => case%point(n(2)), block => deck%block(i))
          point%material = position(deck, "material", block%word("material"))
          if (point%material > 0) point%frame = case%material(point%material)%frame
          call fill_point(point, block)
        end associate
      end if
    end do
  end subroutine fill_named

  !> Position of a named block among those of its kind; 0 if there is none.
  pure integer function position(deck, keyword, name)
    !> The blocks.
    type(deck_t), intent(in) :: deck
    !> The word after the star.
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

  !> Fills the title.
  subroutine fill_title(case, block)
    !> The case.
    type(case_t), intent(inout) :: case
    !> The block.
    type(block_t), intent(in) :: block

    integer :: i

    deallocate (case%title)
    allocate (case%title(block%n_entry))
    do i = 1, block%n_entry
      case%title(i)%s = block%entry(i)%value(1)%text
    end do
  end subroutine fill_title

  !> Fills a blank.
  subroutine fill_blank(blank, block)
    !> The blank.
    type(blank_spec_t), intent(inout) :: blank
    !> The block.
    type(block_t), intent(in) :: block

    blank%name = block%name
    blank%source = block
    if (block%has("origin")) blank%origin = block%numbers("origin")
    if (block%has("size")) blank%size = block%numbers("size")
    if (block%has("divisions")) blank%divisions = nint(block%numbers("divisions"))
    call fill_grading(blank%grading_x, block, "grading_x", blank%divisions(1))
    call fill_grading(blank%grading_y, block, "grading_y", blank%divisions(2))
    call fill_grading(blank%grading_z, block, "grading_z", blank%divisions(3))
    blank%skew = block%number("skew")
    blank%element = block%word("element")
  end subroutine fill_blank

  !> Node abscissae as given, or uniform.
  subroutine fill_grading(grading, block, key, n)
    !> The abscissae, (0:n).
    real(wp), allocatable, intent(out) :: grading(:)
    !> The block.
    type(block_t), intent(in) :: block
    !> The key.
    character(len=*), intent(in) :: key
    !> Number of elements.
    integer, intent(in) :: n

    integer :: i
    real(wp), allocatable :: given(:)

    allocate (grading(0:n))
    grading = [(real(i, wp)/real(n, wp), i=0, n)]
    given = block%numbers(key)
    if (size(given) == n + 1) grading = given
  end subroutine fill_grading

  !> Fills a node set.
  subroutine fill_set(set, block)
    !> The set.
    type(node_set_spec_t), intent(inout) :: set
    !> The block.
    type(block_t), intent(in) :: block

    real(wp), allocatable :: number(:)

    set%name = block%name
    set%source = block
    set%of = block%word("of")
    allocate (set%value(0), set%range(2, 0))
    if (block%has("tolerance")) set%tolerance = block%number("tolerance")
    if (block%has("plane")) then
      set%kind = set_plane
      number = block%numbers("plane")
      set%axis = nint(number(1))
      set%value = number(2:)
    else if (block%has("box")) then
      set%kind = set_box
      set%value = block%numbers("box")
    else if (block%has("near")) then
      set%kind = set_near
      set%value = block%numbers("near")
    else if (block%has("nodes")) then
      set%kind = set_nodes
      number = block%numbers("nodes")
      set%range = reshape(nint(number), [2, size(number)/2])
    end if
  end subroutine fill_set

  !> Fills a material.
  subroutine fill_material(material, block)
    !> The material.
    type(material_spec_t), intent(inout) :: material
    !> The block.
    type(block_t), intent(in) :: block

    integer :: i

    material%name = block%name
    material%source = block
    material%young = block%number("young")
    material%poisson = block%number("poisson")
    material%yield%name = ""
    material%hardening%name = ""
    if (block%has("yield")) call fill_law(material%yield, block%entry(block%find("yield")), &
        block%folder)
    if (block%has("hardening")) call fill_law(material%hardening, &
        block%entry(block%find("hardening")), block%folder)
    allocate (material%backstress(0))
    do i = 1, block%n_entry
      if (block%entry(i)%key /= "backstress" .or. .not. block%entry(i)%valid) cycle
      if (block%entry(i)%value(1)%text == "none" .and. size(block%entry(i)%value) == 1) cycle
      call add_law(material%backstress, block%entry(i), block%folder)
    end do
    if (block%has("rolling_direction") .and. block%has("normal_direction")) then
      material%frame = frame_of(block%numbers("rolling_direction"), &
          block%numbers("normal_direction"))
    end if
  end subroutine fill_material

  !> Appends a law.
  subroutine add_law(law, entry, folder)
    !> The laws.
    type(law_spec_t), allocatable, intent(inout) :: law(:)
    !> The entry it is written in.
    type(entry_t), intent(in) :: entry
    !> Folder of the file it is written in.
    character(len=*), intent(in) :: folder

    type(law_spec_t), allocatable :: larger(:)

    allocate (larger(size(law) + 1))
    larger(:size(law)) = law
    call fill_law(larger(size(larger)), entry, folder)
    call move_alloc(larger, law)
  end subroutine add_law

  !> Fills a law: its name, then triples key, equals sign, value, or points.
  subroutine fill_law(law, entry, folder)
    !> The law.
    type(law_spec_t), intent(inout) :: law
    !> The entry it is written in.
    type(entry_t), intent(in) :: entry
    !> Folder of the file it is written in.
    character(len=*), intent(in) :: folder

    integer :: i, k, points

    law%name = entry%value(1)%text
    law%at = entry%value(1)%at
    law%folder = folder
    points = count([(is_point(entry%value(k)), k=2, size(entry%value))])
    allocate (law%parameter(points + (size(entry%value) - 1 - points)/3))
    k = 2
    do i = 1, size(law%parameter)
      call fill_law_parameter(law%parameter(i), entry, k)
    end do
  end subroutine fill_law

  !> Fills a parameter of a law.
  subroutine fill_law_parameter(parameter, entry, k)
    !> The parameter.
    type(law_parameter_t), intent(inout) :: parameter
    !> The entry it is written in.
    type(entry_t), intent(in) :: entry
    !> Position of its first word; of the next parameter's afterwards.
    integer, intent(inout) :: k

    parameter%key_at = entry%value(k)%at
    if (is_point(entry%value(k))) then
      parameter%key = pair_name
      parameter%text = entry%value(k)%text
      parameter%at = entry%value(k)%at
      call parse_pair(parameter%text, parameter%abscissa, parameter%value, parameter%numeric)
      k = k + 1
    else
      parameter%key = entry%value(k)%text
      parameter%text = entry%value(k + 2)%text
      parameter%at = entry%value(k + 2)%at
      call parse_real(parameter%text, parameter%value, parameter%numeric)
      k = k + 3
    end if
  end subroutine fill_law_parameter

  !> Rolling, transverse and normal direction as columns: the normal is kept, the rolling direction
  !> made square to it.
  !> Zero where the two are parallel or vanish.
  pure function frame_of(rolling, normal) result(frame)
    !> The directions given.
    real(wp), intent(in) :: rolling(3), normal(3)
    real(wp) :: frame(3, 3)

    real(wp) :: n(3), r(3)

    frame = 0.0_wp
    if (norm2(normal) < tiny(1.0_wp) .or. norm2(rolling) < tiny(1.0_wp)) return
    n = normal/norm2(normal)
    r = rolling/norm2(rolling)
    r = r - dot_product(r, n)*n
    if (norm2(r) < 1.0e-6_wp) return
    r = r/norm2(r)
    frame(:, 1) = r
    frame(:, 2) = [n(2)*r(3) - n(3)*r(2), n(3)*r(1) - n(1)*r(3), n(1)*r(2) - n(2)*r(1)]
    frame(:, 3) = n
  end function frame_of

  !> Fills a tool.
  subroutine fill_tool(tool, block)
    !> The tool.
    type(tool_spec_t), intent(inout) :: tool
    !> The block.
    type(block_t), intent(in) :: block

    tool%name = block%name
    tool%source = block
    tool%patches = resolve_path(block%folder, block%word("patches"))
    tool%friction = block%number("friction")
    tool%contact = block%word("contact")
    if (block%has("position")) tool%position = block%numbers("position")
  end subroutine fill_tool

  !> Fills a boundary condition.
  subroutine fill_boundary(boundary, block)
    !> The boundary condition.
    type(boundary_spec_t), intent(inout) :: boundary
    !> The block.
    type(block_t), intent(in) :: block

    integer :: i, k

    boundary%name = block%name
    boundary%source = block
    boundary%set = block%word("set")
    if (.not. block%has("fix")) return
    k = block%find("fix")
    do i = 1, size(block%entry(k)%value)
      boundary%fix(axis_of(block%entry(k)%value(i)%text)) = .true.
    end do
  end subroutine fill_boundary

  !> Fills the settings of the linear solver.
  subroutine fill_solver(case, block)
    !> The case.
    type(case_t), intent(inout) :: case
    !> The block.
    type(block_t), intent(in) :: block

    case%solver%method = block%word("method")
    case%solver%ordering = block%word("ordering")
    if (block%has("ilu_level")) case%solver%ilu_level = nint(block%number("ilu_level"))
    if (block%has("tolerance")) case%solver%tolerance = block%number("tolerance")
    if (block%has("iterations")) case%solver%iterations = nint(block%number("iterations"))
  end subroutine fill_solver

  !> Fills further columns of the history table.
  subroutine fill_history(history, block)
    !> The columns.
    type(history_spec_t), intent(inout) :: history
    !> The block.
    type(block_t), intent(in) :: block

    integer :: i, k

    history%name = block%name
    history%source = block
    history%set = block%word("set")
    if (.not. block%has("quantities")) return
    k = block%find("quantities")
    do i = 1, size(block%entry(k)%value)
      select case (lower_case(block%entry(k)%value(i)%text))
      case ("displacement")
        history%displacement = .true.
      case ("reaction")
        history%reaction = .true.
      case ("position")
        history%position = .true.
      end select
    end do
  end subroutine fill_history

  !> Fills what is written when.
  subroutine fill_output(case, block)
    !> The case.
    type(case_t), intent(inout) :: case
    !> The block.
    type(block_t), intent(in) :: block

    if (block%has("history")) case%output%history = nint(block%number("history"))
    if (block%has("directory")) case%output%directory = resolve_path(block%folder, &
        block%word("directory"))
    if (.not. block%has("fields")) return
    case%output%fields_value = block%numbers("fields")
    select case (block%word("fields"))
    case ("every")
      case%output%fields = fields_every
    case ("at")
      case%output%fields = fields_at
    case default
      case%output%fields = fields_increments
    end select
  end subroutine fill_output

end module dd3_input_fill
