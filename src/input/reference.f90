! SPDX-License-Identifier: GPL-3.0-or-later
!> Check that the sets, tools and materials named in the input exist.
module dd3_input_reference
  use dd3_base_error, only : as_written, error_list_t
  use dd3_base_name_index, only : name_index_t
  use dd3_base_text, only : join, suggestion, same_name, text_t, upper_case
  use dd3_base_parameter, only : parameter_t, kind_name, kind_other
  use dd3_input_block, only : block_t, token_t, deck_t
  use dd3_input_describe, only : word_length
  use dd3_input_form_check, only : form_for
  use dd3_input_sheet_sets, only : sheet_sets
  use dd3_input_table, only : block_row_t, find_block, find_key
  implicit none
  private
  public :: check_references

  !> Longest name that is compared.
  integer, parameter :: name_length = 80
  !> Number of known names shown in an error.
  integer, parameter :: most_listed = 20
  !> Entry of the index if there is a mesh whose sets are not known; no block has such a name.
  character(len=*), parameter :: any_mesh = "mesh, any"
  !> Number in the index of a set that the sheet has.
  integer, parameter :: of_sheet = -1

  !> Names that can be referred to.
  type :: known_t
    !> Kind and name of all blocks and of the sheet's sets, with the position of the block.
    type(name_index_t) :: index
    !> Sets of the sheet.
    character(len=name_length), allocatable :: sheet_set(:)
    !> Number of these that the program makes for each sheet of its kind.
    integer :: n_own = 0
    !> Whether the sheet has sets that are known only when its mesh is made.
    logical :: of_mesh = .false.
  end type known_t

contains

  !> Check all names of sets, tools and materials. Names of sets are left out if there is a mesh
  !> file; when it has been read, only they are checked.
  subroutine check_references(deck, table, errors, mesh_sets)
    type(deck_t), intent(inout) :: deck
    type(block_row_t), intent(in) :: table(:)
    type(error_list_t), intent(inout) :: errors
    !> Sets of the mesh file.
    type(text_t), intent(in), optional :: mesh_sets(:)

    type(known_t) :: known
    integer :: i, j, k, row, before

    call new_known(known, deck, mesh_sets)
    do i = 1, deck%n_block
      row = find_block(table, deck%block(i)%keyword)
      if (row == 0) cycle
      if (table(row)%later) cycle
      before = errors%count
      call check_reserved_name(deck%block(i), known, errors)
      do j = 1, deck%block(i)%n_entry
        if (.not. deck%block(i)%entry(j)%valid) cycle
        k = find_key(table(row)%key, deck%block(i)%entry(j)%key)
        if (k == 0) cycle
        if (present(mesh_sets) .and. index(table(row)%key(k)%form, "set") == 0) cycle
        call check_entry(deck, i, j, table(row)%key(k), known, errors)
      end do
      if (errors%count > before) deck%block(i)%valid = .false.
    end do
  end subroutine check_references

  !> List the sheet's sets, those of its cuts among them, and all blocks with a name; of equal names
  !> the first one counts.
  subroutine new_known(known, deck, mesh_sets)
    type(known_t), intent(out) :: known
    type(deck_t), intent(in) :: deck
    type(text_t), intent(in), optional :: mesh_sets(:)

    integer :: i

    known%sheet_set = sheet_sets(deck)
    known%n_own = size(known%sheet_set)
    if (present(mesh_sets)) then
      do i = 1, size(mesh_sets)
        if (any(known%sheet_set == mesh_sets(i)%s)) cycle
        known%sheet_set = [character(len=name_length) :: known%sheet_set, mesh_sets(i)%s]
      end do
    end if
    do i = 1, deck%n_block
      if (deck%block(i)%keyword /= "trim" .or. any(known%sheet_set == deck%block(i)%name)) cycle
      known%sheet_set = [character(len=name_length) :: known%sheet_set, deck%block(i)%name]
    end do
    do i = 1, size(known%sheet_set)
      call known%index%add("set "//trim(known%sheet_set(i)), of_sheet)
    end do
    do i = 1, deck%n_block
      call known%index%add(deck%block(i)%keyword//" "//deck%block(i)%name, i)
      if (deck%block(i)%keyword /= "mesh" .and. deck%block(i)%keyword /= "start") cycle
      known%of_mesh = .true.
      if (.not. present(mesh_sets)) call known%index%add(any_mesh, i)
    end do
  end subroutine new_known

  !> Report sets, cuts and tools with a reserved name.
  subroutine check_reserved_name(block, known, errors)
    type(block_t), intent(in) :: block
    type(known_t), intent(in) :: known
    type(error_list_t), intent(inout) :: errors

    if ((block%keyword == "set" .and. known%index%find("set "//block%name) == of_sheet) .or. &
        (block%keyword == "trim" .and. any(known%sheet_set(:known%n_own) == block%name))) then
      call errors%push_input(block%named, "'"//block%called()//"' is a set of the "// &
          trim(merge("mesh ", "blank", known%of_mesh)), &
          "another name", code="E123")
    end if
    if (block%keyword == "tool" .and. block%name == "load") then
      call errors%push_input(block%named, "'load' is reserved for control = load", "another name", &
          code="E123")
    end if
  end subroutine check_reserved_name

  !> Check the names in entry j of block i.
  subroutine check_entry(deck, i, j, row, known, errors)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i, j
    type(parameter_t), intent(in) :: row
    type(known_t), intent(in) :: known
    type(error_list_t), intent(inout) :: errors

    character(len=word_length), allocatable :: form(:)
    integer :: k, before

    before = errors%count
    associate (entry => deck%block(i)%entry(j))
      if (row%kind == kind_name .and. row%form /= "") then
        call check_reference(deck, i, entry%value(1), trim(row%form), known, errors)
      else if (row%name == "control" .and. deck%block(i)%keyword == "phase") then
        call check_reference(deck, i, entry%value(1), "tool", known, errors, &
            also="load")
      else if (row%kind == kind_other) then
        form = form_for(entry, row)
        do k = 1, min(size(form), size(entry%value))
          select case (form(k))
          case ("set", "tool", "material")
            call check_reference(deck, i, entry%value(k), trim(form(k)), known, errors)
          case default
            ! Not a name of a block.
          end select
        end do
      end if
      entry%valid = errors%count == before
    end associate
  end subroutine check_entry

  !> Check a name used in block i.
  subroutine check_reference(deck, i, token, what, known, errors, also)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: i
    type(token_t), intent(in) :: token
    !> "set", "tool", "material" or "phase".
    character(len=*), intent(in) :: what
    type(known_t), intent(in) :: known
    type(error_list_t), intent(inout) :: errors
    !> A word that is allowed in place of a name.
    character(len=*), intent(in), optional :: also

    character(len=name_length), allocatable :: names(:)
    character(len=:), allocatable :: expected
    integer :: k, last

    last = deck%n_block
    if (what == "set" .and. deck%block(i)%keyword == "set") last = i - 1
    k = known%index%find(what//" "//trim(token%text))
    if (k /= 0 .and. k <= last) return
    ! The sets of a mesh file are not known here.
    if (what == "set" .and. known%index%find(any_mesh) > 0) return
    names = names_of(deck, what, last, known)
    if (present(also)) then
      if (same_name(also, token%text)) return
      names = [character(len=name_length) :: names, also]
    end if
    expected = "a *"//upper_case(what)//" with this name; none is defined"
    if (size(names) > 0) expected = "one of: "//listed(names)
    if (last < deck%n_block) expected = expected//"; only sets defined above can be used"
    call errors%push_input(token%at, "there is no "//what//" '"// &
        as_written(token%text, token%at)//"'"//suggestion(token%text, names), expected, code="E113")
  end subroutine check_reference

  !> Return the first names of a list, as text.
  pure function listed(name) result(text)
    character(len=*), intent(in) :: name(:)
    character(len=:), allocatable :: text

    text = join(name(:min(most_listed, size(name))), " ")
    if (size(name) > most_listed) text = text//" ..."
  end function listed

  !> Return the names of all sets, tools or materials among the blocks up to `last`.
  pure function names_of(deck, what, last, known) result(name)
    type(deck_t), intent(in) :: deck
    !> "set", "tool", "material" or "phase".
    character(len=*), intent(in) :: what
    integer, intent(in) :: last
    type(known_t), intent(in) :: known
    character(len=name_length), allocatable :: name(:)

    integer :: i, k

    k = 0
    if (what == "set") k = size(known%sheet_set)
    allocate (name(k + count([(deck%block(i)%keyword == what, i=1, last)])))
    name(:k) = known%sheet_set(:k)
    do i = 1, last
      if (deck%block(i)%keyword /= what) cycle
      k = k + 1
      name(k) = deck%block(i)%called()
    end do
  end function names_of

end module dd3_input_reference
