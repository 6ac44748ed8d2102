! SPDX-License-Identifier: GPL-3.0-or-later
!> Internal variables of all materials of a model, for output: those of equal name form one field,
!> which is constant in a material without the variable. The equivalent plastic strain, which every
!> material has first, is not listed.
module dd3_model_internal_variables
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : kelvin_rotation, kelvin_factor
  use dd3_material_description, only : internal_variable_t
  use dd3_material_material, only : material_t
  implicit none
  private
  public :: variable_t, new_variables, global_components, component_names

  !> Components of a tensor in the outputs, and their positions in a Kelvin vector.
  character(len=2), parameter :: tensor_component(6) = ["11", "22", "33", "12", "23", "13"]
  integer, parameter :: kelvin_position(6) = [1, 2, 3, 6, 4, 5]

  !> Internal variable in the outputs.
  type :: variable_t
    !> Name, unit, meaning and number of components as in its law.
    type(internal_variable_t) :: row
    !> Index of its first component among the internal variables of each material, `(n_material)`; 0
    !> if the material lacks it.
    integer, allocatable :: first(:)
    !> Value at a stored zero, `(n_material)`, or in a material that lacks it.
    real(wp), allocatable :: offset(:)
  contains
    procedure :: is_known
  end type variable_t

contains

  !> List the internal variables of all materials.
  subroutine new_variables(variables, material)
    type(variable_t), allocatable, intent(out) :: variables(:)
    type(material_t), intent(in) :: material(:)

    type(internal_variable_t), allocatable :: rows(:)
    type(variable_t), allocatable :: found(:)
    integer :: m, i, j, k, n

    n = 0
    allocate (found(sum(material%n_internal)))
    do m = 1, size(material)
      call material(m)%describe_internal_variables(rows)
      do i = 2, size(rows)
        do k = 1, n
          if (found(k)%row%name == rows(i)%name .and. &
              found(k)%row%n_component == rows(i)%n_component) exit
        end do
        if (k > n) then
          n = k
          found(k)%row = rows(i)
          allocate (found(k)%first(size(material)), source=0)
          found(k)%offset = [(material(j)%constant_value(rows(i)%name), j=1, size(material))]
        end if
        found(k)%first(m) = rows(i)%first
        found(k)%offset(m) = rows(i)%offset
      end do
    end do
    variables = found(:n)
  end subroutine new_variables

  !> Whether materials have the variable, or a constant value of it. Means at nodes on a weld line
  !> leave out the elements of others.
  pure elemental logical function is_known(self, material)
    class(variable_t), intent(in) :: self
    !> Number of the material.
    integer, intent(in) :: material

    is_known = self%first(material) > 0 .or. abs(self%offset(material)) > 0.0_wp
  end function is_known

  !> Return the output components of a variable at a point: those of a tensor in global axes, 11 22
  !> 33 12 23 13, others as the law stores them; the constant if the material lacks it.
  pure function global_components(variable, material, values, axes) result(components)
    type(variable_t), intent(in) :: variable
    !> Number of the material.
    integer, intent(in) :: material
    !> Internal variables of the point.
    real(wp), intent(in) :: values(:)
    !> Orthotropy axes as columns.
    real(wp), intent(in) :: axes(3, 3)
    real(wp) :: components(variable%row%n_component)

    integer :: first

    components = variable%offset(material)
    first = variable%first(material)
    if (first == 0) return
    components = components + values(first:first + variable%row%n_component - 1)
    if (variable%row%n_component /= 6) return
    components = matmul(kelvin_rotation(axes), components)/kelvin_factor
    components = components(kelvin_position)
  end function global_components

  !> Return the endings of the column names of a variable's components.
  function component_names(variable) result(names)
    type(variable_t), intent(in) :: variable
    character(len=3) :: names(variable%row%n_component)

    integer :: i

    if (variable%row%n_component == 1) then
      names = ""
    else if (variable%row%n_component == 6) then
      names = "_"//tensor_component
    else
      do i = 1, size(names)
        write (names(i), '("_", i0)') i
      end do
    end if
  end function component_names

end module dd3_model_internal_variables
