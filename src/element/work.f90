!> The workspace of the element kernels: allocated once per thread, filled element by element.
module dd3_element_work
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  implicit none
  private
  public :: element_work_t, new_element_work

  !> Everything computed for one element. Kelvin vectors at points are in the material frame.
  type :: element_work_t
    !> Positions of the nodes at the start of the increment and now, mm, set by the caller:
    !> `x_old(3,n_node)`, `x_new(3,n_node)`.
    real(wp), allocatable :: x_old(:, :), x_new(:, :)
    !> Gradients of the shape functions at the current configuration, 1/mm:
    !> `gradient(n_node,3,n_point)`.
    real(wp), allocatable :: gradient(:, :, :)
    !> Their means over each group, 1/mm: `mean_gradient(n_node,3,n_group)`.
    real(wp), allocatable :: mean_gradient(:, :, :)
    !> Quadrature weight times Jacobian at the current configuration, mm3: `weight(n_point)`.
    real(wp), allocatable :: weight(:)
    !> The same at the start of the increment, mm3: `weight_old(n_point)`.
    real(wp), allocatable :: weight_old(:)
    !> Volume of each group, mm3: `volume(n_group)`, `volume_old(n_group)`.
    real(wp), allocatable :: volume(:), volume_old(:)
    !> Deformation gradient of the increment, as interpolated: `deformation(3,3,n_point)`.
    real(wp), allocatable :: deformation(:, :, :)
    !> Dilatation of the increment that the material sees, v/V of the point's group:
    !> `dilatation(n_point)`.
    real(wp), allocatable :: dilatation(:)
    !> Logarithmic strain of the increment, Kelvin, material frame: `strain(6,n_point)`.
    real(wp), allocatable :: strain(:, :)
    !> Material axes at the end of the increment, as columns, in the global frame:
    !> `rotation(3,3,n_point)`.
    real(wp), allocatable :: rotation(:, :, :)
    !> Cauchy stress, MPa, Kelvin, material frame, set by the caller: `stress(6,n_point)`.
    real(wp), allocatable :: stress(:, :)
    !> d stress/d strain, MPa, material frame, set by the caller: `tangent(6,6,n_point)`.
    real(wp), allocatable :: tangent(:, :, :)
    !> Internal forces, N: `force(3,n_node)`.
    real(wp), allocatable :: force(:, :)
    !> d force/d displacement, N/mm: `stiffness(3,3,n_node,n_node)`; the 3x3 block of row node a and
    !> column node b is `stiffness(:,:,b,a)`.
    real(wp), allocatable :: stiffness(:, :, :, :)
    !> Strain increment of a trial displacement, to first order, with the mean dilatation, Kelvin,
    !> material frame: `strain_increment(6,n_point)`.
    real(wp), allocatable :: strain_increment(:, :)
    !> Rotation increment of a trial displacement, length of the axial vector, rad:
    !> `rotation_increment(n_point)`.
    real(wp), allocatable :: rotation_increment(:)
    !> Cauchy stress, MPa, tensor in the global frame: `cauchy(3,3,n_point)`.
    real(wp), allocatable :: cauchy(:, :, :)
    !> Inner: dx/dxi of both configurations, `jacobian(3,n_point,3)`; the last index is the
    !> component of x.
    real(wp), allocatable :: jacobian(:, :, :), jacobian_old(:, :, :)
    !> Inner: tangent contracted with the column node's gradient, `half(3,3,n_node,3,n_point)`.
    real(wp), allocatable :: half(:, :, :, :, :)
    !> Inner: factors of the groups' outer products, N/mm2: `row_factor(n_node,3,n_group)`,
    !> `column_factor` alike.
    real(wp), allocatable :: row_factor(:, :, :), column_factor(:, :, :)
    !> Inner: volume integrals of each group, N mm: of the mean stress, and of a ninth of the
    !> moduli's trace, `(n_group)`.
    real(wp), allocatable :: mean_stress_integral(:), bulk_integral(:)
  end type element_work_t

contains

  !> Allocates a workspace for an element.
  subroutine new_element_work(self, element)
    !> The workspace.
    type(element_work_t), intent(out) :: self
    !> The element.
    type(element_t), intent(in) :: element

    integer :: n, p, g

    n = element%n_node
    p = element%n_point
    g = element%n_group
    allocate (self%x_old(3, n), self%x_new(3, n))
    allocate (self%gradient(n, 3, p), self%mean_gradient(n, 3, g))
    allocate (self%weight(p), self%weight_old(p), self%volume(g), self%volume_old(g))
    allocate (self%deformation(3, 3, p), self%dilatation(p), self%strain(6, p))
    allocate (self%rotation(3, 3, p), self%stress(6, p), self%tangent(6, 6, p))
    allocate (self%force(3, n), self%stiffness(3, 3, n, n))
    allocate (self%strain_increment(6, p), self%rotation_increment(p))
    allocate (self%jacobian(3, p, 3), self%jacobian_old(3, p, 3), self%cauchy(3, 3, p))
    allocate (self%half(3, 3, n, 3, p))
    allocate (self%row_factor(n, 3, g), self%column_factor(n, 3, g))
    allocate (self%mean_stress_integral(g), self%bulk_integral(g))
  end subroutine new_element_work

end module dd3_element_work
