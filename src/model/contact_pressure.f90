!> Contact pressure at the candidates: normal force over tributary area. The tributary area of a
!> node is its fraction of the area of the contact faces around it.
module dd3_model_contact_pressure
  use dd3_base_kinds, only : wp
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : outward_normals
  use dd3_model_sheet_faces, only : face_area
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: tributary_areas, contact_pressures, tool_contact_t, tool_contacts

  !> Contact of a tool: area, mm2, and largest pressure, MPa.
  type :: tool_contact_t
    real(wp) :: area = 0.0_wp, pressure = 0.0_wp
  end type tool_contact_t

contains

  !> Return the tributary areas of the candidates, `(n_contact)`, mm2; zero for a candidate without
  !> contact faces.
  pure function tributary_areas(model, x) result(area)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: area(:)

    integer :: f

    allocate (area(model%n_contact), source=0.0_wp)
    if (.not. allocated(model%contact_face)) return
    do f = 1, size(model%contact_face)
      associate (corner => model%face%corner(:, model%contact_face(f)), &
          c => model%candidate_of(model%face%node(:, model%contact_face(f))))
        area(c) = area(c) + face_area(x(:, corner))*model%element%face_weight
      end associate
    end do
  end function tributary_areas

  !> Return the pressures at the candidates, `(n_contact)`, MPa, positive in compression.
  pure function contact_pressures(model, state) result(pressure)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable :: pressure(:)

    pressure = pressures_on_areas(model, state, tributary_areas(model, state%x))
  end function contact_pressures

  !> Return the pressures at the candidates, MPa; zero without an area.
  pure function pressures_on_areas(model, state, area) result(pressure)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Tributary areas, `(n_contact)`, mm2.
    real(wp), intent(in) :: area(:)
    real(wp) :: pressure(size(area))

    real(wp) :: normal(3, size(area))
    integer :: c

    pressure = 0.0_wp
    if (.not. allocated(model%contact_face)) return
    normal = outward_normals(model, state%x)
    do c = 1, size(area)
      if (area(c) <= 0.0_wp) cycle
      pressure(c) = dot_product(normal(:, c), state%lambda(:, c))/area(c)
    end do
  end function pressures_on_areas

  !> Return the contact of each tool, `(n_tool)`.
  pure function tool_contacts(model, state) result(contact)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(tool_contact_t), allocatable :: contact(:)

    real(wp) :: area(model%n_contact), pressure(model%n_contact)
    integer :: c

    allocate (contact(model%n_tool))
    area = tributary_areas(model, state%x)
    pressure = pressures_on_areas(model, state, area)
    do c = 1, model%n_contact
      if (state%status(c) == status_gap .or. state%contact_tool(c) == 0) cycle
      associate (tool => contact(state%contact_tool(c)))
        tool%area = tool%area + area(c)
        tool%pressure = max(tool%pressure, pressure(c))
      end associate
    end do
  end function tool_contacts

end module dd3_model_contact_pressure
