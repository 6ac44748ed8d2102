! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of the input text: comments, continuation lines, included files, parameters, blocks.
module dd3_input_deck
  use dd3_base_error, only : error_t, error_list_t, location_t
  use dd3_base_text, only : text_t, lower_case, upper_case, slice, to_text
  use dd3_input_block, only : block_t, entry_t, token_t, deck_t
  use dd3_input_substitution, only : substitution_t, new_substitution
  use dd3_input_text_file, only : clean_text, folder_of, read_lines, resolve_path, split_lines
  use dd3_input_token, only : line_t, token_list_t, place, split_line
  implicit none
  private
  public :: read_deck

  !> Maximum depth of nested included files.
  integer, parameter :: deepest = 20

  !> Where lines are added: outside any block, to the parameters, a title, or a block.
  integer, parameter :: into_nothing = 0, into_parameters = 1, into_title = 2, into_block = 3

  !> State of the reader.
  type :: reader_t
    !> Complete blocks.
    type(deck_t) :: deck
    !> Current block.
    type(block_t) :: open
    !> One of the `into_*` values.
    integer :: mode = into_nothing
    !> Whether a line outside any block has been reported.
    logical :: stray = .false.
    type(substitution_t) :: substitution
    !> Number of lines read.
    integer :: order = 0
    !> Open files, outermost first.
    type(text_t), allocatable :: file(:)
  end type reader_t

contains

  !> Read a file and the files it includes.
  subroutine read_deck(deck, file_name, overrides, errors, content)
    type(deck_t), intent(out) :: deck
    character(len=*), intent(in) :: file_name
    !> Parameters given as `name=value` on the command line.
    type(text_t), intent(in) :: overrides(:)
    type(error_list_t), intent(inout) :: errors
    !> Text in place of the file, whose name is then that in messages.
    character(len=*), intent(in), optional :: content

    type(reader_t) :: self
    type(location_t) :: whole_file
    integer :: before

    before = errors%count
    allocate (self%file(0), self%deck%file(0))
    call new_substitution(self%substitution, overrides, errors)
    whole_file%file = file_name
    if (present(content)) then
      call read_content(self, file_name, content, errors)
    else
      call read_file(self, file_name, whole_file, errors)
    end if
    call close_block(self)
    if (self%deck%n_block == 0 .and. errors%count == before) then
      call errors%push_input(whole_file, "the file contains no block", &
          "blocks such as *BLANK, *MATERIAL, *PHASE", code="E102")
    end if
    if (self%deck%n_block > 0) call self%substitution%check_overrides(errors)
    if (self%deck%n_block > 0) deck = self%deck
  end subroutine read_deck

  !> Read one file.
  recursive subroutine read_file(self, path, named_at, errors)
    type(reader_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    !> Where the file is named.
    type(location_t), intent(in) :: named_at
    type(error_list_t), intent(inout) :: errors

    type(text_t), allocatable :: text(:)
    type(error_t), allocatable :: error

    call read_lines(path, text, error)
    if (allocated(error)) then
      call errors%push_input(named_at, "cannot read the input file '"//path//"': "//error%message, &
          code="E101")
      return
    end if
    call read_statements(self, path, text, errors)
  end subroutine read_file

  !> Read a text in place of a file.
  subroutine read_content(self, name, content, errors)
    type(reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name, content
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: clean
    type(text_t), allocatable :: text(:)
    type(error_t), allocatable :: error
    type(location_t) :: whole

    clean = content
    call clean_text(clean, error)
    if (allocated(error)) then
      whole%file = name
      call errors%push_input(whole, error%message, code="E101")
      return
    end if
    call split_lines(clean, text)
    call read_statements(self, name, text, errors)
  end subroutine read_content

  !> Read the lines of a file.
  recursive subroutine read_statements(self, path, text, errors)
    type(reader_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    type(text_t), intent(in) :: text(:)
    type(error_list_t), intent(inout) :: errors

    type(text_t) :: opened
    type(line_t) :: line
    integer :: i

    opened%s = path
    self%file = [self%file, opened]
    self%deck%file = [self%deck%file, opened]
    line%file = path
    i = 0
    do while (i < size(text))
      call advance_line(self, line, text, i)
      if (self%mode == into_title .and. index(adjustl(untabbed(line%text)), "*") /= 1) then
        call add_title_line(self, line)
      else
        call read_statement(self, line, text, i, errors)
      end if
    end do
    self%file = self%file(:size(self%file) - 1)
  end subroutine read_statements

  !> Advance to the next line.
  subroutine advance_line(self, line, text, i)
    type(reader_t), intent(inout) :: self
    type(line_t), intent(inout) :: line
    !> All lines of the file.
    type(text_t), intent(in) :: text(:)
    !> Number of the current line.
    integer, intent(inout) :: i

    i = i + 1
    self%order = self%order + 1
    line%number = i
    line%order = self%order
    line%text = text(i)%s
  end subroutine advance_line

  !> Return the text with tabs replaced by blanks.
  pure function untabbed(text)
    character(len=*), intent(in) :: text
    character(len=len(text)) :: untabbed

    integer :: i

    untabbed = text
    do i = 1, len(text)
      if (text(i:i) == achar(9)) untabbed(i:i) = " "
    end do
  end function untabbed

  !> Add a line of the title.
  subroutine add_title_line(self, line)
    type(reader_t), intent(inout) :: self
    type(line_t), intent(in) :: line

    type(entry_t) :: entry
    character(len=:), allocatable :: text
    integer :: comment

    comment = scan(line%text, "#!")
    if (comment == 0) comment = len(line%text) + 1
    text = trim(adjustl(untabbed(slice(line%text, 1, comment - 1))))
    if (text == "") return
    entry%key = "text"
    entry%at = place(line, 1, len(line%text))
    allocate (entry%value(1))
    entry%value(1)%text = text
    entry%value(1)%quoted = .true.
    entry%value(1)%at = entry%at
    call self%open%add_entry(entry)
  end subroutine add_title_line

  !> Read and process a statement with its continuation lines.
  recursive subroutine read_statement(self, line, text, i, errors)
    type(reader_t), intent(inout) :: self
    !> Current line.
    type(line_t), intent(inout) :: line
    !> All lines of the file.
    type(text_t), intent(in) :: text(:)
    !> Number of the current line.
    integer, intent(inout) :: i
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: token
    logical :: continues
    integer :: before

    before = errors%count
    call split_line(line, token, continues, errors)
    do while (continues)
      if (i == size(text)) then
        call errors%push_input(place(line, len_trim(line%text), 1), &
            "continuation beyond the end of the file", "a line after the ampersand", code="E103")
        exit
      end if
      call advance_line(self, line, text, i)
      call split_line(line, token, continues, errors)
    end do
    if (token%count == 0) return
    if (errors%count > before) then
      call add_broken_entry(self, token%item(1))
      return
    end if
    if (index(token%item(1)%text, "*") == 1 .and. .not. token%item(1)%quoted) then
      call open_block(self, token, line%file, errors)
    else
      call read_assignment(self, token, errors)
    end if
  end subroutine read_statement

  !> Add an entry without value for a line with errors, so that its key is not reported as missing.
  subroutine add_broken_entry(self, key)
    type(reader_t), intent(inout) :: self
    type(token_t), intent(in) :: key

    type(entry_t) :: entry

    if (self%mode /= into_block .or. scan(key%text, "*=") == 1) return
    entry%key = lower_case(key%text)
    entry%at = key%at
    allocate (entry%value(0))
    call self%open%add_entry(entry)
  end subroutine add_broken_entry

  !> Read `*BLOCK name`.
  recursive subroutine open_block(self, token, file, errors)
    type(reader_t), intent(inout) :: self
    type(token_list_t), intent(in) :: token
    !> File it is written in.
    character(len=*), intent(in) :: file
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: word
    character(len=:), allocatable :: keyword
    integer :: k, before

    call close_block(self)
    before = errors%count
    do k = 2, token%count
      call self%substitution%expand(token%item(k), word, errors)
    end do
    keyword = lower_case(token%item(1)%text(2:))
    self%mode = into_block
    if (keyword == "parameter") self%mode = into_parameters
    if (keyword == "title") self%mode = into_title
    if (keyword == "include") then
      self%mode = into_nothing
      if (errors%count == before) call include_file(self, token%item(1)%at, word, file, errors)
      return
    end if
    self%open = block_t()
    self%open%keyword = keyword
    self%open%name = ""
    self%open%opened = token%item(1)%at
    self%open%named = token%item(1)%at
    self%open%folder = folder_of(file)
    if (word%count > 0) then
      self%open%name = lower_case(word%item(1)%text)
      self%open%named = word%item(1)%at
    end if
    if (word%count > 1) then
      call errors%push_input(word%item(2)%at, "unexpected '"//word%item(2)%text// &
          "' after the name of *"//upper_case(keyword), "key = value, on a line of its own", &
          code="E103")
    end if
  end subroutine open_block

  !> Read an included file.
  recursive subroutine include_file(self, opened, word, file, errors)
    type(reader_t), intent(inout) :: self
    !> Where `*INCLUDE` is written.
    type(location_t), intent(in) :: opened
    !> Words after it.
    type(token_list_t), intent(in) :: word
    !> File it is written in.
    character(len=*), intent(in) :: file
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: path
    integer :: k

    if (word%count /= 1) then
      call errors%push_input(opened, "expected 1 file, got "//to_text(word%count), &
          '*INCLUDE "file"', code="E103")
      return
    end if
    path = resolve_path(folder_of(file), word%item(1)%text)
    do k = 1, size(self%file)
      if (self%file(k)%s == path) then
        call errors%push_input(word%item(1)%at, "the file '"//path//"' includes itself", &
            code="E104")
        return
      end if
    end do
    if (size(self%file) > deepest) then
      call errors%push_input(word%item(1)%at, &
          "*INCLUDE is nested more than "//to_text(deepest)//" levels deep", code="E104")
      return
    end if
    call read_file(self, path, word%item(1)%at, errors)
    call close_block(self)
  end subroutine include_file

  !> Read `key = value value ...`.
  subroutine read_assignment(self, token, errors)
    type(reader_t), intent(inout) :: self
    type(token_list_t), intent(in) :: token
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: value
    type(entry_t) :: entry
    integer :: k, before

    if (self%mode == into_nothing) then
      if (.not. self%stray) then
        call errors%push_input(token%item(1)%at, "this line is outside any block", &
            "a line *BLOCK above it; *INCLUDE ends a block", code="E103")
      end if
      self%stray = .true.
      return
    end if
    if (.not. is_assignment(token, errors)) then
      call add_broken_entry(self, token%item(1))
      return
    end if
    before = errors%count
    do k = 3, token%count
      call self%substitution%expand(token%item(k), value, errors)
    end do
    if (self%mode == into_parameters) then
      if (errors%count == before) call self%substitution%define(token%item(1), value, errors)
      return
    end if
    entry%key = lower_case(token%item(1)%text)
    entry%at = token%item(1)%at
    ! An invalid value is left out, so that neither it nor its key is reported again.
    if (errors%count > before) then
      allocate (entry%value(0))
    else
      entry%value = value%item(:value%count)
    end if
    call self%open%add_entry(entry)
  end subroutine read_assignment

  !> Whether the words are a key, an equals sign and a value; report it if they are not.
  logical function is_assignment(token, errors)
    type(token_list_t), intent(in) :: token
    type(error_list_t), intent(inout) :: errors

    is_assignment = .false.
    if (token%item(1)%text == "=" .and. .not. token%item(1)%quoted) then
      call errors%push_input(token%item(1)%at, "missing key before the equals sign", &
          "key = value", code="E103")
    else if (token%count == 1) then
      call errors%push_input(token%item(1)%at, "this is neither a block nor a key with a value", &
          "*BLOCK name, or key = value", code="E103")
    else if (token%item(2)%text /= "=" .or. token%item(2)%quoted) then
      call errors%push_input(token%item(2)%at, "missing equals sign after '"// &
          token%item(1)%text//"'", "key = value", code="E103")
    else if (token%count == 2) then
      call errors%push_input(token%item(2)%at, "no value is given for '"//token%item(1)%text//"'", &
          "key = value", code="E121")
    else
      is_assignment = .true.
    end if
  end function is_assignment

  !> End the current block.
  subroutine close_block(self)
    type(reader_t), intent(inout) :: self

    if (self%mode == into_block .or. self%mode == into_title) call self%deck%add_block(self%open)
    self%mode = into_nothing
  end subroutine close_block

end module dd3_input_deck
