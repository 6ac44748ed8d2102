! SPDX-License-Identifier: GPL-3.0-or-later
!> Load on supports that only hold a free sheet in its place. A support of *BOUNDARY counts as one
!> of these if it has few columns of nodes and does not hold all nodes of a plane, as one of
!> symmetry or one at the end of a strip does. Tools should carry what forms the sheet, not it.
module dd3_run_support_load
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : axis_name, to_text
  use dd3_input_case, only : boundary_spec_t, case_t
  use dd3_model_model, only : model_t
  use dd3_model_reactions, only : reactions
  use dd3_model_state, only : state_t
  use dd3_output_closing, only : support_t
  implicit none
  private
  public :: add_support_note, find_support

  !> Largest number of columns: three hold a rigid body.
  integer, parameter :: few = 3
  !> Distance within which nodes lie in a plane, over the thickness, and reaction over the largest
  !> force on a tool that is reported.
  real(wp), parameter :: in_plane = 1.0e-3_wp, notable = 0.01_wp

contains

  !> Find the support with the largest reaction at the end of the running phase; none without a tool
  !> that carries a force.
  subroutine find_support(case, model, state, support)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(support_t), intent(out) :: support

    real(wp) :: reaction(3, model%n_node), sum_of_set
    integer, allocatable :: node(:)
    integer :: i, axis

    if (.not. any(state%tools%touches)) return
    reaction = reactions(model, state)
    support%tool = maxloc(norm2(state%tools%force, dim=1), dim=1)
    support%tool_force = norm2(state%tools%force(:, support%tool))
    do i = 1, size(case%boundary)
      node = nodes_of(model, case%boundary(i)%set)
      if (.not. holds_free_sheet(model, case%boundary(i), node)) cycle
      do axis = 1, 3
        if (.not. case%boundary(i)%fix(axis)) cycle
        sum_of_set = sum(abs(reaction(axis, node)))
        if (allocated(support%name) .and. sum_of_set <= support%reaction) cycle
        support%name = case%boundary(i)%source%called()
        support%axis = axis
        support%reaction = sum_of_set
      end do
    end do
  end subroutine find_support

  !> Return the nodes of a set.
  pure function nodes_of(model, name) result(node)
    type(model_t), intent(in) :: model
    character(len=*), intent(in) :: name
    integer, allocatable :: node(:)

    integer :: i

    allocate (node(0))
    do i = 1, size(model%set)
      if (model%set(i)%name == name) node = model%set(i)%node
    end do
  end function nodes_of

  !> Whether a support has few columns of nodes, and not all nodes of a plane: neither by itself, as
  !> at the end of a strip, nor with others along the normal of the plane.
  pure logical function holds_free_sheet(model, boundary, node)
    type(model_t), intent(in) :: model
    type(boundary_spec_t), intent(in) :: boundary
    integer, intent(in) :: node(:)

    logical :: member(model%n_node), held(model%n_node)
    integer :: axis

    holds_free_sheet = .false.
    if (size(node) == 0) return
    member = .false.
    member(model%column(1, node)) = .true.
    if (count(member) > few) return
    member = .false.
    member(node) = .true.
    do axis = 1, 3
      held = member .or. (model%fixed(axis, :) .and. boundary%fix(axis))
      associate (x => model%x0(axis, :), tolerance => in_plane*model%thickness)
        if (any(abs(x(node) - x(node(1))) > tolerance)) cycle
        if (all(held .or. abs(x - x(node(1))) > tolerance)) return
      end associate
    end do
    holds_free_sheet = .true.
  end function holds_free_sheet

  !> Add a warning if a support carries a notable part of the largest force on a tool.
  subroutine add_support_note(model, state, support, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(support_t), intent(in) :: support
    type(message_list_t), intent(inout) :: notes

    if (.not. allocated(support%name)) return
    if (support%reaction <= notable*support%tool_force) return
    call notes%add_new("W121", "at the end of phase '"//model%phase(state%phase)%name// &
        "' the support '"//support%name//"', which only holds the sheet in its place, carries "// &
        to_text(support%reaction, 3)//" N along "//axis_name(support%axis)//", "// &
        to_text(100.0_wp*support%reaction/support%tool_force, 3)//" % of the force on tool '"// &
        model%tool(support%tool)%name//"'")
  end subroutine add_support_note

end module dd3_run_support_load
