! SPDX-License-Identifier: GPL-3.0-or-later
!> An artificial hardening law that depends on the strain path and has a back-stress, similar to
!> Teodosiu and Hu's: a polarity P evolves to the flow direction N = V/|V|; the flow stress and the
!> saturation of the back-stress depend on |P|^2.
module path_law
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_material_backstress_relaxation, only : relax, relax_back_stress
  use dd3_material_description, only : description_t, internal_variable_t
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_hardening_law, only : hardening_t
  use dd3_linalg_tensor, only : kelvin_deviator
  implicit none
  private
  public :: path_law_t

  !> Constants: initial flow stress, slope, weight of the polarity and its rate; rate of the
  !> back-stress, its saturation and the contribution of the polarity to it.
  real(wp), parameter :: y0 = 200.0_wp, h = 300.0_wp, f = 80.0_wp, c_p = 12.0_wp, &
      c_x = 30.0_wp, x0 = 40.0_wp, g = 30.0_wp

  !> Law with the internal variables P, then X.
  type, extends(hardening_t) :: path_law_t
  contains
    procedure, nopass :: describe
    procedure, nopass :: describe_internal_variables
    procedure :: set
    procedure :: flow_stress
    procedure :: back_stress
    procedure :: evolve
  end type path_law_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "path_law"
    allocate (description%rows(0), description%example(0))
  end subroutine describe

  pure subroutine describe_internal_variables(rows)
    type(internal_variable_t), allocatable, intent(out) :: rows(:)

    allocate (rows(2))
    rows(1) = internal_variable_t("polarity", "", "polarity P", 6)
    rows(2) = internal_variable_t("back_stress", "MPa", "back-stress X", 6)
  end subroutine describe_internal_variables

  subroutine set(self, values)
    class(path_law_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%n_internal = 12 + 0*size(values)
    self%owns_back_stress = .true.
    self%path_dependent = .true.
  end subroutine set

  !> Evaluate the polarity at the end and the derivatives of |P|^2.
  pure subroutine polarity(start, increment, direction, p, slope, gradient)
    real(wp), intent(in) :: start(6), increment
    type(flow_direction_t), intent(in) :: direction
    real(wp), intent(out) :: p(6), slope, gradient(6)

    real(wp) :: n(6), length, decay, tangential(6)

    length = norm2(direction%gradient)
    p = start
    slope = 0.0_wp
    gradient = 0.0_wp
    if (.not. length > 0.0_wp) return
    n = direction%gradient/length
    decay = exp(-c_p*increment)
    p = n - (n - start)*decay
    slope = 2*dot_product(p, c_p*decay*(n - start))
    tangential = (p - dot_product(p, n)*n)/length
    gradient = 2*(1 - decay)*matmul(direction%second, tangential)
  end subroutine polarity

  !> Evaluate the flow stress.
  pure subroutine flow_stress(self, plastic_strain, start, increment, direction, flow)
    class(path_law_t), intent(in) :: self
    real(wp), intent(in) :: plastic_strain, start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    type(flow_response_t), intent(out) :: flow

    real(wp) :: p(6), slope, gradient(6)

    call polarity(start(1:6), increment, direction, p, slope, gradient)
    flow%value = y0 + h*(plastic_strain + increment) + f*dot_product(p, p)
    flow%slope = h + f*slope
    flow%gradient = f*gradient
  end subroutine flow_stress

  !> Evaluate the law's own back-stress.
  pure subroutine back_stress(self, start, increment, direction, back)
    class(path_law_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: back

    real(wp) :: p(6), slope, gradient(6), normal(6), kept, weight
    integer :: j

    call polarity(start(1:6), increment, direction, p, slope, gradient)
    call relax_back_stress(c_x*(x0 + g*dot_product(p, p)), c_x, start(7:12), increment, &
        direction, back)
    if (.not. direction%equivalent > 0.0_wp) return
    call relax(c_x, increment, kept, weight)
    normal = weight*c_x*g*kelvin_deviator(direction%stress)/direction%equivalent
    back%slope = back%slope + slope*normal
    do j = 1, 6
      back%gradient(:, j) = back%gradient(:, j) + gradient(j)*normal
    end do
  end subroutine back_stress

  !> Evolve the internal variables of the law.
  pure subroutine evolve(self, start, increment, direction, evolved)
    class(path_law_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    real(wp), intent(out) :: evolved(self%n_internal)

    type(back_response_t) :: back
    real(wp) :: slope, gradient(6)

    call polarity(start(1:6), increment, direction, evolved(1:6), slope, gradient)
    call self%back_stress(start, increment, direction, back)
    evolved(7:12) = back%value
  end subroutine evolve

end module path_law
