!> The yield criteria the program knows, by name: one array of laws, from which the look-up, the
!> known names, the checks, `--help` and the generic tests derive.
module dd3_material_yield_registry
  use dd3_material_yield_von_mises, only : von_mises_t
  use dd3_material_yield_hill48, only : hill48_t
  use dd3_material_yield_hosford, only : hosford_t
  use dd3_material_yield_yld91, only : yld91_t
  use dd3_material_yield_karafillis_boyce, only : karafillis_boyce_t
  use dd3_material_yield_drucker, only : drucker_t
  use dd3_material_yield_cazacu_barlat2001, only : cazacu_barlat2001_t
  use dd3_material_yield_yld2004, only : yld2004_t
  use dd3_material_yield_cpb06, only : cpb06_t
  use dd3_material_description, only : description_t
  use dd3_material_yield_criterion, only : yield_slot_t
  implicit none
  private
  public :: fill_criteria, find_criterion, describe_criteria, later_criteria

  !> Laws that this version does not provide, separated by blanks.
  character(len=*), parameter :: later_criteria = ""

contains

  !> The registry: one line per law.
  subroutine fill_criteria(entries)
    !> The laws, without parameters.
    type(yield_slot_t), allocatable, intent(out) :: entries(:)

    allocate (entries(9))
    allocate (von_mises_t :: entries(1)%law)
    allocate (hill48_t :: entries(2)%law)
    allocate (hosford_t :: entries(3)%law)
    allocate (yld91_t :: entries(4)%law)
    allocate (karafillis_boyce_t :: entries(5)%law)
    allocate (drucker_t :: entries(6)%law)
    allocate (cazacu_barlat2001_t :: entries(7)%law)
    allocate (yld2004_t :: entries(8)%law)
    allocate (cpb06_t :: entries(9)%law)
  end subroutine fill_criteria

  !> What each law says of itself, in the order of the registry.
  subroutine describe_criteria(descriptions)
    !> The descriptions.
    type(description_t), allocatable, intent(out) :: descriptions(:)
    type(yield_slot_t), allocatable :: entries(:)
    integer :: i

    call fill_criteria(entries)
    allocate (descriptions(size(entries)))
    do i = 1, size(entries)
      call entries(i)%law%describe(descriptions(i))
    end do
  end subroutine describe_criteria

  !> Finds a law by its name; not allocated where there is none.
  subroutine find_criterion(name, found)
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Holds the law, without parameters.
    type(yield_slot_t), intent(out) :: found
    type(yield_slot_t), allocatable :: entries(:)
    type(description_t) :: description
    integer :: i

    call fill_criteria(entries)
    do i = 1, size(entries)
      call entries(i)%law%describe(description)
      if (description%name == name) call move_alloc(entries(i)%law, found%law)
      if (allocated(found%law)) return
    end do
  end subroutine find_criterion

end module dd3_material_yield_registry
