! SPDX-License-Identifier: GPL-3.0-or-later
!> Model of a single element, a block of 4 x 2 x 1 mm, and its bending.
module single_element
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_element_registry, only : new_element
  use dd3_model_model, only : model_t
  use dd3_model_part, only : new_part
  use dd3_model_thickness_columns, only : set_columns
  implicit none
  private
  public :: element_name, length, rotation
  public :: make_single_element, bent

  character(len=*), parameter :: element_name(4) = [character(len=11) :: "hex8", "solid_shell", &
      "hex20", "hex27"]

  !> Of the block, mm.
  real(wp), parameter :: length = 4.0_wp

  !> Rotation matrix.
  real(wp), parameter :: rotation(3, 3) = reshape([2.0_wp, -1.0_wp, 2.0_wp, 2.0_wp, 2.0_wp, &
      -1.0_wp, -1.0_wp, 2.0_wp, 2.0_wp], [3, 3])/3.0_wp

contains

  !> Make the model.
  subroutine make_single_element(model, element)
    type(model_t), intent(out) :: model
    character(len=*), intent(in) :: element

    type(error_t), allocatable :: error
    integer :: a

    call new_element(model%element, trim(element), error)
    model%n_element = 1
    model%n_node = model%element%n_node
    allocate (model%connectivity(model%n_node, 1))
    model%connectivity(:, 1) = [(a, a=1, model%n_node)]
    call new_part(model%part, model%n_node, model%n_element)
    allocate (model%x0(3, model%n_node))
    model%x0(1, :) = 0.5_wp*length*model%element%node(1, :)
    model%x0(2, :) = model%element%node(2, :)
    model%x0(3, :) = 0.5_wp*model%element%node(3, :)
    call set_columns(model)
  end subroutine make_single_element

  !> Return the nodes of the block bent to an arc, with directors of some length, and rotated.
  function bent(model, angle, director) result(x)
    type(model_t), intent(in) :: model
    !> rad; mm.
    real(wp), intent(in) :: angle, director
    real(wp), allocatable :: x(:, :)

    real(wp) :: radius, phi
    integer :: i

    x = model%x0
    do i = 1, model%n_node
      phi = angle*model%x0(1, i)/length
      radius = length/angle + director*model%x0(3, i)
      x(1, i) = radius*sin(phi)
      x(3, i) = radius*cos(phi)
    end do
    x = matmul(rotation, x)
  end function bent

end module single_element
