! SPDX-License-Identifier: GPL-3.0-or-later
!> Tool surfaces: the patches of a `.bez` file as a contact surface, and the checks of its geometry.
module dd3_setup_tool_surface
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_text, only : to_text
  use dd3_input_bezier_file, only : patch_spec_t, read_patches, push_file_errors
  use dd3_tools_bezier, only : patch_t, new_patch, normal_at, largest_degree
  use dd3_tools_surface, only : surface_t, join_patches
  implicit none
  private
  public :: read_tool_surface

contains

  !> Read the surface of a tool from its file; valid only if no error was added. Patches are built
  !> in their place, and the points of the file are given up one by one, to save memory.
  subroutine read_tool_surface(surface, file, location, errors)
    type(surface_t), intent(out) :: surface
    character(len=*), intent(in) :: file
    !> Where the input names the file.
    type(location_t), intent(in) :: location
    type(error_list_t), intent(inout) :: errors

    type(patch_spec_t), allocatable :: patches(:)
    type(error_list_t) :: found
    integer :: i

    call read_patches(patches, file, largest_degree, location, errors)
    if (size(patches) == 0) return
    allocate (surface%patch(size(patches)))
    do i = 1, size(patches)
      call new_tool_patch(surface%patch(i), patches(i))
      deallocate (patches(i)%point)
      if (is_degenerate(surface%patch(i))) then
        call found%push_input(patches(i)%at, "patch "//to_text(patches(i)%number)// &
            " has no area", "control points that span a surface", code="E141")
      end if
    end do
    if (found%count == 0) then
      call join_patches(surface)
      call check_crowding(surface, patches, found)
      call check_orientation(surface, patches, found)
    end if
    call push_file_errors(errors, found, location)
  end subroutine read_tool_surface

  !> Build one patch.
  subroutine new_tool_patch(patch, spec)
    type(patch_t), intent(out) :: patch
    type(patch_spec_t), intent(in) :: spec

    integer :: n(2)

    n = spec%degree + 1
    associate (control => reshape(spec%point(1:3, :), [3, n]))
      if (spec%rational) then
        call new_patch(patch, control, reshape(spec%point(4, :), n), line=spec%at%line)
      else
        call new_patch(patch, control, line=spec%at%line)
      end if
    end associate
  end subroutine new_tool_patch

  !> Whether a patch has no normal at one of nine interior points.
  pure logical function is_degenerate(patch)
    type(patch_t), intent(in) :: patch

    real(wp) :: normal(3)
    integer :: i, j
    logical :: regular

    is_degenerate = .true.
    if (patch%size <= 0.0_wp) return
    do j = 1, 3
      do i = 1, 3
        call normal_at(patch, 0.25_wp*real(i, wp), 0.25_wp*real(j, wp), normal, regular)
        if (.not. regular) return
      end do
    end do
    is_degenerate = .false.
  end function is_degenerate

  !> Report a place with so many patches that not all neighbours were found.
  subroutine check_crowding(surface, patches, errors)
    type(surface_t), intent(in) :: surface
    type(patch_spec_t), intent(in) :: patches(:)
    type(error_list_t), intent(inout) :: errors

    associate (two => surface%crowded)
      if (two(1) == 0) return
      call errors%push_input(patches(maxval(two))%at, "dozens of patches lie at the same "// &
          "place, among them "//to_text(patches(minval(two))%number)//" and "// &
          to_text(patches(maxval(two))%number), "each part of the surface once", code="E141")
    end associate
  end subroutine check_crowding

  !> Report adjacent patches with opposite normals.
  subroutine check_orientation(surface, patches, errors)
    type(surface_t), intent(in) :: surface
    type(patch_spec_t), intent(in) :: patches(:)
    type(error_list_t), intent(inout) :: errors

    type(location_t) :: here
    integer :: k, e, next

    do k = 1, size(surface%patch)
      do e = 1, size(surface%edge, 1)
        next = surface%edge(e, k)%patch
        if (next >= k .or. .not. surface%edge(e, k)%opposite) cycle
        here%file = patches(k)%at%file
        here%line = patches(k)%at%line
        call errors%push_input(here, "the normals of patches "//to_text(patches(next)%number)// &
            " and "//to_text(patches(k)%number)//" point to opposite sides of their common edge", &
            "S_u x S_v pointing out of the tool on both", code="E141")
      end do
    end do
  end subroutine check_orientation

end module dd3_setup_tool_surface
