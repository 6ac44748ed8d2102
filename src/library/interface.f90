! SPDX-License-Identifier: GPL-3.0-or-later
!> The constitutive laws for C, see dd3laws.h. A handle is the address of a `law_material_t`, which
!> does not change after it was made: any number of threads may use it.
module dd3_library_interface
  use, intrinsic :: iso_c_binding, only : c_double, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr, &
      c_size_t
  use dd3_base_kinds, only : wp
  use dd3_base_cause_text, only : cause_text
  use dd3_base_error, only : error_t
  use dd3_base_verdict, only : verdict_converged, verdict_t
  use dd3_base_version, only : program_version
  use dd3_library_c_text, only : from_c, to_c
  use dd3_library_law_material, only : law_material_t, new_law_material, variable_name
  use dd3_library_voigt, only : kelvin_strain, kelvin_stress, voigt_stress, voigt_tangent
  use dd3_linalg_tensor, only : identity, kelvin_rotation
  use dd3_material_update, only : all_finite
  implicit none
  private
  public :: laws_version, material_new, material_read, material_free, material_state_size, &
      material_state_name, material_axes, material_update, material_update_in_sheet, &
      material_update_timed, material_update_in_sheet_timed, material_equivalent_stress, &
      material_flow_stress

  !> File name of a text in messages.
  character(len=*), parameter :: text_name = "text"

contains

  !> Copy the version of the library.
  subroutine laws_version(text, length) bind(c, name="dd3laws_version")
    type(c_ptr), value :: text
    integer(c_size_t), value :: length

    call to_c(program_version, text, length)
  end subroutine laws_version

  !> Make a material from a text; null if it has errors.
  type(c_ptr) function material_new(text, name, message, length) bind(c, name="dd3laws_new")
    type(c_ptr), value :: text, name, message
    integer(c_size_t), value :: length

    material_new = new_handle(text_name, name, message, length, from_c(text))
  end function material_new

  !> Make a material from a file; null if it has errors.
  type(c_ptr) function material_read(file, name, message, length) bind(c, name="dd3laws_read")
    type(c_ptr), value :: file, name, message
    integer(c_size_t), value :: length

    material_read = new_handle(from_c(file), name, message, length)
  end function material_read

  !> Return the handle of a new material; null if it has errors.
  function new_handle(file, name, message, length, content) result(handle)
    character(len=*), intent(in) :: file
    type(c_ptr), intent(in) :: name, message
    integer(c_size_t), intent(in) :: length
    !> Text in place of the file.
    character(len=*), intent(in), optional :: content
    type(c_ptr) :: handle

    type(law_material_t), pointer :: self
    type(error_t), allocatable :: error

    allocate (self)
    call new_law_material(self, file, from_c(name), error, content)
    if (allocated(error)) then
      call to_c(error%message, message, length)
      deallocate (self)
      handle = c_null_ptr
    else
      call to_c("", message, length)
      handle = c_loc(self)
    end if
  end function new_handle

  !> Release a material.
  subroutine material_free(handle) bind(c, name="dd3laws_free")
    type(c_ptr), value :: handle

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    if (associated(self)) deallocate (self)
  end subroutine material_free

  !> Return the number of internal variables.
  integer(c_int) function material_state_size(handle) bind(c, name="dd3laws_state_size")
    type(c_ptr), value :: handle

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    material_state_size = int(self%laws%n_internal, c_int)
  end function material_state_size

  !> Copy the name of an internal variable; empty for one that does not exist.
  subroutine material_state_name(handle, i, name, length) bind(c, name="dd3laws_state_name")
    type(c_ptr), value :: handle
    !> From 0.
    integer(c_int), value :: i
    type(c_ptr), value :: name
    integer(c_size_t), value :: length

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    if (i >= 0 .and. i < self%laws%n_internal) then
      call to_c(variable_name(self, int(i) + 1), name, length)
    else
      call to_c("", name, length)
    end if
  end subroutine material_state_name

  !> Copy rolling, transverse and normal direction.
  subroutine material_axes(handle, axes) bind(c, name="dd3laws_axes")
    type(c_ptr), value :: handle
    real(c_double), intent(out) :: axes(3, 3)

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    axes = self%axes
  end subroutine material_axes

  !> Integrate stress and internal variables over a strain increment. Return 0; or, with stress and
  !> internal variables unchanged, another verdict.
  integer(c_int) function material_update(handle, strain, stress, state, tangent, message, length) &
      bind(c, name="dd3laws_update")
    type(c_ptr), value :: handle
    real(c_double), intent(in) :: strain(6)
    real(c_double), intent(inout) :: stress(6), state(*)
    real(c_double), intent(out) :: tangent(6, 6)
    type(c_ptr), value :: message
    integer(c_size_t), value :: length

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    material_update = updated(self, identity, strain, 0.0_wp, stress, &
        state(:self%laws%n_internal), tangent, message, length)
  end function material_update

  !> The same over a time, s; 0 for none.
  integer(c_int) function material_update_timed(handle, strain, time, stress, state, tangent, &
      message, length) bind(c, name="dd3laws_update_timed")
    type(c_ptr), value :: handle
    real(c_double), intent(in) :: strain(6)
    real(c_double), value :: time
    real(c_double), intent(inout) :: stress(6), state(*)
    real(c_double), intent(out) :: tangent(6, 6)
    type(c_ptr), value :: message
    integer(c_size_t), value :: length

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    material_update_timed = updated(self, identity, strain, time, stress, &
        state(:self%laws%n_internal), tangent, message, length)
  end function material_update_timed

  !> The same with components in the axes in which rolling and normal direction are given.
  integer(c_int) function material_update_in_sheet(handle, strain, stress, state, tangent, &
      message, length) bind(c, name="dd3laws_update_in_sheet")
    type(c_ptr), value :: handle
    real(c_double), intent(in) :: strain(6)
    real(c_double), intent(inout) :: stress(6), state(*)
    real(c_double), intent(out) :: tangent(6, 6)
    type(c_ptr), value :: message
    integer(c_size_t), value :: length

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    material_update_in_sheet = updated(self, self%axes, strain, 0.0_wp, stress, &
        state(:self%laws%n_internal), tangent, message, length)
  end function material_update_in_sheet

  !> The same over a time, s; 0 for none.
  integer(c_int) function material_update_in_sheet_timed(handle, strain, time, stress, state, &
      tangent, message, length) bind(c, name="dd3laws_update_in_sheet_timed")
    type(c_ptr), value :: handle
    real(c_double), intent(in) :: strain(6)
    real(c_double), value :: time
    real(c_double), intent(inout) :: stress(6), state(*)
    real(c_double), intent(out) :: tangent(6, 6)
    type(c_ptr), value :: message
    integer(c_size_t), value :: length

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    material_update_in_sheet_timed = updated(self, self%axes, strain, time, stress, &
        state(:self%laws%n_internal), tangent, message, length)
  end function material_update_in_sheet_timed

  !> Integrate over a strain increment; return the outcome.
  integer(c_int) function updated(self, axes, strain, time, stress, state, tangent, message, length)
    type(law_material_t), intent(in) :: self
    !> Axes of the material as columns, in those of strain and stress.
    real(wp), intent(in) :: axes(3, 3)
    real(wp), intent(in) :: strain(6)
    !> s; 0 for none.
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: stress(6), state(:)
    real(wp), intent(out) :: tangent(6, 6)
    type(c_ptr), intent(in) :: message
    integer(c_size_t), intent(in) :: length

    type(verdict_t) :: verdict
    real(wp) :: rotation(6, 6), start(6), increment(6)
    real(wp) :: kelvin(6), finished(size(state)), derivative(6, 6)
    logical :: plastic

    rotation = kelvin_rotation(axes)
    start = kelvin_stress(stress)
    increment = kelvin_strain(strain)
    if (all_finite(start, state, increment)) then  ! else the update refuses them
      start = matmul(start, rotation)
      increment = matmul(increment, rotation)
    end if
    call self%laws%update(start, state, increment, kelvin, finished, derivative, plastic, verdict, &
        time)
    tangent = voigt_tangent(matmul(rotation, matmul(derivative, transpose(rotation))))
    updated = int(verdict%outcome, c_int)
    if (verdict%outcome == verdict_converged) then
      stress = voigt_stress(matmul(rotation, kelvin))
      state = finished
      call to_c("", message, length)
    else
      call to_c(cause_text(verdict, ""), message, length)
    end if
  end function updated

  !> Return the equivalent stress of a state.
  real(c_double) function material_equivalent_stress(handle, stress, state) &
      bind(c, name="dd3laws_equivalent_stress")
    type(c_ptr), value :: handle
    real(c_double), intent(in) :: stress(6), state(*)

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    material_equivalent_stress = self%laws%equivalent_stress(kelvin_stress(stress), &
        state(:self%laws%n_internal))
  end function material_equivalent_stress

  !> Return the flow stress of a state.
  real(c_double) function material_flow_stress(handle, state) &
      bind(c, name="dd3laws_flow_stress")
    type(c_ptr), value :: handle
    real(c_double), intent(in) :: state(*)

    type(law_material_t), pointer :: self

    call c_f_pointer(handle, self)
    material_flow_stress = self%laws%flow_stress(state(:self%laws%n_internal))
  end function material_flow_stress

end module dd3_library_interface
