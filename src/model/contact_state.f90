! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of the state that belongs to the contact points of the rank.
module dd3_model_contact_state
  use dd3_base_kinds, only : wp
  use dd3_model_part, only : of_points
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_tools_closest, only : hint_t
  implicit none
  private
  public :: contact_state_t, new_contact_state

  !> State of the contact.
  type :: contact_state_t
    !> Contact forces, sheet on tool, `(3, n_contact)`, N.
    real(wp), allocatable :: lambda(:, :)
    !> One of the `status_*` values of dd3_contact_operator, `(n_contact)`.
    integer, allocatable :: status(:)
    !> Nearest tool, `(n_contact)`; 0 for none.
    integer, allocatable :: tool(:)
    !> Place on the edge of the mesh of a point that moves on it, `(n_contact)`.
    real(wp), allocatable :: place(:)
    !> Last closest point on each tool, `(n_tool, n_contact)`.
    type(hint_t), allocatable :: hint(:, :)
    !> Path on the tools while it slips, `(n_contact)`, mm.
    real(wp), allocatable :: slip_path(:)
    !> Speed of sliding in the last increment, `(n_contact)`, mm/s; 0 without a time.
    real(wp), allocatable :: slip_speed(:)
  contains
    procedure :: walk
  end type contact_state_t

contains

  !> Make the state without contact.
  subroutine new_contact_state(self, n_tool, n_contact)
    type(contact_state_t), intent(out) :: self
    integer, intent(in) :: n_tool, n_contact

    allocate (self%lambda(3, n_contact), self%slip_path(n_contact), self%slip_speed(n_contact), &
        source=0.0_wp)
    allocate (self%status(n_contact), self%tool(n_contact), source=0)
    allocate (self%place(n_contact), source=0.5_wp)
    allocate (self%hint(n_tool, n_contact))
  end subroutine new_contact_state

  !> Pass every component to a visitor.
  subroutine walk(self, visitor)
    class(contact_state_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    associate (n => size(self%status))
      call visitor%reals_of_items(of_points, "lambda", 3, n, self%lambda)
      call visitor%integers_of_items(of_points, "status", 1, n, self%status)
      call visitor%integers_of_items(of_points, "contact_tool", 1, n, self%tool)
      call visitor%reals_of_items(of_points, "place", 1, n, self%place)
      call visit_hints("hint", size(self%hint, 1), n, self%hint, visitor)
      call visitor%reals_of_items(of_points, "slip_path", 1, n, self%slip_path)
      call visitor%reals_of_items(of_points, "slip_speed", 1, n, self%slip_speed)
    end associate
  end subroutine walk

  !> Pass every component of the closest points to a visitor.
  subroutine visit_hints(name, n_tool, n, hint, visitor)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n_tool, n
    type(hint_t), intent(inout) :: hint(n_tool, n)
    class(state_visitor_t), intent(inout) :: visitor

    real(wp), allocatable :: anchor(:, :, :), u(:, :), v(:, :), clearance(:, :)
    integer, allocatable :: patch(:, :)
    logical, allocatable :: due(:, :)
    integer :: i, t

    patch = hint%patch
    u = hint%u
    v = hint%v
    due = hint%due
    clearance = hint%clearance
    allocate (anchor(3, n_tool, n))
    do i = 1, n
      do t = 1, n_tool
        anchor(:, t, i) = hint(t, i)%anchor
      end do
    end do
    call visitor%integers_of_items(of_points, name//"_patch", n_tool, n, patch)
    call visitor%reals_of_items(of_points, name//"_u", n_tool, n, u)
    call visitor%reals_of_items(of_points, name//"_v", n_tool, n, v)
    call visitor%logicals_of_items(of_points, name//"_due", n_tool, n, due)
    call visitor%reals_of_items(of_points, name//"_anchor", 3*n_tool, n, anchor)
    call visitor%reals_of_items(of_points, name//"_clearance", n_tool, n, clearance)
    do i = 1, n
      do t = 1, n_tool
        hint(t, i) = hint_t(patch=patch(t, i), u=u(t, i), v=v(t, i), due=due(t, i), &
            anchor=anchor(:, t, i), clearance=clearance(t, i))
      end do
    end do
  end subroutine visit_hints

end module dd3_model_contact_state
