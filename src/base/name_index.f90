! SPDX-License-Identifier: GPL-3.0-or-later
!> Index of names: finds the number of a name in a time that does not depend on how many there are.
!> Hash table with open addressing (Knuth, The Art of Computer Programming, vol. 3, 6.4); the hash
!> is FNV-1a (Fowler, Noll, Vo), reduced to 31 bits.
module dd3_base_name_index
  use dd3_base_kinds, only : i8
  use dd3_base_text, only : lower_case, text_t
  implicit none
  private
  public :: name_index_t

  !> Names, regardless of case, with a number each.
  type :: name_index_t
    integer, private :: count = 0
    !> Names in lower case; not allocated where a place is free.
    type(text_t), allocatable, private :: name(:)
    integer, allocatable, private :: number(:)
  contains
    procedure :: add
    procedure :: find
    procedure, private :: place
    procedure, private :: grow
  end type name_index_t

contains

  !> Add a name with a number; no-op if it is there already.
  subroutine add(self, name, number)
    class(name_index_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: number

    integer :: k

    call self%grow()
    k = self%place(lower_case(name))
    if (allocated(self%name(k)%s)) return
    self%name(k)%s = lower_case(name)
    self%number(k) = number
    self%count = self%count + 1
  end subroutine add

  !> Return the number of a name; 0 if it is not there.
  pure integer function find(self, name)
    class(name_index_t), intent(in) :: self
    character(len=*), intent(in) :: name

    integer :: k

    find = 0
    if (self%count == 0) return
    k = self%place(lower_case(name))
    if (allocated(self%name(k)%s)) find = self%number(k)
  end function find

  !> Return the place of a name, or the free place where it belongs.
  pure integer function place(self, name) result(k)
    class(name_index_t), intent(in) :: self
    !> In lower case.
    character(len=*), intent(in) :: name

    k = modulo(hash(name), size(self%name)) + 1
    do
      if (.not. allocated(self%name(k)%s)) return
      if (len(self%name(k)%s) == len(name)) then
        if (self%name(k)%s == name) return
      end if
      k = modulo(k, size(self%name)) + 1
    end do
  end function place

  !> Make room for a further name: at most half of the places are used.
  subroutine grow(self)
    class(name_index_t), intent(inout) :: self

    type(text_t), allocatable :: old(:)
    integer, allocatable :: number(:)
    integer :: i, k

    if (.not. allocated(self%name)) allocate (self%name(16), self%number(16))
    if (2*self%count < size(self%name)) return
    call move_alloc(self%name, old)
    call move_alloc(self%number, number)
    allocate (self%name(2*size(old)), self%number(2*size(old)))
    do i = 1, size(old)
      if (.not. allocated(old(i)%s)) cycle
      k = self%place(old(i)%s)
      call move_alloc(old(i)%s, self%name(k)%s)
      self%number(k) = number(i)
    end do
  end subroutine grow

  !> Return the hash of a text.
  pure integer function hash(text)
    character(len=*), intent(in) :: text

    integer(i8), parameter :: start = 2166136261_i8, prime = 16777619_i8, bits = 2_i8**31 - 1
    integer(i8) :: value
    integer :: i

    value = iand(start, bits)
    do i = 1, len(text)
      value = iand(ieor(value, int(iachar(text(i:i)), i8))*prime, bits)
    end do
    hash = int(value)
  end function hash

end module dd3_base_name_index
