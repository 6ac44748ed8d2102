! SPDX-License-Identifier: GPL-3.0-or-later
!> Plastic strain of the sheet under the contact points.
module dd3_model_contact_strain
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: strains_below

contains

  !> Return the equivalent plastic strain at the integration point next to each contact point of the
  !> rank, in the element that the contact point belongs to, `(n_contact)`.
  function strains_below(model, state) result(strain)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: strain(model%n_contact)

    real(wp), allocatable :: of_sheet(:, :)
    integer :: c

    ! The element of a point at a node may belong to another rank.
    allocate (of_sheet(model%element%n_point, model%n_element), source=0.0_wp)
    of_sheet(:, model%part%element) = state%sheet%internal_variables(1, :, :)
    if (model%part%divided) call sum_over_ranks(size(of_sheet), of_sheet)
    do c = 1, model%n_contact
      strain(c) = of_sheet(nearest_point(model, c), model%contact_point(c)%element)
    end do
  end function strains_below

  !> Return the integration point next to a contact point.
  pure integer function nearest_point(model, c)
    type(model_t), intent(in) :: model
    integer, intent(in) :: c

    real(wp) :: place(3)

    associate (point => model%contact_point(c), element => model%element)
      associate (n => point%n_surface)
        place = matmul(element%node(:, point%local(:n)), point%weight(:n))
      end associate
      nearest_point = minloc(sum((element%point - spread(place, 2, element%n_point))**2, dim=1), &
          dim=1)
    end associate
  end function nearest_point

end module dd3_model_contact_strain
