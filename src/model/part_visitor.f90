! SPDX-License-Identifier: GPL-3.0-or-later
!> Visitor of a state that has the components of elements and contact points for all ranks: each
!> rank gets its own ones.
module dd3_model_part_visitor
  use dd3_base_kinds, only : wp
  use dd3_model_part, only : part_t
  use dd3_model_state_visitor, only : state_visitor_t
  implicit none
  private
  public :: part_visitor_t

  !> Visitor with the parts of the ranks.
  type, extends(state_visitor_t), abstract :: part_visitor_t
    type(part_t) :: part
  contains
    procedure :: reals_of_items
    procedure :: integers_of_items
  end type part_visitor_t

contains

  !> Visit real numbers of all elements or contact points, and return those of this rank.
  subroutine reals_of_items(self, item, name, n, n_item, values)
    class(part_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items of this rank.
    integer, intent(in) :: n, n_item
    real(wp), intent(inout) :: values(n, n_item)

    real(wp), allocatable :: all(:, :)

    allocate (all(n, size(self%part%ranks_of(item))), source=0.0_wp)
    call self%reals(name, size(all), all)
    values = all(:, self%part%own(item))
  end subroutine reals_of_items

  !> Visit integers of all elements or contact points, and return those of this rank.
  subroutine integers_of_items(self, item, name, n, n_item, values)
    class(part_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items of this rank.
    integer, intent(in) :: n, n_item
    integer, intent(inout) :: values(n, n_item)

    integer, allocatable :: all(:, :)

    allocate (all(n, size(self%part%ranks_of(item))), source=0)
    call self%integers(name, size(all), all)
    values = all(:, self%part%own(item))
  end subroutine integers_of_items

end module dd3_model_part_visitor
