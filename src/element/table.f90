!> The table that is an element: nodes, integration points, shape functions, and which points share
!> a mean dilatation. An element is one filled `element_t`; every kernel works from the table for
!> any number of nodes, points and groups. Shape functions and Gauss rules: Zienkiewicz & Taylor,
!> The Finite Element Method, 1989, chap. 7.
module dd3_element_table
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: element_t, new_table, shape_i, complete_table, set_table_point

  !> An element, in natural coordinates (xi, eta, zeta) within -1 ... 1, zeta through the thickness.
  type :: element_t
    !> Name as written in the input.
    character(len=16) :: name = ""
    !> One line of description.
    character(len=80) :: title = ""
    !> Number of nodes.
    integer :: n_node = 0
    !> Number of integration points.
    integer :: n_point = 0
    !> Number of groups of points that share a mean dilatation; 0 where each point keeps its own.
    integer :: n_group = 0
    !> Number of pairs of nodes that face each other through the thickness.
    integer :: n_pair = 0
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
    !> Group of each point, 1 ... n_group (0 where there is none): `group(n_point)`.
    integer, allocatable :: group(:)
    !> Values at the nodes from values at the points: `extrapolation(n_node,n_point)`; rows sum to
    !> 1.
    real(wp), allocatable :: extrapolation(:, :)
    !> Nodes facing each other, bottom then top: `pair(2,n_pair)`.
    integer, allocatable :: pair(:, :)
    !> Our node at each place of VTK's order: `vtk_order(n_node)`.
    integer, allocatable :: vtk_order(:)
  end type element_t

  abstract interface
    !> Shape functions of an element and their derivatives at one place.
    pure subroutine shape_i(natural, shape, dshape)
      import :: wp
      !> Natural coordinates.
      real(wp), intent(in) :: natural(3)
      !> Shape functions, one per node.
      real(wp), intent(out) :: shape(:)
      !> Their derivatives: `dshape(3,n_node)`.
      real(wp), intent(out) :: dshape(:, :)
    end subroutine shape_i
  end interface

contains

  !> Gives a table its sizes.
  subroutine new_table(self, name, n_node, n_point, n_pair)
    !> The table.
    type(element_t), intent(out) :: self
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Number of nodes, of integration points, of pairs through the thickness.
    integer, intent(in) :: n_node, n_point, n_pair

    integer :: a

    self%name = name
    self%n_node = n_node
    self%n_point = n_point
    self%n_pair = n_pair
    allocate (self%node(3, n_node), self%point(3, n_point), self%weight(n_point))
    allocate (self%shape(n_node, n_point), self%dshape(3, n_node, n_point))
    allocate (self%slope(3, n_point, n_node), self%slope_row(n_node, 3, n_point))
    allocate (self%extrapolation(n_node, n_point))
    allocate (self%pair(2, n_pair))
    allocate (self%group(n_point), source=0)
    allocate (self%vtk_order(n_node), source=[(a, a=1, n_node)])
  end subroutine new_table

  !> Gives a point its place and weight.
  subroutine set_table_point(self, p, natural, weight)
    !> The table.
    type(element_t), intent(inout) :: self
    !> Which point.
    integer, intent(in) :: p
    !> Natural coordinates.
    real(wp), intent(in) :: natural(3)
    !> Quadrature weight.
    real(wp), intent(in) :: weight

    self%point(:, p) = natural
    self%weight(p) = weight
  end subroutine set_table_point

  !> Evaluates the shape functions at the points, once nodes and points are in place.
  subroutine complete_table(self, evaluate)
    !> The table.
    type(element_t), intent(inout) :: self
    !> The element's shape functions.
    procedure(shape_i) :: evaluate

    integer :: p

    do p = 1, self%n_point
      call evaluate(self%point(:, p), self%shape(:, p), self%dshape(:, :, p))
      self%slope(:, p, :) = self%dshape(:, :, p)
      self%slope_row(:, :, p) = transpose(self%dshape(:, :, p))
    end do
    self%n_group = maxval(self%group)
  end subroutine complete_table

end module dd3_element_table
