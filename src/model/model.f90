! SPDX-License-Identifier: GPL-3.0-or-later
!> Constant data of a run. What depends on the mesh is inherited, from the sheet and its contact
!> points; the components added here are the process: materials, tools, phases, output.
module dd3_model_model
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_material_material, only : material_t
  use dd3_model_contact_data, only : contact_data_t
  use dd3_model_internal_variables, only : variable_t
  use dd3_model_mesh_change, only : mesh_change_t
  use dd3_model_mesh_data, only : node_set_t
  use dd3_model_phase, only : phase_t
  use dd3_model_terms_drawbead, only : drawbead_t
  use dd3_settings_output, only : history_quantities_t, output_spec_t
  use dd3_tools_tool, only : tool_t
  implicit none
  private
  public :: model_t, history_set_t, node_set_t

  !> Node set with quantities in history.csv; its name is the prefix of their columns.
  type, extends(history_quantities_t) :: history_set_t
    character(len=:), allocatable :: name
    integer, allocatable :: node(:)
  end type history_set_t

  !> Model of a job.
  type, extends(contact_data_t) :: model_t
    character(len=:), allocatable :: title
    integer :: n_tool = 0, n_internal = 0
    !> Number of locating pins, supports of *BOUNDARY with a diameter.
    integer :: n_pin = 0
    type(material_t), allocatable :: material(:)
    character(len=24), allocatable :: material_name(:)
    !> Check sums of their parameters.
    integer, allocatable :: material_digest(:)
    !> Internal variables of the materials, for output.
    type(variable_t), allocatable :: internal_variable(:)
    !> Orthotropy axes of each material at the start, columns RD, TD, ND, `(3, 3, n_material)`.
    real(wp), allocatable :: axes(:, :, :)
    type(tool_t), allocatable :: tool(:)
    !> Check sums of the tools with their candidates.
    integer, allocatable :: tool_digest(:)
    type(drawbead_t), allocatable :: drawbead(:)
    type(phase_t), allocatable :: phase(:)
    !> Node sets recorded in history.csv.
    type(history_set_t), allocatable :: history(:)
    !> Of the sheet on which the run has begun, before elements were divided in it: mean edge of its
    !> undivided elements, mm, and check sums of its mesh and of its node sets, `(1 + n_set)`. These
    !> are allocated with the first refinement.
    real(wp) :: undivided_length = 0.0_wp
    integer, allocatable :: first_digest(:)
    !> Refinements of the sheet since the start of the job; not allocated before the first.
    type(mesh_change_t), allocatable :: change(:)
    !> Of the cuts of the sheet.
    type(message_list_t) :: cut_warnings
    !> What is written, and when.
    type(output_spec_t) :: output
  contains
    procedure :: turns
    procedure :: tilts
    procedure :: least_shear
    procedure :: begins
    procedure :: returns
  end type model_t

contains

  !> Whether a tool turns in some phase.
  pure logical function turns(self, tool)
    class(model_t), intent(in) :: self
    integer, intent(in) :: tool

    integer :: i

    turns = any([(self%phase(i)%turns(tool), i=1, size(self%phase))])
  end function turns

  !> Whether a tool tilts in some phase.
  pure logical function tilts(self, tool)
    class(model_t), intent(in) :: self
    integer, intent(in) :: tool

    integer :: i

    tilts = any([(self%phase(i)%tilts(tool), i=1, size(self%phase))])
  end function tilts

  !> Return the smallest shear modulus of the elements, MPa.
  pure real(wp) function least_shear(self)
    class(model_t), intent(in) :: self

    integer :: m

    least_shear = huge(1.0_wp)
    do m = 1, size(self%material)
      if (any(self%material_of == m)) then
        least_shear = min(least_shear, self%material(m)%laws%elasticity%shear)
      end if
    end do
  end function least_shear

  !> Whether a tool begins to have contact in a phase: it has none in the phase before.
  pure logical function begins(self, number, tool)
    class(model_t), intent(in) :: self
    !> Number of the phase.
    integer, intent(in) :: number
    integer, intent(in) :: tool

    begins = self%phase(number)%active(tool)
    if (begins .and. number > 1) begins = .not. self%phase(number - 1)%acts(tool)
  end function begins

  !> Whether a phase names a tool that an earlier one released, so that it has contact again.
  pure logical function returns(self, number, tool)
    class(model_t), intent(in) :: self
    !> Number of the phase.
    integer, intent(in) :: number
    integer, intent(in) :: tool

    returns = number > 1 .and. self%begins(number, tool)
  end function returns

end module dd3_model_model
