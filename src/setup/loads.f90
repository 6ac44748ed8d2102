! SPDX-License-Identifier: GPL-3.0-or-later
!> Loads and pressures of the phases: their sets on the mesh, and what a phase changes of them.
module dd3_setup_loads
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t, phase_spec_t
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_terms_gravity, only : gravity_name, new_weight_set
  use dd3_model_terms_load_sets, only : face_load_weights, load_set_t, pressure_set_t
  implicit none
  private
  public :: check_density, new_load_sets, new_pressure_sets, set_loads

contains

  !> Set the loads of the sets that the phase names.
  subroutine set_loads(spec, model, phase)
    type(phase_spec_t), intent(in) :: spec
    type(model_t), intent(in) :: model
    type(phase_t), intent(inout) :: phase

    integer :: i, s

    do i = 1, size(spec%load)
      do s = 1, size(model%load_set)
        if (model%load_set(s)%name /= spec%load(i)%set) cycle
        phase%loads%final(:, s) = spec%load(i)%force
        phase%loads%keeps(s) = .false.
      end do
    end do
    do s = 1, size(model%load_set)
      if (.not. spec%has_gravity .or. model%load_set(s)%name /= gravity_name) cycle
      phase%loads%final(:, s) = model%load_set(s)%scale*spec%gravity
      phase%loads%keeps(s) = .false.
    end do
    do i = 1, size(spec%pressure)
      do s = 1, size(model%pressure_set)
        if (model%pressure_set(s)%name /= spec%pressure(i)%set) cycle
        phase%pressures%final(s) = spec%pressure(i)%value
        phase%pressures%keeps(s) = .false.
      end do
    end do
  end subroutine set_loads

  !> Report the first phase with gravity if a material of the sheet has no density.
  subroutine check_density(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: i, m

    do i = 1, size(case%phase)
      if (.not. case%phase(i)%has_gravity) cycle
      do m = 1, size(case%material)
        if (case%material(m)%density > 0.0_wp .or. .not. any(model%material_of == m)) cycle
        call errors%push_input(case%phase(i)%source%at("gravity"), "material '"// &
            case%material(m)%source%called()//"' has no density", &
            "density = 7.85e-9 (t/mm3, steel) in *MATERIAL "//case%material(m)%source%called(), &
            code="E121")
      end do
      return
    end do
  end subroutine check_density

  !> List the sets that carry a pressure in some phase, with their faces on the boundary.
  subroutine new_pressure_sets(model, case, mesh)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh

    type(pressure_set_t) :: set
    logical :: member(mesh%n_node), inside(model%face%n)
    integer :: i, j, s, f

    allocate (model%pressure_set(0))
    do i = 1, size(case%phase)
      do j = 1, size(case%phase(i)%pressure)
        associate (name => case%phase(i)%pressure(j)%set)
          if (any([(model%pressure_set(s)%name == name, s=1, size(model%pressure_set))])) cycle
          set%name = name
          member = .false.
          member(mesh%nodes_of(name)) = .true.
          inside = [(all(member(model%face%node(:, f))), f=1, model%face%n)]
          set%node = model%face%node(:, pack([(f, f=1, model%face%n)], inside))
          model%pressure_set = [model%pressure_set, set]
        end associate
      end do
    end do
  end subroutine new_pressure_sets

  !> List the sets that carry a load in some phase, in the order of the phases, then the weight.
  subroutine new_load_sets(model, case, mesh)
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    type(mesh_t), intent(in) :: mesh

    type(load_set_t) :: set
    integer :: i, j, s

    allocate (model%load_set(0))
    do i = 1, size(case%phase)
      do j = 1, size(case%phase(i)%load)
        associate (name => case%phase(i)%load(j)%set)
          if (any([(model%load_set(s)%name == name, s=1, size(model%load_set))])) cycle
          set%name = name
          set%node = model%first_nodes(mesh%nodes_of(name))
          call face_load_weights(model%element, model%connectivity, model%x0, set%node, set%weight)
          model%load_set = [model%load_set, set]
        end associate
      end do
    end do
    if (.not. any(case%phase%has_gravity)) return
    call new_weight_set(set, model, case%material%density)
    model%load_set = [model%load_set, set]
  end subroutine new_load_sets

end module dd3_setup_loads
