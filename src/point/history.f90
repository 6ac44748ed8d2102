! SPDX-License-Identifier: GPL-3.0-or-later
!> history.csv of material points: strain, stress, plastic strain, flow stress and the internal
!> variables of the laws. One row for the start of each point and for every n-th step; the last step
!> of a point always has a row.
module dd3_point_history
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t
  use dd3_base_text, only : newline
  use dd3_linalg_tensor, only : kelvin_factor
  use dd3_model_internal_variables, only : component_names, variable_t
  use dd3_output_csv, only : table_t
  implicit none
  private
  public :: point_record_t, point_row_t

  !> Position in a Kelvin vector of the components 11 22 33 12 23 13 of the table.
  integer, parameter :: place(6) = [1, 2, 3, 6, 4, 5]

  !> A row of the table.
  type :: point_row_t
    !> Step of the point, from 0.
    integer :: increment = 0
    !> Time since the start of the point, s.
    real(wp) :: time = 0.0_wp
    !> Name of the point.
    character(len=:), allocatable :: point
    !> Logarithmic strain and stress (MPa) in global axes, Kelvin.
    real(wp) :: strain(6) = 0.0_wp, stress(6) = 0.0_wp
    !> Equivalent plastic strain; flow stress, MPa.
    real(wp) :: plastic = 0.0_wp, flow_stress = 0.0_wp
    !> Components of the internal variables, as output, one after the other.
    real(wp), allocatable :: internal_variables(:)
  end type point_row_t

  !> History of material points.
  type :: point_record_t
    type(table_t), private :: table
    !> Whether there is a column of the time.
    logical, private :: timed = .false.
  contains
    procedure :: open => point_open
    procedure :: write => point_write
    procedure :: close => point_close
  end type point_record_t

contains

  !> Make the file with its two lines of heading.
  subroutine point_open(self, directory, variables, timed, error)
    class(point_record_t), intent(inout) :: self
    !> Folder of the results.
    character(len=*), intent(in) :: directory
    !> Internal variables of the materials.
    type(variable_t), intent(in) :: variables(:)
    !> Whether a point has a time.
    logical, intent(in) :: timed
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%timed = timed
    call self%table%open(directory//"/history.csv", error)
    if (allocated(error)) return
    call self%table%file%put(heading(variables, timed), error)
    if (.not. allocated(error)) call self%table%file%flush(error)
  end subroutine point_open

  !> Return the lines of the heading: units and names of the columns.
  function heading(variables, timed) result(text)
    type(variable_t), intent(in) :: variables(:)
    logical, intent(in) :: timed
    character(len=:), allocatable :: text

    character(len=:), allocatable :: names, units
    character(len=3), allocatable :: endings(:)
    integer :: i, k

    units = "# units: -,-,-,-,-,-,-,-,MPa,MPa,MPa,MPa,MPa,MPa,-,MPa"
    names = "increment,point,e11,e22,e33,e12,e23,e13,s11,s22,s33,s12,s23,s13,eqps,flow_stress"
    do i = 1, size(variables)
      endings = component_names(variables(i))
      do k = 1, size(endings)
        names = names//","//trim(variables(i)%row%name)//trim(endings(k))
        if (variables(i)%row%unit == "") units = units//",-"
        if (variables(i)%row%unit /= "") units = units//","//trim(variables(i)%row%unit)
      end do
    end do
    if (timed) then
      units = units//",s"
      names = names//",time"
    end if
    text = units//newline//names//newline
  end function heading

  !> Add a row.
  subroutine point_write(self, row, error)
    class(point_record_t), intent(inout) :: self
    type(point_row_t), intent(in) :: row
    !> Set if the row cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%add_integer(row%increment)
    call self%table%add_text(row%point)
    call self%table%add_reals(row%strain(place)/kelvin_factor)
    call self%table%add_reals(row%stress(place)/kelvin_factor)
    call self%table%add_real(row%plastic)
    call self%table%add_real(row%flow_stress)
    if (allocated(row%internal_variables)) call self%table%add_reals(row%internal_variables)
    if (self%timed) call self%table%add_real(row%time)
    call self%table%end_row(error)
  end subroutine point_write

  !> Write what is buffered and close the file.
  subroutine point_close(self, error)
    class(point_record_t), intent(inout) :: self
    !> Set if the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%close(error)
  end subroutine point_close

end module dd3_point_history
