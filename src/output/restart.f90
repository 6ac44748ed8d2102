! SPDX-License-Identifier: GPL-3.0-or-later
!> restart.h5: the committed state of a run, the fingerprint of its model, and its mesh, from which
!> another run can take the sheet over (dd3_setup_sheet_file). The file is written aside, synced
!> and renamed, so that a run that is killed leaves the last whole one.
module dd3_output_restart
  use dd3_base_error, only : error_t, share_error
  use dd3_base_file, only : file_t
  use dd3_base_file_system, only : part_of, replace_file, sync_file
  use dd3_base_kinds, only : wp, i8
  use dd3_base_ranks, only : this_rank
  use dd3_base_text, only : join, newline
  use dd3_base_version, only : program_version
  use dd3_model_fingerprint, only : fingerprint_t, model_fingerprint
  use dd3_model_mesh_change, only : packed_integers, packed_reals
  use dd3_model_model, only : model_t, node_set_t
  use dd3_model_part, only : part_t
  use dd3_model_state, only : state_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_model_state_walk, only : visit_state
  use dd3_output_hdf5, only : integer_attribute, kind_int, kind_real, make_group, series_t, &
      start_hdf5, text_attribute
  use dd3_output_restart_format, only : format_version, mark, n_sizes, restart_name
  use hdf5, only : hid_t, h5aclose_f, h5fclose_f, h5fcreate_f, h5gclose_f, H5F_ACC_TRUNC_F
  implicit none
  private
  public :: write_restart

  !> Room on the disk for what is not the values, bytes.
  integer(i8), parameter :: overhead = 300000_i8

  !> Visitor that writes the components into a group, a dataset each.
  type, extends(state_visitor_t) :: writer_t
    integer(hid_t) :: group = -1
    logical :: ok = .true.
    !> Counts the bytes instead of writing them.
    logical :: counting = .false.
    integer(i8) :: bytes = 0
    type(part_t) :: part
  contains
    procedure :: reals => write_reals
    procedure :: integers => write_integers
    procedure :: reals_of_items => write_reals_of_items
    procedure :: integers_of_items => write_integers_of_items
  end type writer_t

contains

  !> Write the committed state.
  subroutine write_restart(directory, model, state, ended, error)
    !> Folder of the results.
    character(len=*), intent(in) :: directory
    type(model_t), intent(in) :: model
    !> Only read, but handed to a visitor.
    type(state_t), intent(inout) :: state
    !> Whether the state is the end of the last phase.
    logical, intent(in) :: ended
    !> Set if the file cannot be written; an older one is left as it is.
    type(error_t), allocatable, intent(out) :: error

    type(file_t) :: guard
    type(writer_t) :: writer
    character(len=:), allocatable :: path

    path = directory//"/"//restart_name
    writer%part = model%part
    writer%counting = .true.
    call visit_state(state, writer)
    call visit_mesh(model, ended, writer)
    if (this_rank() == 0) then
      call guard%create(part_of(path), error)
      if (.not. allocated(error)) call guard%reserve(0_i8, writer%bytes + overhead, error)
    end if
    call share_error(error)
    if (.not. allocated(error)) then
      call write_content(part_of(path), model, ended, state, writer%ok)
    end if
    if (this_rank() == 0) call finish_file(path, guard, writer%ok, error)
    call share_error(error)
  end subroutine write_restart

  !> Put a file in its place if it could be written, and close it.
  subroutine finish_file(path, guard, written, error)
    character(len=*), intent(in) :: path
    !> The file under its temporary name.
    type(file_t), intent(inout) :: guard
    logical, intent(in) :: written
    !> Reason why the file was not begun; set if it cannot be finished.
    type(error_t), allocatable, intent(inout) :: error

    type(error_t), allocatable :: ignored

    if (.not. allocated(error)) then
      if (written) then
        call sync_file(guard)
        call replace_file(path, guard, error)
      else
        call guard%refuse("cannot write '"//path//"': the library HDF5 refuses, most often as "// &
            "the disk is full or cannot be reached", error)
      end if
    end if
    call guard%release()
    call guard%close(ignored)
  end subroutine finish_file

  !> Write marks, fingerprint and state into a new file. The other ranks give their elements.
  subroutine write_content(path, model, ended, state, ok)
    character(len=*), intent(in) :: path
    type(model_t), intent(in) :: model
    logical, intent(in) :: ended
    !> Only read, but handed to a visitor.
    type(state_t), intent(inout) :: state
    logical, intent(out) :: ok

    type(writer_t) :: writer
    integer(hid_t) :: file, attribute
    integer :: status

    ok = .true.
    writer%part = model%part
    if (this_rank() > 0) then
      call visit_state(state, writer)
      return
    end if
    call start_hdf5(ok)
    call h5fcreate_f(path, H5F_ACC_TRUNC_F, file, status)
    ok = ok .and. status >= 0
    call text_attribute(file, "program", mark, ok)
    call integer_attribute(file, "format", [format_version], attribute, ok)
    if (ok) call h5aclose_f(attribute, status)
    call text_attribute(file, "version", program_version, ok)
    writer%ok = ok
    call make_group(file, "state", writer%group, writer%ok)
    call visit_state(state, writer)
    if (writer%group >= 0) call h5gclose_f(writer%group, status)
    call make_group(file, "model", writer%group, writer%ok)
    call visit_fingerprint(model_fingerprint(model, state%phase), writer)
    if (writer%group >= 0) call h5gclose_f(writer%group, status)
    call make_group(file, "mesh", writer%group, writer%ok)
    if (writer%ok) call text_attribute(writer%group, "element", trim(model%element%name), writer%ok)
    call visit_mesh(model, ended, writer)
    if (writer%group >= 0) call h5gclose_f(writer%group, status)
    ok = writer%ok
    if (.not. ok) return
    call h5fclose_f(file, status)
    ok = status >= 0
  end subroutine write_content

  !> Write a fingerprint: the names as character codes, and the check sums.
  subroutine visit_fingerprint(fingerprint, writer)
    type(fingerprint_t), intent(in) :: fingerprint(:)
    type(writer_t), intent(inout) :: writer

    integer :: code(len(fingerprint%part), size(fingerprint)), digest(size(fingerprint)), i, k

    do i = 1, size(fingerprint)
      code(:, i) = [(iachar(fingerprint(i)%part(k:k)), k=1, len(fingerprint%part))]
    end do
    digest = fingerprint%digest
    call writer%integers("part", size(code), code)
    call writer%integers("digest", size(digest), digest)
  end subroutine visit_fingerprint

  !> Write the mesh: initial coordinates, elements, their levels and bound nodes, materials of the
  !> elements, and the node sets of the sheet itself. Names are written as the character codes of a
  !> text, a line each.
  subroutine visit_mesh(model, ended, writer)
    type(model_t), intent(in) :: model
    logical, intent(in) :: ended
    type(writer_t), intent(inout) :: writer

    integer :: sizes(n_sizes)
    real(wp) :: thickness(1), placement(3, 4)
    real(wp), allocatable :: x0(:, :), axes(:, :, :)
    integer, allocatable :: connectivity(:, :), material_of(:), digest(:), label(:)
    character(len=:), allocatable :: materials

    sizes = [model%n_node, model%n_element, model%element%n_node, model%element%n_point, &
        model%n_internal, model%element%n_thickness_point, merge(1, 0, ended)]
    thickness = merge(0.0_wp, model%thickness, allocated(model%node_thickness))
    x0 = model%x0
    connectivity = model%connectivity
    material_of = model%material_of
    digest = model%material_digest
    materials = join(model%material_name, newline)//newline
    call writer%integers("sizes", n_sizes, sizes)
    call writer%reals("x0", size(x0), x0)
    call writer%reals("thickness", 1, thickness)
    placement = model%placement
    call writer%reals("placement", size(placement), placement)
    if (allocated(model%node_label)) then
      label = model%node_label
      call writer%integers("node_label", size(label), label)
    end if
    call writer%integers("connectivity", size(connectivity), connectivity)
    call visit_refinement(model, writer)
    call writer%integers("material_of", size(material_of), material_of)
    call writer%integers("material_digest", size(digest), digest)
    axes = model%axes
    call writer%reals("material_axes", size(axes), axes)
    call visit_text("materials", materials, writer)
    call visit_sets("", model%set(:model%n_sheet_set), writer)
    if (model%mesh_number > 0) call visit_refined(model, writer)
  end subroutine visit_mesh

  !> Write node sets.
  subroutine visit_sets(prefix, set, writer)
    !> Of the names of the datasets.
    character(len=*), intent(in) :: prefix
    type(node_set_t), intent(in) :: set(:)
    type(writer_t), intent(inout) :: writer

    integer, allocatable :: n_member(:), member(:)
    character(len=:), allocatable :: names
    integer :: i

    names = ""
    allocate (n_member(size(set)), member(0))
    do i = 1, size(set)
      names = names//set(i)%name//newline
      n_member(i) = size(set(i)%node)
      member = [member, set(i)%node]
    end do
    call visit_text(prefix//"sets", names, writer)
    call writer%integers(prefix//"set_size", size(n_member), n_member)
    call writer%integers(prefix//"set_node", size(member), member)
  end subroutine visit_sets

  !> Write what a restart cannot find anew on a refined mesh: the node sets of the input, which may
  !> have been selected by places, and the positions at the start of the job.
  subroutine visit_refined(model, writer)
    type(model_t), intent(in) :: model
    type(writer_t), intent(inout) :: writer

    real(wp), allocatable :: x(:, :)

    call visit_sets("input_", model%set(model%n_sheet_set + 1:), writer)
    if (.not. allocated(model%x_start)) return
    x = model%x_start
    call writer%reals("x_start", size(x), x)
  end subroutine visit_refined

  !> Write levels and bound nodes, where there are any, and the numbers of refinements and of nodes
  !> before the first.
  subroutine visit_refinement(model, writer)
    type(model_t), intent(in) :: model
    type(writer_t), intent(inout) :: writer

    integer :: number(2)
    integer, allocatable :: level(:), bound(:, :)

    number = [model%mesh_number, model%n_first_node]
    if (model%mesh_number > 0) call writer%integers("number", 2, number)
    call visit_changes(model, writer)
    if (allocated(model%level)) then
      level = model%level
      call writer%integers("level", size(level), level)
    end if
    if (.not. allocated(model%bound)) return
    bound = model%bound
    call writer%integers("bound", size(bound), bound)
  end subroutine visit_refinement

  !> Write the list of the refinements.
  subroutine visit_changes(model, writer)
    type(model_t), intent(in) :: model
    type(writer_t), intent(inout) :: writer

    integer, allocatable :: number(:, :)
    real(wp), allocatable :: value(:, :)

    if (.not. allocated(model%change)) return
    number = packed_integers(model%change)
    value = packed_reals(model%change)
    call writer%integers("change_number", size(number), number)
    call writer%reals("change_value", size(value), value)
  end subroutine visit_changes

  !> Write a text as character codes.
  subroutine visit_text(name, text, writer)
    character(len=*), intent(in) :: name, text
    type(writer_t), intent(inout) :: writer

    integer :: code(len(text)), i

    code = [(iachar(text(i:i)), i=1, len(text))]
    call writer%integers(name, size(code), code)
  end subroutine visit_text

  !> Write a component of real numbers.
  subroutine write_reals(self, name, n, values)
    class(writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    real(wp), intent(inout) :: values(n)

    type(series_t) :: series

    self%bytes = self%bytes + 8*int(n, i8)
    if (self%counting) return
    if (this_rank() > 0) return
    call series%create(self%group, name, kind_real, 1, .false., max(1, n), self%ok)
    if (n > 0) call series%append_reals(values, self%ok)
    call series%close()
  end subroutine write_reals

  !> Write a component of integers.
  subroutine write_integers(self, name, n, values)
    class(writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    integer, intent(inout) :: values(n)

    type(series_t) :: series

    self%bytes = self%bytes + 4*int(n, i8)
    if (self%counting) return
    if (this_rank() > 0) return
    call series%create(self%group, name, kind_int, 1, .false., max(1, n), self%ok)
    if (n > 0) call series%append_integers(values, self%ok)
    call series%close()
  end subroutine write_integers

  !> Write real numbers of the elements or contact points of all ranks.
  subroutine write_reals_of_items(self, item, name, n, n_item, values)
    class(writer_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items of this rank.
    integer, intent(in) :: n, n_item
    real(wp), intent(inout) :: values(n, n_item)

    real(wp), allocatable :: all(:, :)

    if (self%counting) then
      self%bytes = self%bytes + 8*size(self%part%ranks_of(item), kind=i8)*int(n, i8)
    else
      call self%part%gather(item, n, n_item, values, all)
      call self%reals(name, size(all), all)
    end if
  end subroutine write_reals_of_items

  !> Write integers of the elements or contact points of all ranks.
  subroutine write_integers_of_items(self, item, name, n, n_item, values)
    class(writer_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items of this rank.
    integer, intent(in) :: n, n_item
    integer, intent(inout) :: values(n, n_item)

    real(wp), allocatable :: all(:, :)
    integer, allocatable :: number(:, :)

    if (self%counting) then
      self%bytes = self%bytes + 4*size(self%part%ranks_of(item), kind=i8)*int(n, i8)
    else
      call self%part%gather(item, n, n_item, real(values, wp), all)
      number = nint(all)
      call self%integers(name, size(number), number)
    end if
  end subroutine write_integers_of_items

end module dd3_output_restart
