!> Bound of the factor r and what sets it.
module dd3_process_limit
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: limit_t, limiter_name

  !> Limiters of r, in the order of `names`.
  enum, bind(c)
    enumerator :: limiter_none = 0
    enumerator :: limiter_r_max, limiter_r_min
    enumerator :: limiter_strain, limiter_rotation, limiter_stress, limiter_force
    enumerator :: limiter_gap, limiter_first_contact, limiter_layer
    enumerator :: limiter_phase, limiter_table, limiter_until, limiter_output
    enumerator :: limiter_cutback, limiter_iterations
  end enum
  public :: limiter_none, limiter_r_max, limiter_r_min, limiter_strain, limiter_rotation, &
      limiter_stress, limiter_force, limiter_gap, limiter_first_contact, limiter_layer, &
      limiter_phase, limiter_table, limiter_until, limiter_output, limiter_cutback, &
      limiter_iterations

  !> Names for the records.
  character(len=*), parameter :: names(limiter_none:limiter_iterations) = [character(len=16) :: &
      "", "r_max", "r_min", "strain", "rotation", "stress", "force", "gap", "first contact", &
      "layer", "phase", "table", "until", "output", "cutback", "iterations"]

  !> Upper bound of the factor r and its origin; numbers that do not apply are 0.
  type :: limit_t
    real(wp) :: r = huge(1.0_wp)
    !> One of the `limiter_*` values.
    integer :: limiter = limiter_none
    integer :: element = 0, point = 0, node = 0, tool = 0
    !> Size B of the contact force, eq. (16), of the limiter of contact forces, N.
    real(wp) :: force_size = 0.0_wp
  end type limit_t

contains

  !> Return the name of a limiter.
  pure function limiter_name(limiter) result(name)
    !> One of the `limiter_*` values.
    integer, intent(in) :: limiter
    character(len=:), allocatable :: name

    name = trim(names(limiter))
  end function limiter_name

end module dd3_process_limit
