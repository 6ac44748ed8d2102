! SPDX-License-Identifier: GPL-3.0-or-later
!> Test the stress update with random strain increments up to 10 % from random admissible states:
!> every criterion with published and with extreme parameters, the hardening laws, the back-stresses
!> and their combinations.
!>
!>     benchmark_robustness [part of a combination's name]
!>
!> Prints for each combination the number of increments that failed and that were cut, the largest
!> number of parts and of Newton iterations in a part, and the largest distance of a stress from the
!> yield surface.
program benchmark_robustness
  use dd3_base_kinds, only : wp
  use dd3_base_cause_text, only : cause_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_material_check, only : describe_laws, law_hardening
  use dd3_material_composition, only : evolve_internal_variables
  use dd3_material_description, only : description_t, law_choice_t
  use dd3_material_material, only : material_t, new_material
  use dd3_material_return_mapping, only : step_t, integrate_step
  use parameter_sets, only : set_t, published_sets, law_of
  implicit none

  !> Increments for a criterion, and for any other combination.
  integer, parameter :: many = 1000000, some = 100000
  !> Increments between two restarts from the unstrained state.
  integer, parameter :: walk = 20
  !> Largest number of parts that the update cuts an increment into.
  integer, parameter :: part_limit = 64
  !> Largest norm of a strain increment.
  real(wp), parameter :: largest = 0.1_wp

  !> Results for one material.
  type :: tally_t
    !> Number of increments that failed, and that were cut.
    integer :: failed = 0, cut = 0
    !> Largest number of parts, and of Newton iterations in a part.
    integer :: parts = 1, iterations = 0
    !> Largest relative distance from the yield surface; of elastic states, outside it.
    real(wp) :: distance = 0.0_wp
    !> Reason of the first failure.
    character(len=160) :: reason = ""
  end type tally_t

  type(set_t), allocatable :: sets(:)
  type(law_choice_t), allocatable :: backs(:), none(:)
  type(description_t), allocatable :: hardenings(:)
  type(law_choice_t) :: hardening
  character(len=60) :: filter
  integer :: i, j, k
  !> Sets with which all hardening laws are tested.
  integer, parameter :: chosen(3) = [2, 15, 17]

  call get_command_argument(1, filter)
  sets = published_sets()
  call describe_laws(law_hardening, hardenings)
  backs = [law_of("prager k=800"), law_of("lemaitre_chaboche CX=50 Xsat=60"), &
      law_of("lemaitre_chaboche CX=400 Xsat=30")]
  allocate (none(0))
  print '(a)', "| criterion, laws | increments | failed | cut | parts | iterations | distance |", &
      "|---|---|---|---|---|---|---|"
  do i = 1, size(sets)
    call test(sets(i), law_of("swift K=565 e0=0.007117 n=0.259"), none, many)
  end do
  do i = 1, size(sets)
    call test(sets(i), law_of("voce Y0=120 Rsat=80 CR=28"), backs, some)
  end do
  do j = 1, size(hardenings)
    hardening = law_choice_t(hardenings(j)%name, hardenings(j)%example)
    do i = 1, size(sets)
      if (hardening%name /= "teodosiu_hu" .and. all(chosen /= i)) cycle
      call test(sets(i), hardening, none, some)
      if (all(chosen /= i)) cycle
      do k = 1, 2
        call test(sets(i), hardening, backs(k:k), some)
      end do
      call test(sets(i), hardening, backs, some)
    end do
  end do

contains

  !> Test one material and print a line.
  subroutine test(set, hardening, back, increments)
    type(set_t), intent(in) :: set
    type(law_choice_t), intent(in) :: hardening, back(:)
    !> Number of increments.
    integer, intent(in) :: increments

    type(material_t) :: material
    type(tally_t) :: tally
    character(len=:), allocatable :: name
    integer :: n

    name = trim(set%law%name)
    if (set%title /= "") name = name//" "//trim(set%title)
    name = name//", "//trim(hardening%name)
    do n = 1, size(back)
      name = name//", "//trim(back(n)%name)
    end do
    if (index(name, trim(filter)) == 0) return
    call seed()
    call new_material(material, 2.1e5_wp, 0.3_wp, set%law, hardening, back)
    call walk_randomly(material, increments, tally)
    print '(a, 5(a, i0), a, es8.1, a)', "| "//name, " | ", increments, " | ", tally%failed, " | ", &
        tally%cut, " | ", tally%parts, " | ", tally%iterations, " | ", tally%distance, " |"
    if (tally%failed > 0) print '(2a)', "    ", trim(tally%reason)
  end subroutine test

  !> Start the same random numbers for every material.
  subroutine seed()
    integer :: n, i

    call random_seed(size=n)
    call random_seed(put=[(4321 + 77*i, i=1, n)])
  end subroutine seed

  !> Return a random strain of unit norm.
  function random_direction() result(v)
    real(wp) :: v(6)

    do
      call random_number(v)
      v = 2*v - 1
      if (norm2(v) <= 1.0_wp .and. norm2(v) > 0.01_wp) exit
    end do
    v = v/norm2(v)
  end function random_direction

  !> Apply random increments, starting from the unstrained state; before half of them the stress is
  !> moved to a random point within the yield surface, and before all of them the pressure changes.
  subroutine walk_randomly(material, increments, tally)
    type(material_t), intent(in) :: material
    !> Number of increments.
    integer, intent(in) :: increments
    type(tally_t), intent(inout) :: tally

    real(wp) :: stress(6), internal_variables(material%n_internal), chance(4), strain(6)
    integer :: n

    do n = 1, increments
      if (modulo(n, walk) == 1) then
        stress = 0.0_wp
        internal_variables = 0.0_wp
      end if
      call random_number(chance)
      if (chance(1) < 0.5_wp) then
        stress = chance(2)*stress + (1 - chance(2))*material%back_stress(internal_variables)
      end if
      stress(1:3) = stress(1:3) - sum(stress(1:3))/3 + 600*chance(3) - 300
      ! Norms: half of them uniform, half log-uniform over four decades.
      if (modulo(n, 2) == 0) then
        strain = largest*chance(4)*random_direction()
      else
        strain = largest*10.0_wp**(-4*chance(4))*random_direction()
      end if
      call try_increment(material, stress, internal_variables, strain, tally)
    end do
  end subroutine walk_randomly

  !> Update a state by a strain increment and add the result to the tally.
  subroutine try_increment(material, stress, internal_variables, strain, tally)
    type(material_t), intent(in) :: material
    real(wp), intent(inout) :: stress(6), internal_variables(material%n_internal)
    real(wp), intent(in) :: strain(6)
    type(tally_t), intent(inout) :: tally

    real(wp) :: stress_trial(6), internal_trial(material%n_internal), tangent(6, 6), flow, excess
    type(verdict_t) :: verdict
    logical :: plastic
    integer :: parts

    call material%update(stress, internal_variables, strain, stress_trial, internal_trial, &
        tangent, plastic, verdict)
    if (verdict%outcome /= verdict_converged) then
      if (tally%failed == 0) tally%reason = cause_text(verdict, "")
      tally%failed = tally%failed + 1
      return
    end if
    call count_parts(material, stress, internal_variables, strain, tally%iterations, parts)
    if (parts > 1) tally%cut = tally%cut + 1
    tally%parts = max(tally%parts, parts)
    flow = material%flow_stress(internal_trial)
    excess = (material%equivalent_stress(stress_trial, internal_trial) - flow)/flow
    if (plastic) excess = abs(excess)
    tally%distance = max(tally%distance, excess)
    stress = stress_trial
    internal_variables = internal_trial
  end subroutine try_increment

  !> Count the parts into which the update cuts an increment.
  subroutine count_parts(material, stress, internal_variables, strain, iterations, parts)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: stress(6), internal_variables(material%n_internal), strain(6)
    !> Raised to the largest number of iterations of a part that converged.
    integer, intent(inout) :: iterations
    !> Number of parts.
    integer, intent(out) :: parts

    real(wp) :: start(6), before(material%n_internal), after(material%n_internal)
    type(step_t) :: step
    integer :: part

    parts = 1
    do while (parts <= part_limit)
      start = stress
      after = internal_variables
      do part = 1, parts
        before = after
        call integrate_step(material%laws, start, before, strain/real(parts, wp), step)
        if (.not. step%converged) exit
        iterations = max(iterations, step%iterations)
        start = step%stress
        if (step%plastic) call evolve_internal_variables(material%laws, before, step%increment, &
            0.0_wp, step%stress, step%direction, after)
      end do
      if (step%converged) return
      parts = 2*parts
    end do
  end subroutine count_parts

end program benchmark_robustness
