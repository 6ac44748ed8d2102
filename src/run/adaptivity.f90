! SPDX-License-Identifier: GPL-3.0-or-later
!> Adaptive refinement of the sheet in a run: which elements are divided and when.
!>
!> An element is divided before it comes to lie on a radius of a tool that turns by more than the
!> angle of the input over the length of the element, or that would enter it between its nodes by a
!> depth that is reported, as the exact surfaces of the tools tell: later the forces would change,
!> as the length of a chord is not that of its arc. What of a tool the sheet can meet soon is near
!> and has nearly the direction of the sheet, which must rotate to lie on the rest. As soon as an
!> element would meet such a radius in the next part of the travel, all that would in a longer part
!> are divided, so that the mesh changes a few times only. Where the sheet turns by more than the
!> angle without a tool, as where it bends freely, it is divided too; an increment in which it comes
!> to turn by far more is made again on the finer mesh. Elements of a sheet that yields in
!> compression, and that is not held on both faces, are divided if they are too long for its
!> wrinkles.
!>
!> Of several ranks every one refines the whole sheet, with the same marks, and then keeps its part
!> of a new division.
module dd3_run_adaptivity
  use dd3_base_error, only : error_list_t, error_t, fatal_error
  use dd3_base_kinds, only : pi, wp
  use dd3_base_ranks, only : broadcast_integers
  use dd3_input_case, only : case_t
  use dd3_model_edge_length, only : edge_lengths, longest_edge
  use dd3_model_model, only : model_t
  use dd3_model_redistribution, only : divide_model, move_state
  use dd3_model_refined_state, only : refined_state, sheet_of
  use dd3_model_sheet_compression, only : find_compressed
  use dd3_model_sheet_turn, only : turn_of_sheet, turn_of_tools_ahead
  use dd3_model_state, only : state_t
  use dd3_model_tolerances, only : notable_depth
  use dd3_settings_adaptive, only : adaptive_spec_t
  use dd3_setup_model, only : rebuild_model
  use dd3_sheet_grid, only : grid_t, new_grid
  use dd3_sheet_marks, only : mark_balanced
  use dd3_sheet_refine, only : refine_sheet
  use dd3_sheet_refinement, only : refinement_t
  use dd3_sheet_sheet, only : sheet_t
  use dd3_tools_turn_field, only : new_turn_field, turn_field_t
  implicit none
  private
  public :: adaptivity_t, ahead, most_returns, new_adaptivity

  !> Travel of the tools within which a radius makes an element be divided, and that within which
  !> all are divided then, over the length of the element.
  real(wp), parameter :: near = 0.2_wp, ahead = 0.7_wp
  !> Rotation of the sheet in the one travel and in the other, over the angle.
  real(wp), parameter :: near_rotation = 1.0_wp, rotation_ahead = 2.0_wp
  !> Turn over the angle of the input at which the mesh is changed, and that of the sheet at which
  !> an increment is made again. All elements above the angle are divided then, as they come above
  !> it one after another when they are stretched and bent.
  real(wp), parameter :: over = 1.15_wp, too_far = 1.3_wp
  !> Length of an element above which it cannot show the wrinkles of a compressed sheet, in
  !> thicknesses.
  real(wp), parameter :: longest = 8.0_wp
  !> Relative difference of lengths that are equal.
  real(wp), parameter :: round_off = 1.0e-6_wp
  !> Largest number of increments made again one after another.
  integer, parameter :: most_returns = 3

  !> Refinement of a run.
  type :: adaptivity_t
    !> Settings, with the angle in rad.
    type(adaptive_spec_t) :: spec
    !> Turn of each tool over the edges of the elements of all levels, `(n_tool)`.
    type(turn_field_t), allocatable :: field(:)
    !> Elements to be divided before the next increment, `(n_element)`; not allocated without one.
    logical, allocatable :: waiting(:)
    !> Increments made again since the last one that was accepted.
    integer :: returns = 0
    !> Elements that the last increment bends by more than the angle though it was accepted, as it
    !> had been made again often enough, and the largest angle, rad.
    integer :: n_late = 0
    real(wp) :: late_turn = 0.0_wp
  contains
    procedure :: judge
    procedure :: find_marks
    procedure :: refine
    procedure :: tool_limit
  end type adaptivity_t

contains

  !> Prepare the refinement of a run.
  subroutine new_adaptivity(self, model, spec)
    type(adaptivity_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(adaptive_spec_t), intent(in) :: spec

    integer :: l, coarsest, tool

    self%spec = spec
    self%spec%angle = spec%angle*pi/180.0_wp
    if (spec%levels == 0) return
    allocate (self%field(model%n_tool))
    associate (length => model%undivided_length)
      coarsest = -ceiling(log(longest_edge(model)/length)/log(2.0_wp) - round_off)
      do tool = 1, model%n_tool
        call new_turn_field(self%field(tool), model%tool(tool)%surface, &
            [(length*0.5_wp**l, l=spec%levels, coarsest, -1)])
      end do
    end associate
  end subroutine new_adaptivity

  !> Whether elements may be divided in the running phase: not once the tools leave the sheet.
  pure logical function may_refine(self, model, state)
    type(adaptivity_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    may_refine = self%spec%levels > 0
    if (may_refine) may_refine = .not. (model%phase(state%phase)%unloaded .or. &
        any(model%phase(state%phase)%withdrawn))
  end function may_refine

  !> Return which elements may be divided: their parts are not shorter than the least length.
  pure function divisible(self, model, state)
    type(adaptivity_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    logical :: divisible(model%n_element)

    divisible = 0.5_wp*edge_lengths(model, state%x) >= (1.0_wp - round_off)*self%spec%size
    if (allocated(model%level)) divisible = divisible .and. model%level < self%spec%levels
  end function divisible

  !> Find the elements that are to be divided before the next increment.
  subroutine find_marks(self, model, state, marked)
    class(adaptivity_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Committed state.
    type(state_t), intent(in) :: state
    logical, allocatable, intent(out) :: marked(:)

    logical, dimension(model%n_element) :: free, compressed, yielding, too_long
    real(wp), dimension(model%n_element) :: of_sheet, of_tools, limit

    allocate (marked(model%n_element), source=.false.)
    if (.not. may_refine(self, model, state)) return
    if (allocated(self%waiting)) call move_alloc(self%waiting, marked)
    free = divisible(self, model, state)
    associate (angle => self%spec%angle)
      call turn_of_sheet(model, state%x, of_sheet)
      call turn_of_tools_ahead(model, state, self%field, free, near, near_rotation*angle, of_tools)
      call find_compressed(model, state, compressed, yielding)
      too_long = edge_lengths(model, state%x) > longest*model%thickness
      limit = self%tool_limit(edge_lengths(model, state%x), model%thickness)
      if (.not. any(agreed_marks(marked .or. (free .and. (of_sheet > over*angle .or. &
          of_tools > over*limit .or. (too_long .and. yielding)))))) return
      call turn_of_tools_ahead(model, state, self%field, free, ahead, rotation_ahead*angle, &
          of_tools)
      marked = agreed_marks(marked .or. (free .and. (of_sheet > angle .or. of_tools > limit .or. &
          (too_long .and. compressed))))
    end associate
  end subroutine find_marks

  !> Return the turn of a tool above which an element is divided, rad: the angle of the input, or
  !> the turn whose depth between the nodes, turn*length/8, is `notable_depth` once it is exceeded
  !> by `over`.
  elemental real(wp) function tool_limit(self, length, thickness) result(limit)
    class(adaptivity_t), intent(in) :: self
    !> Mean edge of the element, and thickness of the sheet, mm.
    real(wp), intent(in) :: length, thickness

    limit = min(self%spec%angle, 8.0_wp*notable_depth*thickness/(over*length))
  end function tool_limit

  !> Judge a converged increment: too late if the sheet turns by far more than the angle over an
  !> element that may be divided; then all above the angle are divided before it is made again. It
  !> is not too late after `most_returns` repetitions.
  subroutine judge(self, model, trial, too_late)
    class(adaptivity_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    logical, intent(out) :: too_late

    logical :: marked(model%n_element)
    real(wp) :: turn(model%n_element)

    too_late = .false.
    self%n_late = 0
    if (.not. may_refine(self, model, trial)) then
      self%returns = 0
      return
    end if
    call turn_of_sheet(model, trial%x, turn)
    marked = turn > self%spec%angle .and. divisible(self, model, trial)
    if (.not. any(agreed_marks(marked .and. turn > too_far*self%spec%angle))) then
      self%returns = 0
    else if (self%returns < most_returns) then
      too_late = .true.
      self%waiting = agreed_marks(marked)
      self%returns = self%returns + 1
    else
      self%n_late = count(marked)
      self%late_turn = maxval(turn, marked)
      self%returns = 0
    end if
  end subroutine judge

  !> Return the marks of rank 0, of what all ranks evaluate from the same data.
  function agreed_marks(marked) result(agreed)
    logical, intent(in) :: marked(:)
    logical :: agreed(size(marked))

    integer :: number(size(marked))

    number = merge(1, 0, marked)
    call broadcast_integers(0, size(number), number)
    agreed = number > 0
  end function agreed_marks

  !> Divide marked elements: the model and the state on the finer sheet.
  subroutine refine(self, case, marked, model, state, error)
    class(adaptivity_t), intent(in) :: self
    type(case_t), intent(in) :: case
    !> Gets those that are divided with them; none are if all have the highest level.
    logical, intent(inout) :: marked(:)
    type(model_t), intent(inout) :: model
    !> Committed state; its internal forces are left to the caller.
    type(state_t), intent(inout) :: state
    !> Set if the refined sheet is refused.
    type(error_t), allocatable, intent(out) :: error

    type(model_t) :: old_model
    type(state_t) :: old
    type(sheet_t) :: sheet, refined
    type(grid_t) :: grid
    type(refinement_t) :: origin
    type(error_list_t) :: errors
    logical :: regular, divided

    sheet = sheet_of(model, state)
    call new_grid(grid, sheet%mesh, regular)  ! in layers, or the set-up would have refused it
    call mark_balanced(sheet%mesh, grid, self%spec%levels, marked)
    if (.not. any(marked)) return
    divided = model%part%divided
    if (divided) then
      call make_whole(case, model, state)
      sheet = sheet_of(model, state)
    end if
    allocate (sheet%earlier(3, model%n_node, merge(2, 1, allocated(model%x_start))))
    sheet%earlier(:, :, 1) = state%start%x
    if (allocated(model%x_start)) sheet%earlier(:, :, 2) = model%x_start
    call refine_sheet(sheet, grid, model%element, marked, refined, origin)
    refined%mesh%mesh_number = model%mesh_number + 1
    refined%mesh%n_first_node = model%n_first_node
    old_model = model
    old = state
    sheet = refined
    sheet%x = sheet%mesh%x
    if (allocated(model%x_start)) sheet%x = refined%earlier(:, :, 2)
    call rebuild_model(model, case, sheet, errors)
    if (errors%count > 0) then
      call fatal_error(error, "the refined sheet: "//errors%item(1)%message, errors%item(1)%code)
      return
    end if
    call refined_state(old_model, old, model, refined, origin, state)
    if (.not. divided) return
    old_model = model
    call divide_model(model)
    old = state
    call move_state(old_model, old, model, state)
  end subroutine refine

  !> Make a divided model and its state whole on every rank.
  subroutine make_whole(case, model, state)
    type(case_t), intent(in) :: case
    type(model_t), intent(inout) :: model
    type(state_t), intent(inout) :: state

    type(error_list_t) :: none
    type(model_t) :: part
    type(state_t) :: of_part
    type(sheet_t) :: sheet

    part = model
    of_part = state
    sheet = sheet_of(model, state)
    sheet%mesh%mesh_number = model%mesh_number
    sheet%mesh%n_first_node = model%n_first_node
    sheet%x = model%start_positions()
    ! It has been built on this sheet before.
    call rebuild_model(model, case, sheet, none)
    call move_state(part, of_part, model, state)
  end subroutine make_whole

end module dd3_run_adaptivity
