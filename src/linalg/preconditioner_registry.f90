!> The preconditioners there are, by name.
module dd3_linalg_preconditioner_registry
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_text, only : join
  use dd3_linalg_ilu, only : ilu_t, new_ilu
  use dd3_linalg_preconditioner, only : preconditioner_t
  implicit none
  private
  public :: new_preconditioner

  !> Names of the preconditioners.
  character(len=3), parameter :: preconditioner_names(1) = [character(len=3) :: "ilu"]

contains

  !> Makes a preconditioner.
  subroutine new_preconditioner(preconditioner, name, level, may_raise, error)
    !> The preconditioner made.
    class(preconditioner_t), allocatable, intent(out) :: preconditioner
    !> One of `preconditioner_names`.
    character(len=*), intent(in) :: name
    !> Level of fill.
    integer, intent(in) :: level
    !> Whether the level may be raised where that is cheaper in the end.
    logical, intent(in) :: may_raise
    !> An unknown name.
    type(error_t), allocatable, intent(out) :: error
    type(ilu_t), allocatable :: ilu

    select case (name)
    case ("ilu")
      allocate (ilu)
      call new_ilu(ilu, level, may_raise)
      call move_alloc(ilu, preconditioner)
    case default
      call fatal_error(error, "unknown preconditioner "//trim(name)//"; known: " &
        //join(preconditioner_names, ", "))
    end select
  end subroutine new_preconditioner

end module dd3_linalg_preconditioner_registry
