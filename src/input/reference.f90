!> Check that the sets, tools and materials named in the input exist.
module dd3_input_reference
  use dd3_base_error, only : as_written, error_list_t
  use dd3_base_text, only : join, suggestion, same_name, upper_case
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

contains

  !> Check all names of sets, tools and materials.
  subroutine check_references(deck, table, errors)
    type(deck_t), intent(inout) :: deck
    type(block_row_t), intent(in) :: table(:)
    type(error_list_t), intent(inout) :: errors

    integer :: i, j, k, row, before

    do i = 1, deck%n_block
      row = find_block(table, deck%block(i)%keyword)
      if (row == 0) cycle
      if (table(row)%later) cycle
      before = errors%count
      call check_reserved_name(deck%block(i), errors)
      do j = 1, deck%block(i)%n_entry
        if (.not. deck%block(i)%entry(j)%valid) cycle
        k = find_key(table(row)%key, deck%block(i)%entry(j)%key)
        if (k > 0) call check_entry(deck, i, j, table(row)%key(k), errors)
      end do
      if (errors%count > before) deck%block(i)%valid = .false.
    end do
  end subroutine check_references

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
  subroutine check_entry(deck, i, j, row, errors)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i, j
    type(parameter_t), intent(in) :: row
    type(error_list_t), intent(inout) :: errors

    character(len=word_length), allocatable :: form(:)
    integer :: k, before

    before = errors%count
    associate (entry => deck%block(i)%entry(j))
      if (row%kind == kind_name .and. row%form /= "") then
        call check_reference(deck, i, entry%value(1), trim(row%form), errors)
      else if (row%name == "control" .and. deck%block(i)%keyword == "phase") then
        call check_reference(deck, i, entry%value(1), "tool", errors, also="load")
      else if (row%kind == kind_other) then
        form = form_for(entry, row)
        do k = 1, min(size(form), size(entry%value))
          select case (form(k))
          case ("set", "tool", "material")
            call check_reference(deck, i, entry%value(k), trim(form(k)), errors)
          end select
        end do
      end if
      entry%valid = errors%count == before
    end associate
  end subroutine check_entry

  !> Check a name used in block i.
  subroutine check_reference(deck, i, token, what, errors, also)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: i
    type(token_t), intent(in) :: token
    !> "set", "tool" or "material".
    character(len=*), intent(in) :: what
    type(error_list_t), intent(inout) :: errors
    !> A word that is allowed in place of a name.
    character(len=*), intent(in), optional :: also

    character(len=name_length), allocatable :: known(:)
    character(len=:), allocatable :: expected
    integer :: k, last

    last = deck%n_block
    if (what == "set" .and. deck%block(i)%keyword == "set") last = i - 1
    known = names_of(deck, what, last)
    if (present(also)) known = [character(len=name_length) :: known, also]
    ! The groups of a mesh file are not known here.
    if (what == "set" .and. size(names_of(deck, "mesh", deck%n_block)) > 0) return
    do k = 1, size(known)
      if (same_name(known(k), token%text)) return
    end do
    expected = "a *"//upper_case(what)//" with this name; none is defined"
    if (size(known) > 0) expected = "one of: "//listed(known)
    if (last < deck%n_block) expected = expected//"; only sets defined above can be used"
    call errors%push_input(token%at, "there is no "//what//" '"// &
        as_written(token%text, token%at)//"'"//suggestion(token%text, known), expected)
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
    !> "set", "tool", "material" or "mesh".
    character(len=*), intent(in) :: what
    integer, intent(in) :: last
    character(len=name_length), allocatable :: name(:)

    integer :: i

    allocate (name(0))
    if (what == "set") name = [character(len=name_length) :: blank_sets]
    do i = 1, last
      if (deck%block(i)%keyword == what) name = [character(len=name_length) :: name, &
          deck%block(i)%called()]
    end do
  end function names_of

end module dd3_input_reference
