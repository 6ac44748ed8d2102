!> The limits of the predictor that follow from the accuracy or are given, as text for `--check` and
!> the log.
module dd3_model_limits_report
  use dd3_base_text, only : newline, to_text
  use dd3_input_case, only : limit_spec_t, limits_spec_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: limits_report

contains

  !> Return a line for the first phase and for each later one with other limits.
  pure function limits_report(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    character(len=:), allocatable :: before, here
    integer :: i

    text = ""
    before = ""
    if (.not. allocated(model%phase)) return
    do i = 1, size(model%phase)
      here = values(model%phase(i)%limits)
      if (here == before) cycle
      if (i > 1) text = text//"from phase '"//model%phase(i)%name//"': "
      text = text//here//newline
      before = here
    end do
  end function limits_report

  !> Return the limits of a phase.
  pure function values(limits) result(text)
    type(limits_spec_t), intent(in) :: limits
    character(len=:), allocatable :: text

    text = "limits of an increment: strain "//value(limits%strain, "")//", rotation "// &
        value(limits%rotation, " degrees")//", depth "//value(limits%depth, " thicknesses")// &
        ", r_max "//value(limits%r_max, "")
  end function values

  !> Return a limit with its unit.
  pure function value(limit, unit) result(text)
    type(limit_spec_t), intent(in) :: limit
    !> After a blank, or empty.
    character(len=*), intent(in) :: unit
    character(len=:), allocatable :: text

    text = "off"
    if (limit%active) text = to_text(limit%value, 3)//unit
  end function value

end module dd3_model_limits_report
