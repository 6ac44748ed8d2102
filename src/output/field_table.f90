!> The table of the output fields: name, place, components, unit, meaning, and what fills them.
!> A field of the integration points is written twice: its mean at the cells, and extrapolated at
!> the nodes.
module dd3_output_field_table
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : tensor_from_kelvin
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_columns, only : sheet_columns
  implicit none
  private
  public :: field_t, field_table, at_nodes_and_cells, at_points

  !> The field has a value at each node.
  integer, parameter :: at_nodes = 1
  !> It has a value at each node; a cell has the mean of its nodes.
  integer, parameter :: at_nodes_and_cells = 2
  !> It has a value at each integration point.
  integer, parameter :: at_points = 3

  !> An output field.
  type :: field_t
    !> Name, as ParaView shows it.
    character(len=32) :: name = ""
    !> `at_nodes`, `at_nodes_and_cells` or `at_points`.
    integer :: location = at_nodes
    !> Numbers at each place.
    integer :: components = 1
    !> Whether they are whole numbers; whether they are never negative: extrapolation stops at 0.
    logical :: whole = .false., positive = .false.
    !> Unit; empty where it has none.
    character(len=8) :: unit = ""
    !> Meaning, in a line.
    character(len=120) :: description = ""
    !> What fills it.
    procedure(fill_field), nopass, pointer :: fill => null()
  end type field_t

  abstract interface
    !> Fills a field.
    subroutine fill_field(model, state, value)
      import :: model_t, state_t, wp
      !> The model.
      type(model_t), intent(in) :: model
      !> The state.
      type(state_t), intent(in) :: state
      !> The field: components; nodes, or points of an element and elements behind each other.
      real(wp), intent(out) :: value(:, :)
    end subroutine fill_field
  end interface

contains

  !> The table.
  function field_table() result(table)
    type(field_t), allocatable :: table(:)

    table = [ &
      row("displacement", at_nodes, 3, "mm", &
          "displacement from the initial position", fill_displacement), &
      row("contact_force", at_nodes, 3, "N", &
          "force of the tools on the sheet", fill_contact_force), &
      row("contact_status", at_nodes, 1, "", &
          "0 gap or no candidate, 1 stick, 2 slip", fill_contact_status), &
      row("stress", at_points, 6, "MPa", &
          "Cauchy stress in global axes: 11 22 33 12 23 13", fill_stress), &
      row("equivalent_plastic_strain", at_points, 1, "", &
          "equivalent plastic strain, conjugate to the equivalent stress", fill_plastic_strain), &
      row("equivalent_stress", at_points, 1, "MPa", &
          "equivalent stress of the material's yield criterion", fill_equivalent_stress), &
      row("thickness", at_nodes_and_cells, 1, "mm", &
          "distance between the bottom and the top node through the thickness", fill_thickness)]
    table(3)%whole = .true.
    table(5:6)%positive = .true.
  end function field_table

  !> A row of the table.
  function row(name, location, components, unit, description, fill)
    !> Name, unit and meaning.
    character(len=*), intent(in) :: name, unit, description
    !> Where it lives, and its numbers there.
    integer, intent(in) :: location, components
    !> What fills it.
    procedure(fill_field) :: fill
    type(field_t) :: row

    row%name = name
    row%location = location
    row%components = components
    row%unit = unit
    row%description = description
    row%fill => fill
  end function row

  !> Displacements.
  subroutine fill_displacement(model, state, value)
    !> See `fill_field`.
    type(model_t), intent(in) :: model
    !> See `fill_field`.
    type(state_t), intent(in) :: state
    !> See `fill_field`.
    real(wp), intent(out) :: value(:, :)

    value = state%x - model%x0
  end subroutine fill_displacement

  !> Contact forces; the state keeps the sheet's push on the tools.
  subroutine fill_contact_force(model, state, value)
    !> See `fill_field`.
    type(model_t), intent(in) :: model
    !> See `fill_field`.
    type(state_t), intent(in) :: state
    !> See `fill_field`.
    real(wp), intent(out) :: value(:, :)
    integer :: i

    value = 0.0_wp
    do i = 1, model%n_contact
      value(:, model%contact_node(i)) = 0.0_wp - state%lambda(:, i)
    end do
  end subroutine fill_contact_force

  !> Contact status.
  subroutine fill_contact_status(model, state, value)
    !> See `fill_field`.
    type(model_t), intent(in) :: model
    !> See `fill_field`.
    type(state_t), intent(in) :: state
    !> See `fill_field`.
    real(wp), intent(out) :: value(:, :)
    integer :: i

    value = 0.0_wp
    do i = 1, model%n_contact
      value(1, model%contact_node(i)) = real(state%status(i), wp)
    end do
  end subroutine fill_contact_status

  !> Stress, turned from the axes of the material into the global ones.
  subroutine fill_stress(model, state, value)
    !> See `fill_field`.
    type(model_t), intent(in) :: model
    !> See `fill_field`.
    type(state_t), intent(in) :: state
    !> See `fill_field`.
    real(wp), intent(out) :: value(:, :)
    real(wp) :: q(3, 3), t(3, 3)
    integer :: p, e, i

    i = 0
    do e = 1, model%n_element
      do p = 1, model%element%n_point
        i = i + 1
        q = state%orientation(:, :, p, e)
        t = tensor_from_kelvin(state%stress(:, p, e))
        t = matmul(q, matmul(t, transpose(q)))
        value(:, i) = [t(1, 1), t(2, 2), t(3, 3), t(1, 2), t(2, 3), t(1, 3)]
      end do
    end do
  end subroutine fill_stress

  !> Equivalent plastic strain.
  subroutine fill_plastic_strain(model, state, value)
    !> See `fill_field`.
    type(model_t), intent(in) :: model
    !> See `fill_field`.
    type(state_t), intent(in) :: state
    !> See `fill_field`.
    real(wp), intent(out) :: value(:, :)
    integer :: e, n

    n = model%element%n_point
    do e = 1, model%n_element
      value(1, (e - 1)*n + 1:e*n) = state%internal(1, :, e)
    end do
  end subroutine fill_plastic_strain

  !> Equivalent stress.
  subroutine fill_equivalent_stress(model, state, value)
    !> See `fill_field`.
    type(model_t), intent(in) :: model
    !> See `fill_field`.
    type(state_t), intent(in) :: state
    !> See `fill_field`.
    real(wp), intent(out) :: value(:, :)
    integer :: p, e, i, m

    i = 0
    do e = 1, model%n_element
      m = model%material_of(e)
      do p = 1, model%element%n_point
        i = i + 1
        value(1, i) = model%material(m)%equivalent_stress(state%stress(:, p, e), &
                                                          state%internal(:, p, e))
      end do
    end do
  end subroutine fill_equivalent_stress

  !> Thickness.
  subroutine fill_thickness(model, state, value)
    !> See `fill_field`.
    type(model_t), intent(in) :: model
    !> See `fill_field`.
    type(state_t), intent(in) :: state
    !> See `fill_field`.
    real(wp), intent(out) :: value(:, :)
    integer, allocatable :: column(:, :)
    integer :: i

    call sheet_columns(model, column)
    do i = 1, model%n_node
      value(1, i) = norm2(state%x(:, column(2, i)) - state%x(:, column(1, i)))
    end do
  end subroutine fill_thickness

end module dd3_output_field_table
