! SPDX-License-Identifier: GPL-3.0-or-later
!> Common access to the registries: the descriptions of the laws and the check of the values
!> given to one.
module dd3_material_check
  use dd3_base_parameter, only : parameter_t, law_value_t
  use dd3_material_backstress_law, only : backstress_slot_t
  use dd3_material_backstress_registry, only : describe_backstresses, find_backstress
  use dd3_material_description, only : description_t, problem_t
  use dd3_material_fracture_law, only : fracture_slot_t
  use dd3_material_fracture_registry, only : describe_fractures, find_fracture
  use dd3_material_hardening_law, only : hardening_slot_t
  use dd3_material_hardening_registry, only : describe_hardenings, find_hardening
  use dd3_material_modulus_law, only : modulus_slot_t
  use dd3_material_modulus_registry, only : describe_moduli, find_modulus
  use dd3_material_rate_law, only : rate_slot_t
  use dd3_material_rate_registry, only : describe_rates, find_rate
  use dd3_material_temperature_law, only : temperature_slot_t
  use dd3_material_temperature_registry, only : describe_temperatures, find_temperature
  use dd3_material_yield_criterion, only : yield_slot_t
  use dd3_material_yield_convexity, only : check_convexity
  use dd3_material_yield_registry, only : describe_criteria, find_criterion
  implicit none
  private
  public :: law_yield, law_hardening, law_backstress, law_modulus, law_rate, law_temperature, &
      law_fracture
  public :: describe_laws, known_laws, law_rows, check_together

  !> The kinds of laws.
  integer, parameter :: law_yield = 1, law_hardening = 2, law_backstress = 3, &
      law_modulus = 4, law_rate = 5, law_temperature = 6, law_fracture = 7

contains

  !> Describe the laws of a kind, in the order of the registry.
  subroutine describe_laws(kind, descriptions)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    type(description_t), allocatable, intent(out) :: descriptions(:)

    select case (kind)
    case (law_yield)
      call describe_criteria(descriptions)
    case (law_hardening)
      call describe_hardenings(descriptions)
    case (law_backstress)
      call describe_backstresses(descriptions)
    case (law_modulus)
      call describe_moduli(descriptions)
    case (law_rate)
      call describe_rates(descriptions)
    case (law_temperature)
      call describe_temperatures(descriptions)
    case default
      call describe_fractures(descriptions)
    end select
  end subroutine describe_laws

  !> List the names of the laws of a kind, in the order of the registry.
  subroutine known_laws(kind, names)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    character(len=24), allocatable, intent(out) :: names(:)

    type(description_t), allocatable :: descriptions(:)
    integer :: i

    call describe_laws(kind, descriptions)
    allocate (names(size(descriptions)))
    do i = 1, size(names)
      names(i) = descriptions(i)%name
    end do
  end subroutine known_laws

  !> List the parameters of a law; none if the name is unknown.
  subroutine law_rows(kind, name, rows)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    character(len=*), intent(in) :: name
    type(parameter_t), allocatable, intent(out) :: rows(:)

    type(description_t), allocatable :: descriptions(:)
    integer :: i

    call describe_laws(kind, descriptions)
    do i = 1, size(descriptions)
      if (descriptions(i)%name == name) then
        call move_alloc(descriptions(i)%rows, rows)
        return
      end if
    end do
    allocate (rows(0))
  end subroutine law_rows

  !> Check relations between the parameters of a law, each of which has been checked by itself.
  subroutine check_together(kind, name, values, problems, refused)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    character(len=*), intent(in) :: name
    type(law_value_t), intent(in) :: values(:)
    !> Problems found; of size zero if none.
    type(problem_t), allocatable, intent(out) :: problems(:)
    !> Whether a value is missing or has been refused, false by default; if so, check only which
    !> names are given.
    logical, intent(in), optional :: refused

    type(yield_slot_t) :: criterion
    type(hardening_slot_t) :: hardening
    type(backstress_slot_t) :: backstress
    type(modulus_slot_t) :: modulus
    type(rate_slot_t) :: rate
    type(temperature_slot_t) :: temperature
    type(fracture_slot_t) :: fracture
    integer :: before

    before = 0
    if (present(refused)) before = merge(1, 0, refused)
    allocate (problems(before))
    select case (kind)
    case (law_yield)
      call find_criterion(name, criterion)
      call criterion%law%check(values, problems)
      if (size(problems) == 0) then
        call criterion%law%set(values)
        call check_convexity(criterion%law, problems)
      end if
    case (law_hardening)
      call find_hardening(name, hardening)
      call hardening%law%check(values, problems)
    case (law_backstress)
      call find_backstress(name, backstress)
      call backstress%law%check(values, problems)
    case (law_modulus)
      call find_modulus(name, modulus)
      call modulus%law%check(values, problems)
    case (law_rate)
      call find_rate(name, rate)
      call rate%law%check(values, problems)
    case (law_temperature)
      call find_temperature(name, temperature)
      call temperature%law%check(values, problems)
    case default
      call find_fracture(name, fracture)
      call fracture%law%check(values, problems)
    end select
    problems = problems(before + 1:)
  end subroutine check_together

end module dd3_material_check
