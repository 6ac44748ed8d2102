! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of relations between the values of the case. Blocks with earlier errors are skipped.
module dd3_input_cross_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : to_text
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t, blank_spec_t, node_set_spec_t, material_spec_t, &
      contact_spec_t, start_spec_t
  use dd3_input_forming_limit_check, only : check_forming_limit
  use dd3_input_sheet_sets, only : n_quarters
  use dd3_settings_limits, only : limits_spec_t
  use dd3_settings_output, only : fields_every, fields_at
  implicit none
  private
  public :: cross_check, check_material

contains

  !> Check everything but the phases.
  subroutine cross_check(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i, before

    do i = 1, size(case%blank)
      if (case%blank(i)%source%valid) call check_blank(case%blank(i), errors)
    end do
    do i = 1, size(case%set)
      if (case%set(i)%source%valid) call check_set(case%set(i), errors)
    end do
    do i = 1, size(case%material)
      ! With a mesh and without a normal the directions are checked in the model.
      if (case%material(i)%source%valid .and. (size(case%mesh) == 0 .or. &
          case%material(i)%source%has("normal_direction"))) then
        call check_material(case%material(i), errors)
      end if
    end do
    do i = 1, size(case%start)
      if (case%start(i)%source%valid) call check_start(case%start(i), errors)
    end do
    do i = 1, size(case%trim)
      if (case%trim(i)%source%valid) call check_trim(case%trim(i)%source, errors)
    end do
    call check_history_names(case, errors)
    call check_compliance(case, errors)
    do i = 1, case%deck%n_block
      if (.not. case%deck%block(i)%valid) cycle
      select case (case%deck%block(i)%keyword)
      case ("limits")
        call check_limits(case%limits, case%deck%block(i), errors)
      case ("contact")
        call check_contact(case%contact, case%deck%block(i), errors)
      case ("output")
        before = errors%count
        call check_output(case, case%deck%block(i), errors)
        if (errors%count == before) call check_travel(case, case%deck%block(i), errors)
      case default
        ! Other blocks are checked with their lists above and below.
      end select
    end do
    do i = 1, size(case%phase)
      if (.not. case%phase(i)%source%valid) cycle
      call check_limits(case%phase(i)%limits, case%phase(i)%source, errors)
      call check_contact(case%phase(i)%contact, case%phase(i)%source, errors)
    end do
  end subroutine cross_check

  !> Check that a blank is a box or round, and its gradings and skew.
  subroutine check_blank(blank, errors)
    type(blank_spec_t), intent(in) :: blank
    type(error_list_t), intent(inout) :: errors

    real(wp) :: shift, room, n_element
    integer :: before

    before = errors%count
    call check_form(blank%source, errors)
    if (errors%count > before) return
    n_element = product(real(blank%divisions, wp))
    if (blank%radius > 0.0_wp) n_element = n_element*(2.0_wp + real(blank%divisions(1), wp) &
        /real(blank%divisions(2), wp))*real(n_quarters(blank%portion), wp)
    call check_grading(blank%source, "grading_x", blank%divisions(1), errors)
    call check_grading(blank%source, "grading_y", blank%divisions(2), errors)
    call check_grading(blank%source, "grading_z", blank%divisions(3), errors)
    if (n_element > 5.0e6_wp) then
      call errors%push_input(blank%source%at("divisions"), &
          "more than 5 million elements", "at most 5 million", code="E133")
    end if
    if (errors%count > before .or. blank%divisions(1) < 2 .or. blank%radius > 0.0_wp) return
    associate (x => blank%grading_x, n => blank%divisions(1))
      shift = 0.5_wp*abs(blank%skew)/real(n, wp)
      room = min(x(1) - x(0), x(n) - x(n - 1))
      if (shift >= room) then
        call errors%push_input(blank%source%at("skew"), "skew = "//to_text(blank%skew)// &
            " inverts the elements at the ends", "a magnitude below "// &
            to_text(2.0_wp*room*real(n, wp)), code="E133")
      end if
    end associate
  end subroutine check_blank

  !> Check that a blank has the keys of a box or those of a round one.
  subroutine check_form(block, errors)
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    character(len=*), parameter :: box_keys(5) = [character(len=9) :: "size", "grading_x", &
        "grading_y", "grading_z", "skew"]
    character(len=*), parameter :: round_keys(2) = [character(len=9) :: "thickness", "portion"]
    integer :: i

    if (block%find("radius") == 0) then
      if (block%find("size") == 0) call errors%push_input(block%opened, &
          "'size' is missing in *BLANK "//block%called(), "size = lx ly lz for a box, or "// &
          "radius = R and thickness = t for a round blank", code="E121")
      do i = 1, size(round_keys)
        if (block%given(trim(round_keys(i)))) call errors%push_input( &
            block%at(trim(round_keys(i))), "'"//trim(round_keys(i))//"' is a key of a round "// &
            "blank", "radius, thickness and portion, or size alone", code="E124")
      end do
      return
    end if
    if (block%find("thickness") == 0) call errors%push_input(block%opened, &
        "'thickness' is missing in *BLANK "//block%called(), "thickness = t with radius = R", &
        code="E121")
    do i = 1, size(box_keys)
      if (block%given(trim(box_keys(i)))) call errors%push_input(block%at(trim(box_keys(i))), &
          "'"//trim(box_keys(i))//"' is a key of a box; this blank is round", &
          "radius, thickness, portion and divisions", code="E124")
    end do
  end subroutine check_form

  !> Check the axes of the turns of a sheet.
  subroutine check_start(start, errors)
    type(start_spec_t), intent(in) :: start
    type(error_list_t), intent(inout) :: errors

    integer :: i, n

    n = 0
    do i = 1, start%source%n_entry
      if (start%source%entry(i)%key /= "turn") cycle
      n = n + 1
      if (norm2(start%turn(4:6, n)) > 0.0_wp) cycle
      call errors%push_input(start%source%entry(i)%value(4)%at, "the axis of the turn is zero", &
          "turn = px py pz ax ay az angle with an axis a that is not zero", code="E135")
    end do
  end subroutine check_start

  !> Check that a cut has its curves in one place.
  subroutine check_trim(block, errors)
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    if (block%has("file") .neqv. block%has("points")) return
    call errors%push_input(block%opened, "cut '"//block%called()//"' has "// &
        trim(merge("both file and points", "no curve            ", block%has("file"))), &
        "file = path, or points = x y z ...", code="E132")
  end subroutine check_trim

  !> Check a grading of n elements: one number per node line, increasing from 0 to 1.
  subroutine check_grading(block, key, n, errors)
    type(block_t), intent(in) :: block
    character(len=*), intent(in) :: key
    integer, intent(in) :: n
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: x(:)
    integer :: i, k

    if (.not. block%has(key)) return
    allocate (x, source=block%numbers(key))
    k = block%find(key)
    if (size(x) /= n + 1) then
      call errors%push_input(block%at(key), "expected "//to_text(n + 1)//" abscissae for "// &
          to_text(n)//" elements, got "//to_text(size(x)), key//" = "//to_text(n + 1)// &
          " numbers increasing from 0 to 1", code="E132")
      return
    end if
    if (abs(x(1)) > 0.0_wp) call errors%push_input(block%at(key), key//" does not start at 0", &
        "0 ... 1", code="E134")
    do i = 2, size(x)
      if (x(i) > x(i - 1)) cycle
      call errors%push_input(block%entry(k)%value(i)%at, key//" does not increase here", &
          "each number larger than the one before", code="E134")
      return
    end do
    if (abs(x(n + 1) - 1.0_wp) > 0.0_wp) then
      call errors%push_input(block%entry(k)%value(n + 1)%at, key//" does not end at 1", "0 ... 1", &
          code="E134")
    end if
  end subroutine check_grading

  !> Check that a set has exactly one definition, and the bounds of a box.
  subroutine check_set(set, errors)
    type(node_set_spec_t), intent(in) :: set
    type(error_list_t), intent(inout) :: errors

    integer :: i, n

    n = count([set%source%has("plane"), set%source%has("box"), set%source%has("nodes"), &
        set%source%has("near")])
    if (n /= 1) then
      call errors%push_input(set%source%opened, "set '"//set%source%called()// &
          "': expected 1 definition, got "//to_text(n), &
          "one of plane, box, nodes, near, alone or with of", code="E132")
    end if
    if (.not. set%source%has("box")) return
    do i = 1, 5, 2
      if (set%value(i + 1) >= set%value(i)) cycle
      call errors%push_input(set%source%entry(set%source%find("box"))%value(i)%at, &
          "the bounds of the box are reversed", &
          "box = x0 x1 y0 y1 z0 z1 with x0 <= x1, y0 <= y1, z0 <= z1", code="E134")
      return
    end do
  end subroutine check_set

  !> Check a material's directions.
  subroutine check_material(material, errors)
    type(material_spec_t), intent(in) :: material
    type(error_list_t), intent(inout) :: errors

    call check_forming_limit(material%source, errors)
    if (any(abs(material%frame) > 0.0_wp)) return
    call errors%push_input(material%source%at("rolling_direction"), &
        "rolling and normal direction are zero or parallel", &
        "two directions that are neither zero nor parallel", code="E135")
  end subroutine check_material

  !> Check the bounds of the factor r if the block gives one of them.
  subroutine check_limits(limits, block, errors)
    !> Limits that apply, given or inherited.
    type(limits_spec_t), intent(in) :: limits
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: key

    key = "r_min"
    if (.not. block%given(key)) key = "r_max"
    if (.not. block%given(key)) return
    if (limits%r_min%value <= limits%r_max%value) return
    call errors%push_input(block%at(key), "r_min = "//to_text(limits%r_min%value)// &
        " is larger than r_max = "//to_text(limits%r_max%value), "r_min <= r_max", code="E134")
  end subroutine check_limits

  !> Check that the settings of the contact belong to its formulation.
  subroutine check_contact(contact, block, errors)
    !> Settings that apply, given or inherited.
    type(contact_spec_t), intent(in) :: contact
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    if (contact%mixed .and. block%given("layer")) call errors%push_input(block%at("layer"), &
        "the mixed formulation has no layer", "formulation = compliant, without penalty", &
        code="E124")
    if (.not. contact%mixed .and. block%given("penalty")) call errors%push_input( &
        block%at("penalty"), "the compliant formulation has no penalty", "formulation = mixed", &
        code="E124")
    if (.not. contact%mixed .or. contact%points == 1) return
    if (block%given("points")) then
      call errors%push_input(block%at("points"), &
          "the mixed formulation has its points at the nodes", "points = 1", code="E124")
    else
      call errors%push_input(block%opened, "the mixed formulation has its points at the nodes", &
          "formulation = compliant, or points = 1 in *CONTACT", code="E124")
    end if
  end subroutine check_contact

  !> Report elastic tools where a phase has the mixed formulation of the contact.
  subroutine check_compliance(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i

    if (.not. any([(case%phase(i)%contact%mixed, i=1, size(case%phase))])) return
    do i = 1, size(case%tool)
      if (case%tool(i)%compliance > 0.0_wp) call errors%push_input( &
          case%tool(i)%source%at("compliance"), "the mixed formulation of the contact has no "// &
          "elastic tools", "formulation = compliant in all phases", code="E250")
    end do
  end subroutine check_compliance

  !> Check the interval or the travels at which fields are written.
  subroutine check_output(case, block, errors)
    type(case_t), intent(in) :: case
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    integer :: i, k

    k = block%find("fields")
    associate (value => case%output%fields_value)
      if (case%output%fields == fields_every) then
        if (value(1) > 0.0_wp) return
        call errors%push_input(block%entry(k)%value(2)%at, "the interval is not positive", &
            "fields = every v mm, v > 0", code="E134")
      else if (case%output%fields == fields_at) then
        do i = 1, size(value)
          if (i == 1 .and. value(1) >= 0.0_wp) cycle
          if (i > 1) then
            if (value(i) > value(i - 1)) cycle
          end if
          call errors%push_input(block%entry(k)%value(i + 1)%at, &
              "the travels do not increase here", "fields = at v1 v2 ..., 0 <= v1 < v2", &
              code="E134")
          return
        end do
      end if
    end associate
  end subroutine check_output

  !> Check that a tool controls some phase if fields are written by travel.
  subroutine check_travel(case, block, errors)
    type(case_t), intent(in) :: case
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    if (case%output%fields /= fields_every .and. case%output%fields /= fields_at) return
    if (some_tool_controls(case)) return
    call errors%push_input(block%at("fields"), &
        "fields are written by travel, but no phase is controlled by a tool", &
        "fields = increments N if all phases have control = load", code="E125")
  end subroutine check_travel

  !> Whether a tool controls one of the phases; true if a phase has errors.
  pure logical function some_tool_controls(case)
    type(case_t), intent(in) :: case

    integer :: i

    some_tool_controls = size(case%phase) == 0
    do i = 1, size(case%phase)
      if (case%phase(i)%source%valid .and. case%phase(i)%control == 0) cycle
      some_tool_controls = .true.
    end do
  end function some_tool_controls

  !> Report columns of the history table that have the name of a tool.
  subroutine check_history_names(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i, j

    do i = 1, size(case%history)
      do j = 1, size(case%tool)
        if (all(case%history(i)%name /= case%tool(j)%name//[character(len=5) :: "", "_tilt"])) cycle
        call errors%push_input(case%history(i)%source%named, "'"// &
            case%history(i)%source%called()//"' names columns of tool '"// &
            case%tool(j)%source%called()//"' in history.csv", "another name", code="E123")
      end do
    end do
  end subroutine check_history_names

end module dd3_input_cross_check
