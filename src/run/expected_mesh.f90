! SPDX-License-Identifier: GPL-3.0-or-later
!> Estimate of the number of elements at the end of a run that refines its mesh, from the surfaces
!> of the tools alone.
!>
!> At the end of a phase the tools are at their places of the input (those that are pressed are left
!> out), and the sheet is a membrane between them: the least sum of squares of the slopes of its
!> height z over the plane, on a grid with half the length of the undivided elements. Parts of it
!> count as divided where a tool turns by more than the limit of the run within the reach of an
!> element, and walls steeper than 45 degrees, whose material has come over such a radius. Its area
!> is that of the blank. The largest number of all phases counts.
module dd3_run_expected_mesh
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : newline, to_text
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : face_normal
  use dd3_model_state, only : state_t
  use dd3_process_phase_start, only : begin_phase
  use dd3_run_adaptivity, only : adaptivity_t, ahead, new_adaptivity
  use dd3_run_membrane, only : bound_by_tools, membrane_t, new_membrane, slope_at, span_membrane
  use dd3_tools_placement, only : placement_t
  use dd3_tools_turn_field, only : turn_over
  implicit none
  private
  public :: expected_mesh_t, new_expected_mesh

  !> Slope of a wall, and least component of the sheet's normal along z.
  real(wp), parameter :: wall = 1.0_wp, least_upright = 0.9_wp

  !> Expected numbers of elements.
  type :: expected_mesh_t
    !> Whether elements may be divided.
    logical :: refines = .false.
    !> In the first increment, and at the end; 0 there if it is not estimated.
    integer :: at_start = 0, at_end = 0
  contains
    procedure :: report
    procedure :: mean_number
  end type expected_mesh_t

contains

  !> Estimate the numbers of elements.
  subroutine new_expected_mesh(self, case, model, state)
    type(expected_mesh_t), intent(out) :: self
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Initial state, or that of a restart.
    type(state_t), intent(in) :: state

    type(adaptivity_t) :: adaptivity
    type(state_t) :: moved
    type(membrane_t) :: grid
    real(wp), allocatable :: start(:, :)
    integer :: number, tool

    self%at_start = model%n_element
    self%refines = case%adaptive%levels > 0
    if (.not. self%refines) return
    call new_adaptivity(adaptivity, model, case%adaptive)
    self%at_start = elements_at_start(adaptivity, case, model, state)
    if (.not. is_plain(model)) return
    self%at_end = self%at_start
    moved = state
    do number = state%phase, size(model%phase)
      associate (phase => model%phase(number))
        if (phase%unloaded .or. any(phase%withdrawn)) exit
        start = moved%tools%displacement
        do tool = 1, model%n_tool
          if (.not. phase%pressed(tool)) moved%tools%displacement(:, tool) = &
              start(:, tool) + phase%tool_motion(tool, start)
        end do
      end associate
      call new_membrane(grid, model, state%x)
      call bound_by_tools(grid, model, moved, number)
      call span_membrane(grid)
      self%at_end = max(self%at_end, count_elements(grid, model, moved, number, adaptivity))
    end do
  end subroutine new_expected_mesh

  !> Return the numbers as text for the user; empty without refinement.
  function report(self) result(text)
    class(expected_mesh_t), intent(in) :: self
    character(len=:), allocatable :: text

    text = ""
    if (.not. self%refines) return
    text = "refinement: "//to_text(self%at_start)//" elements in the first increment, "
    if (self%at_end > 0) then
      text = text//"about "//to_text(two_digits(self%at_end))//" at the end of the forming"
    else
      text = text//"unknown later: the sheet does not lie across z, or tools turn"
    end if
    text = text//newline
  end function report

  !> Return a number rounded to two digits.
  pure integer function two_digits(number)
    integer, intent(in) :: number

    integer :: unit

    unit = 10**max(0, floor(log10(real(number, wp))) - 1)
    two_digits = unit*nint(real(number, wp)/real(unit, wp))
  end function two_digits

  !> Return the mean number of elements in the run.
  pure real(wp) function mean_number(self)
    class(expected_mesh_t), intent(in) :: self

    mean_number = 0.5_wp*real(self%at_start + max(self%at_start, self%at_end), wp)
  end function mean_number

  !> Whether the sheet lies across z and no tool turns.
  pure logical function is_plain(model)
    type(model_t), intent(in) :: model

    real(wp) :: x(3, model%n_node)
    integer :: f, t

    x = model%start_positions()
    is_plain = .not. any([(model%turns(t), t=1, model%n_tool)])
    do f = 1, size(model%contact_face)
      if (.not. is_plain) return
      associate (corner => x(:, model%face%corner(:, model%contact_face(f))), &
          normal => face_normal(x(:, model%face%corner(:, model%contact_face(f)))))
        is_plain = size(corner, 2) == 4 .and. abs(normal(3)) > least_upright
      end associate
    end do
  end function is_plain

  !> Return the number of elements with which the first increment is made: they are divided as in
  !> the run.
  integer function elements_at_start(adaptivity, case, model, state) result(n)
    type(adaptivity_t), intent(inout) :: adaptivity
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    type(model_t) :: refined
    type(state_t) :: on_refined
    type(error_t), allocatable :: error
    logical, allocatable :: marked(:)
    integer :: level

    refined = model
    on_refined = state
    if (.not. state%begun) call begin_phase(refined, state%phase, on_refined)
    do level = 1, adaptivity%spec%levels
      n = refined%n_element
      call adaptivity%find_marks(refined, on_refined, marked)
      if (.not. any(marked)) return
      call adaptivity%refine(case, marked, refined, on_refined, error)
      if (allocated(error)) return
    end do
    n = refined%n_element
  end function elements_at_start

  !> Return the number of elements of the membrane.
  integer function count_elements(self, model, state, number, adaptivity) result(n)
    type(membrane_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: number
    type(adaptivity_t), intent(in) :: adaptivity

    real(wp) :: total, area, divided(0:adaptivity%spec%levels - 1), steep, slope, length
    integer :: i, j, level

    length = longer_edge(model)
    total = 0.0_wp
    divided = 0.0_wp
    steep = 0.0_wp
    do j = 1, size(self%z, 2)
      do i = 1, size(self%z, 1)
        if (.not. self%inside(i, j)) cycle
        slope = slope_at(self, i, j)
        area = sqrt(1.0_wp + slope**2)
        total = total + 1.0_wp
        if (slope > wall) then
          steep = steep + area
          cycle
        end if
        do level = 0, ubound(divided, 1)
          if (meets_turn(self, i, j, level)) divided(level) = divided(level) + area
        end do
      end do
    end do
    where (divided > 0.0_wp) divided = divided + steep
    n = nint(real(model%n_element, wp)/mean_parts(model)*(1.0_wp + &
        sum([(3.0_wp*4.0_wp**level*min(1.0_wp, divided(level)/total), &
        level=0, ubound(divided, 1))])))

  contains

    !> Whether a tool turns by more than the limit within the reach of an element of a level.
    logical function meets_turn(self, i, j, level) result(meets)
      type(membrane_t), intent(in) :: self
      integer, intent(in) :: i, j, level

      type(placement_t) :: placement
      real(wp) :: x(3), reach
      integer :: tool

      meets = .false.
      x = [self%corner + (real([i, j], wp) - 0.5_wp)*self%step, self%z(i, j)]
      reach = 0.5_wp*self%step + model%undivided_length*0.5_wp**level*(ahead + 0.5_wp)
      do tool = 1, model%n_tool
        if (.not. model%phase(number)%acts(tool)) cycle
        placement = state%placement(tool)
        meets = turn_over(adaptivity%field(tool), placement%to_tool(x), reach, &
            length*0.5_wp**level) &
            > adaptivity%tool_limit(model%undivided_length*0.5_wp**level, model%thickness)
        if (meets) return
      end do
    end function meets_turn

  end function count_elements

  !> Return the mean longer edge of the undivided elements, mm.
  pure real(wp) function longer_edge(model)
    type(model_t), intent(in) :: model

    real(wp) :: edge(2, model%n_element), weight(model%n_element)
    integer :: e

    weight = 1.0_wp
    if (allocated(model%level)) weight = 0.25_wp**model%level
    do e = 1, model%n_element
      associate (x => model%x0(:, model%connectivity(:4, e)))
        edge(:, e) = 0.5_wp*[norm2(x(:, 2) - x(:, 1) + x(:, 3) - x(:, 4)), &
            norm2(x(:, 4) - x(:, 1) + x(:, 3) - x(:, 2))]
      end associate
    end do
    longer_edge = sum(maxval(edge, dim=1)*sqrt(weight))/sum(weight)
  end function longer_edge

  !> Return the mean number of parts into which the elements have been divided already, in the
  !> undivided ones.
  pure real(wp) function mean_parts(model)
    type(model_t), intent(in) :: model

    mean_parts = 1.0_wp
    if (allocated(model%level)) then
      mean_parts = real(model%n_element, wp)/sum(0.25_wp**model%level)
    end if
  end function mean_parts

end module dd3_run_expected_mesh
