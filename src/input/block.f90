! SPDX-License-Identifier: GPL-3.0-or-later
!> The words of the input, grouped into blocks: `*BLOCK name`, followed by lines
!> `key = value value ...`. Every word keeps its location.
module dd3_input_block
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : as_written, location_t
  use dd3_base_text, only : same_name, text_t
  implicit none
  private
  public :: token_t, entry_t, block_t, deck_t

  !> One word of the input.
  type :: token_t
    !> Word without quotes, with parameters replaced.
    character(len=:), allocatable :: text
    !> Whether it was in quotes.
    logical :: quoted = .false.
    type(location_t) :: at
  end type token_t

  !> One line `key = value value ...`; for a title, one line of free text.
  type :: entry_t
    !> Key in lower case.
    character(len=:), allocatable :: key
    !> Where the key is written.
    type(location_t) :: at
    !> Words after the equals sign.
    type(token_t), allocatable :: value(:)
    !> Numbers among the values, in order; during the check `number(1:n_number)`. This and the
    !> following are set by the check.
    real(wp), allocatable :: number(:)
    integer :: n_number = 0
    !> Whether the value has the expected form and range.
    logical :: valid = .true.
    !> Whether the value is `off` in place of a number.
    logical :: is_off = .false.
    !> Whether this is the default of a key that was left out.
    logical :: defaulted = .false.
  contains
    procedure :: add_number
    procedure :: trim_numbers
  end type entry_t

  !> Keyword block of the input.
  type :: block_t
    !> Word after the star, in lower case.
    character(len=:), allocatable :: keyword
    !> The block's own name in lower case; empty if it has none.
    character(len=:), allocatable :: name
    !> Where the block begins.
    type(location_t) :: opened
    !> Where its name is written; where it begins if it has none.
    type(location_t) :: named
    !> Folder of the file that contains the block, with a slash at the end; empty for the working
    !> directory.
    character(len=:), allocatable :: folder
    !> Whether the block and all its entries passed the check.
    logical :: valid = .true.
    integer :: n_entry = 0
    !> Entries, `entry(1:n_entry)`.
    type(entry_t), allocatable :: entry(:)
  contains
    procedure :: find
    procedure :: has
    procedure :: given
    procedure :: word
    procedure :: number
    procedure :: numbers
    procedure :: at
    procedure :: called
    procedure :: add_entry
  end type block_t

  !> The whole input as blocks, with included files inserted.
  type :: deck_t
    integer :: n_block = 0
    !> Blocks, `block(1:n_block)`.
    type(block_t), allocatable :: block(:)
    !> Names of the files read, the input file first.
    type(text_t), allocatable :: file(:)
  contains
    procedure :: add_block
  end type deck_t

contains

  !> Append a number during the check.
  subroutine add_number(self, value)
    class(entry_t), intent(inout) :: self
    real(wp), intent(in) :: value

    real(wp), allocatable :: larger(:)

    if (self%n_number == size(self%number)) then
      allocate (larger(2*self%n_number + 4))
      larger(:self%n_number) = self%number
      call move_alloc(larger, self%number)
    end if
    self%n_number = self%n_number + 1
    self%number(self%n_number) = value
  end subroutine add_number

  !> End the check: leave no room for further numbers.
  subroutine trim_numbers(self)
    class(entry_t), intent(inout) :: self

    self%number = self%number(:self%n_number)
  end subroutine trim_numbers

  !> Return the position of the first entry with a key; 0 if not found.
  pure integer function find(self, key, after)
    class(block_t), intent(in) :: self
    character(len=*), intent(in) :: key
    !> Entry after which the search begins.
    integer, intent(in), optional :: after

    integer :: start

    start = 1
    if (present(after)) start = after + 1
    do find = start, self%n_entry
      if (same_name(self%entry(find)%key, key)) return
    end do
    find = 0
  end function find

  !> Whether a key has a valid value, given or by default.
  pure logical function has(self, key)
    class(block_t), intent(in) :: self
    character(len=*), intent(in) :: key

    integer :: i

    i = self%find(key)
    has = i > 0
    if (has) has = self%entry(i)%valid
  end function has

  !> Whether a key has a valid value that is not its default.
  pure logical function given(self, key)
    class(block_t), intent(in) :: self
    character(len=*), intent(in) :: key

    given = self%has(key)
    if (given) given = .not. self%entry(self%find(key))%defaulted
  end function given

  !> Return the first word of a key's value; empty if it has no valid value.
  pure function word(self, key)
    class(block_t), intent(in) :: self
    character(len=*), intent(in) :: key
    character(len=:), allocatable :: word

    word = ""
    if (self%has(key)) word = self%entry(self%find(key))%value(1)%text
  end function word

  !> Return the first number of a key's value; 0 if it has none.
  pure real(wp) function number(self, key)
    class(block_t), intent(in) :: self
    character(len=*), intent(in) :: key

    integer :: i

    number = 0.0_wp
    if (.not. self%has(key)) return
    i = self%find(key)
    if (size(self%entry(i)%number) > 0) number = self%entry(i)%number(1)
  end function number

  !> Return the numbers of a key's value; size 0 if it has no valid value.
  pure function numbers(self, key)
    class(block_t), intent(in) :: self
    character(len=*), intent(in) :: key
    real(wp), allocatable :: numbers(:)

    if (self%has(key)) then
      numbers = self%entry(self%find(key))%number
    else
      allocate (numbers(0))
    end if
  end function numbers

  !> Return where the value of a key is written; where the block begins if it was left out.
  function at(self, key)
    class(block_t), intent(in) :: self
    character(len=*), intent(in) :: key
    type(location_t) :: at

    integer :: i

    at = self%opened
    i = self%find(key)
    if (i == 0) return
    if (self%entry(i)%defaulted) return
    at = self%entry(i)%at
    if (.not. allocated(self%entry(i)%value)) return
    if (size(self%entry(i)%value) > 0) at = self%entry(i)%value(1)%at
  end function at

  !> Return the block's own name as written.
  pure function called(self)
    class(block_t), intent(in) :: self
    character(len=:), allocatable :: called

    called = as_written(self%name, self%named)
  end function called

  subroutine add_entry(self, entry)
    class(block_t), intent(inout) :: self
    type(entry_t), intent(in) :: entry

    type(entry_t), allocatable :: larger(:)

    if (.not. allocated(self%entry)) allocate (self%entry(8))
    if (self%n_entry == size(self%entry)) then
      allocate (larger(2*self%n_entry))
      larger(:self%n_entry) = self%entry
      call move_alloc(larger, self%entry)
    end if
    self%n_entry = self%n_entry + 1
    self%entry(self%n_entry) = entry
  end subroutine add_entry

  subroutine add_block(self, block)
    class(deck_t), intent(inout) :: self
    type(block_t), intent(in) :: block

    type(block_t), allocatable :: larger(:)

    if (.not. allocated(self%block)) allocate (self%block(8))
    if (self%n_block == size(self%block)) then
      allocate (larger(2*self%n_block))
      larger(:self%n_block) = self%block
      call move_alloc(larger, self%block)
    end if
    self%n_block = self%n_block + 1
    self%block(self%n_block) = block
  end subroutine add_block

end module dd3_input_block
