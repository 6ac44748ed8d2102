! SPDX-License-Identifier: GPL-3.0-or-later
!> Operation on the components of a state, which are passed to it with their names: restart
!> (output/restart.f90) and the tests are such visitors.
module dd3_model_state_visitor
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: state_visitor_t

  !> Operation on the components of a state; it can change them.
  type, abstract :: state_visitor_t
  contains
    procedure(visit_reals_interface), deferred :: reals
    procedure(visit_integers_interface), deferred :: integers
    !> Components that hold values of the elements, or of the contact points, of this rank; these
    !> are consecutive.
    procedure :: reals_of_items
    procedure :: integers_of_items
    procedure :: logicals
    procedure :: logicals_of_items
    procedure :: one_real
    procedure :: one_integer
    procedure :: one_logical
  end type state_visitor_t

  abstract interface
    !> Visit a component of real numbers.
    subroutine visit_reals_interface(self, name, n, values)
      import :: state_visitor_t, wp
      class(state_visitor_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      !> The component in array element order.
      real(wp), intent(inout) :: values(n)
    end subroutine visit_reals_interface

    !> Visit a component of integers; logical components are passed as 0 and 1.
    subroutine visit_integers_interface(self, name, n, values)
      import :: state_visitor_t
      class(state_visitor_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      !> The component in array element order.
      integer, intent(inout) :: values(n)
    end subroutine visit_integers_interface
  end interface

contains

  !> Visit a component of logical values as integers 0 and 1.
  subroutine logicals(self, name, n, values)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    logical, intent(inout) :: values(n)

    integer, allocatable :: number(:)

    number = merge(1, 0, values)
    call self%integers(name, n, number)
    values = number /= 0
  end subroutine logicals

  !> Visit real numbers of elements or contact points as any others.
  subroutine reals_of_items(self, item, name, n, n_item, values)
    class(state_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items.
    integer, intent(in) :: n, n_item
    real(wp), intent(inout) :: values(n, n_item)

    if (item > 0) call self%reals(name, size(values), values)
  end subroutine reals_of_items

  !> Visit integers of elements or contact points as any others.
  subroutine integers_of_items(self, item, name, n, n_item, values)
    class(state_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items.
    integer, intent(in) :: n, n_item
    integer, intent(inout) :: values(n, n_item)

    if (item > 0) call self%integers(name, size(values), values)
  end subroutine integers_of_items

  !> Visit logical values of elements or contact points as integers 0 and 1.
  subroutine logicals_of_items(self, item, name, n, n_item, values)
    class(state_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items.
    integer, intent(in) :: n, n_item
    logical, intent(inout) :: values(n, n_item)

    integer, allocatable :: number(:, :)

    number = merge(1, 0, values)
    call self%integers_of_items(item, name, n, n_item, number)
    values = number /= 0
  end subroutine logicals_of_items

  !> Visit a scalar.
  subroutine one_real(self, name, value)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(inout) :: value

    real(wp) :: values(1)

    values = value
    call self%reals(name, 1, values)
    value = values(1)
  end subroutine one_real

  !> Visit a scalar.
  subroutine one_integer(self, name, value)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(inout) :: value

    integer :: values(1)

    values = value
    call self%integers(name, 1, values)
    value = values(1)
  end subroutine one_integer

  !> Visit a scalar.
  subroutine one_logical(self, name, value)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    logical, intent(inout) :: value

    integer :: number

    number = merge(1, 0, value)
    call self%one_integer(name, number)
    value = number /= 0
  end subroutine one_logical

end module dd3_model_state_visitor
