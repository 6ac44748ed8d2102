! SPDX-License-Identifier: GPL-3.0-or-later
!> Pressures on faces of the sheet. A pressure acts along the inward normal of the deformed faces,
!> integrated with the shape functions of the element; its stiffness is unsymmetric.
!> Source: Schweizerhof and Ramm, Comput. Struct. 18 (1984) 1099-1114.
module dd3_model_terms_pressures
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_partition, only : holds_row
  use dd3_linalg_tensor, only : cross
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_state_visitor, only : state_visitor_t
  use dd3_model_terms_load_sets, only : pressure_set_t
  use dd3_model_terms_term, only : term_t
  implicit none
  private
  public :: pressures_t, new_pressures, add_pressure_forces, face_force, face_stiffness

  !> The term.
  type, extends(term_t) :: pressures_t
    !> Pressure on each set, and those at the start and at the end of the phase, `(n_pressure)`,
    !> MPa.
    real(wp), allocatable :: now(:), start(:), final(:)
  contains
    procedure :: begin_phase
    procedure :: add_rate
    procedure :: evaluate
    procedure :: add_force
    procedure :: add_final_force
    procedure :: add_stiffness
    procedure :: walk
  end type pressures_t

contains

  !> Make the term without pressures.
  function new_pressures(model) result(self)
    type(model_t), intent(in) :: model
    type(pressures_t) :: self

    associate (n => size(model%pressure_set))
      allocate (self%now(n), self%start(n), self%final(n), source=0.0_wp)
    end associate
  end function new_pressures

  !> Begin at the present pressures.
  subroutine begin_phase(self, model, number, state)
    class(pressures_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    type(configuration_t), intent(in) :: state

    self%start = self%now
    self%final = model%phase(number)%pressures%final
    where (model%phase(number)%pressures%keeps) self%final = self%start
  end subroutine begin_phase

  !> Add the change of the pressures.
  subroutine add_rate(self, model, committed, step, force)
    class(pressures_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed
    real(wp), intent(in) :: step
    real(wp), intent(inout) :: force(:, :)

    associate (factor => step*model%phase(committed%phase)%slope(committed%progress))
      call add_pressure_forces(model%element, model%pressure_set, &
          factor*(self%final - self%start), committed%x, force)
    end associate
  end subroutine add_rate

  !> Set the pressures of a trial state.
  subroutine evaluate(self, model, committed, trial)
    class(pressures_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed, trial

    associate (factor => model%phase(trial%phase)%factor(trial%progress))
      self%now = self%start + factor*(self%final - self%start)
    end associate
  end subroutine evaluate

  !> Add the forces on the nodes.
  subroutine add_force(self, model, state, force)
    class(pressures_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    call add_pressure_forces(model%element, model%pressure_set, self%now, state%x, force)
  end subroutine add_force

  !> Add the forces of the pressures at the end of the phase.
  subroutine add_final_force(self, model, state, force)
    class(pressures_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    call add_pressure_forces(model%element, model%pressure_set, self%final, state%x, force)
  end subroutine add_final_force

  !> Add the stiffness of the faces that turn and stretch.
  subroutine add_stiffness(self, model, state, stiffness)
    class(pressures_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    type(block_matrix_t), intent(inout) :: stiffness

    real(wp), allocatable :: block(:, :, :, :)
    integer :: s, f, a, b, k

    do s = 1, size(self%now)
      if (.not. abs(self%now(s)) > 0.0_wp) cycle
      do f = 1, size(model%pressure_set(s)%node, 2)
        associate (node => model%pressure_set(s)%node(:, f), value => stiffness%value)
          block = self%now(s)*face_stiffness(model%element, state%x(:, node))
          do a = 1, size(node)
            if (.not. holds_row(stiffness, node(a))) cycle
            do b = 1, size(node)
              k = position_of(stiffness, node(a), node(b))
              value(:, :, k) = value(:, :, k) - block(:, :, a, b)
            end do
          end do
        end associate
      end do
    end do
  end subroutine add_stiffness

  !> Pass the components to a visitor.
  subroutine walk(self, visitor)
    class(pressures_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("pressure", size(self%now), self%now)
    call visitor%reals("start_pressure", size(self%start), self%start)
    call visitor%reals("final_pressure", size(self%final), self%final)
  end subroutine walk

  !> Add the nodal forces of the pressures.
  pure subroutine add_pressure_forces(element, set, pressure, x, force)
    type(element_t), intent(in) :: element
    type(pressure_set_t), intent(in) :: set(:)
    !> On each set, MPa.
    real(wp), intent(in) :: pressure(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)

    integer :: s, f

    do s = 1, size(set)
      if (.not. abs(pressure(s)) > 0.0_wp) cycle
      do f = 1, size(set(s)%node, 2)
        associate (node => set(s)%node(:, f))
          force(:, node) = force(:, node) + pressure(s)*face_force(element, x(:, node))
        end associate
      end do
    end do
  end subroutine add_pressure_forces

  !> Return the nodal forces of a unit pressure on a face, mm2.
  pure function face_force(element, x) result(force)
    type(element_t), intent(in) :: element
    !> Nodes of the face, mm.
    real(wp), intent(in) :: x(3, element%n_face_node)
    real(wp) :: force(3, element%n_face_node)

    real(wp) :: along(3, 2), area(3)
    integer :: p, a

    force = 0.0_wp
    do p = 1, size(element%face_point_weight)
      along = matmul(x, element%face_slope(:, :, p))
      area = element%face_point_weight(p)*cross(along(:, 1), along(:, 2))
      do a = 1, element%n_face_node
        force(:, a) = force(:, a) - element%face_shape(a, p)*area
      end do
    end do
  end function face_force

  !> Return the derivatives of the nodal forces of a unit pressure in the positions of the nodes,
  !> mm: component of the force, of the position, node of the force, of the position.
  pure function face_stiffness(element, x) result(stiffness)
    type(element_t), intent(in) :: element
    !> Nodes of the face, mm.
    real(wp), intent(in) :: x(3, element%n_face_node)
    real(wp) :: stiffness(3, 3, element%n_face_node, element%n_face_node)

    real(wp) :: along(3, 2), unit(3)
    integer :: p, a, b, i

    stiffness = 0.0_wp
    do p = 1, size(element%face_point_weight)
      associate (slope => element%face_slope(:, :, p), weight => element%face_point_weight(p))
        along = matmul(x, slope)
        do b = 1, element%n_face_node
          do i = 1, 3
            unit = 0.0_wp
            unit(i) = weight
            unit = slope(b, 1)*cross(unit, along(:, 2)) + slope(b, 2)*cross(along(:, 1), unit)
            do a = 1, element%n_face_node
              stiffness(:, i, a, b) = stiffness(:, i, a, b) - element%face_shape(a, p)*unit
            end do
          end do
        end do
      end associate
    end do
  end function face_stiffness

end module dd3_model_terms_pressures
