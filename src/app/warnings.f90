! SPDX-License-Identifier: GPL-3.0-or-later
!> Warnings of unusual input: magnitudes most often caused by a wrong unit or a typing error,
!> settings and meshes that make results inaccurate, loads on held directions, tools that probably
!> are not as meant. They are not errors: a unit cube of a model material is a valid case.
module dd3_app_warnings
  use dd3_app_material_warnings, only : material_warnings
  use dd3_app_unusual, only : add_unusual, outside, unusual_unit
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : location_t
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : axis_name, to_text
  use dd3_input_case, only : case_t
  use dd3_model_contact_data, only : all_faces
  use dd3_model_element_length, only : element_length_t, excess_moment, &
      longest_known, measure_elements
  use dd3_model_model, only : model_t
  use dd3_model_terms_bead_points, only : bead_point_t, covered_length, find_bead_points
  use dd3_setup_axes, only : normal_warnings
  use dd3_setup_held_loads, only : find_held_loads, held_load_t
  use dd3_setup_symmetry_planes, only : symmetry_warnings
  use dd3_setup_tool_report, only : tool_warnings
  implicit none
  private
  public :: unit_warnings

  !> Usual range of the thickness, mm.
  real(wp), parameter :: least_thickness = 1.0e-2_wp, largest_thickness = 1.0e2_wp
  !> Largest usual coefficient of friction and tolerance of the corrector; smallest usual search
  !> distance of the tools, in thicknesses of the sheet.
  real(wp), parameter :: largest_friction = 1.0_wp, largest_tolerance = 0.02_wp, &
      least_search = 0.1_wp
  !> Largest usual compliance of a tool, mm/MPa.
  real(wp), parameter :: largest_compliance = 1.0e-2_wp
  !> Usual range of gravity, mm/s2.
  real(wp), parameter :: least_gravity = 9.81e2_wp, largest_gravity = 9.81e4_wp
  !> Ratio of thicknesses up to which a draw-bead counts as one on a sheet of one thickness.
  real(wp), parameter :: equal_thickness = 1.02_wp

contains

  !> Return the warnings, each with file and line.
  subroutine unit_warnings(case, model, warnings)
    !> Without errors.
    type(case_t), intent(in) :: case
    !> Model of the case.
    type(model_t), intent(in) :: model
    type(message_list_t), intent(out) :: warnings

    integer :: i

    call material_warnings(case, model, warnings)
    call check_thickness(case, model, warnings)
    call check_tool_values(case, model, warnings)
    call check_gravity(case, warnings)
    call normal_warnings(case, model, warnings)
    call check_settings(case, model, warnings)
    call check_held_loads(case, model, warnings)
    call check_single_columns(case, model, warnings)
    call symmetry_warnings(case, model, warnings)
    call check_element_length(case, model, warnings)
    call tool_warnings(case, model, warnings)
    call check_drawbeads(case, model, warnings)
    do i = 1, model%cut_warnings%count
      call warnings%add(model%cut_warnings%item(i))
    end do
  end subroutine unit_warnings

  !> Warn of an unusual friction and compliance of tools, and of candidates on side and rim.
  subroutine check_tool_values(case, model, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    character(len=:), allocatable :: what
    type(location_t) :: at
    real(wp) :: largest
    integer :: i

    do i = 1, size(case%tool)
      associate (tool => case%tool(i))
        largest = model%tool(i)%friction%largest_coefficient()
        what = "friction = "//to_text(tool%friction)//" of tool '"//tool%source%called()//"'"
        at = tool%source%at("friction")
        if (largest > tool%friction) then
          what = what//", by its friction_law up to "//to_text(largest, 3)
          at = tool%friction_law(1)%at
        end if
        if (largest > largest_friction) call add_unusual(warnings, "W005", at, what, &
            "unusual; Coulomb's coefficient is below 1 in sheet metal forming")
        if (tool%compliance > largest_compliance) call add_unusual(warnings, "W028", &
            tool%source%at("compliance"), "compliance = "//to_text(tool%compliance)// &
            " mm/MPa of tool '"//tool%source%called()//"'", &
            "unusual; dies and rings of steel have 1e-5 to 1e-3 mm/MPa")
        if (model%touched_faces(i) == all_faces) call add_unusual(warnings, "W030", &
            tool%source%at("contact"), "contact of tool '"//tool%source%called()//"'", &
            "nodes of the upper or lower side of the sheet and of its rim: where these meet, "// &
            "forces act over the areas of both along their mean normal; expected a set of one")
      end associate
    end do
  end subroutine check_tool_values

  !> Warn of an unusual thickness.
  subroutine check_thickness(case, model, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    integer :: i

    do i = 1, size(case%blank)
      associate (blank => case%blank(i))
        if (.not. outside(blank%size(3), least_thickness, largest_thickness)) cycle
        call add_unusual(warnings, "W004", blank%source%at(trim(merge("thickness", "size     ", &
            blank%radius > 0.0_wp))), "thickness = "//to_text(blank%size(3))// &
            " mm of blank '"//blank%source%called()//"'", unusual_unit)
      end associate
    end do
    do i = 1, size(case%mesh)
      associate (mesh => case%mesh(i))
        if (.not. outside(model%thickness, least_thickness, largest_thickness)) cycle
        call add_unusual(warnings, "W004", mesh%source%at("file"), "thickness = "// &
            to_text(model%thickness, 4)//" mm of mesh '"//mesh%source%called()//"'", unusual_unit)
      end associate
    end do
  end subroutine check_thickness

  !> Warn of a tolerance of the corrector and a search distance that make results inaccurate.
  subroutine check_settings(case, model, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    integer :: i

    do i = 1, case%deck%n_block
      associate (block => case%deck%block(i))
        select case (block%keyword)
        case ("newton", "contact", "phase")
          if (block%keyword /= "contact" .and. block%number("tolerance") > largest_tolerance) then
            call add_unusual(warnings, "W006", block%at("tolerance"), "tolerance = "// &
                to_text(block%number("tolerance")), "forces may be inaccurate above 0.02")
          end if
          if (.not. block%has("search_distance")) cycle
          if (block%number("search_distance") >= least_search*model%thickness) cycle
          call add_unusual(warnings, "W007", block%at("search_distance"), "search_distance = "// &
              to_text(block%number("search_distance")), &
              "small for the thickness; nodes may pass a tool before it is found")
        case default
          ! Other blocks have no such settings.
        end select
      end associate
    end do
  end subroutine check_settings

  !> Warn of draw-beads beside the sheet, and over several parts of a tailored blank.
  subroutine check_drawbeads(case, model, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    type(bead_point_t), allocatable :: point(:)
    character(len=:), allocatable :: parts
    integer :: b

    if (size(case%drawbead) == 0) return
    call find_bead_points(model, [(.true., b=1, size(model%drawbead))], model%start_positions(), &
        point)
    do b = 1, size(model%drawbead)
      associate (at => case%drawbead(b)%source%opened, &
          called => "draw-bead '"//model%drawbead(b)%name//"'")
        if (covered_length(point, b) <= 0.0_wp) then
          call add_unusual(warnings, "W012", at, called, &
              "no part of its line lies on the sheet, seen along z")
          cycle
        end if
        parts = parts_under(case, model, pack(point, point%bead == b))
        if (len(parts) > 0) call add_unusual(warnings, "W130", at, called//" crosses "//parts, &
            "its force per length is the same on all of them; a bead for each gives each its own")
      end associate
    end do
  end subroutine check_drawbeads

  !> Return the initial thicknesses, if the blank has regions, and the materials under a draw-bead;
  !> empty if they are the same everywhere. A face has the largest thickness of its nodes: those of
  !> a thick region on its border have the thickness beside it.
  function parts_under(case, model, point) result(text)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Points of the bead.
    type(bead_point_t), intent(in) :: point(:)
    character(len=:), allocatable :: text

    real(wp) :: thickness(size(point))
    integer :: least(model%n_node), largest(model%n_node)
    logical :: found(size(model%material))
    integer :: a, e, m, p

    least = huge(1)
    largest = 0
    do e = 1, model%n_element
      associate (nodes => model%connectivity(:, e), material => model%material_of(e))
        least(nodes) = min(least(nodes), material)
        largest(nodes) = max(largest(nodes), material)
      end associate
    end do
    found = .false.
    thickness = 0.0_wp
    do p = 1, size(point)
      do a = 1, 4
        associate (ends => model%column(:, point(p)%node(a)))
          thickness(p) = max(thickness(p), norm2(model%x0(:, ends(2)) - model%x0(:, ends(1))))
        end associate
      end do
      associate (node => point(p)%node)
        m = maxval(least(node))
        if (minval(largest(node)) == m) found(m) = .true.
      end associate
    end do
    text = ""
    if (size(case%region) > 0 .and. maxval(thickness) > equal_thickness*minval(thickness)) then
      text = "sheet of "//to_text(minval(thickness), 3)//" to "//to_text(maxval(thickness), 3)// &
          " mm"
    end if
    if (count(found) < 2) return
    if (len(text) > 0) text = text//", "
    text = text//"materials"
    do m = 1, size(found)
      if (found(m)) text = text//" '"//case%material(m)%source%called()//"'"
    end do
  end function parts_under

  !> Warn of loads that supports or `displace` carry in part.
  subroutine check_held_loads(case, model, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    type(held_load_t), allocatable :: found(:)
    integer :: i

    call find_held_loads(model, case, found)
    do i = 1, size(found)
      associate (load => case%phase(found(i)%phase)%load(found(i)%load))
        call add_unusual(warnings, "W008", load%at, "load along "// &
            axis_name(found(i)%axis)//" on '"//load%set//"'", &
            to_text(found(i)%held)//" of its "//to_text(found(i)%n_node)// &
            " nodes are held in this direction, and their supports carry their part of it")
      end associate
    end do
  end subroutine check_held_loads

  !> Warn of supports in a direction at nodes of one column through the thickness only, where tools
  !> are withdrawn: the column cannot turn, and bends the sheet around it when tools that leave push
  !> it sideways.
  subroutine check_single_columns(case, model, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    integer :: axis, i, k

    if (size(case%boundary) == 0) return
    if (.not. any([(any(model%phase(i)%withdrawn), i=1, size(model%phase))])) return
    do axis = 1, 3
      associate (node => pack([(i, i=1, model%n_node)], model%fixed(axis, :)))
        if (size(node) < 2) cycle
        if (any(model%column(1, node) /= model%column(1, node(1)))) cycle
        k = findloc([(case%boundary(i)%fix(axis), i=1, size(case%boundary))], .true., dim=1)
        call add_unusual(warnings, "W024", case%boundary(k)%source%at("fix"), "fix = "// &
            axis_name(axis)//" of '"//case%boundary(k)%source%called()//"'", "the "// &
            to_text(size(node))//" nodes of one column through the thickness are held, which "// &
            "then cannot turn: tools that are withdrawn would bend the sheet around it")
      end associate
    end do
  end subroutine check_single_columns

  !> Warn of elements too long for bending.
  subroutine check_element_length(case, model, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    type(element_length_t) :: length
    type(location_t) :: at

    ! The measured excess is that of hex8.
    if (model%element%name /= "hex8") return
    length = measure_elements(model)
    if (length%n_long == 0) return
    if (size(case%blank) > 0) at = case%blank(1)%source%at("divisions")
    if (size(case%mesh) > 0) at = case%mesh(1)%source%at("file")
    call add_unusual(warnings, "W009", at, "the elements under the tools are "// &
        span(to_text(length%shortest, 2), to_text(length%longest, 2))//" thicknesses long", &
        "where the sheet bends, its moment is "//span(excess(length%shortest), &
        excess(length%longest))//" % too high; expected at most half a thickness there, 3 %")
  end subroutine check_element_length

  !> Return a range, or its only value.
  pure function span(lower, upper) result(text)
    character(len=*), intent(in) :: lower, upper
    character(len=:), allocatable :: text

    text = lower
    if (lower /= upper) text = lower//" to "//upper
  end function span

  !> Return the excess of the moment of elements of a length in thicknesses, per cent.
  function excess(length) result(text)
    real(wp), intent(in) :: length
    character(len=:), allocatable :: text

    text = to_text(nint(100*excess_moment(length)))
    if (length > longest_known) text = "more than "//text
  end function excess

  !> Warn of an unusual acceleration of gravity.
  subroutine check_gravity(case, warnings)
    type(case_t), intent(in) :: case
    type(message_list_t), intent(inout) :: warnings

    !> Other units in mm/s2.
    real(wp), parameter :: factor(3) = [1.0e3_wp, 1.0e6_wp, 9.81e3_wp]
    character(len=24), parameter :: unit(3) = [character(len=24) :: "m/s2", "mm/ms2", &
        "multiples of the earth's"]
    real(wp), parameter :: earth = 9.81e3_wp
    character(len=:), allocatable :: remark
    real(wp) :: size_of
    integer :: i, k

    do i = 1, size(case%phase)
      if (.not. case%phase(i)%has_gravity) cycle
      size_of = norm2(case%phase(i)%gravity)
      if (size_of <= 0.0_wp .or. .not. outside(size_of, least_gravity, largest_gravity)) cycle
      remark = "unusual; the unit is mm/s2, 9810 on the earth"
      do k = 1, size(factor)
        if (outside(factor(k)*size_of, 0.9_wp*earth, 1.1_wp*earth)) cycle
        remark = remark//"; given in "//trim(unit(k))//"?"
        exit
      end do
      call add_unusual(warnings, "W023", case%phase(i)%source%at("gravity"), "gravity of "// &
          to_text(size_of, 4)//" mm/s2", remark)
    end do
  end subroutine check_gravity

end module dd3_app_warnings
