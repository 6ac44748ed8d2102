!> Checks that need several values of the case at once. Blocks that did not pass the earlier checks
!> are left out.
module dd3_input_cross_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : to_text
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t, blank_spec_t, node_set_spec_t, material_spec_t, &
      limits_spec_t, fields_every, fields_at
  implicit none
  private
  public :: cross_check

contains

  !> Checks everything but the phases.
  subroutine cross_check(case, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    integer :: i, before

    do i = 1, size(case%blank)
      if (case%blank(i)%source%valid) call check_blank(case%blank(i), errors)
    end do
    do i = 1, size(case%set)
      if (case%set(i)%source%valid) call check_set(case%set(i), errors)
    end do
    do i = 1, size(case%material)
      if (case%material(i)%source%valid) call check_material(case%material(i), errors)
    end do
    call check_history_names(case, errors)
    do i = 1, case%deck%n_block
      if (.not. case%deck%block(i)%valid) cycle
      select case (case%deck%block(i)%keyword)
      case ("limits")
        call check_limits(case%limits, case%deck%block(i), errors)
      case ("output")
        before = errors%count
        call check_output(case, case%deck%block(i), errors)
        if (errors%count == before) call check_travel(case, case%deck%block(i), errors)
      end select
    end do
    do i = 1, size(case%phase)
      if (case%phase(i)%source%valid) call check_limits(case%phase(i)%limits, &
          case%phase(i)%source, errors)
    end do
  end subroutine cross_check

  !> Checks a blank's gradings and skew.
  subroutine check_blank(blank, errors)
    !> The blank.
    type(blank_spec_t), intent(in) :: blank
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: shift, room
    integer :: before

    before = errors%count
    call check_grading(blank%source, "grading_x", blank%divisions(1), errors)
    call check_grading(blank%source, "grading_y", blank%divisions(2), errors)
    call check_grading(blank%source, "grading_z", blank%divisions(3), errors)
    if (product(real(blank%divisions, wp)) > 5.0e6_wp) then
      call errors%push_input(blank%source%at("divisions"), &
          "there would be more than 5 million elements")
    end if
    if (errors%count > before .or. blank%divisions(1) < 2) return
    associate (x => blank%grading_x, n => blank%divisions(1))
      shift = 0.5_wp*abs(blank%skew)/real(n, wp)
      room = min(x(1) - x(0), x(n) - x(n - 1))
      if (shift >= room) then
        call errors%push_input(blank%source%at("skew"), "skew = "//to_text(blank%skew)// &
            " folds the elements at the ends", "a magnitude below "// &
            to_text(2.0_wp*room*real(n, wp)))
      end if
    end associate
  end subroutine check_blank

  !> Checks a grading: one number per node line, rising from 0 to 1.
  subroutine check_grading(block, key, n, errors)
    !> The blank's block.
    type(block_t), intent(in) :: block
    !> The key.
    character(len=*), intent(in) :: key
    !> Number of elements.
    integer, intent(in) :: n
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: x(:)
    integer :: i, k

    if (.not. block%has(key)) return
    allocate (x, source=block%numbers(key))
    k = block%find(key)
    if (size(x) /= n + 1) then
      call errors%push_input(block%at(key), "there are "//to_text(size(x))//" abscissae for "// &
          to_text(n)//" elements", key//" = "//to_text(n + 1)//" numbers rising from 0 to 1")
      return
    end if
    if (abs(x(1)) > 0.0_wp) call errors%push_input(block%at(key), key//" does not begin with 0", &
        "0 ... 1")
    do i = 2, size(x)
      if (x(i) > x(i - 1)) cycle
      call errors%push_input(block%entry(k)%value(i)%at, key//" does not rise here", &
          "each number larger than the one before")
      return
    end do
    if (abs(x(n + 1) - 1.0_wp) > 0.0_wp) then
      call errors%push_input(block%entry(k)%value(n + 1)%at, key//" does not end with 1", "0 ... 1")
    end if
  end subroutine check_grading

  !> Checks that a set is chosen in one way.
  subroutine check_set(set, errors)
    !> The set.
    type(node_set_spec_t), intent(in) :: set
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: i

    i = count([set%source%has("plane"), set%source%has("box"), set%source%has("nodes"), &
        set%source%has("near")])
    if (i /= 1) then
      call errors%push_input(set%source%opened, "set '"//set%source%called()//"' is chosen in "// &
          to_text(i)//" ways", "one of plane, box, nodes, near; 'of' keeps another set's members")
    end if
    if (.not. set%source%has("box")) return
    do i = 1, 5, 2
      if (set%value(i + 1) >= set%value(i)) cycle
      call errors%push_input(set%source%entry(set%source%find("box"))%value(i)%at, &
          "the box is inside out", "box = x0 x1 y0 y1 z0 z1 with x0 <= x1, y0 <= y1, z0 <= z1")
      return
    end do
  end subroutine check_set

  !> Checks a material's directions.
  subroutine check_material(material, errors)
    !> The material.
    type(material_spec_t), intent(in) :: material
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    if (any(abs(material%frame) > 0.0_wp)) return
    call errors%push_input(material%source%at("rolling_direction"), &
        "rolling and normal direction vanish or are parallel", &
        "two directions square to each other")
  end subroutine check_material

  !> Checks the bounds of the factor r, where the block gives one of them.
  subroutine check_limits(limits, block, errors)
    !> The limits that hold.
    type(limits_spec_t), intent(in) :: limits
    !> The block.
    type(block_t), intent(in) :: block
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: key

    key = "r_min"
    if (.not. given(block, key)) key = "r_max"
    if (.not. given(block, key)) return
    if (limits%r_min%value <= limits%r_max%value) return
    call errors%push_input(block%at(key), "r_min = "//to_text(limits%r_min%value)// &
        " is larger than r_max = "//to_text(limits%r_max%value), "r_min <= r_max")
  end subroutine check_limits

  !> Whether a key was written, not filled in.
  pure logical function given(block, key)
    !> The block.
    type(block_t), intent(in) :: block
    !> The key.
    character(len=*), intent(in) :: key

    given = block%has(key)
    if (given) given = .not. block%entry(block%find(key))%defaulted
  end function given

  !> Checks when fields are written.
  subroutine check_output(case, block, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> The block.
    type(block_t), intent(in) :: block
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: i, k

    k = block%find("fields")
    associate (value => case%output%fields_value)
      if (case%output%fields == fields_every) then
        if (value(1) > 0.0_wp) return
        call errors%push_input(block%entry(k)%value(2)%at, "the interval is not positive", &
            "fields = every v mm, v > 0")
      else if (case%output%fields == fields_at) then
        do i = 1, size(value)
          if (i == 1 .and. value(1) >= 0.0_wp) cycle
          if (i > 1) then
            if (value(i) > value(i - 1)) cycle
          end if
          call errors%push_input(block%entry(k)%value(i + 1)%at, "the travels do not rise here", &
              "fields = at v1 v2 ..., 0 <= v1 < v2")
          return
        end do
      end if
    end associate
  end subroutine check_output

  !> Checks that there is travel where fields are to be written by it.
  subroutine check_travel(case, block, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> The output's block.
    type(block_t), intent(in) :: block
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    if (case%output%fields /= fields_every .and. case%output%fields /= fields_at) return
    if (anything_travels(case)) return
    call errors%push_input(block%at("fields"), &
        "fields by travel, and in no phase of this job does a tool control: nothing travels", &
        "fields = increments N where every phase has control = load")
  end subroutine check_travel

  !> Whether a tool controls one of the phases, as far as they can be read.
  pure logical function anything_travels(case)
    !> The case.
    type(case_t), intent(in) :: case

    integer :: i

    anything_travels = size(case%phase) == 0
    do i = 1, size(case%phase)
      if (case%phase(i)%control > 0 .or. .not. case%phase(i)%source%valid) anything_travels = .true.
    end do
  end function anything_travels

  !> Reports columns of the history table that would bear a tool's name.
  subroutine check_history_names(case, errors)
    !> The case.
    type(case_t), intent(in) :: case
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: i, j

    do i = 1, size(case%history)
      do j = 1, size(case%tool)
        if (case%history(i)%name /= case%tool(j)%name) cycle
        call errors%push_input(case%history(i)%source%named, "a tool is called '"// &
            case%tool(j)%source%called()//"' already: two columns would have one name", &
            "another name")
      end do
    end do
  end subroutine check_history_names

end module dd3_input_cross_check
