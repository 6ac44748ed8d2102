!> What a node finds at its closest point: gap, normal, and how the normal turns with the node.
!>
!> Inside a patch, with a_ab = y_,a . y_,b, b_ab = y_,ab . n and A = a - d b:
!>     dn/dx = - y_,c (a^-1 b A^-1)^cd y_,d^T,
!> which is P/(R + d) on a sphere. On a sharp inner edge, with t the edge's tangent and r = x - y,
!> n = +- r/|r| and
!>     dn/dx = (I - n n^T - t t^T / (t.t - r.y_,tt)) / d.
!> On the outer border nothing can be touched: a surface ends there, and its continuation is no
!> tool.
!> Source: Wriggers, Computational Contact Mechanics, 2nd ed. (2006), chapter 4; Konyukhov
!> and Schweizerhof, Comput. Mech. 35 (2005) 190-213; for signs at edges
!> Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243-253.
module dd3_contact_hit
  use dd3_base_kinds, only : wp
  use dd3_contact_bezier, only : patch_t, evaluate, normal_at, unit_normal
  use dd3_contact_surface, only : surface_t, edge_of, edge_parameters
  use dd3_contact_project, only : foot_t
  implicit none
  private
  public :: hit_t, new_hit, place_border, place_of

  !> The foot lies inside its patch, or at a smooth edge.
  integer, parameter :: place_smooth = 0
  !> The foot lies on a sharp inner edge, the node beside it.
  integer, parameter :: place_crease = 1
  !> The foot lies on the outer border, the node beside it.
  integer, parameter :: place_border = 2

  !> A node stands beside a border or an edge if it is farther off than this share of the
  !> surface's size.
  real(wp), parameter :: beside_border = 1.0e-6_wp, beside_crease = 1.0e-9_wp
  !> The centre of curvature is near where det A is below this share of det a.
  real(wp), parameter :: near_centre = 1.0e-8_wp

  !> Closest point of a surface to a node.
  type :: hit_t
    !> Whether there is a point that the node can touch.
    logical :: found = .false.
    !> Whether the node stands beside the surface, its closest point on the outer border: `found`
    !> is false then.
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

  !> Makes a hit of a foot.
  pure subroutine new_hit(hit, surface, k, x, foot)
    !> The hit made; `found` where it can be touched, whatever its distance.
    type(hit_t), intent(inout) :: hit
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The patch.
    integer, intent(in) :: k
    !> The node, mm.
    real(wp), intent(in) :: x(3)
    !> Its foot on the patch.
    type(foot_t), intent(in) :: foot

    real(wp) :: normal(3), first(3, 2), second(3, 3)
    integer :: place
    logical :: regular

    place = place_smooth
    if (any(foot%side /= 0)) place = place_of(surface, k, foot)
    hit%patch = k
    hit%u = foot%at(1)
    hit%v = foot%at(2)
    hit%point = x + foot%to_foot
    hit%border = place == place_border
    hit%found = .not. hit%border
    select case (place)
    case (place_border)
      hit%distance = foot%distance
      hit%normal = -foot%to_foot/foot%distance
      hit%dnormal = 0.0_wp
    case (place_crease)
      call hit_crease(hit, surface, k, foot)
    case default
      call unit_normal(surface%patch(k), foot%first, normal, regular)
      if (regular) then
        call hit_smooth(hit, surface%patch(k)%flat, normal, foot%to_foot, foot%first, foot%second)
      else
        call leave_pole(surface%patch(k), foot%at, normal, first, second, hit%found)
        call hit_smooth(hit, .false., normal, foot%to_foot, first, second)
      end if
    end select
  end subroutine new_hit

  !> Where a foot lies that is held at a bound.
  pure integer function place_of(surface, k, foot) result(place)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The patch.
    integer, intent(in) :: k
    !> The foot.
    type(foot_t), intent(in) :: foot

    real(wp) :: off
    integer :: a, e

    place = place_smooth
    do a = 1, 2
      if (foot%side(a) == 0) cycle
      e = edge_of(a, foot%side(a) > 0)
      if (surface%edge(e, k)%pole) cycle
      off = abs(dot_product(foot%to_foot, foot%first(:, a))) &
            /max(sqrt(dot_product(foot%first(:, a), foot%first(:, a))), tiny(1.0_wp))
      if (surface%edge(e, k)%patch == 0) then
        if (off > beside_border*surface%size) place = place_border
      else if (.not. surface%edge(e, k)%smooth) then
        if (off > beside_crease*surface%size) place = max(place, place_crease)
      end if
    end do
  end function place_of

  !> Gap, normal and its turning on a smooth patch.
  pure subroutine hit_smooth(hit, flat, normal, to_foot, first, second)
    !> The hit.
    type(hit_t), intent(inout) :: hit
    !> Whether the patch has no curvature.
    logical, intent(in) :: flat
    !> Unit normal.
    real(wp), intent(in) :: normal(3)
    !> From the node to the foot, mm.
    real(wp), intent(in) :: to_foot(3)
    !> S_u, S_v, mm.
    real(wp), intent(in) :: first(3, 2)
    !> S_uu, S_vv, S_uv, mm.
    real(wp), intent(in) :: second(3, 3)

    real(wp) :: a(3), b(3), c(3), m(2, 2), determinant(2)
    integer :: i

    hit%normal = normal
    hit%distance = -dot_product(to_foot, normal)
    hit%dnormal = 0.0_wp
    if (flat) return
    a(1) = dot_product(first(:, 1), first(:, 1))
    a(2) = dot_product(first(:, 2), first(:, 2))
    a(3) = dot_product(first(:, 1), first(:, 2))
    do i = 1, 3
      b(i) = dot_product(second(:, i), normal)
    end do
    c = a - hit%distance*b
    determinant(1) = a(1)*a(2) - a(3)**2
    determinant(2) = c(1)*c(2) - c(3)**2
    if (min(c(1), c(2)) <= 0.0_wp .or. determinant(2) <= near_centre*determinant(1)) then
      c = a
      determinant(2) = determinant(1)
    end if
    if (determinant(1) <= tiny(1.0_wp)) return
    m(1, 1) = a(2)*b(1) - a(3)*b(3)
    m(1, 2) = a(2)*b(3) - a(3)*b(2)
    m(2, 1) = a(1)*b(3) - a(3)*b(1)
    m(2, 2) = a(1)*b(2) - a(3)*b(3)
    m = matmul(m, reshape([c(2), -c(3), -c(3), c(1)], [2, 2]))/(determinant(1)*determinant(2))
    m(1, 2) = 0.5_wp*(m(1, 2) + m(2, 1))
    do i = 1, 3
      hit%dnormal(:, i) = -(m(1, 1)*first(i, 1) + m(1, 2)*first(i, 2))*first(:, 1) &
                          - (m(1, 2)*first(i, 1) + m(2, 2)*first(i, 2))*first(:, 2)
    end do
  end subroutine hit_smooth

  !> Normal and derivatives at a point near a pole.
  pure subroutine leave_pole(patch, at, normal, first, second, regular)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> Parameters of the pole.
    real(wp), intent(in) :: at(2)
    !> Unit normal.
    real(wp), intent(out) :: normal(3)
    !> S_u, S_v near it, mm.
    real(wp), intent(out) :: first(3, 2)
    !> S_uu, S_vv, S_uv near it, mm.
    real(wp), intent(out) :: second(3, 3)
    !> Whether a normal was found.
    logical, intent(out) :: regular

    real(wp), parameter :: step = 1.0e-3_wp
    real(wp) :: point(3), near(2)

    call normal_at(patch, at(1), at(2), normal, regular)
    near = at + step*(0.5_wp - at)
    call evaluate(patch, near(1), near(2), point, first, second)
  end subroutine leave_pole

  !> Gap, normal and its turning at a sharp inner edge or corner.
  pure subroutine hit_crease(hit, surface, k, foot)
    !> The hit.
    type(hit_t), intent(inout) :: hit
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The patch.
    integer, intent(in) :: k
    !> The foot.
    type(foot_t), intent(in) :: foot

    real(wp) :: mean(3), tangent(3), stretch
    integer :: a, i

    mean = mean_normal(surface, k, foot)
    hit%distance = sign(foot%distance, -dot_product(foot%to_foot, mean))
    hit%normal = -foot%to_foot/hit%distance
    hit%dnormal = 0.0_wp
    do i = 1, 3
      hit%dnormal(i, i) = 1.0_wp/hit%distance
      hit%dnormal(:, i) = hit%dnormal(:, i) - hit%normal*hit%normal(i)/hit%distance
    end do
    do a = 1, 2
      if (foot%side(a) /= 0) cycle
      tangent = foot%first(:, a)
      stretch = dot_product(tangent, tangent)
      stretch = max(stretch + dot_product(foot%to_foot, foot%second(:, a)), near_centre*stretch)
      do i = 1, 3
        hit%dnormal(:, i) = hit%dnormal(:, i) - tangent*tangent(i)/(stretch*hit%distance)
      end do
    end do
  end subroutine hit_crease

  !> Sum of the normals of a patch and of those behind the edges that hold the foot.
  pure function mean_normal(surface, k, foot) result(mean)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The patch.
    integer, intent(in) :: k
    !> The foot.
    type(foot_t), intent(in) :: foot
    real(wp) :: mean(3), normal(3), at(2), along
    integer :: a, e
    logical :: regular

    call normal_at(surface%patch(k), foot%at(1), foot%at(2), mean, regular)
    do a = 1, 2
      if (foot%side(a) == 0) cycle
      e = edge_of(a, foot%side(a) > 0)
      associate (edge => surface%edge(e, k))
        if (edge%patch == 0) cycle
        along = foot%at(3 - a)
        at = edge_parameters(edge%edge, merge(1.0_wp - along, along, edge%reversed))
        call normal_at(surface%patch(edge%patch), at(1), at(2), normal, regular)
      end associate
      mean = mean + normal
    end do
  end function mean_normal

end module dd3_contact_hit
