! SPDX-License-Identifier: GPL-3.0-or-later
!> Fills the blank, the mesh, the sheet of another run, the cuts and the node sets of the case.
module dd3_input_fill_blank
  use dd3_base_kinds, only : wp
  use dd3_input_block, only : block_t
  use dd3_input_case, only : blank_spec_t, mesh_spec_t, node_set_spec_t, start_spec_t, &
      region_spec_t, trim_spec_t, set_plane, set_box, set_nodes, set_near
  use dd3_input_text_file, only : resolve_path
  use dd3_settings_adaptive, only : adaptive_spec_t
  implicit none
  private
  public :: fill_adaptive, fill_blank, fill_region, fill_mesh, fill_start, fill_trim, fill_set

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
    blank%radius = block%number("radius")
    blank%portion = block%word("portion")
    if (block%has("radius")) blank%size = [blank%radius, blank%radius, block%number("thickness")]
  end subroutine fill_blank

  !> Fill a region; the position of its material is left to the caller.
  subroutine fill_region(region, block)
    type(region_spec_t), intent(inout) :: region
    type(block_t), intent(in) :: block

    region%source = block
    region%point = block%numbers("points")
    region%file = ""
    if (block%has("file")) region%file = resolve_path(block%folder, block%word("file"))
    region%side = block%word("side")
    region%thickness = block%number("thickness")
    region%step = "top"
    if (block%has("step")) region%step = block%word("step")
  end subroutine fill_region

  !> Fill the settings of the refinement of a sheet.
  subroutine fill_adaptive(adaptive, block)
    type(adaptive_spec_t), intent(inout) :: adaptive
    type(block_t), intent(in) :: block

    adaptive%levels = nint(block%number("adaptive"))
    adaptive%angle = block%number("adaptive_angle")
    adaptive%size = block%number("adaptive_size")
    adaptive%at = block%at("adaptive")
  end subroutine fill_adaptive

  !> Fill a mesh; the positions of the materials are left to the caller.
  subroutine fill_mesh(mesh, block)
    type(mesh_spec_t), intent(inout) :: mesh
    type(block_t), intent(in) :: block

    integer :: i, n

    mesh%name = block%name
    mesh%source = block
    mesh%file = resolve_path(block%folder, block%word("file"))
    mesh%element = block%word("element")
    mesh%thickness_points = nint(block%number("thickness_points"))
    allocate (mesh%material_of(count([(is_material_of(block, i), i=1, block%n_entry)])))
    n = 0
    do i = 1, block%n_entry
      if (.not. is_material_of(block, i)) cycle
      n = n + 1
      mesh%material_of(n)%set = block%entry(i)%value(1)%text
      mesh%material_of(n)%name = block%entry(i)%value(2)%text
      mesh%material_of(n)%at = block%entry(i)%value(1)%at
    end do
  end subroutine fill_mesh

  subroutine fill_start(start, block)
    type(start_spec_t), intent(inout) :: start
    type(block_t), intent(in) :: block

    integer :: i, n

    start%source = block
    start%from = resolve_path(block%folder, block%word("from"))
    start%at_end = block%word("at") /= "last"
    if (block%has("move")) start%move = block%numbers("move")
    allocate (start%turn(7, count([(is_turn(block, i), i=1, block%n_entry)])))
    n = 0
    do i = 1, block%n_entry
      if (.not. is_turn(block, i)) cycle
      n = n + 1
      start%turn(:, n) = block%entry(i)%number(:7)
    end do
  end subroutine fill_start

  !> Whether an entry of a block turns the sheet.
  pure logical function is_turn(block, i)
    type(block_t), intent(in) :: block
    integer, intent(in) :: i

    is_turn = block%entry(i)%key == "turn" .and. block%entry(i)%valid
  end function is_turn

  subroutine fill_trim(trim, block)
    type(trim_spec_t), intent(inout) :: trim
    type(block_t), intent(in) :: block

    trim%name = block%name
    trim%source = block
    trim%point = block%numbers("points")
    trim%file = ""
    if (block%has("file")) trim%file = resolve_path(block%folder, block%word("file"))
    if (block%has("along")) trim%along = block%numbers("along")
    trim%keeps_inside = block%word("keep") /= "outside"
  end subroutine fill_trim

  !> Whether an entry of a block assigns a material to a set.
  pure logical function is_material_of(block, i)
    type(block_t), intent(in) :: block
    integer, intent(in) :: i

    is_material_of = block%entry(i)%key == "material_of" .and. block%entry(i)%valid
  end function is_material_of

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
