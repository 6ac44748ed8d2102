! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of locating pins, supports of *BOUNDARY with `pin`.
module dd3_setup_pins
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : axis_name
  use dd3_input_case, only : case_t
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: check_pins

  !> Largest cosine between a direction in which a pin holds the sheet and the sheet's normal.
  real(wp), parameter :: in_plane = 0.5_wp

contains

  !> Check that pins hold nodes of columns through the thickness, in directions in the plane of the
  !> sheet at the start.
  subroutine check_pins(model, case, mesh, errors)
    !> With its columns.
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: x(:, :)
    integer :: i, axis

    x = model%x0
    if (allocated(model%x_start)) x = model%x_start
    do i = 1, size(case%boundary)
      associate (support => case%boundary(i))
        if (support%pin <= 0.0_wp) cycle
        do axis = 1, 3
          if (.not. support%fix(axis)) cycle
          if (is_across(mesh%nodes_of(support%set), axis)) cycle
          call errors%push_input(support%source%at("fix"), "the pin '"//support%source%called()// &
              "' holds the sheet along "//axis_name(axis)//", its normal", &
              "one or two directions in the plane of the sheet", code="E124")
        end do
      end associate
    end do

  contains

    !> Whether the columns of nodes are across an axis.
    pure logical function is_across(node, axis)
      integer, intent(in) :: node(:), axis

      integer :: k

      is_across = .true.
      do k = 1, size(node)
        associate (d => x(:, model%column(2, node(k))) - x(:, model%column(1, node(k))))
          is_across = is_across .and. norm2(d) > 0.0_wp .and. abs(d(axis)) <= in_plane*norm2(d)
        end associate
      end do
    end function is_across

  end subroutine check_pins

end module dd3_setup_pins
