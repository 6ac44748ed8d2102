!> The back-stress laws the program knows, by name: one array of laws, from which the look-up, the
!> known names, the checks, `--help` and the generic tests derive.
module dd3_material_backstress_registry
  use dd3_material_backstress_prager, only : prager_t
  use dd3_material_backstress_lemaitre_chaboche, only : lemaitre_chaboche_t
  use dd3_material_description, only : description_t
  use dd3_material_backstress_law, only : backstress_slot_t
  implicit none
  private
  public :: fill_backstresses, find_backstress, describe_backstresses, later_backstresses

  !> Laws that this version does not provide, separated by blanks.
  character(len=*), parameter :: later_backstresses = &
    ""

contains

  !> The registry: one line per law.
  subroutine fill_backstresses(entries)
    !> The laws, without parameters.
    type(backstress_slot_t), allocatable, intent(out) :: entries(:)

    allocate (entries(2))
    allocate (prager_t :: entries(1)%law)
    allocate (lemaitre_chaboche_t :: entries(2)%law)
  end subroutine fill_backstresses

  !> What each law says of itself, in the order of the registry.
  subroutine describe_backstresses(descriptions)
    !> The descriptions.
    type(description_t), allocatable, intent(out) :: descriptions(:)
    type(backstress_slot_t), allocatable :: entries(:)
    integer :: i

    call fill_backstresses(entries)
    allocate (descriptions(size(entries)))
    do i = 1, size(entries)
      call entries(i)%law%describe(descriptions(i))
    end do
  end subroutine describe_backstresses

  !> Finds a law by its name; not allocated where there is none.
  subroutine find_backstress(name, found)
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Holds the law, without parameters.
    type(backstress_slot_t), intent(out) :: found
    type(backstress_slot_t), allocatable :: entries(:)
    type(description_t) :: description
    integer :: i

    call fill_backstresses(entries)
    do i = 1, size(entries)
      call entries(i)%law%describe(description)
      if (description%name == name) call move_alloc(entries(i)%law, found%law)
      if (allocated(found%law)) return
    end do
  end subroutine find_backstress

end module dd3_material_backstress_registry
