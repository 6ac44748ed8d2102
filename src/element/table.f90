! SPDX-License-Identifier: GPL-3.0-or-later
!> The table that describes an element type: nodes, faces, integration points, shape functions,
!> which points share a mean dilatation, and the kernels of its formulation. Those of the mean
!> dilatation (mean_dilatation.f90) work from the table for any number of nodes, points and groups;
!> an element with another formulation sets its own. Shape functions and Gauss rules: Zienkiewicz &
!> Taylor, The Finite Element Method, 1989, chap. 7.
module dd3_element_table
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_element_gauss, only : gauss_legendre
  use dd3_element_work, only : element_work_t
  implicit none
  private
  public :: element_t, new_table, shape_interface, complete_table, set_table_point

  !> An element type, in natural coordinates (xi, eta, zeta) within -1 ... 1, zeta through the
  !> thickness.
  type :: element_t
    !> Name as written in the input.
    character(len=16) :: name = ""
    !> One line of description.
    character(len=80) :: title = ""
    !> Number of nodes.
    integer :: n_node = 0
    !> Number of integration points.
    integer :: n_point = 0
    !> Number of groups of points that share a mean dilatation, 0 if each point keeps its own; or
    !> number of functions on which the dilatation is projected.
    integer :: n_group = 0
    !> Number of node pairs through the thickness.
    integer :: n_pair = 0
    !> Number of faces, and of nodes on each.
    integer :: n_face = 0, n_face_node = 0
    !> Number of integration points through the thickness if the input may choose it, 0 otherwise.
    integer :: n_thickness_point = 0
    !> Whether elements of the mesh lie on one another across their thickness; set with the mesh.
    logical :: stacked = .false.
    !> Number of parameters of the enhanced strain, internal to each element.
    integer :: n_enhanced = 0
    !> Cell type of the VTK file format.
    integer :: vtk_type = 0
    !> Natural coordinates of the nodes: `node(3,n_node)`.
    real(wp), allocatable :: node(:, :)
    !> Natural coordinates of the integration points: `point(3,n_point)`.
    real(wp), allocatable :: point(:, :)
    !> Quadrature weights: `weight(n_point)`; their sum is 8.
    real(wp), allocatable :: weight(:)
    !> Shape functions at the points: `shape(n_node,n_point)`.
    real(wp), allocatable :: shape(:, :)
    !> Their derivatives in the natural coordinates: `dshape(3,n_node,n_point)`.
    real(wp), allocatable :: dshape(:, :, :)
    !> The same laid out for the kernels: `slope(3,n_point,n_node)` and
    !> `slope_row(n_node,3,n_point)`.
    real(wp), allocatable :: slope(:, :, :), slope_row(:, :, :)
    !> The derivatives at the nodes: `node_slope(3,n_node,n_node)`, the last index is the place.
    real(wp), allocatable :: node_slope(:, :, :)
    !> Group of each point, 1 ... n_group, or 0: `group(n_point)`.
    integer, allocatable :: group(:)
    !> The functions on which the dilatation is projected, at the points, with the sum 1:
    !> `projection(n_point,n_group)`; not allocated if points share mean dilatations. With it all
    !> points have the group 1.
    real(wp), allocatable :: projection(:, :)
    !> Nodal values from point values: `extrapolation(n_node,n_point)`; rows sum to 1.
    real(wp), allocatable :: extrapolation(:, :)
    !> Node pairs through the thickness, bottom then top: `pair(2,n_pair)`.
    integer, allocatable :: pair(:, :)
    !> Nodes of the faces, corners first, counter-clockwise seen from outside:
    !> `face(n_face_node,n_face)`.
    integer, allocatable :: face(:, :)
    !> Nodal fractions of a uniform load on a face, consistent with the shape functions:
    !> `face_weight(n_face_node)`; their sum is 1.
    real(wp), allocatable :: face_weight(:)
    !> Quadrature weights of the integration points of a face, with the sum 4, and the shape
    !> functions of its nodes there with their derivatives along the face: `(n_face_point)`,
    !> `(n_face_node,n_face_point)` and `(n_face_node,2,n_face_point)`.
    real(wp), allocatable :: face_point_weight(:), face_shape(:, :), face_slope(:, :, :)
    !> Our node at each place of VTK's order: `vtk_order(n_node)`.
    integer, allocatable :: vtk_order(:)

    ! Kernels. An update of an element calls `deform`, the material at every point, `set_stress`,
    ! `evaluate_force` and, for Newton's method, `evaluate_stiffness`; the predictor calls
    ! `linearise`, `set_stress` and `evaluate_stiffness`, or `linearise` and `evaluate_rate`.

    !> Evaluate strain increments and trial material axes from the positions and the enhanced
    !> parameters of the workspace.
    procedure(deform_interface), pointer, nopass :: deform => null()
    !> Do the same at the committed positions, without an increment.
    procedure(deform_interface), pointer, nopass :: linearise => null()
    !> Transform the stresses of the workspace to the form that forces and stiffness need.
    procedure(evaluate_interface), pointer, nopass :: set_stress => null()
    !> Evaluate the internal forces.
    procedure(evaluate_interface), pointer, nopass :: evaluate_force => null()
    !> Evaluate the stiffness with the tangents of the workspace.
    procedure(evaluate_interface), pointer, nopass :: evaluate_stiffness => null()
    !> Evaluate first-order strain and rotation increments of a trial displacement and of the
    !> workspace's enhanced parameters.
    procedure(rate_interface), pointer, nopass :: evaluate_rate => null()
  end type element_t

  abstract interface
    !> Evaluate an element's shape functions and their derivatives.
    pure subroutine shape_interface(natural, shape, dshape)
      import :: wp
      !> Natural coordinates.
      real(wp), intent(in) :: natural(3)
      !> Shape functions, one per node.
      real(wp), intent(out) :: shape(:)
      !> Their derivatives: `dshape(3,n_node)`.
      real(wp), intent(out) :: dshape(:, :)
    end subroutine shape_interface

    !> Evaluate the deformation of an element.
    subroutine deform_interface(element, rotation_committed, work, verdict)
      import :: element_t, element_work_t, verdict_t, wp
      type(element_t), intent(in) :: element
      !> Committed material axes, as columns: `(3,3,n_point)`.
      real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
      !> Holds the positions and the enhanced parameters; gets `strain` and `rotation`.
      type(element_work_t), intent(inout) :: work
      !> Retry, with the point, if the element is turned inside out.
      type(verdict_t), intent(out) :: verdict
    end subroutine deform_interface

    !> Evaluate results from data, both of the workspace.
    subroutine evaluate_interface(element, work)
      import :: element_t, element_work_t
      type(element_t), intent(in) :: element
      type(element_work_t), intent(inout) :: work
    end subroutine evaluate_interface

    !> Evaluate increments of first order.
    subroutine rate_interface(element, du, rotation_committed, work)
      import :: element_t, element_work_t, wp
      type(element_t), intent(in) :: element
      !> Trial displacement, mm.
      real(wp), intent(in) :: du(:, :)
      !> Committed material axes, as columns: `(3,3,n_point)`.
      real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
      !> Gets `strain_increment` and `rotation_increment`.
      type(element_work_t), intent(inout) :: work
    end subroutine rate_interface
  end interface

contains

  !> Allocate a table. Pairs and faces are left to the element.
  subroutine new_table(self, name, n_node, n_point)
    type(element_t), intent(out) :: self
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Number of nodes and of integration points.
    integer, intent(in) :: n_node, n_point

    integer :: a

    self%name = name
    self%n_node = n_node
    self%n_point = n_point
    allocate (self%node(3, n_node), self%point(3, n_point), self%weight(n_point))
    allocate (self%shape(n_node, n_point), self%dshape(3, n_node, n_point))
    allocate (self%slope(3, n_point, n_node), self%slope_row(n_node, 3, n_point))
    allocate (self%node_slope(3, n_node, n_node))
    allocate (self%extrapolation(n_node, n_point))
    allocate (self%group(n_point), source=0)
    allocate (self%vtk_order(n_node), source=[(a, a=1, n_node)])
  end subroutine new_table

  !> Set the position and weight of an integration point.
  subroutine set_table_point(self, p, natural, weight)
    type(element_t), intent(inout) :: self
    !> Index of the point.
    integer, intent(in) :: p
    !> Natural coordinates.
    real(wp), intent(in) :: natural(3)
    !> Quadrature weight.
    real(wp), intent(in) :: weight

    self%point(:, p) = natural
    self%weight(p) = weight
  end subroutine set_table_point

  !> Set the sizes that follow from the element's arrays, and evaluate the shape functions at the
  !> points.
  subroutine complete_table(self, evaluate)
    type(element_t), intent(inout) :: self
    !> The element's shape functions.
    procedure(shape_interface) :: evaluate

    real(wp) :: shape(self%n_node)
    integer :: p, a

    do p = 1, self%n_point
      call evaluate(self%point(:, p), self%shape(:, p), self%dshape(:, :, p))
      self%slope(:, p, :) = self%dshape(:, :, p)
      self%slope_row(:, :, p) = transpose(self%dshape(:, :, p))
    end do
    do a = 1, self%n_node
      call evaluate(self%node(:, a), shape, self%node_slope(:, :, a))
    end do
    self%n_group = maxval(self%group)
    if (allocated(self%projection)) self%n_group = size(self%projection, 2)
    self%n_pair = size(self%pair, 2)
    self%n_face = size(self%face, 2)
    self%n_face_node = size(self%face, 1)
    call set_face_points(self, evaluate)
  end subroutine complete_table

  !> Evaluate the shape functions of a face at 2 x 2 points, or at 3 x 3 with nodes between the
  !> corners: those of the last face, zeta = 1, whose nodes run from xi to eta. The other faces have
  !> the same, by the order of their nodes.
  subroutine set_face_points(self, evaluate)
    type(element_t), intent(inout) :: self
    procedure(shape_interface) :: evaluate

    real(wp) :: abscissa(3), weight(3), shape(self%n_node), dshape(3, self%n_node)
    integer :: i, j, n, p

    n = merge(2, 3, self%n_face_node == 4)
    call gauss_legendre(n, abscissa(:n), weight(:n))
    allocate (self%face_point_weight(n*n), self%face_shape(self%n_face_node, n*n))
    allocate (self%face_slope(self%n_face_node, 2, n*n))
    associate (node => self%face(:, self%n_face))
      do j = 1, n
        do i = 1, n
          p = i + n*(j - 1)
          call evaluate([abscissa(i), abscissa(j), 1.0_wp], shape, dshape)
          self%face_point_weight(p) = weight(i)*weight(j)
          self%face_shape(:, p) = shape(node)
          self%face_slope(:, :, p) = transpose(dshape(:2, node))
        end do
      end do
    end associate
  end subroutine set_face_points

end module dd3_element_table
