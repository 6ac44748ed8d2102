! SPDX-License-Identifier: GPL-3.0-or-later
!> Element of the sheet: that of the input, of the run whose sheet goes on, or the default, which
!> depends on the number of layers. The default bends one layer exactly whatever the length of its
!> elements; in several layers the elements of a section share its bending.
module dd3_setup_element
  use dd3_base_error, only : error_list_t, error_t
  use dd3_base_text, only : newline, to_text
  use dd3_element_registry, only : element_names, new_element
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t
  use dd3_input_known_name, only : check_known_name
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_model, only : model_t
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: set_element, set_element_of_mesh, default_report

  !> Defaults for one layer of elements and for several; both have eight nodes in the same order.
  character(len=*), parameter :: of_one_layer = "solid_shell", of_layers = "hex8"

contains

  !> Set the element's table, or report a name that is not in the registry. Without a name a mesh
  !> from a file has the default for several layers until it is read.
  subroutine set_element(model, case, sheet, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> The sheet of another run, if the case starts from one.
    type(sheet_t), intent(in) :: sheet
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(error_t), allocatable :: error
    integer :: i

    if (size(case%start) > 0 .and. allocated(sheet%element)) then
      call new_element(model%element, sheet%element, error, sheet%thickness_points)
    end if
    do i = 1, size(case%blank)
      associate (blank => case%blank(i))
        if (blank%element /= "") then
          call set_named(model, blank%source, blank%element, blank%thickness_points, errors)
        else if (is_left_out(blank%source) .and. blank%source%has("divisions")) then
          call set_default(model, blank%source, blank%divisions(3) == 1, blank%thickness_points, &
              errors)
        end if
      end associate
    end do
    do i = 1, size(case%mesh)
      associate (mesh => case%mesh(i))
        if (mesh%element /= "") then
          call set_named(model, mesh%source, mesh%element, mesh%thickness_points, errors)
        else if (is_left_out(mesh%source)) then
          call new_element(model%element, of_layers, error)
        end if
      end associate
    end do
  end subroutine set_element

  !> Set the element of a mesh from a file that has been read, unless the input names one.
  subroutine set_element_of_mesh(model, case, mesh, errors)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    if (size(case%mesh) == 0) return
    associate (spec => case%mesh(1))
      if (is_left_out(spec%source)) call set_default(model, spec%source, is_one_layer(mesh), &
          spec%thickness_points, errors)
    end associate
  end subroutine set_element_of_mesh

  !> Return a line on the default that acts, with its end; empty if the input names the element.
  function default_report(case, model) result(text)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    logical :: acts

    acts = .false.
    if (size(case%blank) > 0) acts = is_left_out(case%blank(1)%source)
    if (size(case%mesh) > 0) acts = is_left_out(case%mesh(1)%source)
    text = ""
    if (.not. acts) return
    text = "default: element = "//trim(model%element%name)
    if (model%element%name == of_one_layer) then
      text = text//" with "//to_text(model%element%n_thickness_point)// &
          " points through the thickness, as the sheet is one layer; "//of_layers//" for more"// &
          newline
    else
      text = text//", as the sheet has several layers; "//of_one_layer// &
          " for one"//newline
    end if
  end function default_report

  !> Set the element that the input names.
  subroutine set_named(model, block, element, thickness_points, errors)
    type(model_t), intent(inout) :: model
    type(block_t), intent(in) :: block
    !> Its name.
    character(len=*), intent(in) :: element
    integer, intent(in) :: thickness_points
    type(error_list_t), intent(inout) :: errors

    type(error_t), allocatable :: error
    character(len=16), allocatable :: name(:)
    integer :: position

    name = element_names()
    call check_known_name(element, block%at("element"), "element type", name, position, errors)
    if (position == 0 .or. .not. block%has("thickness_points")) return
    call new_element(model%element, name(position), error, thickness_points)
    call check_points(model, block, errors)
  end subroutine set_named

  !> Set the default.
  subroutine set_default(model, block, one_layer, thickness_points, errors)
    type(model_t), intent(inout) :: model
    type(block_t), intent(in) :: block
    !> Whether the sheet is one layer of elements.
    logical, intent(in) :: one_layer
    integer, intent(in) :: thickness_points
    type(error_list_t), intent(inout) :: errors

    type(error_t), allocatable :: error

    if (.not. block%has("thickness_points")) return
    if (one_layer) then
      call new_element(model%element, of_one_layer, error, thickness_points)
    else
      call new_element(model%element, of_layers, error)
    end if
    call check_points(model, block, errors)
  end subroutine set_default

  !> Report a number of points through the thickness that the element does not take.
  subroutine check_points(model, block, errors)
    type(model_t), intent(in) :: model
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    if (.not. block%given("thickness_points")) return
    if (model%element%n_thickness_point == 0) call errors%push_input( &
        block%at("thickness_points"), "element type '"//trim(model%element%name)// &
        "' has a fixed number of points through the thickness", &
        "this key only with an element that has a choice: solid_shell", code="E148")
  end subroutine check_points

  !> Whether a block of the sheet has no key `element`.
  pure logical function is_left_out(block)
    type(block_t), intent(in) :: block

    is_left_out = block%find("element") == 0
  end function is_left_out

  !> Whether all nodes of a mesh of elements with eight nodes are at the two faces of the sheet.
  pure logical function is_one_layer(mesh)
    type(mesh_t), intent(in) :: mesh

    logical :: lower(mesh%n_node), upper(mesh%n_node)

    lower = .false.
    upper = .false.
    lower(mesh%nodes_of("z_min")) = .true.
    upper(mesh%nodes_of("z_max")) = .true.
    associate (node => mesh%connectivity)
      is_one_layer = all(lower(pack(node(:4, :), .true.))) .and. &
          all(upper(pack(node(5:, :), .true.)))
    end associate
  end function is_one_layer

end module dd3_setup_element
