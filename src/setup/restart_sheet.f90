! SPDX-License-Identifier: GPL-3.0-or-later
!> The model of a run whose sheet has been refined, for its restart: that of the case, built anew on
!> the sheet of the restart file.
module dd3_setup_restart_sheet
  use dd3_base_error, only : error_list_t, error_t, fatal_error
  use dd3_base_text, only : same_name
  use dd3_input_case, only : case_t
  use dd3_mesh_mesh, only : mesh_set_t
  use dd3_model_model, only : model_t
  use dd3_model_redistribution, only : divide_model
  use dd3_output_restart_changes, only : read_changes
  use dd3_setup_model, only : rebuild_model
  use dd3_setup_sheet_file, only : read_restart_sheet
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: take_restart_sheet

contains

  !> Build a model anew on the sheet of a restart file if elements were divided in that run.
  subroutine take_restart_sheet(path, case, model, error)
    character(len=*), intent(in) :: path
    type(case_t), intent(in) :: case
    !> Of the case; without a refined sheet left as it is.
    type(model_t), intent(inout) :: model
    !> Set if the file cannot be read, or the sheet is not one of the case.
    type(error_t), allocatable, intent(out) :: error

    type(sheet_t) :: sheet
    type(error_list_t) :: errors
    character(len=:), allocatable :: names

    call read_restart_sheet(path, sheet, error)
    if (allocated(error)) return
    if (sheet%mesh%mesh_number == 0) return
    names = parts_that_differ(sheet, model)
    if (names == "") call sort_sets(sheet, model, names)
    if (names == "") then
      call rebuild_model(model, case, sheet, errors)
      if (errors%count == 0) then
        call read_changes(path, model%change, error)
        call divide_model(model)
        return
      end if
      call fatal_error(error, "'"//path//"': the input does not fit its refined sheet: "// &
          errors%item(1)%message, "E204")
    else
      call fatal_error(error, "'"//path//"' belongs to another model; different: "//names, "E204")
    end if
  end subroutine take_restart_sheet

  !> Return what keeps a model from being built on a sheet of another run; empty if nothing does.
  !> Their parameters are compared later.
  function parts_that_differ(sheet, model) result(names)
    type(sheet_t), intent(in) :: sheet
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: names

    integer :: i
    logical :: same

    names = ""
    if (sheet%element /= trim(model%element%name) .or. &
        sheet%thickness_points /= model%element%n_thickness_point) names = "the mesh"
    same = size(sheet%material) == size(model%material)
    do i = 1, merge(size(model%material), 0, same)
      same = same .and. same_name(sheet%material(i)%s, trim(model%material_name(i)))
    end do
    if (.not. same) names = trim(names//merge(", ", "  ", names /= "")//"the materials")
    names = trim(adjustl(names))
  end function parts_that_differ

  !> Bring the node sets of a sheet into the order of those of the model.
  subroutine sort_sets(sheet, model, missing)
    type(sheet_t), intent(inout) :: sheet
    type(model_t), intent(in) :: model
    !> Names of the sets that the sheet has not, separated by commas.
    character(len=:), allocatable, intent(out) :: missing

    type(mesh_set_t), allocatable :: sorted(:)
    integer :: i, k

    missing = ""
    allocate (sorted(size(model%set)))
    do i = 1, size(sorted)
      k = sheet%mesh%find_set(model%set(i)%name)
      if (k > 0) then
        sorted(i) = sheet%mesh%set(k)
      else
        if (missing /= "") missing = missing//", "
        missing = missing//"set '"//model%set(i)%name//"' (new)"
      end if
    end do
    call move_alloc(sorted, sheet%mesh%set)
  end subroutine sort_sets

end module dd3_setup_restart_sheet
