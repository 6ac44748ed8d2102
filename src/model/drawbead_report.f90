!> Draw-beads as text, for `--check` and the log: lengths of their lines at the start.
module dd3_model_drawbead_report
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : newline, to_text
  use dd3_model_bead_points, only : bead_point_t, covered_length, find_bead_points
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: drawbead_report, initial_bead_lengths

contains

  !> Return a line for each draw-bead; empty without draw-beads.
  function drawbead_report(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    real(wp), allocatable :: length(:)
    integer :: b

    length = initial_bead_lengths(model)
    text = ""
    do b = 1, size(length)
      associate (bead => model%drawbead(b))
        text = text//"draw-bead '"//bead%name//"': "//to_text(bead%length(), 4)//" mm long, "// &
            to_text(length(b), 4)//" mm of it on the sheet, "//to_text(size(bead%line, 3))// &
            " intervals"//newline
      end associate
    end do
  end function drawbead_report

  !> Return the lengths of the draw-beads on the initial sheet, mm.
  function initial_bead_lengths(model) result(length)
    type(model_t), intent(in) :: model
    real(wp), allocatable :: length(:)

    type(bead_point_t), allocatable :: point(:)
    integer :: b

    allocate (length(0))
    if (.not. allocated(model%drawbead)) return
    call find_bead_points(model, [(.true., b=1, size(model%drawbead))], model%x0, point)
    length = [(covered_length(point, b), b=1, size(model%drawbead))]
  end function initial_bead_lengths

end module dd3_model_drawbead_report
