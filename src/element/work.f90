! SPDX-License-Identifier: GPL-3.0-or-later
!> The workspace of the element kernels, one per thread, reused for every element.
module dd3_element_work
  use dd3_base_kinds, only : wp
  use dd3_element_shell_work, only : new_shell_work, shell_work_t
  implicit none
  private
  public :: element_work_t, new_element_work

  !> Data and results of one element. Kelvin vectors at points are in the material frame.
  type :: element_work_t
    !> Initial, committed and trial positions of the nodes, mm, set by the caller: `(3,n_node)`.
    real(wp), allocatable :: x_initial(:, :), x_committed(:, :), x_trial(:, :)
    !> Gradients of the shape functions in the trial configuration, 1/mm:
    !> `gradient(n_node,3,n_point)`.
    real(wp), allocatable :: gradient(:, :, :)
    !> Their means over each group, 1/mm: `mean_gradient(n_node,3,n_group)`.
    real(wp), allocatable :: mean_gradient(:, :, :)
    !> Quadrature weight times Jacobian in the trial and the committed configuration, mm3:
    !> `(n_point)`.
    real(wp), allocatable :: weight(:), weight_committed(:)
    !> Fraction of each group in the relative change of a point's dilatation, for elements with a
    !> projection: `fraction(n_point,n_group)`.
    real(wp), allocatable :: fraction(:, :)
    !> Volume of each group in both configurations, mm3: `(n_group)`.
    real(wp), allocatable :: volume(:), volume_committed(:)
    !> Interpolated deformation gradient of the increment: `deformation(3,3,n_point)`.
    real(wp), allocatable :: deformation(:, :, :)
    !> Dilatation of the increment passed to the material, v/V of the point's group:
    !> `dilatation(n_point)`.
    real(wp), allocatable :: dilatation(:)
    !> Logarithmic strain of the increment, Kelvin, material frame: `strain(6,n_point)`.
    real(wp), allocatable :: strain(:, :)
    !> Trial material axes, as columns, in the global frame: `rotation(3,3,n_point)`.
    real(wp), allocatable :: rotation(:, :, :)
    !> Cauchy stress, MPa, Kelvin, material frame, set by the caller: `stress(6,n_point)`.
    real(wp), allocatable :: stress(:, :)
    !> d stress/d strain, MPa, material frame, set by the caller: `tangent(6,6,n_point)`.
    real(wp), allocatable :: tangent(:, :, :)
    !> Parameters of the enhanced strain in this increment, mm2, set by the caller: `(n_enhanced)`.
    real(wp), allocatable :: enhanced(:)
    !> Internal forces, N: `force(3,n_node)`.
    real(wp), allocatable :: force(:, :)
    !> Forces conjugate to the enhanced parameters, N/mm, zero in equilibrium: `(n_enhanced)`.
    real(wp), allocatable :: enhanced_force(:)
    !> d force/d displacement, N/mm: `stiffness(3,3,n_node,n_node)`; the 3x3 block of row node a and
    !> column node b is `stiffness(:,:,b,a)`. Enhanced parameters are condensed: they follow the
    !> displacement as -(enhanced_offset + enhanced_gain : du).
    real(wp), allocatable :: stiffness(:, :, :, :)
    !> Set with the stiffness: `(n_enhanced)`, mm2, and `(n_enhanced,3,n_node)`, mm.
    real(wp), allocatable :: enhanced_offset(:), enhanced_gain(:, :, :)
    !> Squares of the forces on all nodes, (N/mm)2, and on the enhanced parameters, (N/mm2)2, that a
    !> unit displacement causes which the parameters do not follow, beside the condensed stiffness,
    !> `(3,n_node,2)`.
    real(wp), allocatable :: unfollowed(:, :, :)
    !> Nodal forces, N, that vanish with the enhanced parameters' own: to be subtracted from the
    !> internal forces beside the condensed stiffness, `(3,n_node)`.
    real(wp), allocatable :: condensed_force(:, :)
    !> First-order strain increment of a trial displacement, with the mean dilatation, Kelvin,
    !> material frame: `strain_increment(6,n_point)`.
    real(wp), allocatable :: strain_increment(:, :)
    !> Rotation increment of a trial displacement, norm of the axial vector, rad:
    !> `rotation_increment(n_point)`.
    real(wp), allocatable :: rotation_increment(:)
    !> Cauchy stress, MPa, tensor in the global frame: `cauchy(3,3,n_point)`.
    real(wp), allocatable :: cauchy(:, :, :)
    !> Internal: dx/dxi in both configurations, mm: `(3,n_point,3)`, last index the component of x.
    real(wp), allocatable :: jacobian(:, :, :), jacobian_committed(:, :, :)
    !> Internal: moduli contracted with the column node's gradient:
    !> `contracted(3,3,n_node,3,n_point)`.
    real(wp), allocatable :: contracted(:, :, :, :, :)
    !> Internal: factors of the groups' outer products, N/mm2: `(n_node,3,n_group)`.
    real(wp), allocatable :: row_factor(:, :, :), column_factor(:, :, :)
    !> Internal: volume integrals of the mean stress and of a ninth of the moduli's trace, N mm:
    !> `(n_group)`.
    real(wp), allocatable :: mean_stress_integral(:), bulk_integral(:)
    !> Internal to the solid-shell.
    type(shell_work_t) :: shell
  end type element_work_t

contains

  !> Allocate the workspace for an element type.
  subroutine new_element_work(self, n_node, n_point, n_group, n_enhanced)
    type(element_work_t), intent(out) :: self
    !> Sizes as in `element_t`.
    integer, intent(in) :: n_node, n_point, n_group, n_enhanced

    associate (n => n_node, p => n_point, g => n_group, m => n_enhanced)
      allocate (self%x_initial(3, n), self%x_committed(3, n), self%x_trial(3, n))
      allocate (self%gradient(n, 3, p), self%mean_gradient(n, 3, g))
      allocate (self%weight(p), self%weight_committed(p), self%volume(g), self%volume_committed(g))
      allocate (self%fraction(p, g))
      allocate (self%deformation(3, 3, p), self%dilatation(p), self%strain(6, p))
      allocate (self%rotation(3, 3, p), self%stress(6, p), self%tangent(6, 6, p))
      allocate (self%force(3, n), self%stiffness(3, 3, n, n))
      allocate (self%strain_increment(6, p), self%rotation_increment(p))
      allocate (self%jacobian(3, p, 3), self%jacobian_committed(3, p, 3), self%cauchy(3, 3, p))
      allocate (self%contracted(3, 3, n, 3, p))
      allocate (self%row_factor(n, 3, g), self%column_factor(n, 3, g))
      allocate (self%mean_stress_integral(g), self%bulk_integral(g))
      allocate (self%enhanced(m), self%enhanced_force(m), self%enhanced_offset(m), source=0.0_wp)
      allocate (self%enhanced_gain(m, 3, n), self%condensed_force(3, n), source=0.0_wp)
      allocate (self%unfollowed(3, n, 2), source=0.0_wp)
      if (m > 0) call new_shell_work(self%shell, p)
    end associate
  end subroutine new_element_work

end module dd3_element_work
