!> Checks the value of one key against its row: form, type, range, known words.
module dd3_input_value
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : as_written, error_list_t, location_t
  use dd3_base_text, only : to_text, lower_case, same_name, suggestion
  use dd3_base_parameter, only : parameter_t, in_range, range_text, kind_real, kind_integer, &
      kind_logical, kind_name, kind_text, kind_reals, kind_integers, kind_names, kind_law, &
      kind_other
  use dd3_input_block, only : entry_t, token_t
  use dd3_input_number, only : parse_real, parse_integer
  use dd3_input_table, only : axis_of
  use dd3_input_token, only : line_t, token_list_t, add_token, split_line
  implicit none
  private
  public :: check_value, describe, split_words, word_length, not_available, form_for, &
      check_range, is_point, no_number

  !> Longest word in a row's lists.
  integer, parameter :: word_length = 24
  !> What is said of everything that a later version brings.
  character(len=*), parameter :: not_available = "is not available in this version"

contains

  !> Checks an entry's value and gathers its numbers; clears `entry%valid` where an error is added.
  subroutine check_value(entry, row, errors)
    !> The entry.
    type(entry_t), intent(inout) :: entry
    !> Its row.
    type(parameter_t), intent(in) :: row
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: before

    before = errors%count
    allocate (entry%number(0))
    if (size(entry%value) == 0) then
      entry%valid = .false.
      return
    end if
    if (row%later == "*") then
      call errors%push_input(entry%at, "'"//trim(row%name)//"' "//not_available)
    else if (row%may_be_off .and. size(entry%value) == 1 .and. same_name(entry%value(1)%text, &
        "off")) then
      entry%is_off = .true.
    else
      select case (row%kind)
      case (kind_real, kind_reals, kind_integer, kind_integers)
        call check_numbers(entry, row, errors)
      case (kind_other)
        call check_form(entry, row, errors)
      case (kind_law)
        call check_law_form(entry, row, errors)
      case default
        call check_words(entry, row, errors)
      end select
    end if
    entry%valid = errors%count == before
  end subroutine check_value

  !> Checks numbers: how many, of what type, in what range.
  subroutine check_numbers(entry, row, errors)
    !> The entry.
    type(entry_t), intent(inout) :: entry
    !> Its row.
    type(parameter_t), intent(in) :: row
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: i, wanted, given, before

    before = errors%count
    do i = 1, size(entry%value)
      if (row%kind == kind_integer .or. row%kind == kind_integers) then
        call take_integer(entry, entry%value(i), describe(row), errors)
      else
        call take_real(entry, entry%value(i), describe(row), errors)
      end if
      if (errors%count > before) cycle
      call check_range(entry%number(i), row, entry%value(i)%at, describe(row), errors)
    end do
    if (errors%count > before) return
    wanted = row%count
    given = size(entry%value)
    if (row%kind == kind_real .or. row%kind == kind_integer) wanted = 1
    if (wanted == 0 .or. given == wanted) return
    if (given > wanted) then
      call errors%push_input(entry%value(wanted + 1)%at, counted(given, "value")// &
          " given where "//to_text(wanted)//" would do", describe(row))
    else
      call errors%push_input(entry%value(given)%at, "only "//counted(given, "value")//" of "// &
          to_text(wanted), describe(row))
    end if
  end subroutine check_numbers

  !> A number of things in words.
  function counted(number, thing)
    !> How many.
    integer, intent(in) :: number
    !> What one of them is called.
    character(len=*), intent(in) :: thing
    character(len=:), allocatable :: counted

    counted = to_text(number)//" "//thing
    if (number /= 1) counted = counted//"s"
  end function counted

  !> Takes a word as a real number.
  subroutine take_real(entry, token, expected, errors)
    !> Receives the number.
    type(entry_t), intent(inout) :: entry
    !> The word.
    type(token_t), intent(in) :: token
    !> What is expected.
    character(len=*), intent(in) :: expected
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: value
    logical :: ok

    call parse_real(token%text, value, ok)
    if (ok) then
      entry%number = [entry%number, value]
    else
      call errors%push_input(token%at, no_number(token%text), expected)
    end if
  end subroutine take_real

  !> What is said of a word that is not a number.
  pure function no_number(word) result(text)
    !> The word.
    character(len=*), intent(in) :: word
    character(len=:), allocatable :: text

    text = "'"//word//"' is not a number"
    if (index(word, ",") > 0) then
      text = text//": decimals take a point, values are separated by blanks"
    else if (verify(word, "+-.0123456789eEdD") == 0 .and. scan(word, "eEdD") > 1) then
      text = text//" that can be held"
    end if
  end function no_number

  !> Takes a word as a whole number.
  subroutine take_integer(entry, token, expected, errors)
    !> Receives the number.
    type(entry_t), intent(inout) :: entry
    !> The word.
    type(token_t), intent(in) :: token
    !> What is expected.
    character(len=*), intent(in) :: expected
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    integer :: value
    logical :: ok

    call parse_integer(token%text, value, ok)
    if (ok) then
      entry%number = [entry%number, real(value, wp)]
    else
      call errors%push_input(token%at, "'"//token%text//"' is not a whole number", expected)
    end if
  end subroutine take_integer

  !> Checks a number against its row's bounds.
  subroutine check_range(value, row, at, expected, errors)
    !> The number.
    real(wp), intent(in) :: value
    !> The row.
    type(parameter_t), intent(in) :: row
    !> Where it was written.
    type(location_t), intent(in) :: at
    !> What is expected.
    character(len=*), intent(in) :: expected
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    if (in_range(row, value)) return
    call errors%push_input(at, trim(row%name)//" = "//to_text(value)//" is out of range", expected)
  end subroutine check_range

  !> Checks words: switches, names, options, paths.
  subroutine check_words(entry, row, errors)
    !> The entry.
    type(entry_t), intent(inout) :: entry
    !> Its row.
    type(parameter_t), intent(in) :: row
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: i
    logical :: on, ok

    if (row%kind /= kind_names .and. size(entry%value) > 1) then
      call errors%push_input(entry%value(2)%at, "one value is asked for", describe(row))
      return
    end if
    if (row%kind == kind_text) then
      if (entry%value(1)%text == "") call errors%push_input(entry%value(1)%at, &
          "the text is empty", describe(row))
      return
    end if
    if (row%kind == kind_logical) then
      call is_on(entry%value(1)%text, on, ok)
      if (.not. ok) call errors%push_input(entry%value(1)%at, "'"//entry%value(1)%text// &
          "' is no switch", describe(row))
      entry%number = [merge(1.0_wp, 0.0_wp, on)]
      return
    end if
    if (row%count > 1 .and. size(entry%value) /= row%count .and. row%kind == kind_names) then
      call errors%push_input(entry%at, to_text(row%count)//" words are asked for", describe(row))
    end if
    do i = 1, size(entry%value)
      entry%value(i)%text = lower_case(entry%value(i)%text)
      call check_choice(entry%value(i), row, errors)
      if (word_before(entry, i)) call errors%push_input(entry%value(i)%at, "'"// &
          as_written(entry%value(i)%text, entry%value(i)%at)//"' is given twice")
    end do
  end subroutine check_words

  !> Whether a word of a value has stood before it already.
  pure logical function word_before(entry, i)
    !> The entry.
    type(entry_t), intent(in) :: entry
    !> Position of the word.
    integer, intent(in) :: i

    integer :: j

    word_before = .false.
    do j = 1, i - 1
      if (entry%value(j)%text == entry%value(i)%text) word_before = .true.
    end do
  end function word_before

  !> Checks a word against the row's alternatives.
  subroutine check_choice(token, row, errors)
    !> The word.
    type(token_t), intent(in) :: token
    !> The row.
    type(parameter_t), intent(in) :: row
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    character(len=word_length), allocatable :: known(:)

    known = split_words(row%later)
    if (any(known == token%text) .and. len(token%text) <= word_length) then
      call errors%push_input(token%at, "'"//as_written(token%text, token%at)//"' "// &
          not_available, describe(row))
      return
    end if
    known = split_words(row%choices)
    if (size(known) == 0) return
    if (any(known == token%text) .and. len(token%text) <= word_length) return
    call errors%push_input(token%at, "unknown word '"//as_written(token%text, token%at)//"'"// &
        suggestion(token%text, known), describe(row))
  end subroutine check_choice

  !> Checks the outline of a law: a name, then `key = value` pairs, or points `p:Y`. A value that is
  !> left out becomes an empty word, which the check of the law's parameters tells of.
  subroutine check_law_form(entry, row, errors)
    !> The entry.
    type(entry_t), intent(inout) :: entry
    !> Its row.
    type(parameter_t), intent(in) :: row
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: word
    integer :: i, k

    call unfold_law(entry, errors)
    entry%value(1)%text = lower_case(entry%value(1)%text)
    if (any(split_words(row%later) == entry%value(1)%text)) then
      call errors%push_input(entry%value(1)%at, "'"//entry%value(1)%text//"' "//not_available)
      return
    end if
    if (is_equals(entry%value(1))) then
      call errors%push_input(entry%value(1)%at, "the law's name is missing", describe(row))
      return
    end if
    call take_words(word, entry, 1, 1)
    i = 2
    do while (i <= size(entry%value))
      if (is_point(entry%value(i))) then
        call take_words(word, entry, i, i)
        i = i + 1
      else if (equals_at(entry, i) .or. .not. equals_at(entry, i + 1)) then
        call errors%push_input(entry%value(i)%at, "'"//entry%value(i)%text// &
            "' is not followed by =value", describe(row))
        do k = i + 1, size(entry%value)
          if (is_point(entry%value(k)) .or. equals_at(entry, k + 1)) exit
        end do
        i = k
      else if (i + 2 > size(entry%value) .or. equals_at(entry, i + 2) .or. &
               equals_at(entry, i + 3)) then
        call take_words(word, entry, i, i + 1)
        call add_token(word, "", .false., entry%value(i)%at)
        i = i + 2
      else
        call take_words(word, entry, i, i + 2)
        i = i + 3
      end if
    end do
    entry%value = word%item(:word%count)
  end subroutine check_law_form

  !> Adds some words of an entry's value to others.
  subroutine take_words(word, entry, first, last)
    !> The words.
    type(token_list_t), intent(inout) :: word
    !> The entry.
    type(entry_t), intent(in) :: entry
    !> Positions of the first and the last to be added.
    integer, intent(in) :: first, last

    integer :: i

    do i = first, last
      call add_token(word, entry%value(i)%text, entry%value(i)%quoted, entry%value(i)%at)
    end do
  end subroutine take_words

  !> Cuts a whole law in one pair of quotes into its words, as a parameter may hold it.
  subroutine unfold_law(entry, errors)
    !> The entry.
    type(entry_t), intent(inout) :: entry
    !> Receives the error of a quote inside that is not closed.
    type(error_list_t), intent(inout) :: errors

    type(token_list_t) :: word
    type(line_t) :: line
    logical :: continues
    integer :: i

    if (.not. entry%value(1)%quoted .or. scan(entry%value(1)%text, " =") == 0) return
    line%file = entry%value(1)%at%file
    line%text = entry%value(1)%text
    call split_line(line, word, continues, errors)
    do i = 1, word%count
      word%item(i)%at = entry%value(1)%at
    end do
    call take_words(word, entry, 2, size(entry%value))
    if (word%count > 0) entry%value = word%item(:word%count)
  end subroutine unfold_law

  !> Whether a word is a point `p:Y`.
  pure logical function is_point(token)
    !> The word.
    type(token_t), intent(in) :: token

    is_point = index(token%text, ":") > 0 .and. .not. token%quoted
  end function is_point

  !> Whether a word is an equals sign.
  pure logical function is_equals(token)
    !> The word.
    type(token_t), intent(in) :: token

    is_equals = token%text == "=" .and. .not. token%quoted
  end function is_equals

  !> Whether a word of a value is an equals sign; not beyond its end.
  pure logical function equals_at(entry, i)
    !> The entry.
    type(entry_t), intent(in) :: entry
    !> Position of the word.
    integer, intent(in) :: i

    equals_at = .false.
    if (i <= size(entry%value)) equals_at = is_equals(entry%value(i))
  end function equals_at

  !> Checks a value against the form of its row.
  subroutine check_form(entry, row, errors)
    !> The entry.
    type(entry_t), intent(inout) :: entry
    !> Its row.
    type(parameter_t), intent(in) :: row
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    character(len=word_length), allocatable :: form(:)
    character(len=word_length) :: wanted
    integer :: i, k, before
    logical :: again

    before = errors%count
    form = form_for(entry, row)
    k = 1
    again = .false.
    do i = 1, size(entry%value)
      if (k > size(form)) then
        call errors%push_input(entry%value(i)%at, "'"//entry%value(i)%text// &
            "' is one value too many", describe(row))
        return
      end if
      wanted = form(k)
      again = index(wanted, "...") > 0
      if (again) wanted = wanted(:index(wanted, "...") - 1)
      call check_form_word(entry, i, wanted, row, errors)
      if (errors%count > before) return
      if (.not. again) k = k + 1
    end do
    if (again .or. k > size(form)) return
    if (form(k)(1:1) == "[") return
    call errors%push_input(entry%value(size(entry%value))%at, &
        "something is missing after this: "//trim(form(k)), describe(row))
  end subroutine check_form

  !> Checks one word of a value against one word of the form.
  subroutine check_form_word(entry, i, wanted, row, errors)
    !> The entry.
    type(entry_t), intent(inout) :: entry
    !> Position of the word.
    integer, intent(in) :: i
    !> The word of the form.
    character(len=*), intent(in) :: wanted
    !> The row.
    type(parameter_t), intent(in) :: row
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: text
    integer :: before

    before = errors%count
    text = lower_case(entry%value(i)%text)
    select case (wanted)
    case ("number")
      call take_real(entry, entry%value(i), describe(row), errors)
    case ("count")
      call take_integer(entry, entry%value(i), describe(row), errors)
      if (errors%count > before) return
      if (entry%number(size(entry%number)) < 1.0_wp) then
        call errors%push_input(entry%value(i)%at, "'"//text// &
            "' is out of range: 1 or more is asked for", describe(row))
      end if
    case ("axis")
      entry%number = [entry%number, real(axis_of(text), wp)]
      if (axis_of(text) == 0) call errors%push_input(entry%value(i)%at, "'"// &
          as_written(text, entry%value(i)%at)//"' is no axis: x, y or z", describe(row))
    case ("range")
      call take_range(entry, entry%value(i), row, errors)
    case ("set", "tool", "material")
      entry%value(i)%text = text
    case default
      call check_literal(entry%value(i), wanted, row, errors)
      entry%value(i)%text = text
    end select
  end subroutine check_form_word

  !> Checks a word against a fixed one, or against one of several.
  subroutine check_literal(token, wanted, row, errors)
    !> The word.
    type(token_t), intent(in) :: token
    !> `word`, `[word]` or `word|word`.
    character(len=*), intent(in) :: wanted
    !> The row.
    type(parameter_t), intent(in) :: row
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    character(len=word_length), allocatable :: known(:)
    character(len=len(wanted)) :: plain
    integer :: i

    plain = wanted
    do i = 1, len(wanted)
      if (scan(wanted(i:i), "[]|") > 0) plain(i:i) = " "
    end do
    known = split_words(plain)
    do i = 1, size(known)
      if (same_name(known(i), token%text)) return
    end do
    call errors%push_input(token%at, "unknown word '"//as_written(token%text, token%at)//"'"// &
        suggestion(token%text, known), describe(row))
  end subroutine check_literal

  !> Takes `n` or `n-m` as a range of node numbers: two numbers.
  subroutine take_range(entry, token, row, errors)
    !> Receives the numbers.
    type(entry_t), intent(inout) :: entry
    !> The word.
    type(token_t), intent(in) :: token
    !> The row.
    type(parameter_t), intent(in) :: row
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: text
    integer :: dash, first, last
    logical :: ok(2)

    text = token%text
    dash = index(text, "-")
    if (dash == 0) then
      call parse_integer(text, first, ok(1))
      last = first
      ok(2) = ok(1)
    else
      call parse_integer(text(:dash - 1), first, ok(1))
      call parse_integer(text(dash + 1:), last, ok(2))
    end if
    if (.not. all(ok) .or. first < 1 .or. last < first) then
      call errors%push_input(token%at, "'"//text//"' is no range of node numbers", describe(row))
    else
      entry%number = [entry%number, real(first, wp), real(last, wp)]
    end if
  end subroutine take_range

  !> The alternative of a row's form that a value is meant for, as words.
  function form_for(entry, row) result(form)
    !> The entry.
    type(entry_t), intent(in) :: entry
    !> Its row.
    type(parameter_t), intent(in) :: row
    character(len=word_length), allocatable :: form(:)

    character(len=word_length), allocatable :: all_words(:)
    character(len=len(row%form)) :: spaced
    character(len=:), allocatable :: given
    integer :: i, first, last

    spaced = row%form
    all_words = split_words(spaced, "/")
    first = 1
    given = lower_case(entry%value(1)%text)
    do i = 1, size(all_words)
      if (all_words(i) == "/") first = i + 1
      if (i == first .and. all_words(i) == given) exit
    end do
    if (i > size(all_words)) first = 1
    last = first
    do while (last < size(all_words))
      if (all_words(last + 1) == "/") exit
      last = last + 1
    end do
    form = all_words(first:last)
  end function form_for

  !> Words separated by blanks; a separator given is a word of its own.
  pure function split_words(text, separator) result(word)
    !> The text.
    character(len=*), intent(in) :: text
    !> One character.
    character(len=1), intent(in), optional :: separator
    character(len=word_length), allocatable :: word(:)

    character(len=1) :: mark
    integer :: start, last

    mark = " "
    if (present(separator)) mark = separator
    allocate (word(0))
    start = 1
    do while (start <= len_trim(text))
      last = scan(text(start:), " "//mark)
      last = merge(len(text), start + last - 2, last == 0)
      if (last >= start) word = [character(len=word_length) :: word, text(start:last)]
      start = last + 2
      if (last + 1 > len_trim(text) .or. mark == " ") cycle
      if (text(last + 1:last + 1) == mark) word = [character(len=word_length) :: word, mark]
    end do
  end function split_words

  !> Reads a switch.
  pure subroutine is_on(text, on, ok)
    !> The word.
    character(len=*), intent(in) :: text
    !> Whether it says on.
    logical, intent(out) :: on
    !> Whether it is a switch.
    logical, intent(out) :: ok

    select case (lower_case(text))
    case ("on", "yes", "true")
      on = .true.
      ok = .true.
    case ("off", "no", "false")
      on = .false.
      ok = .true.
    case default
      on = .false.
      ok = .false.
    end select
  end subroutine is_on

  !> What a row asks for, in words: `size = 3 numbers, > 0, mm`.
  function describe(row) result(text)
    !> The row.
    type(parameter_t), intent(in) :: row
    character(len=:), allocatable :: text

    character(len=:), allocatable :: many

    many = to_text(row%count)
    if (row%count == 0) many = "several"
    select case (row%kind)
    case (kind_real)
      text = "a number"
    case (kind_integer)
      text = "a whole number"
    case (kind_logical)
      text = "on or off"
    case (kind_name)
      text = "a name"
      if (row%form /= "") text = "the name of a "//trim(row%form)
      if (row%choices /= "") text = "one of: "//trim(row%choices)
    case (kind_text)
      text = "a text, in quotes where it holds blanks"
    case (kind_reals)
      text = many//" numbers"
    case (kind_integers)
      text = many//" whole numbers"
    case (kind_names)
      text = many//" words"
      if (row%choices /= "") text = "any of: "//trim(row%choices)
    case (kind_law)
      text = "a law and its parameters: name key=value key=value ..."
    case default
      text = alternatives(row)
    end select
    text = trim(row%name)//" = "//text//range_text(row)
    if (row%unit /= "") text = text//", "//trim(row%unit)
    if (row%may_be_off) text = text//", or off"
  end function describe

  !> The forms of a row's value, in words.
  function alternatives(row) result(text)
    !> The row.
    type(parameter_t), intent(in) :: row
    character(len=:), allocatable :: text

    character(len=word_length), allocatable :: word(:)
    integer :: i

    word = split_words(row%form, "/")
    text = ""
    do i = 1, size(word)
      if (word(i) == "/") word(i) = "or"
      if (i > 1) text = text//" "
      text = text//trim(word(i))
    end do
  end function alternatives

end module dd3_input_value
