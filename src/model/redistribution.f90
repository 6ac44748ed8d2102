! SPDX-License-Identifier: GPL-3.0-or-later
!> Division of a model and its state among the ranks, and back: a refinement is made on the whole
!> sheet by every rank, and what follows on the parts of a new division. Each rank has a copy of the
!> whole state meanwhile.
module dd3_model_redistribution
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_reals
  use dd3_model_contact_points, only : keep_own_points, set_point_owners
  use dd3_model_model, only : model_t
  use dd3_model_part_visitor, only : part_visitor_t
  use dd3_model_state, only : new_state, state_t
  use dd3_model_state_walk, only : visit_state
  implicit none
  private
  public :: divide_model, move_state

  !> Values of a component of the state.
  type :: component_t
    real(wp), allocatable :: value(:)
  end type component_t

  !> Visitor with the components of a whole state as real numbers, in the order of the walk.
  type, extends(part_visitor_t), abstract :: mover_t
    type(component_t), allocatable :: component(:)
    !> Components visited.
    integer :: n = 0
  contains
    procedure :: integers
  end type mover_t

  !> Visitor that takes the components from a state.
  type, extends(mover_t) :: taker_t
  contains
    procedure :: reals => take_reals
    procedure :: reals_of_items => take_reals_of_items
    procedure :: integers_of_items => take_integers_of_items
  end type taker_t

  !> Visitor that gives them to a state.
  type, extends(mover_t) :: giver_t
  contains
    procedure :: reals => give_reals
  end type giver_t

contains

  !> Divide a whole model among the ranks; no-op with one.
  subroutine divide_model(model)
    type(model_t), intent(inout) :: model

    call model%part%divide(model%coupling)
    call set_point_owners(model)
    call keep_own_points(model)
  end subroutine divide_model

  !> Give a state to a model of the same sheet that is whole, or divided otherwise.
  subroutine move_state(old_model, old, model, new)
    type(model_t), intent(in) :: old_model
    !> Only read, but handed to a visitor.
    type(state_t), intent(inout) :: old
    type(model_t), intent(in) :: model
    type(state_t), intent(out) :: new

    type(taker_t) :: taker
    type(giver_t) :: giver

    taker%part = old_model%part
    allocate (taker%component(0))
    call visit_state(old, taker)
    giver%part = model%part
    call move_alloc(taker%component, giver%component)
    call new_state(new, model)
    call visit_state(new, giver)
  end subroutine move_state

  !> Visit a component of integers.
  subroutine integers(self, name, n, values)
    class(mover_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    integer, intent(inout) :: values(n)

    real(wp) :: number(n)

    number = real(values, wp)
    call self%reals(name, n, number)
    values = nint(number)
  end subroutine integers

  !> Take a component of real numbers.
  subroutine take_reals(self, name, n, values)
    class(taker_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    real(wp), intent(inout) :: values(n)

    type(component_t), allocatable :: more(:)
    integer :: i

    if (name == "") return
    if (self%n == size(self%component)) then
      allocate (more(max(64, 2*self%n)))
      do i = 1, self%n
        call move_alloc(self%component(i)%value, more(i)%value)
      end do
      call move_alloc(more, self%component)
    end if
    self%n = self%n + 1
    self%component(self%n)%value = values
  end subroutine take_reals

  !> Take real numbers of all elements or contact points, from the ranks that hold them.
  subroutine take_reals_of_items(self, item, name, n, n_item, values)
    class(taker_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items of this rank.
    integer, intent(in) :: n, n_item
    real(wp), intent(inout) :: values(n, n_item)

    real(wp), allocatable :: all(:, :)

    call self%part%gather(item, n, n_item, values, all)
    if (self%part%divided) then
      associate (n_all => size(self%part%ranks_of(item)))
        if (size(all, 2) /= n_all) then
          deallocate (all)
          allocate (all(n, n_all), source=0.0_wp)
        end if
        call broadcast_reals(0, n*n_all, all)
      end associate
    end if
    call self%reals(name, size(all), all)
  end subroutine take_reals_of_items

  !> Take integers of all elements or contact points.
  subroutine take_integers_of_items(self, item, name, n, n_item, values)
    class(taker_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items of this rank.
    integer, intent(in) :: n, n_item
    integer, intent(inout) :: values(n, n_item)

    real(wp), allocatable :: number(:, :)

    number = real(values, wp)
    call self%reals_of_items(item, name, n, n_item, number)
  end subroutine take_integers_of_items

  !> Give a component of real numbers.
  subroutine give_reals(self, name, n, values)
    class(giver_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    real(wp), intent(inout) :: values(n)

    if (name == "") return
    self%n = self%n + 1
    values = self%component(self%n)%value
  end subroutine give_reals

end module dd3_model_redistribution
