!> The hardening laws the program knows, by name: one array of laws, from which the look-up, the
!> known names, the checks, `--help` and the generic tests derive.
module dd3_material_hardening_registry
  use dd3_material_hardening_perfect, only : perfect_t
  use dd3_material_hardening_linear, only : linear_t
  use dd3_material_hardening_swift, only : swift_t
  use dd3_material_hardening_voce, only : voce_t
  use dd3_material_hardening_swift_voce, only : swift_voce_t
  use dd3_material_hardening_ludwick, only : ludwick_t
  use dd3_material_hardening_hockett_sherby, only : hockett_sherby_t
  use dd3_material_hardening_table, only : table_t
  use dd3_material_hardening_teodosiu_hu, only : teodosiu_hu_t
  use dd3_material_description, only : description_t
  use dd3_material_hardening_law, only : hardening_slot_t
  implicit none
  private
  public :: fill_hardenings, find_hardening, describe_hardenings, later_hardenings

  !> Laws that this version does not provide, separated by blanks.
  character(len=*), parameter :: later_hardenings = &
    ""

contains

  !> The registry: one line per law.
  subroutine fill_hardenings(entries)
    !> The laws, without parameters.
    type(hardening_slot_t), allocatable, intent(out) :: entries(:)

    allocate (entries(9))
    allocate (perfect_t :: entries(1)%law)
    allocate (linear_t :: entries(2)%law)
    allocate (swift_t :: entries(3)%law)
    allocate (voce_t :: entries(4)%law)
    allocate (swift_voce_t :: entries(5)%law)
    allocate (ludwick_t :: entries(6)%law)
    allocate (hockett_sherby_t :: entries(7)%law)
    allocate (table_t :: entries(8)%law)
    allocate (teodosiu_hu_t :: entries(9)%law)
  end subroutine fill_hardenings

  !> What each law says of itself, in the order of the registry.
  subroutine describe_hardenings(descriptions)
    !> The descriptions.
    type(description_t), allocatable, intent(out) :: descriptions(:)
    type(hardening_slot_t), allocatable :: entries(:)
    integer :: i

    call fill_hardenings(entries)
    allocate (descriptions(size(entries)))
    do i = 1, size(entries)
      call entries(i)%law%describe(descriptions(i))
    end do
  end subroutine describe_hardenings

  !> Finds a law by its name; not allocated where there is none.
  subroutine find_hardening(name, found)
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Holds the law, without parameters.
    type(hardening_slot_t), intent(out) :: found
    type(hardening_slot_t), allocatable :: entries(:)
    type(description_t) :: description
    integer :: i

    call fill_hardenings(entries)
    do i = 1, size(entries)
      call entries(i)%law%describe(description)
      if (description%name == name) call move_alloc(entries(i)%law, found%law)
      if (allocated(found%law)) return
    end do
  end subroutine find_hardening

end module dd3_material_hardening_registry
