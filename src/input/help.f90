!> Help on blocks and keys, and the manual's reference, printed from the keyword tables.
module dd3_input_help
  use dd3_base_kinds, only : i8
  use dd3_base_text, only : upper_case, lower_case, newline, same_name
  use dd3_base_parameter, only : parameter_t
  use dd3_input_table, only : block_row_t, block_table
  use dd3_input_value, only : describe, not_available
  implicit none
  private
  public :: help_blocks, help_topic, reference_markdown, describe_key, escaped

  !> Width of the column of names.
  integer, parameter :: block_width = 18

contains

  !> The list of all blocks.
  function help_blocks() result(text)
    character(len=:), allocatable :: text

    type(block_row_t), allocatable :: table(:)
    integer :: i

    table = block_table()
    text = ""
    do i = 1, size(table)
      text = text//"  "//padded(title(table(i)), block_width)//trim(table(i)%help)//newline
    end do
  end function help_blocks

  !> Help on a block, or on a key in all blocks that have it; empty if there is none of this name.
  function help_topic(topic) result(text)
    !> Name of a block, with or without its star, or of a key.
    character(len=*), intent(in) :: topic
    character(len=:), allocatable :: text

    type(block_row_t), allocatable :: table(:)
    character(len=:), allocatable :: name
    integer :: i, k

    table = block_table()
    name = lower_case(trim(topic))
    if (index(name, "*") == 1) name = name(2:)
    text = ""
    do i = 1, size(table)
      if (same_name(table(i)%keyword, name)) text = help_block(table(i))
    end do
    if (text /= "") return
    do i = 1, size(table)
      do k = 1, size(table(i)%key)
        if (.not. same_name(table(i)%key(k)%name, name)) cycle
        text = text//trim(title(table(i)))//newline//help_key(table(i)%key(k))
      end do
    end do
  end function help_topic

  !> Help on one block.
  function help_block(row) result(text)
    !> The block.
    type(block_row_t), intent(in) :: row
    character(len=:), allocatable :: text

    integer :: k

    text = trim(title(row))//newline//"  "//trim(row%help)//newline
    if (row%later) text = text//"  This block "//not_available//"."//newline
    do k = 1, size(row%key)
      text = text//help_key(row%key(k))
    end do
  end function help_block

  !> Help on one key: what is expected, its default, what it means.
  function help_key(key) result(text)
    !> The key.
    type(parameter_t), intent(in) :: key
    character(len=:), allocatable :: text

    text = "  "//describe_key(key)//newline//repeat(" ", 6)//trim(key%help)//newline
    if (key%later == "*") then
      text = text//repeat(" ", 6)//"This key "//not_available//"."//newline
    else if (key%later /= "") then
      text = text//repeat(" ", 6)//"Not available in this version: "//trim(key%later)//newline
    end if
  end function help_key

  !> What a key asks for, and its default: in one line.
  function describe_key(key) result(text)
    !> The key.
    type(parameter_t), intent(in) :: key
    character(len=:), allocatable :: text

    text = describe(key)//" ("//default_text(key)//")"
    if (key%repeatable) text = text//" (may be repeated)"
  end function describe_key

  !> What holds where a key is left out.
  function default_text(key) result(text)
    !> The key.
    type(parameter_t), intent(in) :: key
    character(len=:), allocatable :: text

    select case (key%default)
    case ("")
      text = "must be given"
    case ("-")
      text = "may be left out"
    case default
      text = "default "//trim(key%default)
    end select
  end function default_text

  !> The block as it is written.
  function title(row)
    !> The block.
    type(block_row_t), intent(in) :: row
    character(len=:), allocatable :: title

    title = "*"//upper_case(trim(row%keyword))
    if (row%named) title = title//" name"
    if (row%keyword == "include") title = title//" file"
  end function title

  !> The text with blanks up to a width.
  function padded(text, width)
    !> The text.
    character(len=*), intent(in) :: text
    !> The width.
    integer, intent(in) :: width
    character(len=:), allocatable :: padded

    integer(i8) :: gap

    gap = int(max(1, width - len(text)), i8)
    padded = text//repeat(" ", gap)
  end function padded

  !> The reference of all blocks and keys for the manual, in Markdown.
  function reference_markdown() result(text)
    character(len=:), allocatable :: text

    type(block_row_t), allocatable :: table(:)
    integer :: i, k

    table = block_table()
    text = "# Keyword reference"//newline//newline// &
           "Printed by `dd3imp --help markdown` from the tables the input is checked against."// &
           newline
    do i = 1, size(table)
      text = text//newline//"## `"//trim(title(table(i)))//"`"//newline//newline// &
          escaped(trim(table(i)%help))//newline
      if (table(i)%later) text = text//newline//"This block "//not_available//"."//newline
      if (size(table(i)%key) == 0) cycle
      text = text//newline//"| key | value | default | meaning |"//newline//"|---|---|---|---|"// &
          newline
      do k = 1, size(table(i)%key)
        text = text//markdown_row(table(i)%key(k))
      end do
    end do
  end function reference_markdown

  !> One key as a row of a Markdown table.
  function markdown_row(key) result(text)
    !> The key.
    type(parameter_t), intent(in) :: key
    character(len=:), allocatable :: text

    character(len=:), allocatable :: value, meaning
    integer :: start

    value = describe(key)
    start = index(value, "= ") + 2
    meaning = trim(key%help)
    if (key%repeatable) meaning = meaning//"; may be repeated"
    if (key%later == "*") then
      meaning = meaning//"; "//not_available
    else if (key%later /= "") then
      meaning = meaning//"; not available in this version: "//trim(key%later)
    end if
    text = "| `"//trim(key%name)//"` | "//escaped(value(start:))//" | "//default_text(key)// &
        " | "// &
           escaped(meaning)//" |"//newline
  end function markdown_row

  !> The text with bars and angle brackets that Markdown would take for its own.
  function escaped(text)
    !> The text.
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: escaped

    integer :: i

    escaped = ""
    do i = 1, len(text)
      if (scan(text(i:i), "|<>*") > 0) escaped = escaped//"\"
      escaped = escaped//text(i:i)
    end do
  end function escaped

end module dd3_input_help
