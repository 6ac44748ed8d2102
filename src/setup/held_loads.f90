! SPDX-License-Identifier: GPL-3.0-or-later
!> Loads on directions that supports or `displace` hold: there they do not act on the sheet.
module dd3_setup_held_loads
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : axis_name
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: check_loads, find_held_loads, held_load_t

  !> A component of a load that is held at some nodes of its set.
  type :: held_load_t
    !> Numbers of the phase, and of the load in it.
    integer :: phase = 0, load = 0
    !> Direction: 1, 2, 3.
    integer :: axis = 0
    !> Number of nodes held, of those held in all phases in which the load acts, and of all nodes
    !> of the set.
    integer :: held = 0, always_held = 0, n_node = 0
  end type held_load_t

contains

  !> Report loads along a direction that is held at all nodes of the set as long as they act.
  subroutine check_loads(model, case, errors)
    !> With its phases.
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    type(held_load_t), allocatable :: found(:)
    integer :: i

    call find_held_loads(model, case, found)
    do i = 1, size(found)
      if (found(i)%always_held < found(i)%n_node) cycle
      associate (load => case%phase(found(i)%phase)%load(found(i)%load), &
          axis => axis_name(found(i)%axis))
        call errors%push_input(load%at, "the load along "//axis//" on '"//load%set// &
            "' has no effect: all its nodes are held in this direction", "free = "//load%set// &
            " "//axis//" where `displace` holds them, or no load in this direction", code="E125")
      end associate
    end do
    call check_pressures(model, case, errors)
  end subroutine check_loads

  !> Report pressures on sets without a face.
  subroutine check_pressures(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i, k, s

    do i = 1, size(case%phase)
      do k = 1, size(case%phase(i)%pressure)
        associate (pressure => case%phase(i)%pressure(k))
          do s = 1, size(model%pressure_set)
            if (model%pressure_set(s)%name /= pressure%set) cycle
            if (size(model%pressure_set(s)%node, 2) == 0) call errors%push_input(pressure%at, &
                "the set '"//pressure%set//"' contains no face of the sheet", &
                "all nodes of at least one face on the boundary", code="E146")
          end do
        end associate
      end do
    end do
  end subroutine check_pressures

  !> Find the loads given in the phases that are held there in part or in whole.
  pure subroutine find_held_loads(model, case, found)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    type(held_load_t), allocatable, intent(out) :: found(:)

    type(held_load_t) :: this
    integer :: i, k, s, axis

    allocate (found(0))
    do i = 1, size(case%phase)
      do k = 1, size(case%phase(i)%load)
        do axis = 1, 3
          if (abs(case%phase(i)%load(k)%force(axis)) <= 0.0_wp) cycle
          do s = 1, size(model%load_set)
            if (model%load_set(s)%name /= case%phase(i)%load(k)%set) cycle
            associate (node => model%load_set(s)%node)
              this = held_load_t(i, k, axis, count(model%phase(i)%prescribed(axis, node)), &
                  count(held_throughout(model, i, s, axis)), size(node))
            end associate
            if (this%held > 0) found = [found, this]
          end do
        end do
      end do
    end do
  end subroutine find_held_loads

  !> Return the nodes of a set that are held along an axis in all phases in which a load on it acts.
  pure function held_throughout(model, number, set, axis) result(held)
    type(model_t), intent(in) :: model
    !> Number of the phase that gives the load, and of its set.
    integer, intent(in) :: number, set
    integer, intent(in) :: axis
    logical :: held(size(model%load_set(set)%node))

    integer :: i

    held = model%phase(number)%prescribed(axis, model%load_set(set)%node)
    do i = number + 1, size(model%phase)
      if (.not. model%phase(i)%loads%keeps(set)) return
      held = held .and. model%phase(i)%prescribed(axis, model%load_set(set)%node)
    end do
  end function held_throughout

end module dd3_setup_held_loads
