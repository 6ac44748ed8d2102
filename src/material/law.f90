! SPDX-License-Identifier: GPL-3.0-or-later
!> Base of the yield criteria, hardening laws and back-stress laws: description, parameters, checks.
module dd3_material_law
  use dd3_base_parameter, only : law_value_t
  use dd3_material_description, only : description_t, internal_variable_t, problem_t
  implicit none
  private
  public :: law_t

  type, abstract :: law_t
  contains
    !> Describe the law: name, source, parameters.
    procedure(describe_interface), deferred, nopass :: describe
    !> Describe the internal variables that the law adds to the equivalent plastic strain, in the
    !> order in which the law stores them; by default there are none.
    procedure, nopass :: describe_internal_variables => describe_none
    !> Set the parameters, which have been checked.
    procedure(set_interface), deferred :: set
    !> Check relations between parameters. If `problems` is not empty, values are missing or out of
    !> bounds: check only which names are given.
    procedure, nopass :: check => check_nothing
  end type law_t

  abstract interface
    !> Describe the law.
    subroutine describe_interface(description)
      import :: description_t
      type(description_t), intent(out) :: description
    end subroutine describe_interface

    !> Set the parameters.
    subroutine set_interface(self, values)
      import :: law_t, law_value_t
      class(law_t), intent(inout) :: self
      type(law_value_t), intent(in) :: values(:)
    end subroutine set_interface
  end interface

contains

  !> Describe no internal variables.
  pure subroutine describe_none(rows)
    type(internal_variable_t), allocatable, intent(out) :: rows(:)

    allocate (rows(0))
  end subroutine describe_none

  !> Accept any parameters.
  subroutine check_nothing(values, problems)
    type(law_value_t), intent(in) :: values(:)
    !> Problems are appended.
    type(problem_t), allocatable, intent(inout) :: problems(:)

    associate (unused => values, unchanged => problems)
    end associate
  end subroutine check_nothing

end module dd3_material_law
