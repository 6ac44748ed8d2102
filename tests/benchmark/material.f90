! SPDX-License-Identifier: GPL-3.0-or-later
!> Time the stress update with its tangent for the registered laws: each yield criterion with
!> Swift's law, each other law with von Mises, in ns; limits, which have no influence on the stress,
!> beside none. tests/benchmark/laws.py makes tables of it.
!>
!>     benchmark_material [kind]
program benchmark_material
  use dd3_base_clock, only : wall_time
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_linalg_tensor, only : kelvin_deviator
  use dd3_material_check, only : describe_laws, law_backstress, law_fracture, law_hardening, &
      law_modulus, law_rate, law_temperature, law_yield
  use dd3_material_description, only : description_t, law_choice_t
  use dd3_material_limits, only : forming_limit_t
  use dd3_material_material, only : material_t, new_material
  use parameter_sets, only : law_of, published_sets, set_t
  implicit none

  !> Number of states; the best of several rounds over them counts, more for a single kind.
  integer, parameter :: states = 1000, few = 20, many = 400
  !> Norms of the strain increments, and their rate, 1/s.
  real(wp), parameter :: sizes(4) = [1.0e-5_wp, 1.0e-4_wp, 1.0e-3_wp, 1.0e-2_wp], speed = 0.01_wp
  integer, parameter :: kinds(*) = [law_yield, law_hardening, law_backstress, law_modulus, &
      law_rate, law_temperature, law_fracture]
  character(len=*), parameter :: titles(*) = [character(len=11) :: "yield", "hardening", &
      "back-stress", "modulus", "rate", "temperature", "limits"]
  type(description_t), allocatable :: laws(:)
  type(set_t), allocatable :: sets(:)
  character(len=len(titles)) :: only
  integer :: i, k, rounds

  only = ""
  if (command_argument_count() > 0) call get_command_argument(1, only)
  rounds = merge(few, many, only == "")
  sets = published_sets()
  print '(a)', "kind law elastic 1e-5 1e-4 1e-3 1e-2 ns iterations"
  do k = 1, size(kinds)
    if (only /= "" .and. only /= titles(k)) cycle
    call describe_laws(kinds(k), laws)
    if (kinds(k) == law_fracture) call measure(k, law_choice_t("none"))
    do i = 1, size(laws)
      call measure(k, choice_of(laws(i)))
    end do
    if (kinds(k) == law_fracture) call measure(k, law_choice_t("forming_limit"))
  end do

contains

  !> Return a law with its example parameters, or with a published set if there is one.
  type(law_choice_t) function choice_of(description) result(choice)
    type(description_t), intent(in) :: description

    integer :: n

    choice = law_choice_t(description%name, description%example)
    do n = size(sets), 1, -1
      if (sets(n)%law%name == description%name) choice = sets(n)%law
    end do
  end function choice_of

  !> Time a law with others of the simplest kind and print a line.
  subroutine measure(k, law)
    !> Kind of the law, as its place in the list.
    integer, intent(in) :: k
    type(law_choice_t), intent(in) :: law

    type(material_t) :: material
    type(law_choice_t) :: choice(size(kinds))
    type(law_choice_t), allocatable :: back(:)
    type(forming_limit_t) :: curve
    real(wp) :: plastic_time(size(sizes)), iterations(size(sizes)), elastic_time
    integer :: n

    choice(1) = law_of("von_mises")
    choice(2) = law_of("swift K=565 e0=0.007117 n=0.2589")
    choice(k) = law
    allocate (back(merge(1, 0, kinds(k) == law_backstress)))
    if (size(back) > 0) back(1) = law
    if (law%name == "forming_limit") then
      curve%minor = [-0.2_wp, 0.0_wp, 0.1_wp, 0.3_wp]
      curve%major = [0.45_wp, 0.25_wp, 0.3_wp, 0.35_wp]
    end if
    call new_material(material, 2.1e5_wp, 0.3_wp, choice(1), choice(2), back, choice(4), &
        choice(5), choice(6), fracture=choice(7), forming_limit=curve)
    do n = 1, size(sizes)
      call time_updates(material, sizes(n), .true., plastic_time(n), iterations(n))
    end do
    call time_updates(material, 1.0e-5_wp, .false., elastic_time, iterations(1))
    call time_updates(material, sizes(1), .true., plastic_time(1), iterations(1))
    print '(a, 5f9.1, 4f6.1)', trim(titles(k))//" "//trim(law%name), elastic_time, plastic_time, &
        iterations
  end subroutine measure

  !> Return a vector of random numbers between -1 and 1.
  function random_vector() result(v)
    real(wp) :: v(6)

    call random_number(v)
    v = 2*v - 1
  end function random_vector

  !> Time updates from states on the yield surface.
  subroutine time_updates(material, length, load, time, iterations)
    type(material_t), intent(in) :: material
    !> Norm of the strain increments.
    real(wp), intent(in) :: length
    !> Whether the increments load or unload.
    logical, intent(in) :: load
    !> Time per update, ns, and mean number of iterations.
    real(wp), intent(out) :: time, iterations

    real(wp) :: stress(6, states), strain(6, states)
    real(wp) :: internal_variables(material%n_internal, states)
    real(wp) :: zero(6), zeros(material%n_internal), direction(6)
    real(wp) :: stress_trial(6), internal_trial(material%n_internal), tangent(6, 6), start
    type(verdict_t) :: verdict
    logical :: plastic
    integer :: n, r, total

    zero = 0.0_wp
    zeros = 0.0_wp
    do n = 1, states
      strain(:, n) = 0.02_wp*random_vector()
      call material%update(zero, zeros, strain(:, n), stress(:, n), &
          internal_variables(:, n), tangent, plastic, verdict)
      strain(:, n) = length*random_vector()
      strain(:, n) = kelvin_deviator(strain(:, n))
      direction = material%plastic_direction(stress(:, n), internal_variables(:, n))
      if (dot_product(strain(:, n), direction) > 0.0_wp .neqv. load) strain(:, n) = -strain(:, n)
    end do
    time = huge(1.0_wp)
    do r = 1, rounds
      total = 0
      start = wall_time()
      do n = 1, states
        call material%update(stress(:, n), internal_variables(:, n), strain(:, n), stress_trial, &
            internal_trial, tangent, plastic, verdict, length/speed)
        total = total + verdict%iterations
      end do
      time = min(time, 1.0e9_wp*(wall_time() - start)/states)
    end do
    iterations = real(total, wp)/states
  end subroutine time_updates

end program benchmark_material
