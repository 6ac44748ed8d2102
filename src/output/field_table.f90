! SPDX-License-Identifier: GPL-3.0-or-later
!> Table of the output fields: name, location, components, unit, meaning, and procedure. A field of
!> the integration points is written twice: its mean at the cells, and extrapolated at the nodes.
module dd3_output_field_table
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_linalg_tensor, only : tensor_from_kelvin
  use dd3_model_internal_variables, only : global_components
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_forming_fields, only : fill_contact_gap, fill_contact_pressure, &
      fill_contact_tool, fill_draw_in, fill_slip_path, fill_slip_speed, fill_thickness, &
      fill_thinning
  implicit none
  private
  public :: field_t, field_table, common_fields, fill_internal_variable, at_nodes_and_cells, &
      at_points

  !> Locations: a value at each node;
  integer, parameter :: at_nodes = 1
  !> a value at each node and at each cell, for a strain the mean of its nodes;
  integer, parameter :: at_nodes_and_cells = 2
  !> a value at each integration point.
  integer, parameter :: at_points = 3

  !> An output field.
  type :: field_t
    character(len=32) :: name = ""
    !> `at_nodes`, `at_nodes_and_cells` or `at_points`.
    integer :: location = at_nodes
    !> Components of a value.
    integer :: components = 1
    !> The values are integers; they are never negative: extrapolation is cut off at zero.
    logical :: whole = .false., positive = .false.
    character(len=8) :: unit = ""
    character(len=120) :: description = ""
    !> Not associated for a strain in the surface and for an internal variable; the second for
    !> fields at nodes and cells.
    procedure(fill_interface), nopass, pointer :: fill => null()
    procedure(fill_both_interface), nopass, pointer :: fill_both => null()
    !> Position of a strain in the surface among those of `evaluate_strains`: component and height;
    !> 0 for another field.
    integer :: strain = 0, height = 0
    !> Position among the internal variables of the model, if the field is one of them; 0 otherwise.
    integer :: variable = 0
  end type field_t

  abstract interface
    !> Evaluate a field.
    subroutine fill_interface(model, state, value)
      import :: model_t, state_t, wp
        type(model_t), intent(in) :: model
        type(state_t), intent(in) :: state
      !> `(components, n_node)`, or those of the elements of this rank, `(components,
      !> n_point*n_element)`, points first.
      real(wp), intent(out) :: value(:, :)
    end subroutine fill_interface

    !> Evaluate a field at nodes and cells.
    subroutine fill_both_interface(model, state, nodal, cell)
      import :: model_t, state_t, wp
        type(model_t), intent(in) :: model
        type(state_t), intent(in) :: state
      !> `(components, n_node)` and `(components, n_element)`.
      real(wp), intent(out) :: nodal(:, :), cell(:, :)
    end subroutine fill_both_interface
  end interface

contains

  !> Return the table for a model: the fields of every model, then the internal variables of its
  !> materials.
  function field_table(model) result(table)
    type(model_t), intent(in) :: model
    type(field_t), allocatable :: table(:)

    integer :: i

    table = common_fields()
    if (has_materials(model)) then
      table = [table, sheet_row("material", "", "number of the material, in the order of the "// &
          "input; 0 at nodes between materials", fill_material)]
    end if
    if (.not. allocated(model%internal_variable)) return
    do i = 1, size(model%internal_variable)
      table = [table, internal_variable_row(model, i)]
    end do
  end function field_table

  !> Whether the sheet has several materials.
  pure logical function has_materials(model)
    type(model_t), intent(in) :: model

    has_materials = allocated(model%material_of)
    if (has_materials) has_materials = any(model%material_of /= model%material_of(1))
  end function has_materials

  !> Return the fields of every model.
  function common_fields() result(table)
    type(field_t), allocatable :: table(:)

    table = [ &
      row("displacement", at_nodes, 3, "mm", &
          "displacement from the initial position", fill_displacement), &
      row("contact_force", at_nodes, 3, "N", &
          "force of the tools on the sheet", fill_contact_force), &
      row("contact_status", at_nodes, 1, "", &
          "0 gap or no candidate, 1 stick, 2 slip", fill_contact_status, whole=.true.), &
      row("stress", at_points, 6, "MPa", &
          "Cauchy stress in global axes: 11 22 33 12 23 13", fill_stress), &
      row("equivalent_plastic_strain", at_points, 1, "", &
          "equivalent plastic strain, conjugate to the equivalent stress", fill_plastic_strain, &
          positive=.true.), &
      row("equivalent_stress", at_points, 1, "MPa", &
          "equivalent stress of the material's yield criterion", fill_equivalent_stress, &
          positive=.true.), &
      sheet_row("thickness", "mm", "thickness of the sheet along its normal", fill_thickness), &
      forming_rows()]
  end function common_fields

  !> Return the rows of the fields that describe the result of forming.
  function forming_rows() result(table)
    type(field_t), allocatable :: table(:)

    table = [ &
      sheet_row("thinning", "", "decrease of the thickness over the initial thickness", &
          fill_thinning), &
      strain_rows(), &
      row("draw_in", at_nodes, 1, "mm", &
          "displacement of the rim along its initial inward normal, without that of *START; "// &
          "0 elsewhere", fill_draw_in), &
      row("contact_pressure", at_nodes, 1, "MPa", &
          "normal force of the tools over the tributary area of the node", &
          fill_contact_pressure), &
      row("contact_gap", at_nodes, 1, "mm", &
          "distance from the nearest tool, at most the search distance", fill_contact_gap), &
      row("slip_path", at_nodes, 1, "mm", &
          "path of the node on the tools while it slips, since the start of the job", &
          fill_slip_path), &
      row("slip_speed", at_nodes, 1, "mm/s", &
          "speed of sliding on the tools in the last increment; 0 in phases without a time", &
          fill_slip_speed), &
      row("contact_tool", at_nodes, 1, "", &
          "number of the tool in contact, in the order of the input; 0 for none", &
          fill_contact_tool, whole=.true.)]
  end function forming_rows

  !> Return the rows of the strains in the surface of the sheet.
  function strain_rows() result(table)
    type(field_t) :: table(6)

    character(len=*), parameter :: strain(2) = ["major", "minor"]
    character(len=*), parameter :: name(3) = [character(len=6) :: "lower", "middle", "upper"]
    character(len=*), parameter :: place(3) = [character(len=10) :: "lower face", "middle", &
        "upper face"]
    integer :: i, k, n

    n = 0
    do i = 1, size(name)
      do k = 1, size(strain)
        n = n + 1
        table(n)%name = strain(k)//"_strain_"//name(i)
        table(n)%location = at_nodes_and_cells
        table(n)%description = strain(k)//" logarithmic strain in the surface at the "// &
            trim(place(i))//" of the sheet"
        table(n)%strain = k
        table(n)%height = i
      end do
    end do
  end function strain_rows

  !> Make the row of an internal variable.
  function internal_variable_row(model, i) result(row)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    type(field_t) :: row

    associate (described => model%internal_variable(i)%row)
      row%name = described%name
      row%location = at_points
      row%components = described%n_component
      row%unit = described%unit(:len(row%unit))
      row%description = described%meaning
      if (row%components == 6) row%description = trim(row%description)// &
        "; in global axes: 11 22 33 12 23 13"
      row%variable = i
    end associate
  end function internal_variable_row

  !> Make a row of the table.
  function row(name, location, components, unit, description, fill, whole, positive)
    character(len=*), intent(in) :: name, unit, description
    integer, intent(in) :: location, components
    procedure(fill_interface) :: fill
    !> The values are integers; extrapolation is cut off at zero. Default: no.
    logical, intent(in), optional :: whole, positive
    type(field_t) :: row

    row%name = name
    row%location = location
    row%components = components
    row%unit = unit
    row%description = description
    row%fill => fill
    if (present(whole)) row%whole = whole
    if (present(positive)) row%positive = positive
  end function row

  !> Make the row of a field at nodes and cells.
  function sheet_row(name, unit, description, fill_both) result(row)
    character(len=*), intent(in) :: name, unit, description
    procedure(fill_both_interface) :: fill_both
    type(field_t) :: row

    row%name = name
    row%location = at_nodes_and_cells
    row%unit = unit
    row%description = description
    row%fill_both => fill_both
  end function sheet_row

  !> Evaluate the displacements.
  subroutine fill_displacement(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value = state%x - model%x0
  end subroutine fill_displacement

  !> Evaluate the forces of the tools on the sheet, opposite to those of the state.
  subroutine fill_contact_force(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)

    value = 0.0_wp - model%nodal_contact_forces(state%x, state%contact%lambda, state%contact%place)
  end subroutine fill_contact_force

  !> Evaluate the contact status.
  subroutine fill_contact_status(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)
    integer :: i

    value = 0.0_wp
    do i = 1, model%n_contact_node
      value(1, model%contact_node(i)) = real(state%contact%status(i), wp)
    end do
    call sum_over_ranks(size(value), value)
  end subroutine fill_contact_status

  !> Evaluate the stress in global axes.
  subroutine fill_stress(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)
    real(wp) :: q(3, 3), t(3, 3)
    integer :: p, e, i

    i = 0
    do e = 1, size(model%part%element)
      do p = 1, model%element%n_point
        i = i + 1
        q = state%sheet%orientation(:, :, p, e)
        t = tensor_from_kelvin(state%sheet%stress(:, p, e))
        t = matmul(q, matmul(t, transpose(q)))
        value(:, i) = [t(1, 1), t(2, 2), t(3, 3), t(1, 2), t(2, 3), t(1, 3)]
      end do
    end do
  end subroutine fill_stress

  !> Evaluate the equivalent plastic strain.
  subroutine fill_plastic_strain(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)
    integer :: e, n

    n = model%element%n_point
    do e = 1, size(model%part%element)
      value(1, (e - 1)*n + 1:e*n) = state%sheet%internal_variables(1, :, e)
    end do
  end subroutine fill_plastic_strain

  !> Evaluate the equivalent stress.
  subroutine fill_equivalent_stress(model, state, value)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: value(:, :)
    integer :: p, e, i, m

    i = 0
    do e = 1, size(model%part%element)
      m = model%material_of(model%part%element(e))
      do p = 1, model%element%n_point
        i = i + 1
        value(1, i) = model%material(m)%equivalent_stress(state%sheet%stress(:, p, e), &
                                                          state%sheet%internal_variables(:, p, e))
      end do
    end do
  end subroutine fill_equivalent_stress

  !> Set the numbers of the materials.
  pure subroutine fill_material(model, state, nodal, cell)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(out) :: nodal(:, :), cell(:, :)

    integer :: number(size(state%x, 2)), e

    number = -1
    do e = 1, model%n_element
      associate (node => model%connectivity(:, e))
        number(node) = merge(model%material_of(e), 0, number(node) == -1 &
            .or. number(node) == model%material_of(e))
      end associate
    end do
    nodal(1, :) = real(number, wp)
    cell(1, :) = real(model%material_of, wp)
  end subroutine fill_material

  !> Evaluate an internal variable.
  subroutine fill_internal_variable(variable, model, state, value)
    !> Position among the internal variables of the model.
    integer, intent(in) :: variable
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> `(components, n_point*n_element)`, points first.
    real(wp), intent(out) :: value(:, :)

    integer :: p, e, i

    i = 0
    do e = 1, size(model%part%element)
      do p = 1, model%element%n_point
        i = i + 1
        value(:, i) = global_components(model%internal_variable(variable), &
            model%material_of(model%part%element(e)), &
            state%sheet%internal_variables(:, p, e), state%sheet%orientation(:, :, p, e))
      end do
    end do
  end subroutine fill_internal_variable

end module dd3_output_field_table
