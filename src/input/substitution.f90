! SPDX-License-Identifier: GPL-3.0-or-later
!> Parameters of the input: `name = value` in `*PARAMETER`, used as `${name}` in later values.
module dd3_input_substitution
  use dd3_base_error, only : as_written, error_list_t, location_t
  use dd3_base_text, only : text_t, lower_case, suggestion, join, slice
  use dd3_base_name_index, only : name_index_t
  use dd3_input_block, only : token_t
  use dd3_input_token, only : token_list_t, line_t, split_line, add_token
  implicit none
  private
  public :: substitution_t, new_substitution

  !> Longest name that is compared.
  integer, parameter :: name_length = 64
  !> Most names listed in a message.
  integer, parameter :: most_listed = 40

  !> A parameter.
  type :: binding_t
    !> Name in lower case.
    character(len=:), allocatable :: name
    type(token_list_t) :: value
    !> Where it is defined.
    type(location_t) :: at
    !> Whether its value is given on the command line.
    logical :: overridden = .false.
    !> Whether it is defined in the input.
    logical :: defined = .false.
  end type binding_t

  !> All parameters.
  type :: substitution_t
    integer :: count = 0
    !> In the order of the definitions, `item(1:count)`.
    type(binding_t), allocatable :: item(:)
    type(name_index_t) :: index
  contains
    procedure :: define
    procedure :: expand
    procedure :: check_overrides
  end type substitution_t

contains

  !> Start with the parameters given on the command line.
  subroutine new_substitution(self, overrides, errors)
    type(substitution_t), intent(out) :: self
    !> Texts `name=value`.
    type(text_t), intent(in) :: overrides(:)
    type(error_list_t), intent(inout) :: errors

    type(binding_t) :: binding
    type(line_t) :: line
    logical :: continues
    integer :: i, equals

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
        call errors%push_input(binding%at, "expected --set name=value", code="E103")
        cycle
      end if
      if (position(self, binding%name) > 0) then
        call errors%push_input(binding%at, "parameter '"//binding%name//"' is set twice", &
            code="E122")
      else
        call append(self, binding)
      end if
    end do
  end subroutine new_substitution

  !> Define a parameter of the input; an override keeps its value.
  subroutine define(self, name, value, errors)
    class(substitution_t), intent(inout) :: self
    type(token_t), intent(in) :: name
    !> Value with parameters replaced.
    type(token_list_t), intent(in) :: value
    type(error_list_t), intent(inout) :: errors

    type(binding_t) :: binding
    integer :: i

    i = position(self, name%text)
    if (i == 0) then
      binding%name = lower_case(name%text)
      call append(self, binding)
      i = self%count
    else if (self%item(i)%defined) then
      call errors%push_input(name%at, "parameter '"//name%text//"' is defined twice", code="E122")
      return
    end if
    self%item(i)%at = name%at
    self%item(i)%defined = .true.
    if (.not. self%item(i)%overridden) self%item(i)%value = value
  end subroutine define

  !> Append a parameter.
  subroutine append(self, binding)
    type(substitution_t), intent(inout) :: self
    type(binding_t), intent(in) :: binding

    type(binding_t), allocatable :: larger(:)

    if (.not. allocated(self%item)) allocate (self%item(8))
    if (self%count == size(self%item)) then
      allocate (larger(2*self%count))
      larger(:self%count) = self%item
      call move_alloc(larger, self%item)
    end if
    self%count = self%count + 1
    self%item(self%count) = binding
    call self%index%add(trim(binding%name), self%count)
  end subroutine append

  !> Report overrides of parameters that the input does not define.
  subroutine check_overrides(self, errors)
    class(substitution_t), intent(in) :: self
    type(error_list_t), intent(inout) :: errors

    integer :: i

    do i = 1, self%count
      if (self%item(i)%defined) cycle
      call errors%push_input(self%item(i)%at, "the input defines no parameter '"// &
          self%item(i)%name//"'"//suggestion(self%item(i)%name, defined_names(self)), &
          expected_names(self), code="E115")
    end do
  end subroutine check_overrides

  !> Append a word to a list, with its parameters replaced.
  subroutine expand(self, token, list, errors)
    class(substitution_t), intent(in) :: self
    type(token_t), intent(in) :: token
    type(token_list_t), intent(inout) :: list
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: text, name
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
        call errors%push_input(at, "missing closing brace", "${name}", code="E103")
        return
      end if
      name = slice(token%text, first + k + 1, first + k + last - 2)
      i = position(self, name)
      if (i > 0) then
        if (.not. self%item(i)%defined) i = 0
      end if
      if (i == 0) then
        call errors%push_input(at, "unknown parameter '"//name//"'"// &
            suggestion(name, defined_names(self)), expected_names(self), code="E115")
        return
      end if
      if (last + 1 == len(token%text) .and. .not. token%quoted) then
        do k = 1, self%item(i)%value%count
          associate (word => self%item(i)%value%item(k))
            call add_token(list, word%text, word%quoted, token%at)
          end associate
        end do
        return
      end if
      text = text//slice(token%text, first, first + k - 2)//plain(self%item(i)%value)
      first = first + k + last
    end do
    call add_token(list, text//token%text(first:), token%quoted, token%at)
  end subroutine expand

  !> Return the words of a value separated by single blanks.
  pure function plain(value) result(text)
    type(token_list_t), intent(in) :: value
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    do i = 1, value%count
      if (i > 1) text = text//" "
      text = text//value%item(i)%text
    end do
  end function plain

  !> Return the position of a parameter; 0 if not found.
  pure integer function position(self, name)
    type(substitution_t), intent(in) :: self
    character(len=*), intent(in) :: name

    position = self%index%find(trim(name))
  end function position

  !> Return the names of the parameters defined in the input.
  pure function defined_names(self) result(names)
    type(substitution_t), intent(in) :: self
    character(len=name_length), allocatable :: names(:)

    integer :: i, k

    k = 0
    do i = 1, self%count
      if (self%item(i)%defined) k = k + 1
    end do
    allocate (names(k))
    k = 0
    do i = 1, self%count
      if (.not. self%item(i)%defined) cycle
      k = k + 1
      names(k) = as_written(self%item(i)%name, self%item(i)%at)
    end do
  end function defined_names

  !> Return the names that could be used, as the expectation of an error.
  function expected_names(self) result(text)
    type(substitution_t), intent(in) :: self
    character(len=:), allocatable :: text

    character(len=name_length), allocatable :: names(:)

    allocate (names, source=defined_names(self))
    text = "one of: "//join(names(:min(most_listed, size(names))), " ")
    if (size(names) > most_listed) text = text//" ..."
    if (size(names) == 0) text = "a parameter of a *PARAMETER block above; none is defined"
  end function expected_names

end module dd3_input_substitution
