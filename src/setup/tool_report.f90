! SPDX-License-Identifier: GPL-3.0-or-later
!> What the input says about the tools: the joints of their surfaces as text, and warnings of edges
!> that nearly coincide and of candidates on the wrong face of the sheet.
module dd3_setup_tool_report
  use dd3_base_kinds, only : wp, pi
  use dd3_base_error, only : location_t
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : newline, to_text
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : face_normal
  use dd3_model_tolerances, only : start_depth
  use dd3_tools_closest, only : find_contact, hint_t, hit_t
  use dd3_tools_joints, only : near_miss_t, new_surface_report, surface_report_t
  implicit none
  private
  public :: tool_report, tool_warnings, near_gap

  !> Largest gap of edges that count as near, in thicknesses.
  real(wp), parameter :: near_gap = 2.0_wp
  !> Near edges named for one tool.
  integer, parameter :: most_named = 5
  !> Largest number of faces of the sheet at which their direction is compared with a tool's.
  integer, parameter :: most_faces = 500
  !> Least |m.n| of the normals of sheet and tool at which one faces the other.
  real(wp), parameter :: facing = 0.5_wp
  real(wp), parameter :: degree = pi/180.0_wp

contains

  !> Return a line for each tool with the joints of its surface; empty without tools.
  function tool_report(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    type(surface_report_t) :: report
    integer :: i

    text = ""
    do i = 1, model%n_tool
      call new_surface_report(report, model%tool(i)%surface, near_gap*model%thickness)
      text = text//"tool '"//model%tool(i)%name//"': "//joints(model, i, report)// &
          elasticity(model, i)//newline
    end do
  end function tool_report

  !> Return the numbers of a report, with the lines of the patches in the tool's file.
  function joints(model, tool, report) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    type(surface_report_t), intent(in) :: report
    character(len=:), allocatable :: text

    associate (patch => model%tool(tool)%surface%patch, n_t => size(report%t_junction, 2))
      text = counted(report%n_patch, "patch", "patches")//"; edges: "// &
          to_text(report%n_joined)//" joined, "//to_text(report%n_open)//" open; "// &
          counted(size(report%near_miss), "near miss", "near misses")//", "// &
          counted(n_t, "T-junction", "T-junctions")
      if (n_t > 0) text = text//" ("//lines(patch(report%t_patch(:, 1))%line)//")"
      text = text//", "//counted(report%n_kink, "kink", "kinks")
      if (report%n_kink > 0) text = text//" (up to "//to_text(report%largest_kink/degree, 3)// &
          " degrees, "//lines(patch(report%kink_patch)%line)//")"
      text = text//", "//counted(report%n_pole, "pole", "poles")
    end associate
  end function joints

  !> Return the deflection of an elastic tool; empty for a rigid one.
  function elasticity(model, tool) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    character(len=:), allocatable :: text

    !> MPa.
    real(wp), parameter :: pressure = 100.0_wp

    text = ""
    associate (compliance => model%tool(tool)%compliance)
      if (compliance > 0.0_wp) text = "; deflects by "//to_text(pressure*compliance, 3)// &
          " mm at "//to_text(nint(pressure))//" MPa"
    end associate
  end function elasticity

  !> Return a number with its noun.
  pure function counted(n, one, many) result(text)
    integer, intent(in) :: n
    character(len=*), intent(in) :: one, many
    character(len=:), allocatable :: text

    text = to_text(n)//" "//many
    if (n == 1) text = "1 "//one
  end function counted

  pure function lines(line) result(text)
    integer, intent(in) :: line(2)
    character(len=:), allocatable :: text

    text = "patches of lines "//to_text(line(1))//" and "//to_text(line(2))
  end function lines

  !> Add the warnings about the tools, each with file and line.
  subroutine tool_warnings(case, model, warnings)
    !> Without errors.
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    type(surface_report_t) :: report
    integer :: i, k

    do i = 1, model%n_tool
      call new_surface_report(report, model%tool(i)%surface, near_gap*model%thickness)
      do k = 1, min(size(report%near_miss), most_named)
        call add_gap_warning(case, model, i, report%near_miss(k), warnings)
      end do
      if (k <= size(report%near_miss)) call warnings%add_new("W010", &
          to_text(size(report%near_miss) - most_named)//" more pairs of edges of tool '"// &
          model%tool(i)%name//"' nearly coincide without being joined")
      call warnings%add_new("W011", face_warning(case, model, i), &
          case%tool(i)%source%at("contact"))
    end do
  end subroutine tool_warnings

  !> Add the warning of two edges that nearly coincide.
  subroutine add_gap_warning(case, model, tool, near_miss, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    type(near_miss_t), intent(in) :: near_miss
    type(message_list_t), intent(inout) :: warnings

    type(location_t) :: at

    associate (line => model%tool(tool)%surface%patch(near_miss%patch)%line)
      at%file = case%tool(tool)%patches
      at%line = line(2)
      call warnings%add_new("W010", "the "//lines(line)// &
          " are not joined, although their edges run beside each other at up to "// &
          to_text(near_miss%gap, 3)//" mm: a node between them does not meet tool '"// &
          model%tool(tool)%name//"'; expected edges with the same control points and weights", at)
    end associate
  end subroutine add_gap_warning

  !> Return a warning if most faces before a tool whose nodes are its candidates are turned away
  !> from it; empty otherwise.
  function face_warning(case, model, tool) result(text)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    character(len=:), allocatable :: text

    real(wp) :: up
    integer :: n_facing, n_averted

    text = ""
    call count_faces(model, tool, n_facing, n_averted, up)
    if (n_averted <= n_facing) return
    text = "the nodes of set '"//case%tool(tool)%contact//"' before tool '"// &
        model%tool(tool)%name//"' lie on the face of the sheet that is turned away from it ("// &
        to_text(n_averted)//" of "//to_text(n_averted + n_facing)//" element faces); expected "// &
        "the nodes of the face that it meets"
    if (abs(up) > facing*real(n_averted, wp)) text = text//", such as contact = "// &
        merge("z_min", "z_max", up > 0.0_wp)
  end function face_warning

  !> Count the faces before a tool that face it, and those that are turned away; of many, every
  !> n-th is examined.
  subroutine count_faces(model, tool, n_facing, n_averted, up)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    integer, intent(out) :: n_facing, n_averted
    !> Sum of the vertical components of the normals of the tool before the latter.
    real(wp), intent(out) :: up

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: x(3, 4), position(3, model%n_node), cosine
    integer :: f, n

    position = model%start_positions()
    n = 0
    n_facing = 0
    n_averted = 0
    up = 0.0_wp
    do f = 1, model%face%n
      if (.not. all(model%member(tool, model%face%corner(:, f)))) cycle
      n = n + 1
      if (mod(n, model%face%n/most_faces + 1) > 0) cycle
      x = position(:, model%face%corner(:, f))
      hint = hint_t()
      call find_contact(model%tool(tool)%surface, 0.25_wp*sum(x, dim=2) &
          - model%tool(tool)%position, hint, model%tolerance%start_search, start_depth, hit)
      if (.not. hit%found) cycle
      cosine = dot_product(face_normal(x), hit%normal)
      if (cosine < -facing) n_facing = n_facing + 1
      if (cosine <= facing) cycle
      n_averted = n_averted + 1
      up = up + hit%normal(3)
    end do
  end subroutine count_faces

end module dd3_setup_tool_report
