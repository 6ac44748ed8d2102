! SPDX-License-Identifier: GPL-3.0-or-later
!> Columns of history.csv that follow those of the tools and of the node sets: contact area and
!> largest pressure of each tool, work and energies.
module dd3_output_forming_columns
  use dd3_base_kinds, only : wp
  use dd3_model_contact_results, only : tool_contact_t, tool_contacts
  use dd3_model_energy, only : contact_energy, elastic_energy, energy_error
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : new_terms
  use dd3_model_terms_term, only : term_box_t
  use dd3_output_csv, only : table_t
  implicit none
  private
  public :: add_forming_heading, add_forming_values

  !> Names of the energies, in the order of `energies`.
  character(len=*), parameter :: energy_name(8) = [character(len=15) :: "tool_work", &
      "external_work", "internal_work", "elastic_energy", "plastic_work", "friction_work", &
      "contact_energy", "energy_error"]

contains

  !> Add names and units of the columns.
  subroutine add_forming_heading(model, names, units)
    type(model_t), intent(in) :: model
    !> Separated by commas.
    character(len=:), allocatable, intent(inout) :: names, units

    type(term_box_t), allocatable :: terms(:)
    integer :: i

    do i = 1, model%n_tool
      names = names//","//trim(model%tool(i)%name)//"_area,"//trim(model%tool(i)%name)//"_pressure"
      units = units//",mm2,MPa"
    end do
    call new_terms(terms, model)
    do i = 1, size(terms)
      call terms(i)%of%columns(model, names, units)
    end do
    do i = 1, size(energy_name)
      names = names//","//trim(energy_name(i))
      units = units//",mJ"
    end do
    if (.not. any(model%material%laws%softens)) return
    names = names//",modulus_energy"
    units = units//",mJ"
  end subroutine add_forming_heading

  !> Add the values of a state to a row.
  subroutine add_forming_values(table, model, state)
    type(table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    type(tool_contact_t) :: contact(model%n_tool)
    real(wp), allocatable :: row(:)
    integer :: i

    if (model%n_tool > 0) contact = tool_contacts(model, state)
    do i = 1, model%n_tool
      call table%add_real(contact(i)%area)
      call table%add_real(contact(i)%pressure)
    end do
    row = [real(wp) ::]
    do i = 1, size(state%term)
      call state%term(i)%of%values(row)
    end do
    call table%add_reals(row)
    call table%add_reals(energies(model, state))
    if (any(model%material%laws%softens)) call table%add_real(state%work%modulus)
  end subroutine add_forming_values

  !> Return work and energies, mJ.
  function energies(model, state) result(energy)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: energy(size(energy_name))

    energy = [state%work%tools, state%work%external, state%work%internal, &
        elastic_energy(model, state), state%work%plastic, state%work%friction, &
        contact_energy(model, state), energy_error(model, state)]
  end function energies

end module dd3_output_forming_columns
