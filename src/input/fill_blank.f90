!> Fills the blank and the node sets of the case.
module dd3_input_fill_blank
  use dd3_base_kinds, only : wp
  use dd3_input_block, only : block_t
  use dd3_input_case, only : blank_spec_t, node_set_spec_t, set_plane, set_box, set_nodes, set_near
  implicit none
  private
  public :: fill_blank, fill_set

contains

  subroutine fill_blank(blank, block)
    type(blank_spec_t), intent(inout) :: blank
    type(block_t), intent(in) :: block

    blank%name = block%name
    blank%source = block
    if (block%has("origin")) blank%origin = block%numbers("origin")
    if (block%has("size")) blank%size = block%numbers("size")
    if (block%has("divisions")) blank%divisions = nint(block%numbers("divisions"))
    call fill_grading(blank%grading_x, block, "grading_x", blank%divisions(1))
    call fill_grading(blank%grading_y, block, "grading_y", blank%divisions(2))
    call fill_grading(blank%grading_z, block, "grading_z", blank%divisions(3))
    blank%skew = block%number("skew")
    blank%element = block%word("element")
    blank%thickness_points = nint(block%number("thickness_points"))
  end subroutine fill_blank

  !> Set the node abscissae of n elements as given, or uniform.
  subroutine fill_grading(grading, block, key, n)
    !> Abscissae, `(0:n)`.
    real(wp), allocatable, intent(out) :: grading(:)
    type(block_t), intent(in) :: block
    character(len=*), intent(in) :: key
    integer, intent(in) :: n

    integer :: i
    real(wp), allocatable :: given(:)

    allocate (grading(0:n))
    grading = [(real(i, wp)/real(n, wp), i=0, n)]
    given = block%numbers(key)
    if (size(given) == n + 1) grading = given
  end subroutine fill_grading

  subroutine fill_set(set, block)
    type(node_set_spec_t), intent(inout) :: set
    type(block_t), intent(in) :: block

    real(wp), allocatable :: number(:)

    set%name = block%name
    set%source = block
    set%of = block%word("of")
    allocate (set%value(0), set%range(2, 0))
    if (block%has("tolerance")) set%tolerance = block%number("tolerance")
    if (block%has("plane")) then
      set%kind = set_plane
      number = block%numbers("plane")
      set%axis = nint(number(1))
      set%value = number(2:)
    else if (block%has("box")) then
      set%kind = set_box
      set%value = block%numbers("box")
    else if (block%has("near")) then
      set%kind = set_near
      set%value = block%numbers("near")
    else if (block%has("nodes")) then
      set%kind = set_nodes
      number = block%numbers("nodes")
      set%range = reshape(nint(number), [2, size(number)/2])
    end if
  end subroutine fill_set

end module dd3_input_fill_blank
