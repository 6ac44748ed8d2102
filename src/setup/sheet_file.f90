! SPDX-License-Identifier: GPL-3.0-or-later
!> The sheet in a restart file: mesh and state; that of another run is moved to its new place.
module dd3_setup_sheet_file
  use dd3_base_error, only : error_list_t, error_t, fatal_error
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : newline, text_t
  use dd3_input_case, only : start_spec_t
  use dd3_mesh_mesh, only : mesh_set_t, mesh_t
  use dd3_output_hdf5, only : start_hdf5
  use dd3_output_hdf5_read, only : close_hdf5, dataset_size, open_hdf5, read_integers, read_reals, &
      read_text_attribute
  use dd3_output_restart_format, only : at_element, at_element_node, at_ended, at_internal, &
      at_node, at_point, at_thickness_point, check_origin, n_sizes, open_restart, restart_name
  use dd3_sheet_sheet, only : sheet_t
  use hdf5, only : hid_t, h5gclose_f, h5gopen_f
  implicit none
  private
  public :: read_sheet, read_restart_sheet

contains

  !> Read the sheet that a run has left. It may be used if no error was added.
  subroutine read_sheet(sheet, spec, errors)
    type(sheet_t), intent(out) :: sheet
    type(start_spec_t), intent(in) :: spec
    type(error_list_t), intent(inout) :: errors

    type(error_t), allocatable :: error
    character(len=:), allocatable :: path
    integer(hid_t) :: file
    integer :: sizes(n_sizes)
    logical :: there, ok

    path = spec%from//"/"//restart_name
    inquire (file=path, exist=there)
    if (.not. there) then
      call report("'"//path//"' does not exist", "the folder of the results of a run with a "// &
          "restart file (restart = off in *OUTPUT writes none), or in it that of a phase with "// &
          "keep = on")
      return
    end if
    call start_hdf5(ok)
    if (ok) call open_hdf5(path, file, ok)
    if (.not. ok) then
      call report("'"//path//"' is truncated or not an HDF5 file", "the folder of a run")
      return
    end if
    call check_origin(path, file, error)
    if (allocated(error)) then
      call report(error%message, "a restart file of this version")
    else
      call read_integers(file, "mesh/sizes", sizes, ok)
      if (.not. ok) then
        call report("'"//path//"' has no mesh: an earlier version wrote it", &
            "a run of this version")
      else if (spec%at_end .and. sizes(at_ended) == 0) then
        call report("the run in '"//spec%from//"' has not reached its end", &
            "a run that has ended, or at = last")
      else
        call read_mesh(sheet, file, sizes, ok)
        ! It counts the refinements of the run that has read the sheet.
        sheet%mesh%mesh_number = 0
        call read_state(sheet, file, sizes, ok)
        if (.not. ok) call report("the sheet in '"//path//"' is incomplete", &
            "a run of this version")
      end if
    end if
    call close_hdf5(file)
    if (ok) call sheet%place(spec%turn, spec%move)

  contains

    subroutine report(message, expected)
      character(len=*), intent(in) :: message, expected

      call errors%push_input(spec%source%at("from"), message, expected, code="E152")
      ok = .false.
    end subroutine report

  end subroutine read_sheet

  !> Read the refined sheet of a restart file, on which the model of the run can be built anew
  !> before its state is read: positions at the start of the job, node sets also of the input.
  !> Materials have their numbers in that run.
  subroutine read_restart_sheet(path, sheet, error)
    character(len=*), intent(in) :: path
    !> Its mesh has the number 0, and nothing else, where no element was divided in the run.
    type(sheet_t), intent(out) :: sheet
    !> Set if the file cannot be read.
    type(error_t), allocatable, intent(out) :: error

    integer(hid_t) :: file
    integer :: sizes(n_sizes)
    logical :: ok

    call open_restart(path, file, error)
    if (allocated(error)) return
    ok = .true.
    call read_number(file, sheet%mesh, ok)
    if (sheet%mesh%mesh_number > 0) then
      call read_integers(file, "mesh/sizes", sizes, ok)
      if (ok) call read_mesh(sheet, file, sizes, ok)
      if (ok) call read_start(sheet, file, ok)
    end if
    call close_hdf5(file)
    if (.not. ok) call fatal_error(error, "'"//path//"' has no whole mesh", "E204")
  end subroutine read_restart_sheet

  !> Read the mesh.
  subroutine read_mesh(sheet, file, sizes, ok)
    type(sheet_t), intent(inout) :: sheet
    integer(hid_t), intent(in) :: file
    !> See dd3_output_restart_format.
    integer, intent(in) :: sizes(n_sizes)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer(hid_t) :: group
    real(wp) :: thickness(1)
    integer :: n, status

    associate (mesh => sheet%mesh)
      mesh%n_node = sizes(at_node)
      mesh%n_element = sizes(at_element)
      mesh%n_element_node = sizes(at_element_node)
      sheet%thickness_points = sizes(at_thickness_point)
      call h5gopen_f(file, "mesh", group, status)
      call read_text_attribute(group, "element", sheet%element)
      call h5gclose_f(group, status)
      allocate (mesh%x(3, mesh%n_node), mesh%material(mesh%n_element))
      allocate (mesh%connectivity(mesh%n_element_node, mesh%n_element))
      call read_block(file, "mesh/x0", size(mesh%x), mesh%x, ok)
      call read_reals(file, "mesh/thickness", thickness, ok)
      mesh%thickness = thickness(1)
      ! The files of other programs and of earlier versions have no placement and axes.
      call dataset_size(file, "mesh/placement", n)
      if (n >= 0) call read_block(file, "mesh/placement", 12, mesh%placement, ok)
      call dataset_size(file, "mesh/node_label", n)
      if (n == mesh%n_node) then
        allocate (mesh%node_label(n))
        call read_integers(file, "mesh/node_label", mesh%node_label, ok)
      end if
      call read_integer_block(file, "mesh/connectivity", size(mesh%connectivity), &
          mesh%connectivity, ok)
      call read_refinement(file, mesh, ok)
      call read_integers(file, "mesh/material_of", mesh%material, ok)
      call read_names(file, "mesh/materials", sheet%material, ok)
      allocate (sheet%digest(size(sheet%material)))
      call read_integers(file, "mesh/material_digest", sheet%digest, ok)
      call dataset_size(file, "mesh/material_axes", n)
      if (n == 9*size(sheet%material)) then
        allocate (sheet%axes(3, 3, size(sheet%material)))
        call read_block(file, "mesh/material_axes", n, sheet%axes, ok)
      end if
      call read_sets(file, "mesh/", mesh%set, ok)
    end associate
  end subroutine read_mesh

  !> Read what the restart file of a refined sheet has besides.
  subroutine read_start(sheet, file, ok)
    !> With its mesh.
    type(sheet_t), intent(inout) :: sheet
    integer(hid_t), intent(in) :: file
    logical, intent(inout) :: ok

    type(mesh_set_t), allocatable :: set(:)
    integer :: n

    call read_sets(file, "mesh/input_", set, ok)
    sheet%mesh%set = [sheet%mesh%set, set]
    sheet%x = sheet%mesh%x
    call dataset_size(file, "mesh/x_start", n)
    if (n >= 0) call read_block(file, "mesh/x_start", size(sheet%x), sheet%x, ok)
  end subroutine read_start

  !> Read node sets.
  subroutine read_sets(file, prefix, set, ok)
    integer(hid_t), intent(in) :: file
    !> Of the names of the datasets.
    character(len=*), intent(in) :: prefix
    type(mesh_set_t), allocatable, intent(out) :: set(:)
    !> Success flag.
    logical, intent(inout) :: ok

    type(text_t), allocatable :: name(:)
    integer, allocatable :: n_member(:), member(:)
    integer :: i, first, n

    call read_names(file, prefix//"sets", name, ok)
    allocate (n_member(size(name)), set(size(name)))
    call read_integers(file, prefix//"set_size", n_member, ok)
    call dataset_size(file, prefix//"set_node", n)
    ok = ok .and. n == sum(n_member)
    if (.not. ok) return
    allocate (member(n))
    call read_integers(file, prefix//"set_node", member, ok)
    first = 1
    do i = 1, size(name)
      set(i)%name = name(i)%s
      set(i)%node = member(first:first + n_member(i) - 1)
      first = first + n_member(i)
    end do
  end subroutine read_sets

  !> Read the numbers of refinements and of nodes before the first, left out if there are none.
  subroutine read_number(file, mesh, ok)
    integer(hid_t), intent(in) :: file
    type(mesh_t), intent(inout) :: mesh
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: number(2), n

    call dataset_size(file, "mesh/number", n)
    if (n /= 2) return
    call read_integers(file, "mesh/number", number, ok)
    mesh%mesh_number = number(1)
    mesh%n_first_node = number(2)
  end subroutine read_number

  !> Read levels and bound nodes, where there are any, and the number of refinements.
  subroutine read_refinement(file, mesh, ok)
    integer(hid_t), intent(in) :: file
    !> With its sizes.
    type(mesh_t), intent(inout) :: mesh
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: n

    call read_number(file, mesh, ok)
    call dataset_size(file, "mesh/level", n)
    if (n >= 0) then
      allocate (mesh%level(mesh%n_element))
      call read_integer_block(file, "mesh/level", size(mesh%level), mesh%level, ok)
    end if
    call dataset_size(file, "mesh/bound", n)
    if (n >= 0) then
      allocate (mesh%bound(3, n/3))
      call read_integer_block(file, "mesh/bound", size(mesh%bound), mesh%bound, ok)
    end if
  end subroutine read_refinement

  !> Read positions, stresses, internal variables and axes.
  subroutine read_state(sheet, file, sizes, ok)
    type(sheet_t), intent(inout) :: sheet
    integer(hid_t), intent(in) :: file
    !> See dd3_output_restart_format.
    integer, intent(in) :: sizes(n_sizes)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    if (.not. ok) return
    associate (n => sizes(at_element), n_point => sizes(at_point))
      allocate (sheet%x(3, sizes(at_node)), sheet%stress(6, n_point, n))
      allocate (sheet%internal_variables(sizes(at_internal), n_point, n))
      allocate (sheet%orientation(3, 3, n_point, n))
    end associate
    call read_block(file, "state/x", size(sheet%x), sheet%x, ok)
    call read_block(file, "state/stress", size(sheet%stress), sheet%stress, ok)
    call read_block(file, "state/internal_variables", size(sheet%internal_variables), &
        sheet%internal_variables, ok)
    call read_block(file, "state/orientation", size(sheet%orientation), sheet%orientation, ok)
    sheet%has_state = ok
    sheet%report = ""
  end subroutine read_state

  !> Read an array of any rank.
  subroutine read_block(file, name, n, values, ok)
    integer(hid_t), intent(in) :: file
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    real(wp), intent(out) :: values(n)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: there

    call dataset_size(file, name, there)
    ok = ok .and. there == n
    call read_reals(file, name, values, ok)
  end subroutine read_block

  !> Read an array of integers of any rank.
  subroutine read_integer_block(file, name, n, values, ok)
    integer(hid_t), intent(in) :: file
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    integer, intent(out) :: values(n)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    integer :: there

    call dataset_size(file, name, there)
    ok = ok .and. there == n
    call read_integers(file, name, values, ok)
  end subroutine read_integer_block

  !> Read names that are written as the character codes of a text, a line each.
  subroutine read_names(file, name, names, ok)
    integer(hid_t), intent(in) :: file
    character(len=*), intent(in) :: name
    type(text_t), allocatable, intent(out) :: names(:)
    !> Success flag; no-op if false.
    logical, intent(inout) :: ok

    character(len=:), allocatable :: text
    integer, allocatable :: code(:)
    integer :: n, i, k, first

    call dataset_size(file, name, n)
    ok = ok .and. n >= 0
    allocate (code(merge(n, 0, ok)))
    call read_integers(file, name, code, ok)
    allocate (character(len=size(code)) :: text)
    do i = 1, size(code)
      text(i:i) = achar(code(i))
    end do
    allocate (names(count([(text(i:i) == newline, i=1, len(text))])))
    first = 1
    do k = 1, size(names)
      i = first + index(text(first:), newline) - 1
      names(k)%s = text(first:i - 1)
      first = i + 1
    end do
  end subroutine read_names

end module dd3_setup_sheet_file
