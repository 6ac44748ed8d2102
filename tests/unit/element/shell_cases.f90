! SPDX-License-Identifier: GPL-3.0-or-later
!> Small solver for the tests of the solid-shell: a mesh of one layer on any surface, Newton's
!> method with the enhanced parameters condensed, band matrix.
module shell_cases
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use element_cases, only : evaluate, identities, law_t, make_element
  implicit none
  private
  public :: shell_mesh_t, new_grid, new_shell_mesh, solve, assemble, nodes_at

  !> A mesh of one layer: nodes 2 k - 1 and 2 k lie at the bottom and the top of pair k.
  type :: shell_mesh_t
    integer :: n_node = 0, n_element = 0
    !> Positions in the plane of the parameters, 0 ... 1, bottom and top: `(3,n_node)`, the third is
    !> -1 or 1.
    real(wp), allocatable :: parameter(:, :)
    !> Committed and trial positions, external forces and residuals: `(3,n_node)`.
    real(wp), allocatable :: x0(:, :), x(:, :), force(:, :), internal(:, :)
    integer, allocatable :: node(:, :)
    !> Degrees of freedom held at `x`.
    logical, allocatable :: held(:, :)
    !> Enhanced parameters: `(n_enhanced,n_element)`.
    real(wp), allocatable :: enhanced(:, :)
    !> Stresses and log strains: `(6,n_point,n_element)`.
    real(wp), allocatable :: stress(:, :, :), strain(:, :, :)
    type(element_t) :: element
    type(element_work_t) :: work
  end type shell_mesh_t

  interface
    !> Solve a system with a band matrix (LAPACK).
    subroutine dgbsv(n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
      import :: wp
      integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb
      real(wp), intent(inout) :: ab(ldab, *), b(ldb, *)
      integer, intent(out) :: ipiv(*), info
    end subroutine dgbsv

    !> Position of a point of the sheet.
    pure function surface_interface(parameter) result(x)
      import :: wp
      !> 0 ... 1 along the first and the second direction, -1 ... 1 through the thickness.
      real(wp), intent(in) :: parameter(3)
      real(wp) :: x(3)
    end function surface_interface
  end interface

contains

  !> Make a regular mesh on a surface; the numbers rise along the second direction first.
  subroutine new_grid(self, name, nx, ny, surface)
    type(shell_mesh_t), intent(out) :: self
    character(len=*), intent(in) :: name
    !> Number of elements.
    integer, intent(in) :: nx, ny
    procedure(surface_interface) :: surface

    real(wp), allocatable :: parameter(:, :)
    integer, allocatable :: corner(:, :)
    integer :: i, j, k

    allocate (parameter(2, (nx + 1)*(ny + 1)), corner(4, nx*ny))
    do i = 0, nx
      do j = 0, ny
        parameter(:, i*(ny + 1) + j + 1) = [real(i, wp)/real(nx, wp), real(j, wp)/real(ny, wp)]
      end do
    end do
    do i = 1, nx
      do j = 1, ny
        k = (i - 1)*(ny + 1) + j
        corner(:, (i - 1)*ny + j) = [k, k + ny + 1, k + ny + 2, k + 1]
      end do
    end do
    call new_shell_mesh(self, name, parameter, corner, surface)
  end subroutine new_grid

  !> Make a mesh of quadrilaterals on a surface.
  subroutine new_shell_mesh(self, name, parameter, corner, surface)
    type(shell_mesh_t), intent(out) :: self
    character(len=*), intent(in) :: name
    !> Of the pairs, and the pairs at the corners of the elements.
    real(wp), intent(in) :: parameter(:, :)
    integer, intent(in) :: corner(:, :)
    procedure(surface_interface) :: surface

    integer :: k, layer, n

    call make_element(name, self%element, self%work)
    self%n_node = 2*size(parameter, 2)
    self%n_element = size(corner, 2)
    n = self%n_node
    allocate (self%parameter(3, n), self%x0(3, n), self%force(3, n), self%held(3, n))
    allocate (self%internal(3, n), source=0.0_wp)
    allocate (self%enhanced(self%element%n_enhanced, self%n_element), source=0.0_wp)
    allocate (self%stress(6, self%element%n_point, self%n_element), source=0.0_wp)
    allocate (self%strain(6, self%element%n_point, self%n_element), source=0.0_wp)
    self%force = 0.0_wp
    self%held = .false.
    do k = 1, size(parameter, 2)
      do layer = -1, 1, 2
        associate (p => self%parameter(:, 2*k - (1 - layer)/2))
          p = [parameter(:, k), real(layer, wp)]
          self%x0(:, 2*k - (1 - layer)/2) = surface(p)
        end associate
      end do
    end do
    self%x = self%x0
    allocate (self%node(8, self%n_element))
    self%node(1:4, :) = 2*corner - 1
    self%node(5:8, :) = 2*corner
  end subroutine new_shell_mesh

  !> Return the nodes at a value of a parameter.
  pure function nodes_at(self, direction, value) result(node)
    type(shell_mesh_t), intent(in) :: self
    integer, intent(in) :: direction
    real(wp), intent(in) :: value
    integer, allocatable :: node(:)

    integer :: i

    node = pack([(i, i=1, self%n_node)], abs(self%parameter(direction, :) - value) < 1.0e-9_wp)
  end function nodes_at

  !> Solve for the free degrees of freedom by Newton's method from `x`. The last row of a band is
  !> that of a full matrix, so numbers must rise along the narrow direction.
  subroutine solve(self, law, iterations, residual)
    type(shell_mesh_t), intent(inout) :: self
    type(law_t), intent(in) :: law
    integer, intent(in) :: iterations
    !> Largest residual after the last iteration over the largest force.
    real(wp), intent(out) :: residual

    real(wp), allocatable :: matrix(:, :), rhs(:, :), gain(:, :, :, :), offset(:, :)
    integer, allocatable :: pivot(:)
    integer :: a, band, e, i, info, iteration

    band = 3*maxval(maxval(self%node, dim=1) - minval(self%node, dim=1)) + 2
    allocate (matrix(3*band + 1, 3*self%n_node), rhs(3*self%n_node, 1), pivot(3*self%n_node))
    allocate (gain(self%element%n_enhanced, 3, 8, self%n_element))
    allocate (offset(self%element%n_enhanced, self%n_element))
    do iteration = 1, iterations
      call assemble(self, law, band, matrix, rhs(:, 1), gain, offset)
      call dgbsv(3*self%n_node, band, band, 1, matrix, 3*band + 1, pivot, rhs, 3*self%n_node, info)
      if (info /= 0) error stop "singular matrix"
      self%x = self%x + reshape(rhs, [3, self%n_node])
      do e = 1, self%n_element
        self%enhanced(:, e) = self%enhanced(:, e) - offset(:, e)
        do a = 1, 8
          do i = 1, 3
            self%enhanced(:, e) = self%enhanced(:, e) &
                - gain(:, i, a, e)*rhs(3*self%node(a, e) - 3 + i, 1)
          end do
        end do
      end do
    end do
    call assemble(self, law, band, matrix, rhs(:, 1), gain, offset)
    residual = maxval(abs(rhs))/max(maxval(abs(self%internal)), maxval(abs(self%force)))
  end subroutine solve

  !> Assemble band matrix and right-hand side, with the condensed forces.
  subroutine assemble(self, law, band, matrix, rhs, gain, offset)
    type(shell_mesh_t), intent(inout) :: self
    type(law_t), intent(in) :: law
    integer, intent(in) :: band
    real(wp), intent(out) :: matrix(:, :), rhs(:), gain(:, :, :, :), offset(:, :)

    real(wp) :: right(3, self%n_node)
    integer :: a, b, e, i, j, row, column
    logical :: ok

    matrix = 0.0_wp
    right = self%force
    self%internal = 0.0_wp
    do e = 1, self%n_element
      associate (node => self%node(:, e), work => self%work)
        work%enhanced(:) = self%enhanced(:, e)
        call evaluate(self%element, law, self%x0(:, node), self%x(:, node), &
            identities(self%element%n_point), 0.0_wp*self%stress(:, :, e), work, ok)
        if (.not. ok) error stop "an element is turned inside out"
        self%stress(:, :, e) = work%stress
        self%strain(:, :, e) = work%strain
        gain(:, :, :, e) = work%enhanced_gain
        offset(:, e) = work%enhanced_offset
        self%internal(:, node) = self%internal(:, node) + work%force
        right(:, node) = right(:, node) - work%force + work%condensed_force
        do a = 1, 8
          do b = 1, 8
            do j = 1, 3
              column = 3*node(b) - 3 + j
              do i = 1, 3
                row = 3*node(a) - 3 + i
                if (self%held(i, node(a))) cycle
                matrix(2*band + 1 + row - column, column) = &
                    matrix(2*band + 1 + row - column, column) + work%stiffness(i, j, b, a)
              end do
            end do
          end do
        end do
      end associate
    end do
    where (self%held) right = 0.0_wp
    rhs = reshape(right, [3*self%n_node])
    do a = 1, self%n_node
      do i = 1, 3
        if (self%held(i, a)) matrix(2*band + 1, 3*a - 3 + i) = 1.0_wp
      end do
    end do
  end subroutine assemble

end module shell_cases
