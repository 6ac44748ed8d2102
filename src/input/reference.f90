!> Check that the sets, tools and materials named in the input exist.
module dd3_input_reference
  use dd3_base_error, only : as_written, error_list_t
  use dd3_base_name_index, only : name_index_t
  use dd3_base_text, only : join, lower_case, suggestion, same_name, upper_case
  use dd3_base_parameter, only : parameter_t, kind_name, kind_other
  use dd3_input_block, only : block_t, token_t, deck_t
  use dd3_input_case, only : blank_sets
  use dd3_input_describe, only : word_length
  use dd3_input_form_check, only : form_for
  use dd3_input_table, only : block_row_t, find_block, find_key
  implicit none
  private
  public :: check_references

  !> Longest name that is compared.
  integer, parameter :: name_length = 80
  !> Number of known names shown in an error.
  integer, parameter :: most_listed = 20
  !> Entry of the index if there is a *MESH; no block has such a name.
  character(len=*), parameter :: any_mesh = "mesh, any"

contains

  !> Check all names of sets, tools and materials.
  subroutine check_references(deck, table, errors)
    type(deck_t), intent(inout) :: deck
    type(block_row_t), intent(in) :: table(:)
    type(error_list_t), intent(inout) :: errors

    type(name_index_t) :: known
    integer :: i, j, k, row, before

    known = index_of(deck)
    do i = 1, deck%n_block
      row = find_block(table, deck%block(i)%keyword)
      if (row == 0) cycle
      if (table(row)%later) cycle
      before = errors%count
      call check_reserved_name(deck%block(i), errors)
      do j = 1, deck%block(i)%n_entry
        if (.not. deck%block(i)%entry(j)%valid) cycle
        k = find_key(table(row)%key, deck%block(i)%entry(j)%key)
        if (k > 0) call check_entry(deck, i, j, table(row)%key(k), known, errors)
      end do
      if (errors%count > before) deck%block(i)%valid = .false.
    end do
  end subroutine check_references

  !> Return the index of all blocks with a name: kind and name, with the position of the first one.
  function index_of(deck) result(known)
    type(deck_t), intent(in) :: deck
    type(name_index_t) :: known

    integer :: i

    do i = 1, deck%n_block
      call known%add(deck%block(i)%keyword//" "//deck%block(i)%name, i)
      if (deck%block(i)%keyword == "mesh") call known%add(any_mesh, i)
    end do
  end function index_of

  !> Report sets and tools with a reserved name.
  subroutine check_reserved_name(block, errors)
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    if (block%keyword == "set" .and. any(blank_sets == block%name)) then
      call errors%push_input(block%named, "'"//block%called()//"' is a set of the blank", &
          "another name")
    end if
    if (block%keyword == "tool" .and. block%name == "load") then
      call errors%push_input(block%named, "'load' is reserved for control = load", "another name")
    end if
  end subroutine check_reserved_name

  !> Check the names in entry j of block i.
  subroutine check_entry(deck, i, j, row, known, errors)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i, j
    type(parameter_t), intent(in) :: row
    !> Index of the blocks.
    type(name_index_t), intent(in) :: known
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
    !> "set", "tool" or "material".
    character(len=*), intent(in) :: what
    !> Index of the blocks.
    type(name_index_t), intent(in) :: known
    type(error_list_t), intent(inout) :: errors
    !> A word that is allowed in place of a name.
    character(len=*), intent(in), optional :: also

    character(len=name_length), allocatable :: names(:)
    character(len=:), allocatable :: expected
    integer :: k, last

    last = deck%n_block
    if (what == "set" .and. deck%block(i)%keyword == "set") last = i - 1
    k = known%find(what//" "//trim(token%text))
    if (k > 0 .and. k <= last) return
    if (what == "set" .and. any(blank_sets == lower_case(token%text))) return
    ! The groups of a mesh file are not known here.
    if (what == "set" .and. known%find(any_mesh) > 0) return
    names = names_of(deck, what, last)
    if (present(also)) then
      if (same_name(also, token%text)) return
      names = [character(len=name_length) :: names, also]
    end if
    expected = "a *"//upper_case(what)//" with this name; none is defined"
    if (size(names) > 0) expected = "one of: "//listed(names)
    if (last < deck%n_block) expected = expected//"; only sets defined above can be used"
    call errors%push_input(token%at, "there is no "//what//" '"// &
        as_written(token%text, token%at)//"'"//suggestion(token%text, names), expected)
  end subroutine check_reference

  !> Return the first names of a list, as text.
  pure function listed(name) result(text)
    character(len=*), intent(in) :: name(:)
    character(len=:), allocatable :: text

    text = join(name(:min(most_listed, size(name))), " ")
    if (size(name) > most_listed) text = text//" ..."
  end function listed

  !> Return the names of all sets, tools or materials among the blocks up to `last`.
  pure function names_of(deck, what, last) result(name)
    type(deck_t), intent(in) :: deck
    !> "set", "tool" or "material".
    character(len=*), intent(in) :: what
    integer, intent(in) :: last
    character(len=name_length), allocatable :: name(:)

    integer :: i, k

    k = 0
    if (what == "set") k = size(blank_sets)
    allocate (name(k + count([(deck%block(i)%keyword == what, i=1, last)])))
    name(:k) = blank_sets(:k)
    do i = 1, last
      if (deck%block(i)%keyword /= what) cycle
      k = k + 1
      name(k) = deck%block(i)%called()
    end do
  end function names_of

end module dd3_input_reference
