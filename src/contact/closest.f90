!> Closest point of a tool's surface to a node.
module dd3_contact_closest
  use dd3_base_kinds, only : wp
  use dd3_contact_surface, only : surface_t
  implicit none
  private
  public :: hint_t, hit_t, find_contact

  !> What is remembered of a node's last query.
  type :: hint_t
    !> Patch of the last closest point; 0 for none.
    integer :: patch = 0
    !> Its parameters.
    real(wp) :: u = 0.5_wp, v = 0.5_wp
    !> Whether the whole surface is to be searched next time.
    logical :: due = .true.
    !> Where the node stood when the whole surface was searched last, in the surface's frame, mm.
    real(wp) :: anchor(3) = 0.0_wp
    !> How far it may move from there before something of the surface can come within the search distance, mm.
    real(wp) :: free = -1.0_wp
  end type hint_t

  !> Closest point of a surface to a node.
  type :: hit_t
    !> Whether there is a point that the node can touch.
    logical :: found = .false.
    !> Whether the node stands beside the surface, its closest point on the outer border: `found` is false then.
    logical :: border = .false.
    !> Patch of the closest point; 0 for none.
    integer :: patch = 0
    !> Its parameters.
    real(wp) :: u = 0.0_wp, v = 0.0_wp
    !> Gap, negative inside the tool, mm.
    real(wp) :: distance = huge(1.0_wp)
    !> Closest point, mm.
    real(wp) :: point(3) = 0.0_wp
    !> Outward unit normal.
    real(wp) :: normal(3) = 0.0_wp
    !> Turning of the normal with the node, dn/dx, symmetric, 1/mm.
    real(wp) :: dnormal(3, 3) = 0.0_wp
  end type hit_t

contains

  !> Finds the point of a surface that a node touches or is nearest to.
  subroutine find_contact(surface, x, hint, search_distance, depth, hit)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The node, in the surface's frame, mm.
    real(wp), intent(in) :: x(3)
    !> What is remembered of the node.
    type(hint_t), intent(inout) :: hint
    !> Nodes farther away than this have no contact, mm.
    real(wp), intent(in) :: search_distance
    !> Nodes deeper inside than this are on the wrong side, mm.
    real(wp), intent(in) :: depth
    !> The closest point.
    type(hit_t), intent(out) :: hit

    if (any(x > surface%upper + max(search_distance, depth))) hint%due = .true.
  end subroutine find_contact

end module dd3_contact_closest
