! SPDX-License-Identifier: GPL-3.0-or-later
!> Time the linear solvers on strips of hexahedra like those of a bending test, or on a system in
!> Matrix Market format.
!>
!>     benchmark_solvers [--default] [matrix file]
!>
!> The right-hand side is read from the matrix file's name with `.rhs` appended. Columns: level of
!> fill (all: complete), ordering, ratio of the blocks in the factors to those in the matrix,
!> iterations, restarts, times of set-up, factorisation and solution in ms (best of several; of
!> auto, where its choice varies, the means of up to 50, a factorisation after a failure of CGS
!> being part of the solution), memory of the factors and workspaces in MB (0 if not known),
!> relative residual, and largest difference from UMFPACK's solution relative to its largest
!> component. With `--default` CGS has its default level and ordering, without it six levels with
!> every ordering.
program benchmark_solvers
  use dd3_base_clock, only : processor_time
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_fill_pattern, only : fill_pattern_t, new_fill_pattern
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern, find_positions
  use dd3_linalg_ordering, only : find_ordering, ordering_names
  use dd3_linalg_scaled_system, only : scaled_system_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_solver_registry, only : missing_package, new_linear_solver, solver_names
  use matrix_market, only : read_matrix_market
  implicit none

  !> Level of fill of a complete factorisation.
  integer, parameter :: complete = huge(0)/2
  !> Most factorisations of one solver, and those of the automatic choice if it varies.
  integer, parameter :: most_rounds = 200, auto_rounds = 50
  type(block_matrix_t) :: matrix
  type(error_t), allocatable :: error
  real(wp), allocatable :: b(:)
  character(len=1000) :: file
  logical :: only_default

  call get_command_argument(1, file)
  only_default = file == "--default"
  if (only_default) call get_command_argument(2, file)
  if (file /= "") then
    call read_matrix_market(matrix, b, trim(file), error)
    if (allocated(error)) then
      print '(a)', error%message
      error stop 1
    end if
    call compare(trim(file), matrix, b)
  else
    call compare_strip([10, 3, 2])
    call compare_strip([80, 4, 2])
    call compare_strip([60, 20, 3])
    call compare_strip([175, 10, 3])
  end if

contains

  !> Compare the solvers on a strip.
  subroutine compare_strip(divisions)
    !> Number of elements in length, width and thickness.
    integer, intent(in) :: divisions(3)

    character(len=40) :: name

    call make_strip(divisions, matrix, b)
    write (name, '(a,i0,2("x",i0))') "strip ", divisions
    call compare(trim(name), matrix, b)
  end subroutine compare_strip

  !> Compare the solvers on a system and print a table.
  subroutine compare(name, matrix, b)
    character(len=*), intent(in) :: name
    type(block_matrix_t), intent(inout) :: matrix
    real(wp), intent(in) :: b(:)

    integer, parameter :: levels(6) = [0, 1, 2, 3, 5, complete]
    real(wp), allocatable :: reference(:)
    character(len=16), allocatable :: names(:)
    type(solver_options_t) :: options
    integer :: i, k

    print '(/,a,": ",i0," unknowns, ",i0," blocks")', name, size(b), size(matrix%column)
    print '(2a)', "  method   level order   fill  iter  re    set-up    factor     solve", &
        "    memory  residual     error"
    options%method = "umfpack"
    options%ilu_level = 2
    options%tolerance = 1.0e-10_wp
    options%iterations = 200
    options%ordering = "none"
    allocate (reference(size(b)))
    reference = 0.0_wp
    call measure(options, matrix, b, reference)
    names = solver_names()
    names = pack(names, [(missing_package(names(i)) == "", i = 1, size(names))])
    names = pack(names, names /= "umfpack" .and. names /= "cgs")
    do i = 1, size(names)
      options%method = names(i)
      call measure(options, matrix, b, reference)
    end do
    options%method = "cgs"
    if (only_default) then
      options%ordering = "auto"
      call measure(options, matrix, b, reference)
      return
    end if
    do i = 1, size(ordering_names)
      do k = 1, size(levels)
        options%ordering = ordering_names(i)
        options%ilu_level = levels(k)
        call measure(options, matrix, b, reference)
      end do
    end do
  end subroutine compare

  !> Time one solver on a system and print a line.
  subroutine measure(options, matrix, b, reference)
    type(solver_options_t), intent(in) :: options
    type(block_matrix_t), intent(inout) :: matrix
    real(wp), intent(in) :: b(:)
    !> Direct solution; set if it is zero.
    real(wp), intent(inout) :: reference(:)

    class(linear_solver_t), allocatable :: solver
    type(solver_report_t) :: report
    type(verdict_t) :: verdict
    type(error_t), allocatable :: error
    real(wp), allocatable :: x(:)
    ! Factorisation and solution: times of one round, sums and minima.
    real(wp) :: spent(2), total(2), least(2)
    real(wp) :: began, setup, megabytes
    integer :: round
    logical :: varies

    allocate (x(size(b)))
    call new_linear_solver(solver, options, error)
    if (allocated(error)) error stop 1
    began = processor_time()
    call solver%setup(matrix)
    setup = processor_time() - began
    varies = index(solver%description, "whichever") > 0
    total = 0.0_wp
    least = huge(least)
    do round = 1, most_rounds
      began = processor_time()
      call solver%factor(matrix, verdict)
      spent(1) = processor_time() - began
      began = processor_time()
      if (verdict%outcome == verdict_converged) call solver%solve(b, x, report)
      spent(2) = processor_time() - began
      total = total + spent
      least = min(least, spent)
      if (sum(total) > merge(40.0_wp, 2.0_wp, varies)) exit
      if (varies .and. round == auto_rounds) exit
    end do
    if (varies) least = total/real(min(round, most_rounds), wp)
    megabytes = 1.0e-6_wp*solver%factor_bytes()
    call solver%release()
    if (all(abs(reference) <= 0.0_wp)) reference = x
    print '(2x,a8,a6,2x,a4,a7,i6,i4,4f10.3,2es10.1,1x,a)', options%method, level_text(options), &
        options%ordering, fill_text(options, matrix), report%iterations, report%restarts, &
        1.0e3_wp*[setup, least], megabytes, report%residual, &
        maxval(abs(x - reference))/maxval(abs(reference)), trim(verdict%detail)//trim(report%reason)
    if (options%method /= "cgs") print '(10x,a)', trim(solver%description)
  end subroutine measure

  !> Return the level of fill of a solver for the table.
  function level_text(options) result(text)
    type(solver_options_t), intent(in) :: options
    character(len=6) :: text

    write (text, '(i6)') options%ilu_level
    if (options%ilu_level == complete) text = "   all"
    if (options%method /= "cgs") text = "     -"
  end function level_text

  !> Return the ratio of the blocks in the factors to those in the matrix for the table.
  function fill_text(options, matrix) result(text)
    type(solver_options_t), intent(in) :: options
    type(block_matrix_t), intent(in) :: matrix
    character(len=7) :: text

    type(scaled_system_t) :: system
    type(error_t), allocatable :: error
    type(fill_pattern_t) :: pattern
    integer, allocatable :: order(:)

    text = "      -"
    if (options%method /= "cgs") return
    call find_ordering(trim(options%ordering), matrix, order, error)
    call system%setup(matrix, order)
    call new_fill_pattern(pattern, system%matrix, options%ilu_level)
    write (text, '(f7.2)') real(size(pattern%column), wp)/real(size(matrix%column), wp)
  end function fill_text

  !> Build the elastic stiffness matrix and a right-hand side of a strip of 175 x 35 x 0.78 mm,
  !> clamped at one end; some top nodes are held by unit rows like those of contact. Nodes are
  !> numbered in thickness first, then in width.
  subroutine make_strip(divisions, matrix, b)
    !> Number of elements in length, width and thickness.
    integer, intent(in) :: divisions(3)
    type(block_matrix_t), intent(out) :: matrix
    real(wp), allocatable, intent(out) :: b(:)

    real(wp), parameter :: size_of_strip(3) = [175.0_wp, 35.0_wp, 0.78_wp]
    integer, allocatable :: connectivity(:, :), position(:, :, :)
    real(wp) :: stiffness(3, 3, 8, 8)
    integer :: i, j, k, e, p, q, node, corner(4)

    allocate (connectivity(8, product(divisions)))
    e = 0
    do i = 1, divisions(1)
      do j = 1, divisions(2)
        do k = 1, divisions(3)
          e = e + 1
          corner(1:4) = [number(divisions, i, j, k), number(divisions, i + 1, j, k), &
              number(divisions, i + 1, j + 1, k), number(divisions, i, j + 1, k)]
          connectivity(:, e) = [corner(1:4), corner(1:4) + 1]
        end do
      end do
    end do
    call new_pattern(matrix, product(divisions + 1), connectivity)
    call find_positions(matrix, connectivity, position)
    call brick_stiffness(size_of_strip/real(divisions, wp), stiffness)
    do e = 1, size(connectivity, 2)
      do q = 1, 8
        do p = 1, 8
          associate (block => matrix%value(:, :, position(p, q, e)))
            block = block + stiffness(:, :, p, q)
          end associate
        end do
      end do
    end do
    allocate (b(3*matrix%n))
    b = 0.0_wp
    do j = 1, divisions(2) + 1
      do k = 1, divisions(3) + 1
        call hold(matrix, number(divisions, 1, j, k), [1, 2, 3])
      end do
    end do
    do i = divisions(1)/2, divisions(1)/2 + max(1, divisions(1)/10)
      do j = 1, divisions(2) + 1
        node = number(divisions, i, j, divisions(3) + 1)
        call hold(matrix, node, [3])
        b(3*node) = -1.0e-2_wp
      end do
    end do
    do j = 1, divisions(2) + 1
      b(3*number(divisions, divisions(1) + 1, j, 1)) = 1.0_wp
    end do
  end subroutine make_strip

  !> Return the number of a node of the grid.
  pure integer function number(divisions, i, j, k)
    !> Number of elements in length, width and thickness.
    integer, intent(in) :: divisions(3)
    !> Position in length, width and thickness.
    integer, intent(in) :: i, j, k

    number = k + (divisions(3) + 1)*(j - 1 + (divisions(2) + 1)*(i - 1))
  end function number

  !> Replace rows of a node by scaled unit rows.
  subroutine hold(matrix, node, components)
    type(block_matrix_t), intent(inout) :: matrix
    integer, intent(in) :: node, components(:)

    integer :: c

    matrix%value(components, :, matrix%row_start(node):matrix%row_start(node + 1) - 1) = 0.0_wp
    do c = 1, size(components)
      matrix%value(components(c), components(c), matrix%diagonal(node)) = 1.0e3_wp
    end do
  end subroutine hold

  !> Evaluate the stiffness of an elastic brick with its deviatoric strain at the Gauss points and
  !> its volumetric strain at the centre.
  subroutine brick_stiffness(edge, stiffness)
    !> Edge lengths, mm.
    real(wp), intent(in) :: edge(3)
    !> Row component, column component, row node, column node.
    real(wp), intent(out) :: stiffness(3, 3, 8, 8)

    ! Bulk and shear modulus of steel, MPa.
    real(wp), parameter :: bulk = 175000.0_wp, shear = 80769.0_wp
    integer, parameter :: corner_sign(3, 8) = reshape([-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, &
        -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
    real(wp), parameter :: corner(3, 8) = real(corner_sign, wp)
    real(wp) :: g(3, 8), mean(3, 8), point(3), weight, value
    integer :: p, a, b, i, j

    stiffness = 0.0_wp
    weight = product(edge)/8.0_wp
    do a = 1, 8
      mean(:, a) = corner(:, a)/(4.0_wp*edge)
    end do
    do p = 1, 8
      point = corner(:, p)/sqrt(3.0_wp)
      do a = 1, 8
        do i = 1, 3
          g(i, a) = 0.25_wp*corner(i, a)/edge(i)
          do j = 1, 3
            if (j /= i) g(i, a) = g(i, a)*(1.0_wp + point(j)*corner(j, a))
          end do
        end do
      end do
      do b = 1, 8
        do a = 1, 8
          do j = 1, 3
            do i = 1, 3
              value = bulk*mean(i, a)*mean(j, b) &
                  + shear*(g(j, a)*g(i, b) - 2.0_wp/3.0_wp*g(i, a)*g(j, b))
              if (i == j) value = value + shear*dot_product(g(:, a), g(:, b))
              stiffness(i, j, a, b) = stiffness(i, j, a, b) + weight*value
            end do
          end do
        end do
      end do
    end do
  end subroutine brick_stiffness

end program benchmark_solvers
