! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of a name in the input against the names in a registry.
module dd3_input_known_name
  use dd3_base_error, only : as_written, error_list_t, location_t
  use dd3_base_text, only : same_name, suggestion, join
  implicit none
  private
  public :: check_known_name

contains

  !> Return the position of a name among the known ones; 0, with an error that suggests similar
  !> names, if not found.
  subroutine check_known_name(name, at, what, known, position, errors)
    character(len=*), intent(in) :: name
    !> Where the name is written.
    type(location_t), intent(in) :: at
    !> What the name stands for, such as "hardening law".
    character(len=*), intent(in) :: what
    character(len=*), intent(in) :: known(:)
    integer, intent(out) :: position
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: meant

    do position = 1, size(known)
      if (same_name(known(position), name)) return
    end do
    position = 0
    meant = suggestion(name, known)
    if (meant == "") meant = names_containing(name, known)
    call errors%push_input(at, "there is no "//what//" '"//as_written(name, at)//"'"//meant, &
        "one of: "//join(known, " "), code="E113")
  end subroutine check_known_name

  !> Return the known names that contain a name, as a question; empty if there is none.
  pure function names_containing(name, known) result(text)
    character(len=*), intent(in) :: name
    character(len=*), intent(in) :: known(:)
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    do i = 1, size(known)
      if (len(name) < 3 .or. index(known(i), name) == 0) cycle
      if (text /= "") text = text//" or"
      text = text//" '"//trim(known(i))//"'"
    end do
    if (text /= "") text = "; did you mean"//text//"?"
  end function names_containing

end module dd3_input_known_name
