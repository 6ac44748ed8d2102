! SPDX-License-Identifier: GPL-3.0-or-later
!> Check that a criterion with its parameters has a closed and convex surface. Closed: the
!> equivalent stress of sampled deviators without shears and of the pure shears exceeds a small
!> fraction of its largest value without shears. Convex: the second derivative has no negative
!> eigenvalue in sampled directions, by the pivots of its elimination (Sylvester's law of inertia).
!> The directions, one family of plane stresses and one of deviators, are the points inside the unit
!> ball of the additive sequence of M. Roberts (The unreasonable effectiveness of quasirandom
!> sequences, extremelearning.com.au, 2018).
module dd3_material_yield_convexity
  use dd3_base_kinds, only : inverse_sqrt2, sqrt2, wp, pi
  use dd3_material_description, only : description_t, problem_t, add_problem
  use dd3_material_flow, only : flow_direction_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  use dd3_material_yield_transformation, only : deviator_of
  implicit none
  private
  public :: check_convexity

  !> Directions: in the sheet's plane, or any deviator.
  integer, parameter :: plane = 1, deviatoric = 2
  !> Number of points of the sequence of each family, including those outside the ball.
  integer, parameter :: points(2) = [1500, 5000]
  !> Numbers of sampled deviators without shears, and of shears of either sign.
  integer, parameter :: angles = 720, shears = 6
  !> Smallest equivalent stress, relative to the largest without shears: below the distance of
  !> neighbouring samples, in order to detect a zero between them.
  real(wp), parameter :: smallest_fraction = 0.005_wp
  !> Roots of x^4 = x + 1 and x^7 = x + 1, whose powers generate the sequences.
  real(wp), parameter :: generator(2) = [1.2207440846057596_wp, 1.1127756842787055_wp]
  !> Negative eigenvalues up to this fraction of the largest diagonal entry are round-off.
  real(wp), parameter :: margin = 1.0e-6_wp

contains

  !> Add a problem, with an example stress, if the surface is open or not convex.
  subroutine check_convexity(criterion, problems)
    class(yield_criterion_t), intent(in) :: criterion
    type(problem_t), allocatable, intent(inout) :: problems(:)

    type(flow_direction_t) :: at
    real(wp) :: stress(6)
    integer :: family, n

    call check_closed(criterion, problems)
    if (size(problems) > 0 .or. criterion%always_convex .or. criterion%convexity_waived) return
    do family = plane, deviatoric
      do n = 1, points(family)
        stress = direction(family, n)
        if (dot_product(stress, stress) > 1.0_wp) cycle
        call criterion%second_derivative(stress, at)
        if (at%equivalent > 0.0_wp .and. semidefinite(at%second)) cycle
        call add_problem(problems, 0, "the yield surface is not convex at the stress "// &
            components(stress), "a convex surface"//waiver(criterion))
        return
      end do
    end do
  end subroutine check_convexity

  !> Return a hint how to accept a surface that is not convex; empty if the law has no such option.
  function waiver(criterion) result(text)
    class(yield_criterion_t), intent(in) :: criterion
    character(len=:), allocatable :: text

    type(description_t) :: description

    call criterion%describe(description)
    text = ""
    if (.not. any(description%rows%name == "nonconvex")) return
    text = "; nonconvex=1 accepts this one with a warning; stress updates may fail"
  end function waiver

  !> Add a problem if a sampled stress has almost no equivalent stress.
  subroutine check_closed(criterion, problems)
    class(yield_criterion_t), intent(in) :: criterion
    type(problem_t), allocatable, intent(inout) :: problems(:)

    real(wp) :: value(angles + shears)
    integer :: n

    do n = 1, size(value)
      value(n) = criterion%value(sample(n))
    end do
    n = minloc(value, 1)
    if (value(n) > smallest_fraction*maxval(value(:angles))) return
    call add_problem(problems, 0, "the yield surface is open near the stress "// &
        components(sample(n)), "a closed surface")
  end subroutine check_closed

  !> Return sample n: a deviator without shears, or a shear; all of the same norm.
  pure function sample(n) result(stress)
    integer, intent(in) :: n
    real(wp) :: stress(6)

    real(wp) :: angle
    integer :: k

    stress = 0.0_wp
    if (n <= angles) then
      angle = 2*pi*real(n, wp)/angles
      stress(1:3) = cos(angle)*[0.5_wp, -0.5_wp, 0.0_wp] + &
          sin(angle)*[1.0_wp, 1.0_wp, -2.0_wp]/sqrt(12.0_wp)
    else
      k = n - angles
      stress(4 + (k - 1)/2) = merge(1.0_wp, -1.0_wp, modulo(k, 2) == 1)*inverse_sqrt2
    end if
  end function sample

  !> Return point n of the sequence as a stress of the family.
  pure function direction(family, n) result(stress)
    !> `plane` or `deviatoric`.
    integer, intent(in) :: family
    integer, intent(in) :: n
    real(wp) :: stress(6)

    real(wp) :: point(6)
    integer :: k

    do k = 1, 6
      point(k) = 2*modulo(0.5_wp + real(n, wp)*generator(family)**(-k), 1.0_wp) - 1
    end do
    if (family == plane) then
      stress = 0.0_wp
      stress([1, 2, 6]) = point(1:3)
    else
      stress = deviator_of(point)
    end if
  end function direction

  !> Return whether a symmetric matrix has no negative eigenvalue beyond round-off.
  pure logical function semidefinite(matrix)
    real(wp), intent(in) :: matrix(6, 6)

    real(wp) :: a(6, 6), shift
    integer :: j, k

    a = matrix
    shift = 0.0_wp
    do k = 1, 6
      shift = max(shift, margin*abs(a(k, k)))
    end do
    do k = 1, 6
      a(k, k) = a(k, k) + shift
    end do
    semidefinite = .not. any(abs(a) > 0.0_wp)
    if (semidefinite) return
    do k = 1, 6
      if (.not. a(k, k) > 0.0_wp) return
      do j = k + 1, 6
        a(k + 1:, j) = a(k + 1:, j) - (a(k, j)/a(k, k))*a(k + 1:, k)
      end do
    end do
    semidefinite = .true.
  end function semidefinite

  !> Format the tensor components of a stress in the order of the input.
  function components(stress) result(text)
    real(wp), intent(in) :: stress(6)
    character(len=:), allocatable :: text

    character(len=5) :: number
    real(wp) :: component(6)
    integer :: k

    component = [stress(1:3), stress([6, 4, 5])/sqrt2]
    text = "(11 22 33 12 23 13) ="
    do k = 1, 6
      write (number, '(f5.2)') component(k)
      text = text//" "//trim(adjustl(number))
    end do
  end function components

end module dd3_material_yield_convexity
