! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of the blocks of an input against the keyword table; fills in the defaults.
module dd3_input_check
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : as_written, error_list_t, location_t
  use dd3_base_name_index, only : name_index_t
  use dd3_base_text, only : upper_case, same_name, nearest_name, suggestion, join, to_text
  use dd3_base_parameter, only : parameter_t
  use dd3_input_block, only : block_t, entry_t, deck_t
  use dd3_input_describe, only : not_available
  use dd3_input_table, only : block_row_t, find_block, find_key
  use dd3_input_token, only : line_t, token_list_t, split_line
  use dd3_input_value, only : check_value
  implicit none
  private
  public :: check_deck, check_blocks

  !> Longest name of a block.
  integer, parameter :: longest_name = 60
  !> Blocks that define the sheet.
  character(len=5), parameter :: sheet_blocks(3) = [character(len=5) :: "blank", "mesh", "start"]

contains

  !> Check all blocks, and add the blocks and keys that were left out and have defaults.
  subroutine check_deck(deck, table, file, errors)
    type(deck_t), intent(inout) :: deck
    type(block_row_t), intent(in) :: table(:)
    character(len=*), intent(in) :: file
    type(error_list_t), intent(inout) :: errors

    call check_blocks(deck, table, errors)
    call check_presence(deck, table, file, errors)
    call add_blocks(deck, table, errors)
  end subroutine check_deck

  !> Check each block by itself, and add the keys that were left out and have defaults.
  subroutine check_blocks(deck, table, errors)
    type(deck_t), intent(inout) :: deck
    type(block_row_t), intent(in) :: table(:)
    type(error_list_t), intent(inout) :: errors

    type(name_index_t) :: given
    integer :: i, k, before

    do i = 1, deck%n_block
      before = errors%count
      k = find_block(table, deck%block(i)%keyword)
      if (k == 0) then
        call unknown_block(deck%block(i), table, errors)
      else if (table(k)%later) then
        call errors%push_input(deck%block(i)%opened, "*"//upper_case(trim(table(k)%keyword))// &
            " "//not_available, code="E116")
      else
        call check_name(deck%block(i), table(k), given, errors)
        call check_keys(deck%block(i), table(k)%key, errors)
      end if
      ! An entry without a value was reported when it was read.
      deck%block(i)%valid = errors%count == before .and. entries_valid(deck%block(i))
    end do
  end subroutine check_blocks

  !> Whether all entries of a block passed the check.
  pure logical function entries_valid(block)
    type(block_t), intent(in) :: block

    integer :: i

    entries_valid = .true.
    do i = 1, block%n_entry
      entries_valid = entries_valid .and. block%entry(i)%valid
    end do
  end function entries_valid

  !> Report a block that is not in the table.
  subroutine unknown_block(block, table, errors)
    type(block_t), intent(in) :: block
    type(block_row_t), intent(in) :: table(:)
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: nearest

    nearest = nearest_name(block%keyword, table%keyword)
    if (nearest /= "") nearest = "; did you mean *"//upper_case(nearest)//"?"
    call errors%push_input(block%opened, "unknown block *"//upper_case(block%keyword)//nearest, &
        "one of: *"//upper_case(join(table%keyword, " *")), code="E111")
  end subroutine unknown_block

  !> Check the name of a block, and that the block is not given twice.
  subroutine check_name(block, row, given, errors)
    type(block_t), intent(in) :: block
    type(block_row_t), intent(in) :: row
    !> Blocks above: kind and name, or the kind alone of those that may be given only once.
    type(name_index_t), intent(inout) :: given
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: title, full_name

    title = "*"//upper_case(block%keyword)
    if (row%named .and. block%name == "") then
      call errors%push_input(block%opened, title//" requires a name", title//" name", code="E121")
    else if (.not. row%named .and. block%name /= "") then
      call errors%push_input(block%named, title//" takes no name", title//" alone on its line", &
          code="E123")
    else if (row%named .and. .not. is_name(block%name)) then
      call errors%push_input(block%named, "'"//block%called()//"' is not a valid name", &
          "a letter, then letters, digits, _ - or ., at most "//to_text(longest_name)// &
          " characters", code="E123")
    end if
    if (row%repeatable .and. block%name == "") return
    full_name = block%keyword
    if (row%repeatable) full_name = full_name//" "//block%name
    if (given%find(full_name) > 0) call errors%push_input(block%named, &
        trim(title//" "//block%called())//trim(merge(" is given twice        ", &
            " may be given only once", row%repeatable)), code="E122")
    call given%add(full_name, 1)
  end subroutine check_name

  !> Whether a text is a valid name.
  pure logical function is_name(text)
    character(len=*), intent(in) :: text

    character(len=*), parameter :: letters = "abcdefghijklmnopqrstuvwxyz"

    is_name = text /= "" .and. len(text) <= longest_name &
        .and. verify(text, letters//"0123456789_-.") == 0
    if (is_name) is_name = index(letters, text(1:1)) > 0
  end function is_name

  !> Check the keys of a block.
  subroutine check_keys(block, key, errors)
    type(block_t), intent(inout) :: block
    type(parameter_t), intent(in) :: key(:)
    type(error_list_t), intent(inout) :: errors

    integer :: i, k
    logical :: given(size(key))

    if (block%keyword == "title") return
    given = .false.
    do i = 1, block%n_entry
      k = find_key(key, block%entry(i)%key)
      if (k == 0) then
        call unknown_key(block, block%entry(i), key, errors)
        block%entry(i)%valid = .false.
        allocate (block%entry(i)%number(0))
        cycle
      end if
      if (.not. key(k)%repeatable .and. given(k)) then
        call errors%push_input(block%entry(i)%at, "'"// &
            as_written(block%entry(i)%key, block%entry(i)%at)//"' is given twice in "// &
            title_of(block), code="E122")
      end if
      given(k) = .true.
      call check_value(block%entry(i), key(k), errors)
    end do
    call add_defaults(block, key, errors)
  end subroutine check_keys

  !> Return the first line of a block as written.
  pure function title_of(block) result(title)
    type(block_t), intent(in) :: block
    character(len=:), allocatable :: title

    title = trim("*"//upper_case(block%keyword)//" "//block%called())
  end function title_of

  !> Report a key that is not in the table.
  subroutine unknown_key(block, entry, key, errors)
    type(block_t), intent(in) :: block
    type(entry_t), intent(in) :: entry
    type(parameter_t), intent(in) :: key(:)
    type(error_list_t), intent(inout) :: errors

    call errors%push_input(entry%at, "unknown key '"//as_written(entry%key, entry%at)//"' in "// &
        title_of(block)//suggestion(entry%key, key%name), "one of: "//join(key%name, " "), &
        code="E112")
  end subroutine unknown_key

  !> Add the defaults of the keys that were left out; report keys without a default.
  subroutine add_defaults(block, key, errors)
    type(block_t), intent(inout) :: block
    type(parameter_t), intent(in) :: key(:)
    type(error_list_t), intent(inout) :: errors

    type(entry_t) :: entry
    type(token_list_t) :: word
    type(line_t) :: line
    character(len=len(key%default)) :: value
    logical :: continues
    integer :: k

    do k = 1, size(key)
      if (block%find(key(k)%name) > 0) cycle
      value = key(k)%default
      if (block%find(key(k)%implied_by) > 0) then
        if (block%word(key(k)%implied_by) /= "off") value = key(k)%implied
      end if
      if (value == "-") cycle
      if (value == "") then
        call errors%push_input(block%opened, "'"//trim(key(k)%name)//"' is missing in "// &
            title_of(block), trim(key(k)%name)//" = "//trim(key(k)%help), code="E121")
        cycle
      end if
      word = token_list_t()
      line%file = "default"
      line%text = trim(value)
      call split_line(line, word, continues, errors)
      entry = entry_t(defaulted=.true.)
      entry%key = trim(key(k)%name)
      entry%value = word%item(:word%count)
      call check_value(entry, key(k), errors)
      call block%add_entry(entry)
    end do
  end subroutine add_defaults

  !> Report required blocks that are missing.
  subroutine check_presence(deck, table, file, errors)
    type(deck_t), intent(in) :: deck
    type(block_row_t), intent(in) :: table(:)
    character(len=*), intent(in) :: file
    type(error_list_t), intent(inout) :: errors

    type(location_t) :: whole_file
    character(len=:), allocatable :: first
    integer :: i

    whole_file%file = file
    do i = 1, size(table)
      if (.not. table(i)%required .or. has_block(deck, trim(table(i)%keyword))) cycle
      if (table(i)%keyword == "phase" .and. has_block(deck, "point")) cycle
      call errors%push_input(whole_file, "the block *"//upper_case(trim(table(i)%keyword))// &
          " is missing", "*"//upper_case(trim(table(i)%keyword))//" name: "//trim(table(i)%help), &
          code="E121")
    end do
    if (.not. (has_block(deck, "point") .or. &
        any([(has_block(deck, trim(sheet_blocks(i))), i=1, size(sheet_blocks))]))) then
      call errors%push_input(whole_file, "the block *BLANK is missing", &
          "*BLANK name for a sheet, *MESH name for one from a mesh file, *START for that of "// &
          "another run, or *POINT name for a single material point", code="E121")
    end if
    first = ""
    do i = 1, deck%n_block
      associate (keyword => deck%block(i)%keyword)
        if (all(sheet_blocks /= keyword)) cycle
        if (first == "") first = keyword
        if (first /= keyword) call errors%push_input(deck%block(i)%opened, "there is a *"// &
            upper_case(first)//" as well", "one sheet, by *BLANK, by *MESH or by *START", &
            code="E122")
      end associate
    end do
  end subroutine check_presence

  pure logical function has_block(deck, keyword)
    type(deck_t), intent(in) :: deck
    character(len=*), intent(in) :: keyword

    integer :: i

    has_block = .false.
    do i = 1, deck%n_block
      if (same_name(deck%block(i)%keyword, keyword)) has_block = .true.
    end do
  end function has_block

  !> Add the blocks that were left out if all their keys have defaults.
  subroutine add_blocks(deck, table, errors)
    type(deck_t), intent(inout) :: deck
    type(block_row_t), intent(in) :: table(:)
    type(error_list_t), intent(inout) :: errors

    type(block_t) :: block
    integer :: i

    do i = 1, size(table)
      if (table(i)%named .or. table(i)%repeatable .or. size(table(i)%key) == 0) cycle
      if (any(table(i)%key%default == "") .or. has_block(deck, trim(table(i)%keyword))) cycle
      block = block_t()
      block%keyword = trim(table(i)%keyword)
      block%name = ""
      block%folder = ""
      call add_defaults(block, table(i)%key, errors)
      call deck%add_block(block)
    end do
  end subroutine add_blocks

end module dd3_input_check
