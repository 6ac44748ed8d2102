! SPDX-License-Identifier: GPL-3.0-or-later
!> Comparison of states, a visitor of `visit_state`.
module state_difference
  use dd3_base_kinds, only : wp
  use dd3_model_state, only : state_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_model_state_walk, only : visit_state
  implicit none
  private
  public :: first_difference

  !> Visitor that gathers names and values.
  type, extends(state_visitor_t) :: gatherer_t
    !> Names of the components, and where the values of each one end.
    character(len=32), allocatable :: name(:)
    integer, allocatable :: last(:)
    real(wp), allocatable :: value(:)
  contains
    procedure :: reals => gather_reals
    procedure :: integers => gather_integers
  end type gatherer_t

contains

  !> Return the name of the first component in which two states differ, bit for bit; empty where
  !> they are equal.
  function first_difference(a, b) result(name)
    type(state_t), intent(in) :: a, b
    character(len=:), allocatable :: name

    type(gatherer_t) :: left, right
    integer :: i, first

    call gather(a, left)
    call gather(b, right)
    name = ""
    first = 1
    do i = 1, size(left%last)
      name = trim(left%name(i))
      if (left%last(i) /= right%last(i)) return
      if (any(transfer(left%value(first:left%last(i)), [0]) /= &
          transfer(right%value(first:right%last(i)), [0]))) return
      first = left%last(i) + 1
    end do
    name = ""
  end function first_difference

  !> Gather the values of a state.
  subroutine gather(state, values)
    type(state_t), intent(in) :: state
    type(gatherer_t), intent(out) :: values

    type(state_t) :: copy

    allocate (values%name(0), values%last(0), values%value(0))
    copy = state
    call visit_state(copy, values)
  end subroutine gather

  !> Append a component of real numbers.
  subroutine gather_reals(self, name, n, values)
    class(gatherer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    real(wp), intent(inout) :: values(n)

    self%value = [self%value, values]
    self%name = [character(len=len(self%name)) :: self%name, name]
    self%last = [self%last, size(self%value)]
  end subroutine gather_reals

  !> Append a component of integers, which are exact as real numbers.
  subroutine gather_integers(self, name, n, values)
    class(gatherer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    integer, intent(inout) :: values(n)

    real(wp) :: number(n)

    number = real(values, wp)
    call self%reals(name, n, number)
  end subroutine gather_integers

end module state_difference
