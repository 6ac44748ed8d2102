!> Checks that the sets, tools and materials an input names exist.
module dd3_input_reference
  use dd3_base_error, only : as_written, error_list_t
  use dd3_base_text, only : suggestion, same_name, upper_case
  use dd3_base_parameter, only : parameter_t, kind_name, kind_other
  use dd3_input_block, only : block_t, token_t, deck_t
  use dd3_input_table, only : block_row_t, find_block, find_key
  use dd3_input_value, only : form_for, word_length
  implicit none
  private
  public :: check_references

  !> Longest name that is compared.
  integer, parameter :: name_length = 80

  !> Node sets that every structured blank has.
  character(len=5), parameter :: blank_sets(7) = [character(len=5) :: &
                                                  "x_min", "x_max", "y_min", "y_max", "z_min", &
                                                  "z_max", "all"]

contains

  !> Checks all names of sets, tools and materials.
  subroutine check_references(deck, table, errors)
    !> The checked blocks.
    type(deck_t), intent(inout) :: deck
    !> The keyword tables.
    type(block_row_t), intent(in) :: table(:)
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    integer :: i, j, k, row, before

    do i = 1, deck%n_block
      row = find_block(table, deck%block(i)%keyword)
      if (row == 0) cycle
      if (table(row)%later) cycle
      before = errors%count
      call check_set_name(deck%block(i), errors)
      do j = 1, deck%block(i)%n_entry
        if (.not. deck%block(i)%entry(j)%valid) cycle
        k = find_key(table(row)%key, deck%block(i)%entry(j)%key)
        if (k > 0) call check_entry(deck, i, j, table(row)%key(k), errors)
      end do
      if (errors%count > before) deck%block(i)%valid = .false.
    end do
  end subroutine check_references

  !> Reports a set that takes the name of one of the blank's.
  subroutine check_set_name(block, errors)
    !> The block.
    type(block_t), intent(in) :: block
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    if (block%keyword == "set" .and. any(blank_sets == block%name)) then
      call errors%push_input(block%named, "the blank has a set '"//block%called()//"' already", &
          "another name")
    end if
    if (block%keyword == "tool" .and. block%name == "load") then
      call errors%push_input(block%named, &
          "a tool cannot be called 'load': control = load has a meaning of its own")
    end if
  end subroutine check_set_name

  !> Checks the names in one entry.
  subroutine check_entry(deck, i, j, row, errors)
    !> The checked blocks.
    type(deck_t), intent(inout) :: deck
    !> Positions of the block and of the entry.
    integer, intent(in) :: i, j
    !> The entry's row.
    type(parameter_t), intent(in) :: row
    !> Receives all errors found.
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

  !> Checks one name.
  subroutine check_reference(deck, i, token, what, errors, also)
    !> The checked blocks.
    type(deck_t), intent(in) :: deck
    !> Position of the block the name is used in.
    integer, intent(in) :: i
    !> The name.
    type(token_t), intent(in) :: token
    !> set, tool or material.
    character(len=*), intent(in) :: what
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors
    !> A word that may stand in place of a name.
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
    expected = "a *"//upper_case(what)//" of this name, but there is none at all"
    if (size(known) > 0) expected = "one of: "//listed(known)
    if (last < deck%n_block) expected = expected//"; a set is made from sets that stand above it"
    call errors%push_input(token%at, "there is no "//what//" '"// &
        as_written(token%text, token%at)//"'"//suggestion(token%text, known), expected)
  end subroutine check_reference

  !> The first names of a list.
  pure function listed(name) result(text)
    !> The names.
    character(len=*), intent(in) :: name(:)
    character(len=:), allocatable :: text

    integer :: i

    text = trim(name(1))
    do i = 2, min(20, size(name))
      text = text//" "//trim(name(i))
    end do
    if (size(name) > 20) text = text//" ..."
  end function listed

  !> Names of all sets, tools or materials among the first blocks.
  pure function names_of(deck, what, last) result(name)
    !> The blocks.
    type(deck_t), intent(in) :: deck
    !> Which kind of block.
    character(len=*), intent(in) :: what
    !> The last block looked at.
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
