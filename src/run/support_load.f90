! SPDX-License-Identifier: GPL-3.0-or-later
!> Load on supports that only hold a free sheet in its place. A support of *BOUNDARY, or of a phase
!> that displaces nodes by zero, counts as one of these if it has few columns of nodes and does not
!> hold all nodes of a plane, as one of symmetry or one at the end of a strip does, and is no pin.
!> Tools should carry what forms the sheet, not it.
module dd3_run_support_load
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : axis_name, to_text
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_reactions, only : reactions
  use dd3_model_state, only : state_t
  use dd3_model_terms_gravity, only : gravity_name
  use dd3_output_closing, only : support_t
  implicit none
  private
  public :: add_support_note, find_support, nodes_of

  !> Largest number of columns: three hold a rigid body.
  integer, parameter :: few = 3
  !> Distance within which nodes lie in a plane, over the thickness, and reaction over the largest
  !> force on a tool that is reported.
  real(wp), parameter :: in_plane = 1.0e-3_wp, notable = 0.01_wp

  !> A set of nodes that is held along some axes.
  type :: support_spec_t
    !> Name in messages, and node set.
    character(len=:), allocatable :: name, set
    !> Whether x, y, z are held.
    logical :: fix(3) = .false.
  end type support_spec_t

contains

  !> Find the support with the largest reaction at the end of the running phase; none without a tool
  !> that carries a force.
  subroutine find_support(case, model, state, support)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(support_t), intent(out) :: support

    type(support_spec_t), allocatable :: spec(:)
    real(wp) :: reaction(3, model%n_node), sum_of_set
    integer, allocatable :: node(:)
    integer :: i, axis

    if (.not. any(state%tools%touches)) return
    reaction = reactions(model, state)
    support%tool = maxloc(norm2(state%tools%force, dim=1), dim=1)
    support%tool_force = norm2(state%tools%force(:, support%tool))
    spec = supports(case, model, state%phase)
    do i = 1, size(spec)
      node = nodes_of(model, spec(i)%set)
      if (.not. holds_free_sheet(model, spec(i), node)) cycle
      do axis = 1, 3
        if (.not. spec(i)%fix(axis)) cycle
        sum_of_set = sum(abs(reaction(axis, node)))
        if (allocated(support%name) .and. sum_of_set <= support%reaction) cycle
        support%name = spec(i)%name
        support%axis = axis
        support%reaction = sum_of_set
      end do
    end do
  end subroutine find_support

  !> Return the supports of a phase.
  pure function supports(case, model, phase) result(spec)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    integer, intent(in) :: phase
    type(support_spec_t), allocatable :: spec(:)

    integer :: i, k, n

    n = 0
    allocate (spec(size(case%boundary) + sum([(size(case%phase(i)%displace), i=1, phase)])))
    do i = 1, size(case%boundary)
      if (case%boundary(i)%pin > 0.0_wp) cycle
      n = n + 1
      spec(n)%name = case%boundary(i)%source%called()
      spec(n)%set = case%boundary(i)%set
      spec(n)%fix = case%boundary(i)%fix
    end do
    do i = 1, phase
      do k = 1, size(case%phase(i)%displace)
        associate (held => case%phase(i)%displace(k))
          if (held%is_coordinate .or. abs(held%value) > 0.0_wp) cycle
          if (.not. all(model%phase(phase)%prescribed(held%axis, nodes_of(model, held%set)))) cycle
          n = n + 1
          spec(n)%name = held%set
          spec(n)%set = held%set
          spec(n)%fix(held%axis) = .true.
        end associate
      end do
    end do
    spec = spec(:n)
  end function supports

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
  pure logical function holds_free_sheet(model, support, node)
    type(model_t), intent(in) :: model
    type(support_spec_t), intent(in) :: support
    integer, intent(in) :: node(:)

    real(wp) :: start(3, model%n_node)
    logical :: member(model%n_node), held(model%n_node)
    integer :: axis

    holds_free_sheet = .false.
    if (size(node) == 0) return
    member = .false.
    member(model%column(1, node)) = .true.
    if (count(member) > few) return
    member = .false.
    member(node) = .true.
    start = model%start_positions()
    do axis = 1, 3
      held = member .or. (model%fixed(axis, :) .and. support%fix(axis))
      associate (x => start(axis, :), tolerance => in_plane*model%thickness)
        if (any(abs(x(node) - x(node(1))) > tolerance)) cycle
        if (all(held .or. abs(x - x(node(1))) > tolerance)) return
      end associate
    end do
    holds_free_sheet = .true.
  end function holds_free_sheet

  !> Add a warning if a support carries a notable part of the largest force on a tool, and more than
  !> the weight of the sheet, which is what supports are for.
  subroutine add_support_note(model, state, support, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(support_t), intent(in) :: support
    type(message_list_t), intent(inout) :: notes

    if (.not. allocated(support%name)) return
    if (support%reaction <= max(notable*support%tool_force, weight(model, state%phase))) return
    call notes%add_new("W121", "at the end of phase '"//model%phase(state%phase)%name// &
        "' the support '"//support%name//"', which only holds the sheet in its place, carries "// &
        to_text(support%reaction, 3)//" N along "//axis_name(support%axis)//", "// &
        to_text(100.0_wp*support%reaction/support%tool_force, 3)//" % of the force on tool '"// &
        model%tool(support%tool)%name//"'")
  end subroutine add_support_note

  !> Return the weight of the sheet at the end of a phase, N.
  pure real(wp) function weight(model, phase)
    type(model_t), intent(in) :: model
    integer, intent(in) :: phase

    integer :: i, s

    weight = 0.0_wp
    do s = 1, size(model%load_set)
      if (model%load_set(s)%name /= gravity_name) cycle
      do i = 1, phase
        associate (loads => model%phase(i)%loads)
          if (.not. loads%keeps(s)) weight = norm2(loads%final(:, s))
        end associate
      end do
    end do
  end function weight

end module dd3_run_support_load
