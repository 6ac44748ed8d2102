! SPDX-License-Identifier: GPL-3.0-or-later
!> Check that no result would be written over a file that the job reads.
module dd3_app_overwrite
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_file_system, only : part_of
  use dd3_base_identity, only : is_same_file
  use dd3_base_text, only : text_t, same_name
  use dd3_input_case, only : case_t, law_spec_t
  use dd3_input_text_file, only : resolve_path
  use dd3_output_restart_format, only : restart_name
  use dd3_run_file_writer, only : run_file_name
  implicit none
  private
  public :: check_overwrite, result_file

  !> Files that a run writes beside job.log.
  character(len=14), parameter :: result_file(5) = [character(len=14) :: "history.csv", &
      "status.csv", "fields.vtkhdf", restart_name, run_file_name]

contains

  !> Report the input files that lie where a result would be written, under whatever name.
  subroutine check_overwrite(case, directory, restart, errors)
    type(case_t), intent(in) :: case
    !> Folder of the results; it may not exist yet.
    character(len=*), intent(in) :: directory
    !> Restart file to continue from; empty for none. It may be the one of the folder.
    character(len=*), intent(in) :: restart
    type(error_list_t), intent(inout) :: errors

    type(location_t) :: whole_file
    integer :: i, k

    do i = 1, size(case%deck%file)
      whole_file%file = case%deck%file(i)%s
      call check_file(case%deck%file(i)%s, directory, whole_file, errors)
    end do
    do i = 1, size(case%tool)
      call check_file(case%tool(i)%patches, directory, case%tool(i)%source%at("patches"), errors)
    end do
    do i = 1, size(case%tool)
      do k = 1, size(case%tool(i)%friction_law)
        call check_law(case%tool(i)%friction_law(k), directory, errors)
      end do
    end do
    do i = 1, size(case%start)
      call check_file(case%start(i)%from//"/"//restart_name, directory, &
          case%start(i)%source%at("from"), errors)
    end do
    do i = 1, size(case%trim)
      call check_file(case%trim(i)%file, directory, case%trim(i)%source%at("file"), errors)
    end do
    do i = 1, size(case%material)
      call check_law(case%material(i)%yield, directory, errors)
      call check_law(case%material(i)%hardening, directory, errors)
      call check_law(case%material(i)%modulus, directory, errors)
      call check_law(case%material(i)%rate, directory, errors)
      call check_law(case%material(i)%temperature, directory, errors)
      call check_law(case%material(i)%fracture, directory, errors)
      do k = 1, size(case%material(i)%backstress)
        call check_law(case%material(i)%backstress(k), directory, errors)
      end do
    end do
    if (restart == "") return
    if (is_same_file(restart, directory//"/"//restart_name)) return
    whole_file%file = restart
    call check_file(restart, directory, whole_file, errors)
  end subroutine check_overwrite

  !> Check the files that a law reads.
  subroutine check_law(law, directory, errors)
    type(law_spec_t), intent(in) :: law
    character(len=*), intent(in) :: directory
    type(error_list_t), intent(inout) :: errors

    integer :: i

    if (.not. allocated(law%parameter)) return
    do i = 1, size(law%parameter)
      if (.not. same_name(law%parameter(i)%key, "file")) cycle
      call check_file(resolve_path(law%folder, law%parameter(i)%text), directory, &
          law%parameter(i)%at, errors)
    end do
  end subroutine check_law

  !> Check one file.
  subroutine check_file(path, directory, at, errors)
    character(len=*), intent(in) :: path
    character(len=*), intent(in) :: directory
    !> Where it is named.
    type(location_t), intent(in) :: at
    type(error_list_t), intent(inout) :: errors

    type(text_t) :: target(2)
    integer :: i, k

    do i = 0, size(result_file)
      target(1)%s = directory//"/job.log"
      if (i > 0) target(1)%s = directory//"/"//trim(result_file(i))
      target(2)%s = part_of(target(1)%s)
      do k = 1, size(target)
        if (.not. is_same_file(path, target(k)%s)) cycle
        call errors%push_input(at, "the results would overwrite the input file '"//path//"'", &
            "another folder of results, by --output DIR or directory of *OUTPUT, or another "// &
            "name of the file", code="E151")
      end do
    end do
  end subroutine check_file

end module dd3_app_overwrite
