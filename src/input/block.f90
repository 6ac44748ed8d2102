!> The words of the input text, gathered into blocks: `*BLOCK name` and below it `key = value value
!> ...`.
!> Every word remembers where it was written.
module dd3_input_block
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : as_written, location_t
  use dd3_base_text, only : same_name
  implicit none
  private
  public :: token_t, entry_t, block_t, deck_t

  !> One word of the input.
  type :: token_t
    !> The word, without its quotes, parameters replaced.
    character(len=:), allocatable :: text
    !> Whether it stood in quotes.
    logical :: quoted = .false.
    !> Where it was written.
    type(location_t) :: at
  end type token_t

  !> One line `key = value value ...`; for a title, one line of free text.
  type :: entry_t
    !> The key, in small letters.
    character(len=:), allocatable :: key
    !> Where the key was written.
    type(location_t) :: at
    !> What stands right of the equals sign.
    type(token_t), allocatable :: value(:)
    !> The numbers among the values, in order; filled by the check.
    real(wp), allocatable :: number(:)
    !> Whether the value has the form and the range asked for; set by the check.
    logical :: valid = .true.
    !> Whether `off` stands in place of the numbers; set by the check.
    logical :: is_off = .false.
    !> Whether the key was left out and this is its default; set by the check.
    logical :: defaulted = .false.
  end type entry_t

  !> One block.
  type :: block_t
    !> What kind of block: the word after the star, in small letters.
    character(len=:), allocatable :: keyword
    !> The block's own name, in small letters; empty where it has none.
    character(len=:), allocatable :: name
    !> Where the block was opened.
    type(location_t) :: opened
    !> Where its name was written; where it was opened if it has none.
    type(location_t) :: named
    !> Folder of the file that holds the block, with a slash at the end; empty for the working
    !> directory.
    character(len=:), allocatable :: folder
    !> Whether the block and all its entries passed the check.
    logical :: valid = .true.
    !> Number of entries.
    integer :: n_entry = 0
    !> The entries, `entry(1:n_entry)`.
    type(entry_t), allocatable :: entry(:)
  contains
    procedure :: find
    procedure :: has
    procedure :: word
    procedure :: number
    procedure :: numbers
    procedure :: at
    procedure :: called
    procedure :: add_entry
  end type block_t

  !> The whole input as blocks, included files unfolded.
  type :: deck_t
    !> Number of blocks.
    integer :: n_block = 0
    !> The blocks, `block(1:n_block)`.
    type(block_t), allocatable :: block(:)
  contains
    procedure :: add_block
  end type deck_t

contains

  !> Position of the first entry with a key after a given one; 0 if there is none.
  pure integer function find(self, key, after)
    !> The block.
    class(block_t), intent(in) :: self
    !> The key.
    character(len=*), intent(in) :: key
    !> The entry after which the search begins; the first one when left out.
    integer, intent(in), optional :: after

    integer :: start

    start = 1
    if (present(after)) start = after + 1
    do find = start, self%n_entry
      if (same_name(self%entry(find)%key, key)) return
    end do
    find = 0
  end function find

  !> Whether a key has a value that passed the check, its default included.
  pure logical function has(self, key)
    !> The block.
    class(block_t), intent(in) :: self
    !> The key.
    character(len=*), intent(in) :: key

    integer :: i

    i = self%find(key)
    has = i > 0
    if (has) has = self%entry(i)%valid
  end function has

  !> The first word of a key's value; empty where there is none.
  pure function word(self, key)
    !> The block.
    class(block_t), intent(in) :: self
    !> The key.
    character(len=*), intent(in) :: key
    character(len=:), allocatable :: word

    word = ""
    if (self%has(key)) word = self%entry(self%find(key))%value(1)%text
  end function word

  !> The first number of a key's value; 0 where there is none.
  pure real(wp) function number(self, key)
    !> The block.
    class(block_t), intent(in) :: self
    !> The key.
    character(len=*), intent(in) :: key

    integer :: i

    number = 0.0_wp
    if (.not. self%has(key)) return
    i = self%find(key)
    if (size(self%entry(i)%number) > 0) number = self%entry(i)%number(1)
  end function number

  !> The numbers of a key's value; none where there is no value.
  pure function numbers(self, key)
    !> The block.
    class(block_t), intent(in) :: self
    !> The key.
    character(len=*), intent(in) :: key
    real(wp), allocatable :: numbers(:)

    if (self%has(key)) then
      numbers = self%entry(self%find(key))%number
    else
      allocate (numbers(0))
    end if
  end function numbers

  !> Where the value of a key was written; where the block was opened if it was left out.
  function at(self, key)
    !> The block.
    class(block_t), intent(in) :: self
    !> The key.
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

  !> The block's own name as the user wrote it.
  pure function called(self)
    !> The block.
    class(block_t), intent(in) :: self
    character(len=:), allocatable :: called

    called = as_written(self%name, self%named)
  end function called

  !> Appends an entry.
  subroutine add_entry(self, entry)
    !> The block.
    class(block_t), intent(inout) :: self
    !> The entry.
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

  !> Appends a block.
  subroutine add_block(self, block)
    !> The deck.
    class(deck_t), intent(inout) :: self
    !> The block.
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
