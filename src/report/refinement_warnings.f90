! SPDX-License-Identifier: GPL-3.0-or-later
!> Warnings about the refinement of the sheet: elements that are bent by more than the angle of the
!> input and are not divided further as its levels or its least length do not let them.
module dd3_report_refinement_warnings
  use dd3_base_kinds, only : pi, wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : to_text
  use dd3_model_contact_results, only : touching_tools
  use dd3_model_edge_length, only : edge_lengths
  use dd3_model_element_columns, only : n_corner
  use dd3_model_model, only : model_t
  use dd3_model_sheet_turn, only : turn_of_sheet
  use dd3_model_state, only : state_t
  use dd3_report_suitable_levels, only : halvings, levels_advice
  use dd3_report_tool_warnings, only : depth_warning
  use dd3_settings_adaptive, only : adaptive_spec_t
  use dd3_tools_curvature, only : smallest_radius
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: add_refinement_warnings, late_warning

  !> Angle that is told, over that of the input: with its default 22.5 degrees, four elements to the
  !> quarter circle, from where the depth of a tool is told too.
  real(wp), parameter :: notable = 1.5_wp
  !> Difference of lengths that is round-off, relative.
  real(wp), parameter :: round_off = 1.0e-6_wp

contains

  !> Add the warnings at the end of the running phase: one for each tool that bends such elements,
  !> unless that it enters the sheet between its nodes is told already, and one for the others.
  subroutine add_refinement_warnings(model, state, adaptive, warnings)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(adaptive_spec_t), intent(in) :: adaptive
    type(message_list_t), intent(inout) :: warnings

    real(wp) :: turn(model%n_element), length(model%n_element)
    integer :: level(model%n_element), tool(model%n_element), t
    logical :: over(model%n_element)

    if (adaptive%levels == 0) return
    associate (phase => model%phase(state%phase), angle => pi/180.0_wp*adaptive%angle)
      if (phase%unloaded .or. any(phase%withdrawn)) return
      level = 0
      if (allocated(model%level)) level = model%level
      length = edge_lengths(model, state%x)
      call turn_of_sheet(model, state%x, turn)
      over = turn > notable*angle .and. (level >= adaptive%levels .or. &
          0.5_wp*length < (1.0_wp - round_off)*adaptive%size)
      if (.not. any(over)) return
      tool = tools_of_elements(model, state, over)
      do t = 0, model%n_tool
        if (.not. any(over .and. tool == t)) cycle
        if (t > 0) then
          if (len(depth_warning(model, state, t, adaptive)) > 0) cycle
        end if
        call warnings%add_new("W118", "in phase '"//phase%name//"' the sheet is bent by up to "// &
            degrees(maxval(turn, over .and. tool == t))//" over an element "// &
            place_of(model, state, t, maxloc(turn, 1, over .and. tool == t))//", more than "// &
            to_text(notable, 2)//" times adaptive_angle = "//to_text(adaptive%angle, 3)//" at "// &
            to_text(count(over .and. tool == t))//" elements that are not divided further; "// &
            "expected "//levels_advice(adaptive, maxval(level + halvings(turn, angle), &
            over .and. tool == t), minval(length/2.0_wp**halvings(turn, angle), &
            over .and. tool == t)))
      end do
    end associate
  end subroutine add_refinement_warnings

  !> Return the tool that bends each of some elements: of those in contact with its nodes the one
  !> with the smallest radius there. One without contact takes it from one beside it. 0 for none.
  function tools_of_elements(model, state, over) result(tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> `(n_element)`.
    logical, intent(in) :: over(:)
    integer :: tool(model%n_element)

    integer :: touching(model%n_node), e, i
    real(wp) :: radius, smallest
    logical :: changed

    touching = touching_tools(model, state)
    tool = 0
    do e = 1, model%n_element
      if (.not. over(e)) cycle
      smallest = 0.0_wp
      do i = 1, model%n_tool
        if (.not. any(touching(model%connectivity(:, e)) == i)) cycle
        radius = radius_at(model, state, i, e)
        if (tool(e) > 0 .and. radius >= smallest) cycle
        tool(e) = i
        smallest = radius
      end do
    end do
    touching = 0
    do
      changed = .false.
      do e = 1, model%n_element
        if (.not. over(e)) cycle
        associate (node => model%connectivity(:, e))
          if (tool(e) == 0) tool(e) = maxval(touching(node))
          if (tool(e) == 0 .or. all(touching(node) > 0)) cycle
          where (touching(node) == 0) touching(node) = tool(e)
          changed = .true.
        end associate
      end do
      if (.not. changed) return
    end do
  end function tools_of_elements

  !> Return the smallest radius of a tool at an element, mm; huge if it is not convex there.
  function radius_at(model, state, tool, element) result(radius)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool, element
    real(wp) :: radius

    type(placement_t) :: placement
    real(wp) :: corner(3, n_corner)
    integer :: i

    placement = state%placement(tool)
    associate (node => model%connectivity(:, element))
      do i = 1, n_corner
        corner(:, i) = placement%to_tool(state%x(:, node(i)))
      end do
    end associate
    radius = smallest_radius(model%tool(tool)%surface, 0.25_wp*sum(corner, dim=2), &
        norm2(corner(:, 3) - corner(:, 1)))
  end function radius_at

  !> Return the place of an element on a tool: the tool's smallest radius there.
  function place_of(model, state, tool, element) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> 0 for none.
    integer, intent(in) :: tool, element
    character(len=:), allocatable :: text

    real(wp) :: radius

    text = "where no tool touches it"
    if (tool == 0) return
    radius = radius_at(model, state, tool, element)
    text = "at tool '"//trim(model%tool(tool)%name)//"'"
    if (radius < huge(1.0_wp)) text = text//" with a radius of "//to_text(radius, 3)//" mm"
  end function place_of

  !> Return the warning of elements that are bent by more than the angle in an increment that is
  !> accepted as it has been repeated often enough; empty if there are none.
  function late_warning(n, turn, repetitions) result(text)
    !> Number of elements, and the largest angle, rad.
    integer, intent(in) :: n
    real(wp), intent(in) :: turn
    integer, intent(in) :: repetitions
    character(len=:), allocatable :: text

    text = ""
    if (n == 0) return
    text = "the increment is accepted after "//to_text(repetitions)//" repetitions on finer "// &
        "meshes, though it bends the sheet by up to "//degrees(turn)//" over "//to_text(n)// &
        trim(merge(" elements", " element ", n > 1))//", which are divided before the next one"
  end function late_warning

  !> Return an angle as text.
  pure function degrees(angle) result(text)
    !> rad.
    real(wp), intent(in) :: angle
    character(len=:), allocatable :: text

    text = to_text(180.0_wp/pi*angle, 3)//" degrees"
  end function degrees

end module dd3_report_refinement_warnings
