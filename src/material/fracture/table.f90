! SPDX-License-Identifier: GPL-3.0-or-later
!> The strain to fracture as a table over the triaxiality, or over the triaxiality and the Lode
!> angle: a block of points for each normalised Lode angle, straight between the points of a block
!> and between the blocks, constant before the first and beyond the last of both. With an exponent
!> above 1 the damage grows slowly at first, as in the model GISSMO.
module dd3_material_fracture_table
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real, kind_text, pair_name, parameter_t
  use dd3_base_text, only : to_text
  use dd3_material_description, only : add_problem, check_table, description_t, problem_t, value_of
  use dd3_material_fracture_law, only : fracture_t
  use dd3_material_straight, only : straight
  implicit none
  private
  public :: table_t

  !> Largest number of blocks, and the name of their Lode angles before the number.
  integer, parameter :: most = 9
  character(len=*), parameter :: lode_name = "lode"

  !> Triaxialities and strains of the points of a block.
  type :: block_t
    real(wp), allocatable :: place(:), value(:)
  end type block_t

  !> Largest triaxiality and strain to fracture; larger values are in per cent.
  real(wp), parameter :: largest = 10.0_wp

  type, extends(fracture_t) :: table_t
    private
    type(block_t), allocatable :: block(:)
    !> Normalised Lode angles of the blocks, of size zero if there is only one for all.
    real(wp), allocatable :: lode(:)
  contains
    procedure, nopass :: describe
    procedure, nopass :: check
    procedure :: set
    procedure :: strain
  end type table_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    type(parameter_t) :: lodes(most)
    integer :: k

    description%name = "table"
    description%title = "straight lines through points triaxiality:strain, also over the Lode angle"
    description%source = "F. Neukamm, M. Feucht, A. Haufe, Proc. 7th European LS-DYNA Conf. (2009)"
    do k = 1, most
      lodes(k) = row(lode_name//to_text(k), kind_real, "", "-", "normalised Lode angle of "// &
          "block "//to_text(k)//"; 1: uniaxial, -1: equibiaxial tension", -1.0_wp, 1.0_wp)
    end do
    allocate (description%rows, source=[lodes, &
      row(pair_name, kind_real, "", "-", "strain to fracture at the triaxiality, two points or "// &
          "more: 0:0.7 0.333:0.9 0.577:0.5; blocks begin at the same triaxiality", 0.0_wp, &
          lower_open=.true., repeatable=.true.), &
      row("file", kind_text, "", "-", "file with triaxiality and strain in each line, in place "// &
          "of the points; # begins a comment"), &
      row("exponent", kind_real, "", "1", "exponent of the growth of the damage; 1: linear in "// &
          "the plastic strain", 1.0_wp, 10.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("lode1", -1.0_wp), law_value_t("lode2", 0.0_wp), law_value_t("lode3", 1.0_wp), &
      law_value_t(pair_name, 1.4_wp, 0.0_wp), law_value_t(pair_name, 0.9_wp, 0.667_wp), &
      law_value_t(pair_name, 0.7_wp, 0.0_wp), law_value_t(pair_name, 0.5_wp, 0.577_wp), &
      law_value_t(pair_name, 1.1_wp, 0.0_wp), law_value_t(pair_name, 0.9_wp, 0.333_wp), &
      law_value_t("exponent", 2.0_wp)])
  end subroutine describe

  !> Require a Lode angle for each block, Lode angles that rise, and two points or more of each
  !> block, with triaxialities that rise, none in per cent.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    integer, allocatable :: lode(:), point(:), first(:)
    integer :: k

    if (size(problems) > 0) return
    lode = lodes_among(values)
    point = pack([(k, k=1, size(values))], values%name == pair_name)
    first = begins(values(point)%abscissa, size(lode))
    do k = 2, size(lode)
      if (.not. values(lode(k))%value > values(lode(k - 1))%value) call add_problem(problems, &
          lode(k), "the Lode angle "//to_text(values(lode(k))%value)// &
          " is not larger than the one before", "Lode angles that rise")
    end do
    if (size(lode) > 0 .and. size(first) - 1 /= size(lode)) call add_problem(problems, 0, &
        to_text(size(first) - 1)//" blocks of points and "//to_text(size(lode))//" Lode angles", &
        "lode1= lode2= ... of the blocks, each of which begins at the first triaxiality")
    do k = 1, size(first) - 1
      call check_block(values, point(first(k):first(k + 1) - 1), problems)
    end do
    k = findloc(abs(values(point)%abscissa) > largest .or. values(point)%value > largest, .true., &
        dim=1)
    if (k > 0) call add_problem(problems, point(k), &
        "a triaxiality or a strain to fracture above "//to_text(largest), "fractions, not per cent")
  end subroutine check

  !> Check the points of a block.
  subroutine check_block(values, point, problems)
    type(law_value_t), intent(in) :: values(:)
    !> Positions of the points among the values.
    integer, intent(in) :: point(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    type(problem_t), allocatable :: own(:)
    integer :: i, at

    allocate (own(0))
    call check_table(values(point), "triaxiality", "triaxialities", "triaxiality1:strain1 "// &
        "triaxiality2:strain2 ...", own)
    do i = 1, size(own)
      at = 0
      if (size(point) > 0) at = point(max(own(i)%index, 1))
      call add_problem(problems, at, own(i)%message, own(i)%expected)
    end do
  end subroutine check_block

  !> Return the positions of the Lode angles among the values.
  pure function lodes_among(values) result(lode)
    type(law_value_t), intent(in) :: values(:)
    integer, allocatable :: lode(:)

    integer :: i

    lode = pack([(i, i=1, size(values))], values%name(:len(lode_name)) == lode_name)
  end function lodes_among

  !> Return the first point of each block, those at the triaxiality of the first one, and the end.
  pure function begins(place, n_lode) result(first)
    !> Triaxialities of all points.
    real(wp), intent(in) :: place(:)
    !> Number of Lode angles; without any there is one block.
    integer, intent(in) :: n_lode
    integer, allocatable :: first(:)

    integer :: i

    first = [1, size(place) + 1]
    if (n_lode == 0 .or. size(place) == 0) return
    first = [pack([(i, i=1, size(place))], .not. abs(place - place(1)) > 0.0_wp), size(place) + 1]
  end function begins

  subroutine set(self, values)
    class(table_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    type(law_value_t), allocatable :: pair(:)
    integer, allocatable :: first(:)
    integer :: k

    self%lode = values(lodes_among(values))%value
    pair = pack(values, values%name == pair_name)
    first = begins(pair%abscissa, size(self%lode))
    if (allocated(self%block)) deallocate (self%block)
    allocate (self%block(size(first) - 1))
    do k = 1, size(self%block)
      associate (own => pair(first(k):first(k + 1) - 1))
        self%block(k)%place = own%abscissa
        self%block(k)%value = own%value
      end associate
    end do
    self%exponent = value_of(values, "exponent", 1.0_wp)
  end subroutine set

  !> Return the strain to fracture.
  pure real(wp) function strain(self, triaxiality, lode)
    class(table_t), intent(in) :: self
    real(wp), intent(in) :: triaxiality, lode

    real(wp) :: value(2), slope
    integer :: k, i

    k = min(max(count(self%lode <= lode), 1), max(size(self%block) - 1, 1))
    do i = 1, 2
      associate (block => self%block(min(k + i - 1, size(self%block))))
        call straight(block%place, block%value, triaxiality, value(i), slope)
      end associate
    end do
    strain = value(1)
    if (size(self%block) > 1) call straight(self%lode(k:k + 1), value, lode, strain, slope)
  end function strain

end module dd3_material_fracture_table
