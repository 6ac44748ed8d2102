!> Materials from the case: the laws as written, checked against the registries, with the location
!> of every problem.
module dd3_model_materials
  use dd3_base_digest, only : digest_t
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_parameter, only : parameter_t
  use dd3_base_text, only : newline
  use dd3_input_case, only : case_t, law_spec_t, material_spec_t
  use dd3_input_law, only : check_law_name, check_law_values
  use dd3_material_check, only : check_together, known_laws, law_backstress, law_hardening, &
      law_rows, law_yield
  use dd3_material_description, only : description_t, law_choice_t, problem_t
  use dd3_material_material, only : material_t, new_material
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: new_materials, law_sources, choose_law

  !> Names of the kinds of laws in messages.
  character(len=15), parameter :: kind_name(3) = [character(len=15) :: "yield criterion", &
      "hardening law", "back-stress law"]
  !> Input word for no back-stress.
  character(len=24), parameter :: no_law = "none"

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
      call make_material(model, m, case%material(m), errors)
      model%n_internal = max(model%n_internal, model%material(m)%n_internal)
    end do
  end subroutine new_materials

  !> Make one material.
  subroutine make_material(model, m, spec, errors)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: m
    type(material_spec_t), intent(in) :: spec
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(law_choice_t) :: yield, hardening
    type(law_choice_t), allocatable :: backstress(:)
    type(digest_t) :: digest
    integer :: found, i

    found = errors%count
    if (spec%source%has("yield")) call choose_checked(law_yield, spec%yield, yield, errors)
    if (spec%source%has("hardening")) call choose_checked(law_hardening, spec%hardening, &
        hardening, errors)
    allocate (backstress(size(spec%backstress)))
    do i = 1, size(backstress)
      call choose_checked(law_backstress, spec%backstress(i), backstress(i), errors)
    end do
    if (errors%count > found .or. .not. spec%source%valid) return
    if (yield%name == "" .or. hardening%name == "") return
    call new_material(model%material(m), spec%young, spec%poisson, yield, hardening, backstress)
    call digest%add([spec%young, spec%poisson])
    call add_law(digest, yield)
    call add_law(digest, hardening)
    do i = 1, size(backstress)
      call add_law(digest, backstress(i))
    end do
    model%material_digest(m) = digest%value()
  end subroutine make_material

  !> Add a law and its values to a check sum.
  subroutine add_law(digest, law)
    type(digest_t), intent(inout) :: digest
    type(law_choice_t), intent(in) :: law

    integer :: k

    call digest%add(law%name)
    do k = 1, size(law%values)
      call digest%add(law%values(k)%name)
      call digest%add([law%values(k)%abscissa, law%values(k)%value])
    end do
  end subroutine add_law

  !> Check a law as written, also the relations between its values, and set its values.
  subroutine choose_checked(kind, spec, choice, errors)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    type(law_spec_t), intent(in) :: spec
    !> The law with its values.
    type(law_choice_t), intent(out) :: choice
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(problem_t), allocatable :: problems(:)
    type(location_t) :: place
    !> Position of each value among the parameters as written; 0 for a default.
    integer, allocatable :: origin(:)
    integer :: found, i

    found = errors%count
    call choose_law(kind, spec, choice, errors, origin)
    if (choice%name == "" .or. choice%name == no_law) return
    call check_together(kind, choice%name, choice%values, problems, errors%count > found)
    do i = 1, size(problems)
      ! A problem of the whole law, or of a default, belongs to the name of the law.
      place = spec%at
      if (problems(i)%index > 0) then
        if (origin(problems(i)%index) > 0) place = spec%parameter(origin(problems(i)%index))%at
      end if
      call errors%push_input(place, trim(problems(i)%message), trim(problems(i)%expected), &
          code="E149")
    end do
  end subroutine choose_checked

  !> Check the name and each parameter of a law as written, and set its values.
  subroutine choose_law(kind, spec, choice, errors, origin)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    type(law_spec_t), intent(in) :: spec
    !> The law with its values; without a name if the name is unknown.
    type(law_choice_t), intent(out) :: choice
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors
    !> Position of each value among the parameters as written; 0 for a default. Not allocated if the
    !> name is unknown.
    integer, allocatable, intent(out) :: origin(:)

    character(len=24), allocatable :: names(:)
    type(parameter_t), allocatable :: rows(:)
    integer :: position

    call known_laws(kind, names)
    if (kind == law_backstress) names = [names, no_law]
    call check_law_name(spec, trim(kind_name(kind)), names, position, errors)
    if (position == 0) return
    choice%name = names(position)
    call law_rows(kind, names(position), rows)
    call check_law_values(spec, rows, choice%values, errors, origin)
  end subroutine choose_law

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
  end function law_sources

  !> Return the line of one law.
  pure function source_line(description) result(text)
    type(description_t), intent(in) :: description
    character(len=:), allocatable :: text

    text = newline//"  "//trim(description%name)//": "//trim(description%title)//"; "// &
        trim(description%source)
  end function source_line

end module dd3_model_materials
