!> Parameters of the input: `name = value` in `*PARAMETER`, used as `${name}` in later values.
module dd3_input_substitution
  use dd3_base_error, only : as_written, error_list_t, location_t
  use dd3_base_text, only : text_t, same_name, lower_case, nearest_name, join, slice
  use dd3_input_block, only : token_t
  use dd3_input_token, only : token_list_t, line_t, split_line, add_token
  implicit none
  private
  public :: substitution_t, new_substitution

  !> One parameter.
  type :: binding_t
    !> Its name, in small letters.
    character(len=:), allocatable :: name
    !> Its value.
    type(token_list_t) :: value
    !> Where it was defined; unallocated file: on the command line only.
    type(location_t) :: at
    !> Whether the command line gives its value.
    logical :: overridden = .false.
    !> Whether the input defines it.
    logical :: defined = .false.
  end type binding_t

  !> All parameters.
  type :: substitution_t
    !> The parameters, in the order met.
    type(binding_t), allocatable :: item(:)
  contains
    procedure :: define
    procedure :: expand
    procedure :: check_overrides
  end type substitution_t

contains

  !> Takes the overrides of the command line.
  subroutine new_substitution(self, overrides, errors)
    !> The parameters.
    type(substitution_t), intent(out) :: self
    !> Texts `name=value`.
    type(text_t), intent(in) :: overrides(:)
    !> Receives the errors of malformed overrides.
    type(error_list_t), intent(inout) :: errors

    type(binding_t) :: binding
    type(line_t) :: line
    logical :: continues
    integer :: i, equals

    allocate (self%item(0))
    do i = 1, size(overrides)
      equals = index(overrides(i)%s, "=")
      binding = binding_t(overridden=.true.)
      binding%at%file = "--set "//overrides(i)%s
      binding%at%order = 0
      binding%name = lower_case(trim(adjustl(slice(overrides(i)%s, 1, equals - 1))))
      line%file = binding%at%file
      line%text = overrides(i)%s(equals + 1:)
      if (equals > 0) call split_line(line, binding%value, continues, errors)
      if (binding%name == "" .or. binding%value%count == 0) then
        call errors%push_input(binding%at, "a parameter is set as --set name=value")
        cycle
      end if
      if (position(self, binding%name) > 0) then
        call errors%push_input(binding%at, "parameter '"//binding%name//"' is set twice")
      else
        self%item = [self%item, binding]
      end if
    end do
  end subroutine new_substitution

  !> Defines a parameter as the input gives it.
  subroutine define(self, name, value, errors)
    !> The parameters.
    class(substitution_t), intent(inout) :: self
    !> Its name as written.
    type(token_t), intent(in) :: name
    !> Its value, parameters already replaced.
    type(token_list_t), intent(in) :: value
    !> Receives the error of a name given twice.
    type(error_list_t), intent(inout) :: errors

    type(binding_t) :: binding
    integer :: i

    i = position(self, name%text)
    if (i == 0) then
      binding%name = lower_case(name%text)
      self%item = [self%item, binding]
      i = size(self%item)
    else if (self%item(i)%defined) then
      call errors%push_input(name%at, "parameter '"//name%text//"' is defined twice")
      return
    end if
    self%item(i)%at = name%at
    self%item(i)%defined = .true.
    if (.not. self%item(i)%overridden) self%item(i)%value = value
  end subroutine define

  !> An error for every override that names no parameter of the input.
  subroutine check_overrides(self, errors)
    !> The parameters.
    class(substitution_t), intent(in) :: self
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    integer :: i

    do i = 1, size(self%item)
      if (self%item(i)%defined) cycle
      call errors%push_input(self%item(i)%at, "the input defines no parameter '"// &
          self%item(i)%name//"'", alternatives(self, self%item(i)%name))
    end do
  end subroutine check_overrides

  !> Appends a word to a list with its parameters replaced.
  subroutine expand(self, token, list, errors)
    !> The parameters.
    class(substitution_t), intent(in) :: self
    !> The word.
    type(token_t), intent(in) :: token
    !> The list.
    type(token_list_t), intent(inout) :: list
    !> Receives the errors of unknown parameters.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: text
    type(location_t) :: at
    integer :: first, last, i, k

    text = ""
    first = 1
    do
      k = index(token%text(first:), "${")
      if (k == 0) exit
      last = index(token%text(first + k:), "}")
      at = token%at
      at%column = token%at%column + first + k - 2 + merge(1, 0, token%quoted)
      at%width = merge(last + 1, len(token%text) - first - k + 2, last > 0)
      if (last == 0) then
        call errors%push_input(at, "a closing brace is missing", "${name}")
        return
      end if
      i = position(self, slice(token%text, first + k + 1, first + k + last - 2))
      if (i > 0) then
        if (.not. self%item(i)%defined) i = 0
      end if
      if (i == 0) then
        call errors%push_input(at, "unknown parameter '"//slice(token%text, first + k + 1, &
            first + k + last - 2)//"'", alternatives(self, slice(token%text, first + k + 1, &
            first + k + last - 2)))
        return
      end if
      if (last + 1 == len(token%text) .and. .not. token%quoted) then
        do k = 1, self%item(i)%value%count
          call add_token(list, self%item(i)%value%item(k)%text, self%item(i)%value%item(k)%quoted, &
              token%at)
        end do
        return
      end if
      text = text//slice(token%text, first, first + k - 2)//plain(self%item(i)%value)
      first = first + k + last
    end do
    call add_token(list, text//token%text(first:), token%quoted, token%at)
  end subroutine expand

  !> Words of a value with single blanks between them.
  pure function plain(value) result(text)
    !> The value.
    type(token_list_t), intent(in) :: value
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    do i = 1, value%count
      if (i > 1) text = text//" "
      text = text//value%item(i)%text
    end do
  end function plain

  !> Position of a parameter; 0 if there is none of this name.
  pure integer function position(self, name)
    !> The parameters.
    type(substitution_t), intent(in) :: self
    !> Its name.
    character(len=*), intent(in) :: name

    do position = 1, size(self%item)
      if (same_name(self%item(position)%name, name)) return
    end do
    position = 0
  end function position

  !> What a misspelt name may have meant.
  function alternatives(self, name) result(text)
    !> The parameters.
    type(substitution_t), intent(in) :: self
    !> The name.
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: text

    character(len=64), allocatable :: known(:)
    integer :: i

    allocate (known(0))
    do i = 1, size(self%item)
      if (self%item(i)%defined) known = [character(len=64) :: known, &
          as_written(self%item(i)%name, self%item(i)%at)]
    end do
    if (size(known) == 0) then
      text = "a parameter defined above in a *PARAMETER block (none is)"
    else
      text = "one of: "//join(known, ", ")
      if (nearest_name(name, known) /= "") text = "'"//nearest_name(name, known)// &
          "'? defined are: "//join(known, ", ")
    end if
  end function alternatives

end module dd3_input_substitution
