! SPDX-License-Identifier: GPL-3.0-or-later
!> State of a run on a refined sheet. Tools, terms and the place in the process stay; positions,
!> stresses and internal variables are those of the refined sheet; what belongs to the contact
!> points and to the start of the phase is carried over. Internal forces are left to the caller: the
!> state is in equilibrium but for what the transfer changes.
module dd3_model_refined_state
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : text_t
  use dd3_model_bound_nodes, only : follow_parents
  use dd3_model_model, only : model_t
  use dd3_model_refined_contact, only : carry_contact
  use dd3_model_sheet_state, only : new_sheet_state
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : external_forces
  use dd3_sheet_refinement, only : refinement_t
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: sheet_of, refined_state

contains

  !> Return the sheet of a state, with its mesh.
  function sheet_of(model, state) result(sheet)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(sheet_t) :: sheet

    integer :: i

    associate (mesh => sheet%mesh)
      mesh%n_node = model%n_node
      mesh%n_element = model%n_element
      mesh%n_element_node = model%element%n_node
      mesh%x = model%x0
      mesh%connectivity = model%connectivity
      mesh%material = model%material_of
      if (.not. allocated(model%node_thickness)) mesh%thickness = model%thickness
      mesh%placement = model%placement
      if (allocated(model%node_label)) mesh%node_label = model%node_label
      if (allocated(model%level)) mesh%level = model%level
      if (model%n_bound > 0) mesh%bound = model%bound
      allocate (mesh%set(size(model%set)), mesh%element_set(0))
      do i = 1, size(model%set)
        mesh%set(i)%name = model%set(i)%name
        mesh%set(i)%node = model%set(i)%node
      end do
    end associate
    sheet%element = trim(model%element%name)
    allocate (sheet%material(0), sheet%digest(0))
    sheet%x = state%x
    sheet%has_state = .true.
    sheet%stress = state%sheet%stress
    sheet%internal_variables = state%sheet%internal_variables
    sheet%orientation = state%sheet%orientation
    sheet%report = ""
  end function sheet_of

  !> Set the state on a refined sheet.
  subroutine refined_state(old_model, old, model, sheet, origin, new)
    type(model_t), intent(in) :: old_model
    type(state_t), intent(in) :: old
    !> On the refined sheet.
    type(model_t), intent(in) :: model
    !> The refined sheet; its mesh is not used. The first of its earlier positions are those at the
    !> start of the phase.
    type(sheet_t), intent(in) :: sheet
    type(refinement_t), intent(in) :: origin
    type(state_t), intent(out) :: new

    real(wp), allocatable :: carried(:, :, :)
    integer :: k

    new = old
    new%x = sheet%x
    call follow_parents(model, new%x)
    call new_sheet_state(new%sheet, model, sheet)
    call origin%carry_points(reshape(merge(1.0_wp, 0.0_wp, old%sheet%plastic), &
        [1, shape(old%sheet%plastic)]), carried)
    new%sheet%plastic(:, :) = carried(1, :, :) > 0.5_wp
    call carry_contact(old_model, old%configuration_t, model, origin, new)
    new%start%x = sheet%earlier(:, :, 1)
    call follow_parents(model, new%start%x)
    call origin%carry_points(reshape(old%start%plastic_strain, &
        [1, shape(old%start%plastic_strain)]), carried)
    new%start%plastic_strain = carried(1, :, :)
    do k = 1, size(new%term)
      call new%term(k)%of%extend(old_model, model, new%configuration_t)
    end do
    call carry_observations(old_model, model, new)
    new%external_force = external_forces(new%term, model, new%configuration_t)
  end subroutine refined_state

  !> Find the faces again of which depths of tools are told; the depth in a face that is divided
  !> does not count any more.
  subroutine carry_observations(old_model, model, new)
    type(model_t), intent(in) :: old_model, model
    type(state_t), intent(inout) :: new

    integer :: f, tool

    do tool = 1, model%n_tool
      associate (face => new%observed%deepest_face(tool))
        if (face == 0) cycle
        do f = 1, model%face%n
          if (all(model%face%corner(:, f) == old_model%face%corner(:, face))) exit
        end do
        face = merge(f, 0, f <= model%face%n)
        if (face > 0) cycle
      end associate
      new%observed%depth(tool) = 0.0_wp
      new%observed%largest_depth(tool) = 0.0_wp
      new%observed%deepest_radius(tool) = huge(1.0_wp)
    end do
  end subroutine carry_observations

end module dd3_model_refined_state
