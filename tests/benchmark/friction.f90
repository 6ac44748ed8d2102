! SPDX-License-Identifier: GPL-3.0-or-later
!> Time the contact law with its linearisation at slipping points, in ns, with a constant
!> coefficient and with laws of friction; tests/benchmark/laws.py makes a table of it.
program benchmark_friction
  use dd3_base_clock, only : wall_time
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, pair_name
  use dd3_contact_compliant, only : compliant_operator, gap_under_force, layer_t, new_layer
  use dd3_contact_friction, only : coulomb, friction_t, sliding_t
  use dd3_contact_operator, only : contact_operator_of_status, contact_status, status_gap, &
      status_slip
  implicit none

  !> Number of points; the best of several rounds over them counts.
  integer, parameter :: points = 1000, rounds = 5000
  !> Normal of the tool, its gradient, 1/mm, slip, mm, and penalties, N/mm.
  real(wp), parameter :: normal(3) = [0.0_wp, 0.6_wp, 0.8_wp], slip(3) = [0.01_wp, 0.0_wp, 0.0_wp]
  real(wp), parameter :: dnormal(3, 3) = reshape([0.2_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 0.0_wp, 0.0_wp], [3, 3]), penalty(2) = 1.0e3_wp
  character(len=*), parameter :: laws(*) = [character(len=8) :: "constant", "power", "table", &
      "stribeck"]
  integer :: i

  print '(a)', "kind law ns"
  do i = 1, size(laws)
    call measure("compliant", laws(i))
  end do
  do i = 1, size(laws)
    call measure("mixed", laws(i))
  end do

contains

  !> Return a coefficient of 0.144 with a law.
  function friction_by(law) result(friction)
    character(len=*), intent(in) :: law
    type(friction_t) :: friction

    friction = coulomb(0.144_wp)
    select case (law)
    case ("power")
      call friction%add_law(law, [law_value_t("p0", 10.0_wp), law_value_t("n", 0.8_wp), &
          law_value_t("p_min", 1.0_wp)])
    case ("table")
      call friction%add_law(law, [law_value_t(pair_name, 1.2_wp, 0.0_wp), &
          law_value_t(pair_name, 1.1_wp, 5.0_wp), law_value_t(pair_name, 1.0_wp, 20.0_wp), &
          law_value_t(pair_name, 0.8_wp, 100.0_wp)])
    case ("stribeck")
      call friction%add_law(law, [law_value_t("v0", 20.0_wp), law_value_t("r", 0.6_wp), &
          law_value_t("n", 1.5_wp)])
    case default
      if (law /= "constant") error stop "no such law"
    end select
  end function friction_by

  !> Time a law in a formulation and print a line.
  subroutine measure(formulation, law)
    character(len=*), intent(in) :: formulation, law

    type(friction_t) :: friction
    type(layer_t) :: layer
    real(wp) :: lambda(3, points), gap(points), time, start, total
    integer :: n, r

    friction = friction_by(trim(law))
    layer = new_layer(0.02_wp, 1.0_wp, 2.1e5_wp)
    do n = 1, points
      ! 0.1 to 100 MPa on 1 mm2.
      gap(n) = gap_under_force(layer, 0.1_wp*n)
      lambda(:, n) = 0.1_wp*n*(-normal + [0.5_wp, 0.0_wp, 0.0_wp])
    end do
    time = huge(1.0_wp)
    do r = 1, rounds
      total = 0.0_wp
      start = wall_time()
      if (formulation == "compliant") then
        do n = 1, points
          total = total + compliant(layer, gap(n), lambda(:, n), friction)
        end do
      else
        do n = 1, points
          total = total + mixed(lambda(:, n), friction)
        end do
      end if
      time = min(time, 1.0e9_wp*(wall_time() - start)/points)
    end do
    if (.not. abs(total) < huge(1.0_wp)) error stop "a result is not finite"
    print '(a, f9.1)', formulation//" "//trim(law), time
  end subroutine measure

  !> Evaluate a point in the compliant formulation; return a sum of the results, so that the
  !> compiler cannot drop any.
  real(wp) function compliant(layer, gap, lambda, friction) result(total)
    type(layer_t), intent(in) :: layer
    !> mm.
    real(wp), intent(in) :: gap
    !> N.
    real(wp), intent(in) :: lambda(3)
    type(friction_t), intent(in) :: friction

    real(wp) :: force(3), d(3, 3), e(3, 3)
    integer :: status

    status = status_gap
    call compliant_operator(layer, normal, gap, dnormal, lambda, lambda, slip, friction, &
        sliding_t(per_slip=1.0e3_wp), status, force, d, e)
    if (status /= status_slip) error stop "a point does not slip"
    total = force(1) + d(1, 2) + e(2, 3)
  end function compliant

  !> Evaluate a point in the mixed formulation, likewise.
  real(wp) function mixed(lambda, friction) result(total)
    !> N.
    real(wp), intent(in) :: lambda(3)
    type(friction_t), intent(in) :: friction

    type(sliding_t) :: sliding
    real(wp) :: force(3), d(3, 3), e(3, 3)
    integer :: status

    sliding%per_slip = 1.0e3_wp
    status = contact_status(normal, 0.0_wp, lambda, slip, penalty, friction, sliding)
    if (status /= status_slip) error stop "a point does not slip"
    call contact_operator_of_status(status, normal, 0.0_wp, dnormal, lambda, slip, penalty, &
        friction, sliding, force, d, e)
    total = force(1) + d(1, 2) + e(2, 3)
  end function mixed

end program benchmark_friction
