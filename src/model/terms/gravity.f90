! SPDX-License-Identifier: GPL-3.0-or-later
!> Weight of the sheet: a load on all nodes by their masses, which are those of the initial
!> elements, consistent with the shape functions.
module dd3_model_terms_gravity
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : determinant
  use dd3_model_model, only : model_t
  use dd3_model_rigid_motion, only : new_supported_part, parts_of_nodes, rigid_motion_t
  use dd3_model_terms_load_sets, only : load_set_t
  implicit none
  private
  public :: gravity_name, new_weight_set, is_free

  !> Name of the set of the weight, which no set of the input has.
  character(len=*), parameter :: gravity_name = "*gravity"

contains

  !> Make the set of the weight; `scale` is the mass of the sheet, t.
  pure subroutine new_weight_set(set, model, density)
    type(load_set_t), intent(out) :: set
    !> With its mesh.
    type(model_t), intent(in) :: model
    !> Of each material, t/mm3.
    real(wp), intent(in) :: density(:)

    real(wp) :: mass(model%n_node), jacobian(3, 3), volume
    integer :: e, p, i

    mass = 0.0_wp
    associate (element => model%element)
      do e = 1, model%n_element
        associate (node => model%connectivity(:, e))
          do p = 1, element%n_point
            jacobian = matmul(model%x0(:, node), transpose(element%dshape(:, :, p)))
            volume = element%weight(p)*determinant(jacobian)
            mass(node) = mass(node) + density(model%material_of(e))*volume*element%shape(:, p)
          end do
        end associate
      end do
    end associate
    set%name = gravity_name
    set%scale = sum(mass)
    set%node = [(i, i=1, model%n_node)]
    set%weight = mass/max(tiny(1.0_wp), set%scale)
  end subroutine new_weight_set

  !> Whether the supports leave the sheet, or a part of it, free to move as a rigid body.
  logical function is_free(model, number, x)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    type(rigid_motion_t) :: body
    integer :: part(model%n_node), k

    part = parts_of_nodes(model%connectivity, model%n_node)
    is_free = .false.
    do k = 1, maxval(part)
      call new_supported_part(body, x, model%phase(number)%held(), part == k)
      is_free = is_free .or. len(body%free_motion()) > 0
    end do
  end function is_free

end module dd3_model_terms_gravity
