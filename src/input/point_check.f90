! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of the single-point runs: the prescribed quantities, and that no deformation gradient
!> inverts the material on its path.
module dd3_input_point_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : join, lower_case, same_name, to_text, upper_case
  use dd3_input_case, only : case_t, point_spec_t, gradient_values
  implicit none
  private
  public :: check_points

  !> Components in the order of the input.
  character(len=2), parameter :: component(6) = ["11", "22", "33", "12", "23", "13"]
  !> Blocks that cannot be combined with a point.
  character(len=5), parameter :: of_a_sheet(5) = [character(len=5) :: "blank", "mesh", "start", &
      "trim", "phase"]
  !> Blocks that have an effect on a point.
  character(len=9), parameter :: of_a_point(6) = [character(len=9) :: "title", "include", &
      "parameter", "material", "point", "output"]
  !> Largest strain of a target, and largest number of steps of a run.
  real(wp), parameter :: largest_strain = 10.0_wp, most_steps = 1.0e7_wp
  !> Largest number of steps at which a gradient is checked.
  integer, parameter :: most_checked = 1000

contains

  subroutine check_points(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i, before

    if (size(case%point) == 0) return
    call check_company(case, errors)
    do i = 1, size(case%point)
      before = errors%count
      call check_control(case%point(i), errors)
      if (.not. case%point(i)%source%valid) cycle
      call check_drive(case%point(i), errors)
      if (errors%count > before) cycle
      call check_goals(case%point(i), errors)
      call check_durations(case, case%point(i), errors)
    end do
  end subroutine check_points

  !> Report the blocks of a sheet; if there are none, report blocks without effect, except those
  !> filled in by default, which have no file.
  subroutine check_company(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i, before

    before = errors%count
    associate (block => case%deck%block(:case%deck%n_block))
      do i = 1, size(block)
        if (any(of_a_sheet == block(i)%keyword)) call errors%push_input(block(i)%opened, &
            "*"//upper_case(block(i)%keyword)//" cannot be combined with *POINT", &
            "*POINT in a file of its own", code="E124")
      end do
      if (errors%count > before) return
      do i = 1, size(block)
        if (any(of_a_point == block(i)%keyword) .or. .not. block(i)%valid) cycle
        if (.not. allocated(block(i)%opened%file)) cycle
        call errors%push_input(block(i)%opened, "*"//upper_case(block(i)%keyword)// &
            " has no effect on single points", "one of: *"//upper_case(join(of_a_point, " *")), &
            code="E125")
      end do
    end associate
  end subroutine check_company

  !> Check that either control and target, or gradient are given.
  subroutine check_drive(point, errors)
    type(point_spec_t), intent(in) :: point
    type(error_list_t), intent(inout) :: errors

    associate (block => point%source)
      if (block%has("gradient") .and. block%has("target")) then
        call errors%push_input(block%at("gradient"), "gradient and target cannot be combined", &
            "one of the two", code="E124")
      else if (block%has("gradient") .and. block%has("control")) then
        call errors%push_input(block%at("control"), "control and gradient cannot be combined", &
            "gradient alone, or control and target", code="E124")
      else if (block%has("target") .and. .not. block%has("control")) then
        call errors%push_input(block%at("target"), "target requires control", &
            "control = e11 s22 s33 s12 s23 s13", code="E121")
      else if (.not. (block%has("target") .or. block%has("gradient"))) then
        call errors%push_input(block%opened, "nothing is prescribed for the point '"// &
            block%called()//"'", "control and target, or gradient", code="E121")
      end if
    end associate
  end subroutine check_drive

  !> Check the words of control; other errors of the point do not matter.
  subroutine check_control(point, errors)
    type(point_spec_t), intent(in) :: point
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: word
    integer :: i, k

    k = point%source%find("control")
    if (k == 0) return
    if (.not. point%source%entry(k)%valid) return
    do i = 1, size(component)
      word = lower_case(point%source%entry(k)%value(i)%text)
      if (word == "e"//component(i) .or. word == "s"//component(i)) cycle
      call errors%push_input(point%source%entry(k)%value(i)%at, "expected e"//component(i)// &
          " or s"//component(i)//", got '"//word//"'", "control = e11 s22 s33 s12 s23 s13", &
          code="E114")
    end do
  end subroutine check_control

  !> Check the targets of a point.
  subroutine check_goals(point, errors)
    type(point_spec_t), intent(in) :: point
    type(error_list_t), intent(inout) :: errors

    real(wp) :: from(gradient_values), steps
    integer :: i

    from = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]
    steps = 0.0_wp
    do i = 1, size(point%goal)
      steps = steps + real(point%goal(i)%steps, wp)
      if (steps > most_steps) then
        call errors%push_input(point%goal(i)%at, "more than 10 million steps", &
            "at most 10 million in a run", code="E133")
        return
      end if
      if (point%by_gradient) then
        call check_gradient(point, i, from, errors)
        from = point%goal(i)%value
      else if (any(abs(point%goal(i)%value) > largest_strain .and. .not. point%by_stress)) then
        call errors%push_input(point%goal(i)%at, "a strain is larger than "// &
            to_text(largest_strain), "logarithmic strains: 0.1 is about 10 %", code="E133")
      end if
    end do
  end subroutine check_goals

  !> Check the times of the targets, which a law of the strain rate needs.
  subroutine check_durations(case, point, errors)
    type(case_t), intent(in) :: case
    type(point_spec_t), intent(in) :: point
    type(error_list_t), intent(inout) :: errors

    integer :: n

    associate (block => point%source)
      if (block%has("duration")) then
        n = size(block%numbers("duration"))
        if (n /= 1 .and. n /= size(point%goal)) call errors%push_input(block%at("duration"), &
            to_text(n)//" times are given, and "//to_text(size(point%goal))//" targets", &
            "one time for all, or one for each", code="E164")
      else if (case%material(point%material)%source%has("rate")) then
        if (same_name(case%material(point%material)%rate%name, "none")) return
        call errors%push_input(block%opened, "the point '"//block%called()// &
            "' has no time, but its material has a law of the strain rate", &
            "duration = seconds of each target", code="E163")
      end if
    end associate
  end subroutine check_durations

  !> Check that the volume stays positive on the path to gradient i.
  subroutine check_gradient(point, i, from, errors)
    type(point_spec_t), intent(in) :: point
    integer, intent(in) :: i
    !> Gradient at the start of the path.
    real(wp), intent(in) :: from(gradient_values)
    type(error_list_t), intent(inout) :: errors

    real(wp) :: fraction
    integer :: k, n

    n = min(point%goal(i)%steps, most_checked)
    do k = 1, n
      fraction = real(k, wp)/real(n, wp)
      if (volume(from + fraction*(point%goal(i)%value - from)) > 0.0_wp) cycle
      call errors%push_input(point%goal(i)%at, "det F is not positive "// &
          trim(merge("on the path", "at the end ", k < n)), &
          "F11 F12 F13 F21 F22 F23 F31 F32 F33 with a positive determinant on the whole path", &
          code="E135")
      return
    end do
  end subroutine check_gradient

  !> Return the determinant of a matrix given row by row.
  pure real(wp) function volume(f)
    real(wp), intent(in) :: f(gradient_values)

    volume = f(1)*(f(5)*f(9) - f(6)*f(8)) - f(2)*(f(4)*f(9) - f(6)*f(7)) &
        + f(3)*(f(4)*f(8) - f(5)*f(7))
  end function volume

end module dd3_input_point_check
