! SPDX-License-Identifier: GPL-3.0-or-later
!> The sheet at the start of a job: that of the blank, of the mesh file or of another run, and its
!> cuts.
module dd3_setup_sheet
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : same_name
  use dd3_input_case, only : case_t, material_spec_t
  use dd3_input_fill_material, only : frame_of
  use dd3_mesh_build, only : new_mesh
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_model, only : model_t
  use dd3_element_table, only : element_t
  use dd3_setup_axes, only : direction_text
  use dd3_setup_element, only : set_element_of_mesh
  use dd3_sheet_grid, only : grid_t, new_grid
  use dd3_sheet_marks, only : find_levels
  use dd3_sheet_sheet, only : new_flat_sheet, sheet_t
  use dd3_sheet_trim, only : trim_sheet
  implicit none
  private
  public :: new_sheet

  !> Difference of the cosine of the angle between directions from 1 up to which they are one; the
  !> laws do not know a direction from its opposite.
  real(wp), parameter :: same_axis = 1.0e-9_wp

contains

  !> Make the sheet, that of the blank, of the mesh file or of another run, and cut it.
  subroutine new_sheet(sheet, model, case, errors)
    !> The sheet of another run on entry, if the case starts from one.
    type(sheet_t), intent(inout) :: sheet
    !> With its materials and, but for the default of a mesh from a file, its element.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(mesh_t) :: mesh
    integer :: i

    if (size(case%start) > 0) then
      call match_materials(sheet, model, case, errors)
    else
      call new_mesh(mesh, case, model%element%node, errors)
      if (errors%count == 0) call set_element_of_mesh(model, case, mesh, errors)
      if (errors%count == 0) call new_flat_sheet(sheet, mesh)
    end if
    if (errors%count == 0) call set_levels(sheet%mesh)
    do i = 1, size(case%trim)
      if (errors%count == 0) call trim_sheet(sheet, case%trim(i), model%element, errors)
    end do
    if (errors%count == 0) call check_refinement(sheet%mesh, case, model%element, errors)
  end subroutine new_sheet

  !> Check that elements can be divided, and that nothing asks for an equation at a bound node.
  subroutine check_refinement(mesh, case, element, errors)
    type(mesh_t), intent(in) :: mesh
    type(case_t), intent(in) :: case
    type(element_t), intent(in) :: element
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(grid_t) :: grid
    logical :: regular, mixed
    integer :: i

    mixed = any([(case%phase(i)%contact%mixed, i=1, size(case%phase))])
    if (case%adaptive%levels > 0) then
      if (element%n_node /= 8) then
        call errors%push_input(case%adaptive%at, "elements "//trim(element%name)//" cannot be "// &
            "divided", "elements with eight nodes, hex8 or solid_shell, or adaptive = 0", &
            code="E148")
        return
      end if
      call new_grid(grid, mesh, regular)
      if (.not. regular) call errors%push_input(case%adaptive%at, "elements of a sheet whose "// &
          "columns have different numbers of layers cannot be divided", &
          "the same number of layers everywhere, or adaptive = 0", code="E148")
      if (mixed) call errors%push_input(case%adaptive%at, "elements cannot be divided in the "// &
          "mixed formulation of the contact: it has an equation at each node", &
          "formulation = compliant, or adaptive = 0", code="E148")
    else if (allocated(mesh%bound) .and. mixed) then
      i = findloc([(case%phase(i)%contact%mixed, i=1, size(case%phase))], .true., dim=1)
      call errors%push_input(case%phase(i)%source%opened, "the sheet has nodes in the middle "// &
          "of edges of larger elements, and the mixed formulation of the contact has an "// &
          "equation at each node", "formulation = compliant", code="E148")
    end if
    if (case%adaptive%levels > 0 .and. allocated(mesh%bound) .and. .not. allocated(mesh%level)) then
      call errors%push_input(case%adaptive%at, "the sizes of the elements beside nodes in the "// &
          "middle of edges contradict each other: they do not come from halving", &
          "adaptive = 0", code="E148")
    end if
  end subroutine check_refinement

  !> Find the levels of a mesh with bound nodes that a file gives without levels.
  pure subroutine set_levels(mesh)
    type(mesh_t), intent(inout) :: mesh

    type(grid_t) :: grid
    logical :: regular

    if (allocated(mesh%level) .or. .not. allocated(mesh%bound)) return
    call new_grid(grid, mesh, regular)
    if (regular) call find_levels(mesh, grid)
  end subroutine set_levels

  !> Find the materials of the sheet of another run among those of the case, by their names; they
  !> must have the same laws.
  subroutine match_materials(sheet, model, case, errors)
    !> Its elements get the positions in `case%material`.
    type(sheet_t), intent(inout) :: sheet
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: position(size(sheet%material)), i, m

    ! A sheet of another program has no check sums.
    position = 0
    do i = 1, size(position)
      if (.not. any(sheet%mesh%material == i)) cycle
      associate (name => sheet%material(i)%s)
        do m = size(model%material), 1, -1
          if (same_name(trim(model%material_name(m)), name)) exit
        end do
        position(i) = m
        if (m == 0) then
          call errors%push_input(case%start(1)%source%at("from"), "the sheet is of material '"// &
              name//"', which this input does not define", "*MATERIAL "//name// &
              " as in the input of that run", code="E152")
        else if (all(sheet%digest(i) /= [0, model%material_digest(m)])) then
          call errors%push_input(case%material(m)%source%opened, "material '"//name// &
              "' differs from that of the sheet, of '"//case%start(1)%from//"'", &
              "*MATERIAL "//name//" as in the input of that run", code="E152")
        end if
      end associate
    end do
    if (errors%count > 0) return
    sheet%mesh%material = position(sheet%mesh%material)
    if (.not. allocated(sheet%axes)) return
    do i = 1, size(position)
      if (position(i) > 0) call match_axes(sheet%axes(:, :, i), case%material(position(i)), &
          model%axes(:, :, position(i)), errors)
    end do
  end subroutine match_materials

  !> Take over the axes of a material of the sheet; directions that the input gives must be these.
  subroutine match_axes(of_sheet, material, axes, errors)
    real(wp), intent(in) :: of_sheet(3, 3)
    type(material_spec_t), intent(in) :: material
    real(wp), intent(inout) :: axes(3, 3)
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: frame(3, 3), normal(3)

    if (.not. any(abs(of_sheet) > 0.0_wp)) return
    associate (source => material%source)
      if (source%given("rolling_direction")) then
        frame = frame_of(source%numbers("rolling_direction"), of_sheet(:, 3))
        call compare("rolling_direction", frame(:, 1), of_sheet(:, 1))
      end if
      if (source%given("normal_direction")) then
        normal = source%numbers("normal_direction")
        call compare("normal_direction", normal/norm2(normal), of_sheet(:, 3))
      end if
    end associate
    axes = of_sheet

  contains

    subroutine compare(key, direction, known)
      character(len=*), intent(in) :: key
      real(wp), intent(in) :: direction(3), known(3)

      if (1.0_wp - abs(dot_product(direction, known)) <= same_axis) return
      call errors%push_input(material%source%at(key), key//" of material '"//material%name// &
          "' is another one than that of the sheet, which keeps its own: "//direction_text(known), &
          "the direction in the initial sheet of the first run, or no "//key, code="E152")
    end subroutine compare

  end subroutine match_axes

end module dd3_setup_sheet
