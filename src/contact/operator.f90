!> Contact of one node with a rigid tool: the operators of the augmented Lagrangian with Coulomb
!> friction, and their exact linearisation, with the terms that come from the curvature of the
!> tool.
!>
!> The contact force lambda (the sheet pushes the tool with it, the tool pushes the sheet with
!> -lambda) and the motion give sigma_n = lambda.n + p d and sigma_t = T (lambda + p w), with n
!> the outward normal of the tool, d the gap, w the slip vector, T = I - n n^T and p the penalty.
!> The three states are
!>     gap    sigma_n > 0                                F = 0
!>     stick  sigma_n <= 0, |sigma_t| <= -mu sigma_n     F = sigma_n n + sigma_t
!>     slip   sigma_n <= 0, |sigma_t| >  -mu sigma_n     F = sigma_n (n - mu t)
!> with t = sigma_t / |sigma_t|, and dF = D du + E dlambda. A tool without friction lets every
!> touching node slip. The normal may turn with the node: N = dn/dx, so that d(sigma_n)/du =
!> N lambda + p n and d(sigma_t)/du = p T - (n.v) N - n (N v)^T, v = lambda + p w.
!> Source: Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375; Pietrzak and
!> Curnier, Comput. Methods Appl. Mech. Eng. 177 (1999) 351-381; Heege and Alart, Int. J. Numer.
!> Methods Eng. 39 (1996) 165-184.
module dd3_contact_operator
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: status_gap, status_stick, status_slip, contact_status, round_off
  public :: contact_operator, contact_operator_of_status

  !> The node does not touch.
  integer, parameter :: status_gap = 0
  !> The node touches and keeps its place on the tool.
  integer, parameter :: status_stick = 1
  !> The node touches and slides.
  integer, parameter :: status_slip = 2

  !> A tangential force below this share of its parts has no direction.
  real(wp), parameter :: no_direction = 1.0e-13_wp
  !> Gap and slip below this are round-off, mm: a node that rests on a tool without force sticks,
  !> else a sheet that nothing but friction holds would drift.
  real(wp), parameter :: round_off = 1.0e-12_wp
  !> Largest quotient of the friction force and |sigma_t| in the linearisation; it is at most 1 on
  !> and outside the cone, more only where a slipping state is prescribed inside it.
  real(wp), parameter :: largest_quotient = 10.0_wp

contains

  !> State, force and linearisation of a node in contact.
  pure subroutine contact_operator(normal, distance, dnormal, lambda, slip, penalty, friction, &
                                   force, d, e, status)
    !> Outward unit normal n of the tool at the closest point.
    real(wp), intent(in) :: normal(3)
    !> Gap d, positive outside the tool, mm.
    real(wp), intent(in) :: distance
    !> Its turning N = dn/dx, symmetric, 1/mm.
    real(wp), intent(in) :: dnormal(3, 3)
    !> Contact force, N.
    real(wp), intent(in) :: lambda(3)
    !> Slip vector w, mm.
    real(wp), intent(in) :: slip(3)
    !> Penalty p, N/mm.
    real(wp), intent(in) :: penalty
    !> Coefficient of friction.
    real(wp), intent(in) :: friction
    !> Contact force F by the contact law, N.
    real(wp), intent(out) :: force(3)
    !> Derivative of F by the node's displacement relative to the tool, N/mm.
    real(wp), intent(out) :: d(3, 3)
    !> Derivative of F by lambda.
    real(wp), intent(out) :: e(3, 3)
    !> One of the `status_*` values.
    integer, intent(out) :: status

    status = contact_status(normal, distance, lambda, slip, penalty, friction)
    call contact_operator_of_status(status, normal, distance, dnormal, lambda, slip, penalty, &
                                    friction, force, d, e)
  end subroutine contact_operator

  !> State of a node; at exact touch it sticks, so that a load can build up.
  pure integer function contact_status(normal, distance, lambda, slip, penalty, &
                                       friction) result(status)
    !> Outward unit normal of the tool at the closest point.
    real(wp), intent(in) :: normal(3)
    !> Gap, mm.
    real(wp), intent(in) :: distance
    !> Contact force, N.
    real(wp), intent(in) :: lambda(3)
    !> Slip vector, mm.
    real(wp), intent(in) :: slip(3)
    !> Penalty, N/mm.
    real(wp), intent(in) :: penalty
    !> Coefficient of friction.
    real(wp), intent(in) :: friction

    real(wp) :: sigma_n, tangential(3), v(3)

    sigma_n = dot_product(lambda, normal) + penalty*distance
    if (sigma_n > penalty*round_off) then
      status = status_gap
    else if (friction <= 0.0_wp) then
      status = status_slip
    else
      v = lambda + penalty*slip
      tangential = v - dot_product(normal, v)*normal
      status = status_stick
      if (norm(tangential) > max(-friction*sigma_n, penalty*round_off)) status = status_slip
    end if
  end function contact_status

  !> Force and linearisation of a node whose state is given.
  pure subroutine contact_operator_of_status(status, normal, distance, dnormal, lambda, slip, &
                                             penalty, friction, force, d, e)
    !> One of the `status_*` values.
    integer, intent(in) :: status
    !> Outward unit normal of the tool at the closest point.
    real(wp), intent(in) :: normal(3)
    !> Gap, mm.
    real(wp), intent(in) :: distance
    !> Turning of the normal, 1/mm.
    real(wp), intent(in) :: dnormal(3, 3)
    !> Contact force, N.
    real(wp), intent(in) :: lambda(3)
    !> Slip vector, mm.
    real(wp), intent(in) :: slip(3)
    !> Penalty, N/mm.
    real(wp), intent(in) :: penalty
    !> Coefficient of friction.
    real(wp), intent(in) :: friction
    !> Contact force by the contact law, N.
    real(wp), intent(out) :: force(3)
    !> Derivative of the force by the node's displacement relative to the tool, N/mm.
    real(wp), intent(out) :: d(3, 3)
    !> Derivative of the force by lambda.
    real(wp), intent(out) :: e(3, 3)

    real(wp) :: sigma_n, normal_gradient(3), tangential(3), dtangential(3, 3)
    real(wp) :: v(3), along_normal, turned(3)
    integer :: i, j

    force = 0.0_wp
    d = 0.0_wp
    e = 0.0_wp
    if (status == status_gap) return
    sigma_n = dot_product(lambda, normal) + penalty*distance
    normal_gradient = matmul(dnormal, lambda) + penalty*normal
    v = lambda + penalty*slip
    along_normal = dot_product(normal, v)
    tangential = v - along_normal*normal
    turned = matmul(dnormal, v)
    do j = 1, 3
      do i = 1, 3
        dtangential(i, j) = -normal(i)*(penalty*normal(j) + turned(j)) - along_normal*dnormal(i, j)
      end do
      dtangential(j, j) = dtangential(j, j) + penalty
    end do
    if (status == status_stick) then
      force = sigma_n*normal + tangential
      do j = 1, 3
        d(:, j) = normal*normal_gradient(j) + sigma_n*dnormal(:, j) + dtangential(:, j)
        e(j, j) = 1.0_wp
      end do
    else
      call slip_operator(normal, dnormal, sigma_n, normal_gradient, tangential, dtangential, &
                         friction, no_direction*(norm(lambda) + penalty*norm(slip)), force, d, e)
    end if
  end subroutine contact_operator_of_status

  !> Force and linearisation of a slipping node.
  pure subroutine slip_operator(normal, dnormal, sigma_n, normal_gradient, tangential, &
                                dtangential, friction, noise, force, d, e)
    !> Outward unit normal of the tool.
    real(wp), intent(in) :: normal(3)
    !> Turning of the normal, 1/mm.
    real(wp), intent(in) :: dnormal(3, 3)
    !> sigma_n, N.
    real(wp), intent(in) :: sigma_n
    !> Its derivative by the displacement, N/mm.
    real(wp), intent(in) :: normal_gradient(3)
    !> sigma_t, N.
    real(wp), intent(in) :: tangential(3)
    !> Its derivative by the displacement, N/mm.
    real(wp), intent(in) :: dtangential(3, 3)
    !> Coefficient of friction.
    real(wp), intent(in) :: friction
    !> Size of |sigma_t| below which it has no direction, N.
    real(wp), intent(in) :: noise
    !> Contact force by the contact law, N.
    real(wp), intent(out) :: force(3)
    !> Derivative of the force by the displacement, N/mm.
    real(wp), intent(out) :: d(3, 3)
    !> Derivative of the force by lambda.
    real(wp), intent(out) :: e(3, 3)

    real(wp) :: length, quotient, limit, cone(3), t(3), p_t(3, 3)
    integer :: j

    length = norm(tangential)
    limit = -friction*sigma_n
    t = 0.0_wp
    if (length > noise) t = tangential/length
    quotient = 0.0_wp
    if (length > noise .and. abs(limit) < largest_quotient*length) then
      quotient = limit/length
    else if (limit > 0.0_wp) then
      quotient = merge(largest_quotient, 1.0_wp, length > noise)
    end if
    cone = normal - friction*t
    force = sigma_n*cone
    do j = 1, 3
      p_t(:, j) = -quotient*t*t(j)
      p_t(j, j) = p_t(j, j) + quotient
    end do
    d = matmul(p_t, dtangential)
    do j = 1, 3
      d(:, j) = d(:, j) + cone*normal_gradient(j) + sigma_n*dnormal(:, j)
      e(:, j) = p_t(:, j) + (cone - matmul(p_t, normal))*normal(j)
    end do
  end subroutine slip_operator

  !> Length of a vector; norm2 would call the library, which scales against overflow.
  pure real(wp) function norm(a)
    !> The vector.
    real(wp), intent(in) :: a(3)

    norm = sqrt(a(1)*a(1) + a(2)*a(2) + a(3)*a(3))
  end function norm

end module dd3_contact_operator
