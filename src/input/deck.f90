!> Reads the input text into blocks: comments, continued lines, included files, parameters.
module dd3_input_deck
  use dd3_base_error, only : error_t, error_list_t, location_t
  use dd3_base_text, only : text_t, lower_case, upper_case, slice
  use dd3_input_block, only : block_t, entry_t, token_t, deck_t
  use dd3_input_substitution, only : substitution_t, new_substitution
  use dd3_input_text_file, only : read_lines, resolve_path, folder_of
  use dd3_input_token, only : line_t, token_list_t, place, split_line
  implicit none
  private
  public :: read_deck

  !> Deepest nesting of included files.
  integer, parameter :: deepest = 20

  !> Where the lines go: nowhere yet, into the parameters, a title, or a block.
  integer, parameter :: into_nothing = 0, into_parameters = 1, into_title = 2, into_block = 3

  !> What is known while the text is read.
  type :: reader_t
    !> The blocks closed so far.
    type(deck_t) :: deck
    !> The block that is open.
    type(block_t) :: open
    !> One of the `into_*` values.
    integer :: mode = into_nothing
    !> Whether a line outside all blocks has been reported.
    logical :: stray = .false.
    !> The parameters.
    type(substitution_t) :: substitution
    !> Lines read so far.
    integer :: order = 0
    !> The files that are open, outermost first.
    type(text_t), allocatable :: file(:)
  end type reader_t

contains

  !> Reads a file and all it includes.
  subroutine read_deck(deck, file_name, overrides, errors)
    !> The blocks.
    type(deck_t), intent(out) :: deck
    !> The file.
    character(len=*), intent(in) :: file_name
    !> Texts `name=value` that override parameters.
    type(text_t), intent(in) :: overrides(:)
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    type(reader_t) :: self
    type(location_t) :: whole_file
    integer :: before

    before = errors%count
    allocate (self%file(0))
    call new_substitution(self%substitution, overrides, errors)
    whole_file%file = file_name
    call read_file(self, file_name, whole_file, errors)
    call close_block(self)
    if (self%deck%n_block == 0 .and. errors%count == before) then
      call errors%push_input(whole_file, "the file holds no block", &
          "blocks such as *BLANK, *MATERIAL, *PHASE")
    end if
    if (self%deck%n_block > 0) call self%substitution%check_overrides(errors)
    if (self%deck%n_block > 0) deck = self%deck
  end subroutine read_deck

  !> Reads one file.
  recursive subroutine read_file(self, path, named_at, errors)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> Its path.
    character(len=*), intent(in) :: path
    !> Where it was named.
    type(location_t), intent(in) :: named_at
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    type(text_t), allocatable :: text(:)
    type(error_t), allocatable :: error
    type(text_t) :: opened
    type(line_t) :: line
    integer :: i

    call read_lines(path, text, error)
    if (allocated(error)) then
      call errors%push_input(named_at, "the input file '"//path//"' cannot be read: "// &
          error%message)
      return
    end if
    opened%s = path
    self%file = [self%file, opened]
    line%file = path
    i = 0
    do while (i < size(text))
      call take_line(self, line, text, i)
      if (self%mode == into_title .and. index(adjustl(untabbed(line%text)), "*") /= 1) then
        call add_title_line(self, line)
      else
        call read_statement(self, line, text, i, errors)
      end if
    end do
    self%file = self%file(:size(self%file) - 1)
  end subroutine read_file

  !> Goes on to the next line.
  subroutine take_line(self, line, text, i)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> The line.
    type(line_t), intent(inout) :: line
    !> All lines of the file.
    type(text_t), intent(in) :: text(:)
    !> Number of the line read last; one more afterwards.
    integer, intent(inout) :: i

    i = i + 1
    self%order = self%order + 1
    line%number = i
    line%order = self%order
    line%text = text(i)%s
  end subroutine take_line

  !> The text with blanks in place of tabs.
  pure function untabbed(text)
    !> The text.
    character(len=*), intent(in) :: text
    character(len=len(text)) :: untabbed

    integer :: i

    untabbed = text
    do i = 1, len(text)
      if (text(i:i) == achar(9)) untabbed(i:i) = " "
    end do
  end function untabbed

  !> Keeps a line of free text.
  subroutine add_title_line(self, line)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> The line.
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

  !> Reads a line with those it goes on in, and does what it says.
  recursive subroutine read_statement(self, line, text, i, errors)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> The line read last.
    type(line_t), intent(inout) :: line
    !> All lines of the file.
    type(text_t), intent(in) :: text(:)
    !> Number of the line read last.
    integer, intent(inout) :: i
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: token
    logical :: continues
    integer :: before

    before = errors%count
    call split_line(line, token, continues, errors)
    do while (continues)
      if (i == size(text)) then
        call errors%push_input(place(line, len_trim(line%text), 1), &
            "the last line of the file goes on in another", "a line after the ampersand")
        exit
      end if
      call take_line(self, line, text, i)
      call split_line(line, token, continues, errors)
    end do
    if (token%count == 0) return
    if (errors%count > before) then
      call add_broken_entry(self, token%item(1))
      return
    end if
    if (index(token%item(1)%text, "*") == 1 .and. &
        .not. token%item(1)%quoted) then
      call open_block(self, token, line%file, errors)
    else
      call read_assignment(self, token, errors)
    end if
  end subroutine read_statement

  !> Keeps the key of a line that could not be read, so that it is not reported as missing too.
  subroutine add_broken_entry(self, key)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> The first word of the line.
    type(token_t), intent(in) :: key

    type(entry_t) :: entry

    if (self%mode /= into_block .or. scan(key%text, "*=") == 1) return
    entry%key = lower_case(key%text)
    entry%at = key%at
    allocate (entry%value(0))
    call self%open%add_entry(entry)
  end subroutine add_broken_entry

  !> Reads `*BLOCK name`.
  recursive subroutine open_block(self, token, file, errors)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> The words of the line.
    type(token_list_t), intent(in) :: token
    !> The file it stands in.
    character(len=*), intent(in) :: file
    !> Receives all errors found.
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
      call errors%push_input(word%item(2)%at, "nothing but the block's name stands after *"// &
          upper_case(keyword), "values follow on lines of their own: key = value")
    end if
  end subroutine open_block

  !> Reads an included file.
  recursive subroutine include_file(self, opened, word, file, errors)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> Where `*INCLUDE` stands.
    type(location_t), intent(in) :: opened
    !> What follows it.
    type(token_list_t), intent(in) :: word
    !> The file it stands in.
    character(len=*), intent(in) :: file
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: path
    integer :: k

    if (word%count /= 1) then
      call errors%push_input(opened, "*INCLUDE takes one file", '*INCLUDE "file"')
      return
    end if
    path = resolve_path(folder_of(file), word%item(1)%text)
    do k = 1, size(self%file)
      if (self%file(k)%s == path) then
        call errors%push_input(word%item(1)%at, "the file '"//path//"' includes itself")
        return
      end if
    end do
    if (size(self%file) > deepest) then
      call errors%push_input(word%item(1)%at, &
          "files include one another too deeply; does one include itself?")
      return
    end if
    call read_file(self, path, word%item(1)%at, errors)
    call close_block(self)
  end subroutine include_file

  !> Reads `key = value value ...`.
  subroutine read_assignment(self, token, errors)
    !> What is known so far.
    type(reader_t), intent(inout) :: self
    !> The words of the line.
    type(token_list_t), intent(in) :: token
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: value
    type(entry_t) :: entry
    integer :: k, before

    if (self%mode == into_nothing) then
      if (.not. self%stray) then
        call errors%push_input(token%item(1)%at, "this line belongs to no block", &
            "a line *BLOCK above; *INCLUDE ends the block before it")
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
    ! A value that could not be made is left out, so that it is not reported again; its key is not
    ! missing.
    if (errors%count > before) then
      allocate (entry%value(0))
    else
      entry%value = value%item(:value%count)
    end if
    call self%open%add_entry(entry)
  end subroutine read_assignment

  !> Whether the words are a key, an equals sign and a value.
  logical function is_assignment(token, errors)
    !> The words of the line.
    type(token_list_t), intent(in) :: token
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    is_assignment = .false.
    if (token%item(1)%text == "=" .and. .not. token%item(1)%quoted) then
      call errors%push_input(token%item(1)%at, "a key is missing before the equals sign", &
          "key = value")
    else if (token%count == 1) then
      call errors%push_input(token%item(1)%at, "this is neither a block nor a key with its value", &
          "*BLOCK name, or key = value")
    else if (token%item(2)%text /= "=" .or. token%item(2)%quoted) then
      call errors%push_input(token%item(2)%at, "an equals sign is missing after '"// &
          token%item(1)%text//"'", "key = value")
    else if (token%count == 2) then
      call errors%push_input(token%item(2)%at, "no value is given for '"//token%item(1)%text//"'", &
          "key = value")
    else
      is_assignment = .true.
    end if
  end function is_assignment

  !> Puts the open block away.
  subroutine close_block(self)
    !> What is known so far.
    type(reader_t), intent(inout) :: self

    if (self%mode == into_block .or. self%mode == into_title) call self%deck%add_block(self%open)
    self%mode = into_nothing
  end subroutine close_block

end module dd3_input_deck
