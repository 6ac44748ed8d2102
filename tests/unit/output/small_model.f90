! SPDX-License-Identifier: GPL-3.0-or-later
!> Fixtures of the tests of the records: a block of two stacked elements with two tools and two
!> phases, folders and files.
module small_model
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
  use dd3_base_error, only : error_t
  use dd3_base_file, only : make_directory
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_element_registry, only : new_element
  use dd3_linalg_tensor, only : identity
  use dd3_material_description, only : law_choice_t
  use dd3_material_material, only : new_material
  use dd3_sheet_surface_point, only : node_point
  use dd3_model_contact_data, only : side_faces
  use dd3_model_model, only : model_t
  use dd3_model_part, only : new_part
  use dd3_model_rim, only : set_rim
  use dd3_model_state, only : state_t, new_state
  use dd3_model_thickness_columns, only : set_columns
  implicit none
  private
  public :: make_small_model, fresh_folder, link_full_disk, lines_of, line_t

  !> Line of a file.
  type :: line_t
    character(len=:), allocatable :: text
  end type line_t

  interface
    !> symlink(2).
    integer(c_int) function posix_symlink(from, to) bind(c, name="symlink")
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: from(*), to(*)
    end function posix_symlink
    !> unlink(2).
    integer(c_int) function posix_unlink(path) bind(c, name="unlink")
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
    end function posix_unlink
  end interface

contains

  !> Make a block of 2 x 3 x 1 mm with 12 nodes, numbered through the thickness first.
  subroutine make_small_model(model, state, divisions)
    type(model_t), intent(out) :: model
    !> Initial state.
    type(state_t), intent(out) :: state
    !> Elements along x, each with 6 nodes and 2 elements more. Default: 1.
    integer, intent(in), optional :: divisions

    type(law_choice_t) :: criterion, hardening, none(0)
    type(error_t), allocatable :: error
    integer :: i, j, k, n

    n = 1
    if (present(divisions)) n = divisions
    call new_element(model%element, "hex8", error)
    model%title = "two elements"
    model%n_node = 6*(n + 1)
    model%n_element = 2*n
    model%n_tool = 2
    model%n_contact = 2
    model%n_internal = 1
    model%thickness = 1.0_wp
    allocate (model%x0(3, model%n_node), model%connectivity(8, model%n_element))
    do i = 0, n
      do j = 0, 1
        do k = 0, 2
          model%x0(:, node(i, j, k)) = [2.0_wp*i/n, 3.0_wp*j, 0.5_wp*k]
        end do
      end do
    end do
    do i = 0, n - 1
      do k = 0, 1
        associate (corner => model%connectivity(:, 1 + k + 2*i))
          corner(:4) = [node(i, 0, k), node(i + 1, 0, k), node(i + 1, 1, k), node(i, 1, k)]
          corner(5:) = corner(:4) + 1
        end associate
      end do
    end do
    call new_part(model%part, model%n_node, model%n_element)
    call set_columns(model)
    call set_rim(model)
    criterion%name = "von_mises"
    hardening%name = "perfect"
    allocate (criterion%values(0))
    hardening%values = [law_value_t("Y0", 200.0_wp)]
    allocate (model%material(1))
    call new_material(model%material(1), 2.1e5_wp, 0.3_wp, criterion, hardening, none)
    allocate (model%material_of(model%n_element), source=1)
    model%contact_point = [node_point(1), node_point(3)]
    model%n_contact_node = 2
    model%contact_node = [1, 3]
    allocate (model%candidate_of(model%n_node), source=0)
    model%candidate_of(model%contact_node) = [1, 2]
    allocate (model%tool(2), model%phase(2))
    model%tool(1)%name = "punch"
    model%tool(2)%name = "die"
    model%phase(1)%name = "clamp"
    model%phase(2)%name = "draw"
    model%phase(2)%control = 1
    allocate (model%load_set(0), model%pressure_set(0), model%drawbead(0), model%contact_face(0))
    allocate (model%face_point(4, 0), model%is_rim_face(0))
    model%touched_faces = [side_faces, side_faces]
    allocate (model%candidate(2, 2), model%member(2, model%n_node), source=.false.)
    model%tool_digest = [0, 0]
    model%n_candidate = [0, 0]
    do i = 1, 2
      allocate (model%phase(i)%active(2), source=.true.)
      allocate (model%phase(i)%turn(2), model%phase(i)%tilt(2), model%phase(i)%cushion(2))
      allocate (model%phase(i)%spacer(0))
      allocate (model%phase(i)%pressed(2), source=.false.)
      model%phase(i)%mixed = .true.
    end do
    model%output%history = 1
    model%axes = reshape(identity, [3, 3, 1])
    call new_state(state, model)
  end subroutine make_small_model

  !> Return the number of a node.
  pure integer function node(i, j, k)
    !> Position in x, y and z, from 0.
    integer, intent(in) :: i, j, k

    node = 1 + k + 3*(j + 2*i)
  end function node

  !> Make a folder and remove a file from it.
  subroutine fresh_folder(folder, name)
    !> Path of the folder, name of the file in it.
    character(len=*), intent(in) :: folder, name

    type(error_t), allocatable :: error
    integer(c_int) :: ignored

    call make_directory(folder, error)
    ignored = posix_unlink(folder//"/"//name//c_null_char)
  end subroutine fresh_folder

  !> Make a folder in which a file is linked to a full device.
  subroutine link_full_disk(folder, name)
    !> Path of the folder, name of the file in it.
    character(len=*), intent(in) :: folder, name

    integer(c_int) :: ignored

    call fresh_folder(folder, name)
    ignored = posix_symlink("/dev/full"//c_null_char, folder//"/"//name//c_null_char)
  end subroutine link_full_disk

  !> Read the lines of a file.
  subroutine lines_of(path, line)
    character(len=*), intent(in) :: path
    !> Empty if the file cannot be read.
    type(line_t), allocatable, intent(out) :: line(:)

    character(len=2000) :: buffer
    integer :: unit, status, n, pass

    ! Count first, then store: gfortran 12 at -O3 loses lengths if such an array grows by
    ! constructors.
    do pass = 1, 2
      n = 0
      open (newunit=unit, file=path, status="old", action="read", iostat=status)
      do while (status == 0)
        read (unit, '(a)', iostat=status) buffer
        if (status /= 0) exit
        n = n + 1
        if (pass == 2) line(n)%text = trim(buffer)
      end do
      if (pass == 1) allocate (line(n))
      close (unit)
    end do
  end subroutine lines_of

end module small_model
