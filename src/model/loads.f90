!> External forces on the nodes: the loads of the input, each the total force on a node set, and the
!> fading contact forces of released tools.
module dd3_model_loads
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: load_set_t, nodal_forces

  !> Node set that carries a load in some phase, in equal parts.
  type :: load_set_t
    character(len=:), allocatable :: name
    integer, allocatable :: node(:)
  end type load_set_t

contains

  !> Evaluate the external forces on the nodes.
  pure subroutine nodal_forces(set, load, contact_node, fading, force)
    type(load_set_t), intent(in) :: set(:)
    !> Total force on each set, `(3, size(set))`, N.
    real(wp), intent(in) :: load(:, :)
    !> Nodes of the contact candidates, `(n_contact)`.
    integer, intent(in) :: contact_node(:)
    !> Forces of the candidates on released tools that have not faded yet, `(3, n_contact)`, N.
    real(wp), intent(in) :: fading(:, :)
    !> Nodal forces, `(3, n_node)`, N.
    real(wp), intent(out) :: force(:, :)

    integer :: s, k, c

    force = 0.0_wp
    do s = 1, size(set)
      associate (node => set(s)%node)
        do k = 1, size(node)
          force(:, node(k)) = force(:, node(k)) + load(:, s)/real(size(node), wp)
        end do
      end associate
    end do
    do c = 1, size(contact_node)
      force(:, contact_node(c)) = force(:, contact_node(c)) - fading(:, c)
    end do
  end subroutine nodal_forces

end module dd3_model_loads
