! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact of a node with a rigid tool in the mixed formulation: the augmented Lagrangian operators
!> with Coulomb friction and their exact linearisation, including the terms of the tool's curvature.
!> The compliant formulation shares Coulomb's law.
!>
!> With the contact force lambda (of the sheet on the tool), the outward unit normal n of the tool,
!> the gap d, the slip vector w, T = I - n n^T and the penalty p, the augmented forces are
!> sigma_n = lambda.n + p d and sigma_t = T (lambda + p_t w) with p_t = p, or a larger penalty of
!> its own where a support prescribes the slip. The three states are
!>     gap    sigma_n > 0                                F = 0
!>     stick  sigma_n <= 0, |sigma_t| <= Y     F = sigma_n n + sigma_t
!>     slip   sigma_n <= 0, |sigma_t| >  Y     F = sigma_n n + Y t
!> with t = sigma_t / |sigma_t| and the limit Y(-sigma_n, |T w|) of the friction law, -mu sigma_n of
!> a constant coefficient. Without friction every node in contact slips. The linearisation is
!> dF = D du + E dlambda; with N = dn/dx and v = lambda + p_t w, d(sigma_n)/du = N lambda + p n and
!> d(sigma_t)/du = p_t T - (n.v) N - n (N v)^T. Where Y depends on the speed, t dY/d|T w| times the
!> gradient of |T w| is added to D.
!>
!> Arguments of all procedures: `normal` n; `distance` d, mm; `dnormal` N, symmetric, 1/mm;
!> `lambda`, N; `slip` w, mm; `penalty` p and p_t, N/mm; `friction` and `sliding`, which give Y.
!> Results: `force` F, N; `d` D, N/mm; `e` E.
!> Source: Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375; Pietrzak and
!> Curnier, Comput. Methods Appl. Mech. Eng. 177 (1999) 351-381; Heege and Alart, Int. J. Numer.
!> Methods Eng. 39 (1996) 165-184.
module dd3_contact_operator
  use dd3_base_kinds, only : wp
  use dd3_contact_friction, only : friction_limit_t, friction_t, sliding_t
  implicit none
  private
  public :: status_gap, status_stick, status_slip, contact_status, round_off
  public :: contact_operator_of_status, coulomb_operator
  public :: normal_force_t, traction_t, no_direction, tangential_length

  !> Contact status of a node: not in contact, sticking or slipping.
  integer, parameter :: status_gap = 0, status_stick = 1, status_slip = 2

  !> |sigma_t| below this, relative to its parts, has no direction.
  real(wp), parameter :: no_direction = 1.0e-13_wp
  !> Gap and slip below this are round-off, mm. A node that touches without force sticks; otherwise
  !> a sheet held by friction alone would drift.
  real(wp), parameter :: round_off = 1.0e-12_wp
  !> Largest quotient of the friction force and |sigma_t| in the linearisation. It exceeds 1 only
  !> inside the friction cone, if slip is prescribed there.
  real(wp), parameter :: largest_quotient = 10.0_wp

  !> Normal force sigma_n of a contact law, N, and its derivatives in the displacement, N/mm, and in
  !> lambda.n.
  type :: normal_force_t
    real(wp) :: value = 0.0_wp, by_u(3) = 0.0_wp, by_lambda = 0.0_wp
  end type normal_force_t

  !> Force v whose tangential part a contact law compares with the friction, N; its derivatives, as
  !> multiples of the identity, in the displacement, N/mm, and in lambda; and the smallest length
  !> that has a direction, N.
  type :: traction_t
    real(wp) :: value(3) = 0.0_wp, by_u = 0.0_wp, by_lambda = 0.0_wp, smallest = 0.0_wp
  end type traction_t

contains

  !> Return the status of a node. At zero gap and force it sticks, so that a load can build up.
  pure integer function contact_status(normal, distance, lambda, slip, penalty, friction, sliding) &
      result(status)
    real(wp), intent(in) :: normal(3), distance, lambda(3), slip(3), penalty(2)
    type(friction_t), intent(in) :: friction
    type(sliding_t), intent(in) :: sliding

    type(friction_limit_t) :: limit
    real(wp) :: sigma_n, tangential(3), v(3)

    sigma_n = dot_product(lambda, normal) + penalty(1)*distance
    if (sigma_n > penalty(1)*round_off) then
      status = status_gap
    else if (friction%coefficient <= 0.0_wp) then
      status = status_slip
    else
      v = lambda + penalty(2)*slip
      tangential = v - dot_product(normal, v)*normal
      status = status_stick
      limit = friction%limit(-sigma_n, sliding, tangential_length(normal, slip))
      if (norm(tangential) > max(limit%value, penalty(2)*round_off)) status = status_slip
    end if
  end function contact_status

  !> Kernel: evaluate force and linearisation of a node with a given status.
  pure subroutine contact_operator_of_status(status, normal, distance, dnormal, lambda, slip, &
      penalty, friction, sliding, force, d, e)
    integer, intent(in) :: status
    real(wp), intent(in) :: normal(3), distance, dnormal(3, 3), lambda(3), slip(3)
    real(wp), intent(in) :: penalty(2)
    type(friction_t), intent(in) :: friction
    type(sliding_t), intent(in) :: sliding
    real(wp), intent(out) :: force(3), d(3, 3), e(3, 3)

    type(normal_force_t) :: sigma_n
    type(traction_t) :: traction

    force = 0.0_wp
    d = 0.0_wp
    e = 0.0_wp
    if (status == status_gap) return
    sigma_n%value = dot_product(lambda, normal) + penalty(1)*distance
    sigma_n%by_u = matmul(dnormal, lambda) + penalty(1)*normal
    sigma_n%by_lambda = 1.0_wp
    traction = traction_t(lambda + penalty(2)*slip, penalty(2), 1.0_wp, &
        no_direction*(norm(lambda) + penalty(2)*norm(slip)))
    call coulomb_operator(status, normal, dnormal, sigma_n, traction, slip, &
        friction%limit(-sigma_n%value, sliding, tangential_length(normal, slip)), force, d, e)
  end subroutine contact_operator_of_status

  !> Kernel: evaluate force and linearisation of a node in contact by Coulomb's law.
  pure subroutine coulomb_operator(status, normal, dnormal, sigma_n, traction, slip, limit, &
      force, d, e)
    !> Stick or slip.
    integer, intent(in) :: status
    real(wp), intent(in) :: normal(3), dnormal(3, 3)
    type(normal_force_t), intent(in) :: sigma_n
    type(traction_t), intent(in) :: traction
    !> mm.
    real(wp), intent(in) :: slip(3)
    type(friction_limit_t), intent(in) :: limit
    real(wp), intent(out) :: force(3), d(3, 3), e(3, 3)

    real(wp) :: tangential(3), dtangential(3, 3), v_normal, dnormal_v(3)
    integer :: i, j

    associate (v => traction%value, k => traction%by_u)
      v_normal = dot_product(normal, v)
      tangential = v - v_normal*normal
      dnormal_v = matmul(dnormal, v)
      do j = 1, 3
        do i = 1, 3
          dtangential(i, j) = -normal(i)*(k*normal(j) + dnormal_v(j)) - v_normal*dnormal(i, j)
        end do
        dtangential(j, j) = dtangential(j, j) + k
      end do
    end associate
    if (status == status_stick) then
      force = sigma_n%value*normal + tangential
      do j = 1, 3
        d(:, j) = normal*sigma_n%by_u(j) + sigma_n%value*dnormal(:, j) + dtangential(:, j)
        e(:, j) = (sigma_n%by_lambda - traction%by_lambda)*normal*normal(j)
        e(j, j) = e(j, j) + traction%by_lambda
      end do
    else
      call slip_operator(normal, dnormal, sigma_n, traction, tangential, dtangential, slip, &
          limit, force, d, e)
    end if
  end subroutine coulomb_operator

  !> Kernel: evaluate force and linearisation of a slipping node.
  pure subroutine slip_operator(normal, dnormal, sigma_n, traction, tangential, dtangential, &
      slip, limit, force, d, e)
    real(wp), intent(in) :: normal(3), dnormal(3, 3)
    type(normal_force_t), intent(in) :: sigma_n
    type(traction_t), intent(in) :: traction
    !> sigma_t, N, and its derivative in the displacement, N/mm.
    real(wp), intent(in) :: tangential(3), dtangential(3, 3)
    !> mm.
    real(wp), intent(in) :: slip(3)
    type(friction_limit_t), intent(in) :: limit
    real(wp), intent(out) :: force(3), d(3, 3), e(3, 3)

    !> Derivative of the force in sigma_n.
    real(wp) :: by_normal(3)
    real(wp) :: length, quotient, t(3), p_t(3, 3), by_speed(3)
    integer :: j

    length = norm(tangential)
    t = 0.0_wp
    if (length > traction%smallest) t = tangential/length
    quotient = 0.0_wp
    if (length > traction%smallest .and. abs(limit%value) < largest_quotient*length) then
      quotient = limit%value/length
    else if (limit%value > 0.0_wp) then
      quotient = merge(largest_quotient, 1.0_wp, length > traction%smallest)
    end if
    by_normal = normal - limit%slope*t
    force = sigma_n%value*normal + limit%value*t
    do j = 1, 3
      p_t(:, j) = -quotient*t*t(j)
      p_t(j, j) = p_t(j, j) + quotient
    end do
    d = matmul(p_t, dtangential)
    by_speed = 0.0_wp
    if (abs(limit%by_slip) > 0.0_wp) by_speed = limit%by_slip*length_gradient(normal, dnormal, slip)
    do j = 1, 3
      d(:, j) = d(:, j) + by_normal*sigma_n%by_u(j) + sigma_n%value*dnormal(:, j) + t*by_speed(j)
      e(:, j) = traction%by_lambda*p_t(:, j) &
          + (sigma_n%by_lambda*by_normal - traction%by_lambda*matmul(p_t, normal))*normal(j)
    end do
  end subroutine slip_operator

  !> Return the length of the tangential part of a vector.
  pure real(wp) function tangential_length(normal, a) result(length)
    real(wp), intent(in) :: normal(3), a(3)

    length = norm(a - dot_product(normal, a)*normal)
  end function tangential_length

  !> Return the gradient of the tangential length of the slip in the displacement; zero without
  !> slip.
  pure function length_gradient(normal, dnormal, slip) result(gradient)
    real(wp), intent(in) :: normal(3), dnormal(3, 3), slip(3)
    real(wp) :: gradient(3)

    real(wp) :: along(3), length, normal_slip

    normal_slip = dot_product(normal, slip)
    along = slip - normal_slip*normal
    length = norm(along)
    gradient = 0.0_wp
    if (length > round_off) gradient = (along - normal_slip*matmul(dnormal, along))/length
  end function length_gradient

  !> Return the norm of a vector. norm2 calls the library, which scales against overflow.
  pure real(wp) function norm(a)
    real(wp), intent(in) :: a(3)

    norm = sqrt(a(1)*a(1) + a(2)*a(2) + a(3)*a(3))
  end function norm

end module dd3_contact_operator
