!> A block of two elements on each other, two tools and two phases, for the tests of the records.
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
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t, new_state
  implicit none
  private
  public :: make_small_model, fresh_folder, lead_to_full_disk, lines_of, line_t

  !> A line of text.
  type :: line_t
    !> Its text.
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

  !> A block of 2 x 3 x 1 mm: 12 nodes, numbered through the thickness first.
  subroutine make_small_model(model, state)
    !> The model.
    type(model_t), intent(out) :: model
    !> The initial state.
    type(state_t), intent(out) :: state
    type(law_choice_t) :: criterion, hardening, none(0)
    type(error_t), allocatable :: error
    integer :: i, j, k

    call new_element(model%element, "hex8", error)
    model%title = "two elements"
    model%n_node = 12
    model%n_element = 2
    model%n_tool = 2
    model%n_contact = 2
    model%n_internal = 1
    model%thickness = 1.0_wp
    allocate (model%x0(3, 12), model%connectivity(8, 2))
    do i = 0, 1
      do j = 0, 1
        do k = 0, 2
          model%x0(:, node(i, j, k)) = [2.0_wp*i, 3.0_wp*j, 0.5_wp*k]
        end do
      end do
    end do
    do k = 0, 1
      model%connectivity(:, k + 1) = [node(0, 0, k), node(1, 0, k), node(1, 1, k), node(0, 1, k), &
                                      node(0, 0, k + 1), node(1, 0, k + 1), node(1, 1, k + 1), &
                                      node(0, 1, k + 1)]
    end do
    criterion%name = "von_mises"
    hardening%name = "perfect"
    allocate (criterion%values(0))
    hardening%values = [law_value_t("Y0", 200.0_wp)]
    allocate (model%material(1))
    call new_material(model%material(1), 2.1e5_wp, 0.3_wp, criterion, hardening, none)
    model%material_of = [1, 1]
    model%contact_node = [1, 3]
    model%candidate_of = [1, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    allocate (model%tool(2), model%phase(2))
    model%tool(1)%name = "punch"
    model%tool(2)%name = "die"
    model%phase(1)%name = "clamp"
    model%phase(2)%name = "draw"
    model%phase(2)%control = 1
    allocate (model%load_set(0))
    model%output%history_every = 1
    model%axes = reshape(identity, [3, 3, 1])
    call new_state(state, model)
  end subroutine make_small_model

  !> Number of a node.
  pure integer function node(i, j, k)
    !> Its places along x, y and z, from 0.
    integer, intent(in) :: i, j, k

    node = 1 + k + 3*(j + 2*i)
  end function node

  !> Makes a folder whose files of these names are gone.
  subroutine fresh_folder(folder, name)
    !> The folder, and the file in it.
    character(len=*), intent(in) :: folder, name
    type(error_t), allocatable :: error
    integer(c_int) :: ignored

    call make_directory(folder, error)
    ignored = posix_unlink(folder//"/"//name//c_null_char)
  end subroutine fresh_folder

  !> Makes a folder in which a file stands for a full disk.
  subroutine lead_to_full_disk(folder, name)
    !> The folder, and the file in it.
    character(len=*), intent(in) :: folder, name
    integer(c_int) :: ignored

    call fresh_folder(folder, name)
    ignored = posix_symlink("/dev/full"//c_null_char, folder//"/"//name//c_null_char)
  end subroutine lead_to_full_disk

  !> The lines of a file.
  subroutine lines_of(path, line)
    !> Its name.
    character(len=*), intent(in) :: path
    !> The lines; none where it cannot be read.
    type(line_t), allocatable, intent(out) :: line(:)
    character(len=2000) :: buffer
    integer :: unit, status, n, pass

    ! Counted first, then kept: gfortran 12 at -O3 loses lengths where such an array grows by
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
