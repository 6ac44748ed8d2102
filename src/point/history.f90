!> history.csv of single material points: strain, stress, plastic strain and flow stress, one row
!> for the start of each point and one for every n-th step; the last step of a point is always
!> there.
module dd3_point_history
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t
  use dd3_linalg_tensor, only : kelvin_factor
  use dd3_output_csv, only : table_t
  implicit none
  private
  public :: point_record_t, point_row_t

  !> Where the components 11 22 33 12 23 13 of the table stand in a Kelvin vector.
  integer, parameter :: place(6) = [1, 2, 3, 6, 4, 5]

  !> A row of the table.
  type :: point_row_t
    !> Step of the point, from 0.
    integer :: increment = 0
    !> Name of the point.
    character(len=:), allocatable :: point
    !> Logarithmic strain and stress (MPa) in global axes, Kelvin.
    real(wp) :: strain(6) = 0.0_wp, stress(6) = 0.0_wp
    !> Equivalent plastic strain; flow stress, MPa.
    real(wp) :: plastic = 0.0_wp, flow_stress = 0.0_wp
  end type point_row_t

  !> The history.
  type :: point_record_t
    !> The table.
    type(table_t), private :: table
  contains
    procedure :: open => point_open
    procedure :: write => point_write
    procedure :: close => point_close
  end type point_record_t

contains

  !> Makes the file with its two lines of heading.
  subroutine point_open(self, directory, error)
    !> The record.
    class(point_record_t), intent(inout) :: self
    !> The directory.
    character(len=*), intent(in) :: directory
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%open(directory//"/history.csv", error)
    if (allocated(error)) return
    call self%table%file%put("# units: -,-,-,-,-,-,-,-,MPa,MPa,MPa,MPa,MPa,MPa,-,MPa"// &
        new_line("a")//"increment,point,e11,e22,e33,e12,e23,e13,s11,s22,s33,s12,s23,s13,"// &
        "eqps,flow_stress"//new_line("a"), error)
    if (.not. allocated(error)) call self%table%file%flush(error)
  end subroutine point_open

  !> Adds a row.
  subroutine point_write(self, row, error)
    !> The record.
    class(point_record_t), intent(inout) :: self
    !> The row.
    type(point_row_t), intent(in) :: row
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%add_integer(row%increment)
    call self%table%add_text(row%point)
    call self%table%add_reals(row%strain(place)/kelvin_factor)
    call self%table%add_reals(row%stress(place)/kelvin_factor)
    call self%table%add_real(row%plastic)
    call self%table%add_real(row%flow_stress)
    call self%table%end_row(error)
  end subroutine point_write

  !> Brings everything to the disk and closes the file.
  subroutine point_close(self, error)
    !> The record.
    class(point_record_t), intent(inout) :: self
    !> Says why the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%close(error)
  end subroutine point_close

end module dd3_point_history
