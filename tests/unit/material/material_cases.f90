! SPDX-License-Identifier: GPL-3.0-or-later
!> Shared parts of the material tests: laws with typical and with perturbed parameters, all their
!> combinations, random and degenerate stresses, and a point driven by stress or strain.
module material_cases
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : in_range, law_value_t, parameter_t
  use dd3_base_text, only : same_name
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_tensor, only : solve_small
  use dd3_material_backstress_registry, only : fill_backstresses
  use dd3_material_backstress_law, only : backstress_slot_t
  use dd3_material_check, only : check_together, describe_laws, law_backstress, law_hardening, &
      law_yield
  use dd3_material_description, only : description_t, law_choice_t, problem_t
  use dd3_material_hardening_law, only : hardening_slot_t
  use dd3_material_hardening_registry, only : fill_hardenings
  use dd3_material_material, only : material_t, new_material
  use dd3_material_yield_criterion, only : yield_slot_t
  use dd3_material_yield_registry, only : fill_criteria
  implicit none
  private
  public :: seed, random_vector, stress_of_case, stress_cases, perturbed, mild_steel
  public :: make_criteria, make_hardenings, make_backstresses, combination_count, make_combination
  public :: make_material, choice, drive, young, poisson

  !> Elastic constants of the tests.
  real(wp), parameter :: young = 2.1e5_wp, poisson = 0.3_wp
  !> Number of stresses at which each criterion is tested: the first degenerate, the others random.
  integer, parameter :: stress_cases = 40

contains

  !> Make the random numbers reproducible.
  subroutine seed()
    integer :: n, i

    call random_seed(size=n)
    call random_seed(put=[(1234 + 77*i, i=1, n)])
  end subroutine seed

  !> Return six random numbers between -1 and 1.
  function random_vector() result(v)
    real(wp) :: v(6)

    call random_number(v)
    v = 2*v - 1
  end function random_vector

  !> Return a stress of about 300 MPa: uniaxial, equibiaxial, shears, two equal principal values,
  !> nearly equal ones, with a large pressure; then random.
  function stress_of_case(number) result(stress)
    integer, intent(in) :: number
    real(wp) :: stress(6)

    stress = 0.0_wp
    select case (number)
    case (1:3)
      stress(number) = 300.0_wp
    case (4:6)
      stress(number) = 200.0_wp
    case (7)
      stress(1:2) = 300.0_wp
    case (8)
      stress(1:3) = [-300.0_wp, 0.0_wp, -300.0_wp]
    case (9)
      stress(1:3) = [300.0_wp, 100.0_wp, 100.0_wp*(1 + 1.0e-9_wp)]
    case (10)
      stress(1:3) = [5300.0_wp, 5000.0_wp, 5100.0_wp]
    case (11)
      stress(1:3) = [1.0e-3_wp, -1.0e-3_wp, 0.0_wp]
    case (12)
      stress(1:2) = [300.0_wp, -300.0_wp]
    case default
      stress = 300*random_vector()
    end select
  end function stress_of_case

  !> Return a law with its values.
  function choice(name, keys, values) result(law)
    character(len=*), intent(in) :: name, keys(:)
    real(wp), intent(in) :: values(:)
    type(law_choice_t) :: law

    integer :: i

    law%name = name
    allocate (law%values(size(values)))
    do i = 1, size(values)
      law%values(i) = law_value_t(keys(i), values(i))
    end do
  end function choice

  !> Return Hill's criterion of the steel of the bending test.
  function mild_steel() result(law)
    type(law_choice_t) :: law

    law = choice("hill48", ["F", "G", "H", "L", "M", "N"], &
        [0.284_wp, 0.358_wp, 0.642_wp, 1.289_wp, 1.289_wp, 1.289_wp])
  end function mild_steel

  !> Return valid values, each changed at random by up to a fifth (of one, if it is zero). A
  !> parameter with a lower bound of 1 or more is an exponent or half of one: it becomes the given
  !> multiple of the bound; by default two, three or four times, as a law is smooth for even
  !> exponents only.
  function perturbed(kind, description, multiple) result(values)
    integer, intent(in) :: kind
    type(description_t), intent(in) :: description
    real(wp), intent(in), optional :: multiple
    type(law_value_t), allocatable :: values(:)

    type(problem_t), allocatable :: problems(:)
    type(parameter_t) :: row
    real(wp) :: change
    logical :: allowed
    integer :: i

    do
      allowed = .true.
      values = description%example
      do i = 1, size(values)
        call random_number(change)
        row = row_of(description, values(i)%name)
        if (row%lower >= 1.0_wp) then
          values(i)%value = row%lower*(2 + int(3*change))
          if (present(multiple)) values(i)%value = row%lower*multiple
        else if (values(i)%value == 0.0_wp) then
          values(i)%value = 0.4_wp*change - 0.2_wp
        else
          values(i)%value = values(i)%value*(0.8_wp + 0.4_wp*change)
        end if
        allowed = allowed .and. in_range(row, values(i)%value)
      end do
      if (.not. allowed) cycle
      call check_together(kind, description%name, values, problems)
      if (size(problems) == 0) exit
    end do
  end function perturbed

  !> Return the row of a parameter.
  type(parameter_t) function row_of(description, name)
    type(description_t), intent(in) :: description
    character(len=*), intent(in) :: name

    integer :: i

    do i = 1, size(description%rows)
      if (same_name(description%rows(i)%name, name)) exit
    end do
    row_of = description%rows(i)
  end function row_of

  !> Make every criterion of the registry: with its example, with perturbed values, and with others
  !> whose exponent is not an integer.
  subroutine make_criteria(criteria, isotropic)
    type(yield_slot_t), allocatable, intent(out) :: criteria(:)
    logical, allocatable, intent(out) :: isotropic(:)

    type(yield_slot_t), allocatable :: entries(:)
    type(description_t) :: description
    integer :: i, k

    call fill_criteria(entries)
    allocate (criteria(3*size(entries)), isotropic(3*size(entries)))
    isotropic = .false.
    do i = 1, size(entries)
      call entries(i)%law%describe(description)
      do k = 3*i - 2, 3*i
        allocate (criteria(k)%law, source=entries(i)%law)
      end do
      isotropic(3*i - 2) = .true.
      call criteria(3*i - 2)%law%set(description%example)
      call criteria(3*i - 1)%law%set(perturbed(law_yield, description))
      call criteria(3*i)%law%set(perturbed(law_yield, description, multiple=2.75_wp))
    end do
  end subroutine make_criteria

  !> Make every hardening law of the registry.
  subroutine make_hardenings(laws)
    type(hardening_slot_t), allocatable, intent(out) :: laws(:)

    type(description_t) :: description
    integer :: i

    call fill_hardenings(laws)
    do i = 1, size(laws)
      call laws(i)%law%describe(description)
      call laws(i)%law%set(description%example)
    end do
  end subroutine make_hardenings

  !> Make every back-stress law of the registry.
  subroutine make_backstresses(laws)
    type(backstress_slot_t), allocatable, intent(out) :: laws(:)

    type(description_t) :: description
    integer :: i

    call fill_backstresses(laws)
    do i = 1, size(laws)
      call laws(i)%law%describe(description)
      call laws(i)%law%set(description%example)
    end do
  end subroutine make_backstresses

  !> Return the number of combinations criterion x hardening x back-stress (none, each, all).
  integer function combination_count()
    type(description_t), allocatable :: criteria(:), hardenings(:), backstresses(:)

    call describe_laws(law_yield, criteria)
    call describe_laws(law_hardening, hardenings)
    call describe_laws(law_backstress, backstresses)
    combination_count = size(criteria)*size(hardenings)*(size(backstresses) + 2)
  end function combination_count

  !> Make one of the combinations, the criterion with perturbed values.
  subroutine make_combination(number, material, name)
    integer, intent(in) :: number
    type(material_t), intent(out) :: material
    character(len=:), allocatable, intent(out) :: name

    type(description_t), allocatable :: criteria(:), hardenings(:), backstresses(:)
    type(law_choice_t), allocatable :: back(:)
    integer :: i, j, k, n

    call describe_laws(law_yield, criteria)
    call describe_laws(law_hardening, hardenings)
    call describe_laws(law_backstress, backstresses)
    n = number - 1
    i = modulo(n, size(criteria)) + 1
    n = n/size(criteria)
    j = modulo(n, size(hardenings)) + 1
    k = n/size(hardenings)
    name = trim(criteria(i)%name)//" "//trim(hardenings(j)%name)
    if (k == 0) then
      allocate (back(0))
    else if (k <= size(backstresses)) then
      back = [law_choice_t(backstresses(k)%name, backstresses(k)%example)]
      name = name//" "//trim(backstresses(k)%name)
    else
      allocate (back(size(backstresses)))
      do n = 1, size(back)
        back(n) = law_choice_t(backstresses(n)%name, backstresses(n)%example)
      end do
      name = name//" with all back-stresses"
    end if
    call make_material(material, &
        law_choice_t(criteria(i)%name, perturbed(law_yield, criteria(i))), &
        law_choice_t(hardenings(j)%name, hardenings(j)%example), back)
  end subroutine make_combination

  !> Make a material with valid parameters.
  subroutine make_material(material, criterion, hardening, back)
    type(material_t), intent(out) :: material
    type(law_choice_t), intent(in) :: criterion, hardening
    type(law_choice_t), intent(in), optional :: back(:)

    type(law_choice_t), allocatable :: none(:)

    allocate (none(0))
    if (present(back)) then
      call new_material(material, young, poisson, criterion, hardening, back)
    else
      call new_material(material, young, poisson, criterion, hardening, none)
    end if
  end subroutine make_material

  !> Drive a point over an increment in axes rotated by `r` (material = r times these), each
  !> component to a stress or by a strain. The state is updated on success.
  subroutine drive(material, r, by_stress, goal, stress, internal_variables, strain, success)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: r(6, 6), goal(6)
    logical, intent(in) :: by_stress(6)
    real(wp), intent(inout) :: stress(6), internal_variables(material%n_internal), strain(6)
    logical, intent(out) :: success

    real(wp) :: increment(6), stress_trial(6), internal_trial(material%n_internal), tangent(6, 6)
    real(wp) :: residual(6), matrix(6, 6)
    type(verdict_t) :: verdict
    logical :: plastic, regular
    integer :: i, iteration

    success = .false.
    increment = merge(0.0_wp, goal, by_stress)
    do iteration = 1, 50
      call material%update(stress, internal_variables, matmul(r, increment), stress_trial, &
          internal_trial, tangent, plastic, verdict)
      if (verdict%outcome /= verdict_converged) return
      residual = merge(matmul(stress_trial, r) - goal, 0.0_wp, by_stress)
      if (maxval(abs(residual)) < 1.0e-8_wp) then
        success = .true.
        stress = stress_trial
        internal_variables = internal_trial
        strain = strain + increment
        return
      end if
      matrix = matmul(transpose(r), matmul(tangent, r))
      do i = 1, 6
        if (by_stress(i)) cycle
        matrix(i, :) = 0.0_wp
        matrix(i, i) = 1.0_wp
      end do
      call solve_small(6, 1, matrix, residual, regular)
      if (.not. regular) return
      increment = increment - residual
    end do
  end subroutine drive

end module material_cases
