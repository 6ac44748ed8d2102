! SPDX-License-Identifier: GPL-3.0-or-later
!> Materials of the model from the case, and the sources of their laws.
module dd3_setup_materials
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : newline
  use dd3_input_case, only : case_t
  use dd3_laws_material, only : make_material
  use dd3_material_description, only : description_t
  use dd3_material_material, only : material_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: new_materials, law_sources

contains

  !> Make the materials; they are incomplete if errors were added.
  subroutine new_materials(model, case, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: m, n

    n = size(case%material)
    allocate (model%material(n), model%material_name(n), model%axes(3, 3, n))
    allocate (model%material_digest(n), source=0)
    model%n_internal = 1
    do m = 1, n
      model%material_name(m) = case%material(m)%name
      model%axes(:, :, m) = case%material(m)%frame
      call make_material(model%material(m), case%material(m), model%material_digest(m), errors)
      model%n_internal = max(model%n_internal, model%material(m)%n_internal)
    end do
  end subroutine new_materials

  !> Return the laws of a material with their sources, one per line.
  function law_sources(name, material) result(text)
    character(len=*), intent(in) :: name
    type(material_t), intent(in) :: material
    character(len=:), allocatable :: text

    type(description_t) :: description
    integer :: i

    text = "material "//trim(name)//": laws and their sources"
    call material%laws%criterion%describe(description)
    text = text//source_line(description)
    call material%laws%hardening%describe(description)
    text = text//source_line(description)
    do i = 1, size(material%laws%backstress)
      call material%laws%backstress(i)%law%describe(description)
      text = text//source_line(description)
    end do
    if (material%laws%softens) then
      call material%laws%modulus%law%describe(description)
      text = text//source_line(description)
    end if
    if (material%laws%viscous) then
      call material%laws%rate%law%describe(description)
      text = text//source_line(description)
    end if
    if (allocated(material%laws%temperature%law)) then
      call material%laws%temperature%law%describe(description)
      text = text//source_line(description)
    end if
    if (.not. allocated(material%laws%fracture%law)) return
    call material%laws%fracture%law%describe(description)
    text = text//source_line(description)
  end function law_sources

  !> Return the line of one law.
  pure function source_line(description) result(text)
    type(description_t), intent(in) :: description
    character(len=:), allocatable :: text

    text = newline//"  "//trim(description%name)//": "//trim(description%title)//"; "// &
        trim(description%source)
  end function source_line

end module dd3_setup_materials
