! SPDX-License-Identifier: GPL-3.0-or-later
!> Point of the sheet's surface, as those at which the law of contact holds. It is a node, or lies
!> on a face or an edge between nodes, on the surface
!>     x = sum_a N_a x_a + sum_a (v_a.n_a) n_a,    v_a = sum_b s_ab x_b,
!> with the bilinear functions N_a of the face and the directions n_a of the columns of nodes from
!> the opposite face of the sheet. The second sum bends the face: each of its edges is the cubic
!> whose slopes at the ends are at right angles to the columns there, x = x_a + xi e - h_a (e.n_a)
!> n_a - h_b (-e.n_b) n_b with e = x_b - x_a, h_a = xi (1 - xi)^2 and h_b = xi^2 (1 - xi); in
!> between, opposite edges are blended linearly. Only displacements enter.
!> Source: Coons, Surfaces for computer-aided design of space forms, MIT (1967) (blending of edges);
!> Nagata, Comput. Aided Geom. Des. 22 (2005) 327-347 (faces curved by the normals at the nodes).
module dd3_sheet_surface_point
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : identity
  implicit none
  private
  public :: surface_point_t, most_point_nodes, node_point, edge_point, face_point, crossing_point, &
      middle_point

  !> Largest number of nodes that a point depends on.
  integer, parameter :: most_point_nodes = 8

  !> Point of the surface.
  type :: surface_point_t
    !> Number of nodes between which it lies, and of all nodes that it depends on.
    integer :: n_surface = 0, n_node = 0
    !> The nodes, those of the surface first, then the other ends of their columns.
    integer :: node(most_point_nodes) = 0
    !> Element that it lies on, and the numbers of the nodes in it.
    integer :: element = 0, local(most_point_nodes) = 0
    !> N_a.
    real(wp) :: weight(most_point_nodes/2) = 0.0_wp
    !> s_ab: the column of node a, the node b.
    real(wp) :: slope(most_point_nodes/2, most_point_nodes/2) = 0.0_wp
    !> Whether it is where an edge of the mesh crosses the border of a tool: its place on the edge
    !> is part of the state.
    logical :: moves = .false.
  contains
    procedure :: at_place
    procedure :: position
    procedure :: gradient
    procedure :: change
    procedure :: bending_stiffness
    procedure :: add_nodal_forces
  end type surface_point_t

contains

  !> Make the point at a node.
  pure type(surface_point_t) function node_point(node) result(self)
    integer, intent(in) :: node

    self%n_surface = 1
    self%n_node = 1
    self%node(1) = node
    self%weight(1) = 1.0_wp
  end function node_point

  !> Make a point on an edge.
  pure type(surface_point_t) function edge_point(node, opposite, xi) result(self)
    !> Ends of the edge, and the other ends of their columns.
    integer, intent(in) :: node(2), opposite(2)
    !> Place, 0 at the first node, 1 at the second.
    real(wp), intent(in) :: xi

    self%n_surface = 2
    self%n_node = 4
    self%node(:4) = [node, opposite]
    self%weight(:2) = [1.0_wp - xi, xi]
    call bend_edge(self, 1, 2, xi, 1.0_wp)
  end function edge_point

  !> Make the point in the middle of a straight edge.
  pure type(surface_point_t) function middle_point(node) result(self)
    !> Ends of the edge.
    integer, intent(in) :: node(2)

    self%n_surface = 2
    self%n_node = 2
    self%node(:2) = node
    self%weight(:2) = 0.5_wp
  end function middle_point

  !> Make the point of an edge of the mesh that may cross the border of a tool. The edge is
  !> straight.
  pure type(surface_point_t) function crossing_point(node) result(self)
    !> Ends of the edge.
    integer, intent(in) :: node(2)

    self = middle_point(node)
    self%moves = .true.
  end function crossing_point

  !> Return the point with its place on the edge, if that moves.
  pure type(surface_point_t) function at_place(self, place) result(point)
    class(surface_point_t), intent(in) :: self
    !> 0 at the first node, 1 at the second.
    real(wp), intent(in) :: place

    point = self
    if (self%moves) point%weight(:2) = [1.0_wp - place, place]
  end function at_place

  !> Make a point on a face.
  pure type(surface_point_t) function face_point(node, opposite, xi, eta) result(self)
    !> Corners in order, and the other ends of their columns.
    integer, intent(in) :: node(4), opposite(4)
    !> Place, 0 to 1; `xi` from the first corner to the second, `eta` from the first to the last.
    real(wp), intent(in) :: xi, eta

    self%n_surface = 4
    self%n_node = 8
    self%node = [node, opposite]
    self%weight = [(1.0_wp - xi)*(1.0_wp - eta), xi*(1.0_wp - eta), xi*eta, (1.0_wp - xi)*eta]
    call bend_edge(self, 1, 2, xi, 1.0_wp - eta)
    call bend_edge(self, 4, 3, xi, eta)
    call bend_edge(self, 1, 4, eta, 1.0_wp - xi)
    call bend_edge(self, 2, 3, eta, xi)
  end function face_point

  !> Add the bending of an edge: h_a (x_a - x_b) to v_a, and the same for b.
  pure subroutine bend_edge(self, a, b, xi, blend)
    type(surface_point_t), intent(inout) :: self
    !> Its ends among the nodes of the point.
    integer, intent(in) :: a, b
    !> Place on the edge and weight of the edge.
    real(wp), intent(in) :: xi, blend

    real(wp) :: h

    h = blend*xi*(1.0_wp - xi)**2
    self%slope(a, a) = self%slope(a, a) + h
    self%slope(a, b) = self%slope(a, b) - h
    h = blend*(1.0_wp - xi)*xi**2
    self%slope(b, b) = self%slope(b, b) + h
    self%slope(b, a) = self%slope(b, a) - h
  end subroutine bend_edge

  !> Return the position of the point, mm.
  pure function position(self, x)
    class(surface_point_t), intent(in) :: self
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp) :: position(3)

    real(wp) :: n(3), v(3), p(3, 3)
    integer :: a

    position = self%weight(1)*x(:, self%node(1))
    do a = 2, self%n_surface
      position = position + self%weight(a)*x(:, self%node(a))
    end do
    do a = 1, self%n_node - self%n_surface
      call column(self, x, a, n, v, p)
      position = position + dot_product(v, n)*n
    end do
  end function position

  !> Evaluate n at a node, v of that node, mm, and the derivative of n in the vector along the
  !> column, 1/mm.
  pure subroutine column(self, x, a, n, v, p)
    class(surface_point_t), intent(in) :: self
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: a
    real(wp), intent(out) :: n(3), v(3), p(3, 3)

    real(wp) :: length
    integer :: b

    n = x(:, self%node(a)) - x(:, self%node(self%n_surface + a))
    length = sqrt(dot_product(n, n))
    n = n/length
    do b = 1, 3
      p(:, b) = -n*n(b)/length
      p(b, b) = p(b, b) + 1.0_wp/length
    end do
    v = 0.0_wp
    do b = 1, self%n_surface
      v = v + self%slope(a, b)*x(:, self%node(b))
    end do
  end subroutine column

  !> Return the change of the position by displacements of the nodes, to first order, mm.
  pure function change(self, x, displacement)
    class(surface_point_t), intent(in) :: self
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_node)` of the sheet, mm.
    real(wp), intent(in) :: displacement(:, :)
    real(wp) :: change(3)

    real(wp) :: n(3), v(3), p(3, 3), dn(3), dv(3)
    integer :: a, k

    change = 0.0_wp
    do k = 1, self%n_surface
      change = change + self%weight(k)*displacement(:, self%node(k))
    end do
    do a = 1, self%n_node - self%n_surface
      call column(self, x, a, n, v, p)
      dv = 0.0_wp
      do k = 1, self%n_surface
        dv = dv + self%slope(a, k)*displacement(:, self%node(k))
      end do
      dn = matmul(p, displacement(:, self%node(a)) &
          - displacement(:, self%node(self%n_surface + a)))
      change = change + (dot_product(dv, n) + dot_product(v, dn))*n + dot_product(v, n)*dn
    end do
  end function change

  !> Evaluate the derivatives of the position in the positions of the nodes.
  pure subroutine gradient(self, x, b)
    class(surface_point_t), intent(in) :: self
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, 3, n_node)`: component of the point, component of the node.
    real(wp), intent(out) :: b(:, :, :)

    real(wp) :: n(3), v(3), p(3, 3), by_d(3, 3), vp(3), vn
    integer :: a, k, j

    do a = 1, self%n_surface
      b(:, :, a) = self%weight(a)*identity
    end do
    do a = 1, self%n_node - self%n_surface
      call column(self, x, a, n, v, p)
      vn = dot_product(v, n)
      vp = matmul(p, v)
      do j = 1, 3
        by_d(:, j) = n*vp(j) + vn*p(:, j)
        do k = 1, self%n_surface
          b(:, j, k) = b(:, j, k) + self%slope(a, k)*n(j)*n
        end do
      end do
      b(:, :, a) = b(:, :, a) + by_d
      b(:, :, self%n_surface + a) = -by_d
    end do
  end subroutine gradient

  !> Add the forces on the nodes that have the same work as a force at the point.
  pure subroutine add_nodal_forces(self, x, force, nodal)
    class(surface_point_t), intent(in) :: self
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> N.
    real(wp), intent(in) :: force(3)
    !> `(3, n_node)` of the sheet, N.
    real(wp), intent(inout) :: nodal(:, :)

    real(wp) :: n(3), v(3), p(3, 3), by_d(3), fn
    integer :: a, k

    do a = 1, self%n_surface
      nodal(:, self%node(a)) = nodal(:, self%node(a)) + self%weight(a)*force
    end do
    do a = 1, self%n_node - self%n_surface
      call column(self, x, a, n, v, p)
      fn = dot_product(force, n)
      do k = 1, self%n_surface
        nodal(:, self%node(k)) = nodal(:, self%node(k)) + self%slope(a, k)*fn*n
      end do
      by_d = matmul(p, fn*v + dot_product(v, n)*force)
      nodal(:, self%node(a)) = nodal(:, self%node(a)) + by_d
      associate (opposite => self%node(self%n_surface + a))
        nodal(:, opposite) = nodal(:, opposite) - by_d
      end associate
    end do
  end subroutine add_nodal_forces

  !> Evaluate the derivative of the nodal forces B^T f of a constant force f at the point in the
  !> positions of the nodes, N/mm.
  pure subroutine bending_stiffness(self, x, force, stiffness)
    class(surface_point_t), intent(in) :: self
    !> Positions of the nodes of the sheet, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> N.
    real(wp), intent(in) :: force(3)
    !> `(3, 3, n_node, n_node)`: components and nodes of rows, then of columns.
    real(wp), intent(out) :: stiffness(:, :, :, :)

    real(wp) :: n(3), v(3), p(3, 3), w(3), pw(3), pf(3), pv(3), by_vd(3, 3), by_dd(3, 3)
    real(wp) :: length, fn, along
    integer :: a, o, k, j

    stiffness(:, :, :self%n_node, :self%n_node) = 0.0_wp
    do a = 1, self%n_node - self%n_surface
      o = self%n_surface + a
      call column(self, x, a, n, v, p)
      length = norm2(x(:, self%node(a)) - x(:, self%node(o)))
      ! The energy of f is (v.n)(f.n), with the derivative w in n.
      fn = dot_product(force, n)
      w = fn*v + dot_product(v, n)*force
      pw = matmul(p, w)/length
      pf = matmul(p, force)
      pv = matmul(p, v)
      along = dot_product(n, w)/length
      do j = 1, 3
        by_vd(:, j) = n*pf(j) + fn*p(:, j)
        by_dd(:, j) = pf*pv(j) + pv*pf(j) - pw*n(j) - n*pw(j) - along*p(:, j)
      end do
      do k = 1, self%n_surface
        associate (s => self%slope(a, k))
          stiffness(:, :, k, a) = stiffness(:, :, k, a) + s*by_vd
          stiffness(:, :, k, o) = stiffness(:, :, k, o) - s*by_vd
          stiffness(:, :, a, k) = stiffness(:, :, a, k) + s*transpose(by_vd)
          stiffness(:, :, o, k) = stiffness(:, :, o, k) - s*transpose(by_vd)
        end associate
      end do
      stiffness(:, :, a, a) = stiffness(:, :, a, a) + by_dd
      stiffness(:, :, o, o) = stiffness(:, :, o, o) + by_dd
      stiffness(:, :, a, o) = stiffness(:, :, a, o) - by_dd
      stiffness(:, :, o, a) = stiffness(:, :, o, a) - by_dd
    end do
  end subroutine bending_stiffness

end module dd3_sheet_surface_point
