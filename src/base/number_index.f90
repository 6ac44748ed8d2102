! SPDX-License-Identifier: GPL-3.0-or-later
!> Index of numbers: finds the position of a label in a time that does not depend on how many there
!> are. Hash table with open addressing (Knuth, The Art of Computer Programming, vol. 3, 6.4) and
!> multiplicative hashing.
module dd3_base_number_index
  use dd3_base_kinds, only : i8
  implicit none
  private
  public :: number_index_t, new_number_index

  !> Positive labels with a position each.
  type :: number_index_t
    !> Labels; 0 where a place is free.
    integer, allocatable, private :: label(:)
    integer, allocatable, private :: position(:)
  contains
    procedure :: add
    procedure :: find
    procedure, private :: place
  end type number_index_t

contains

  !> Make an empty index.
  pure subroutine new_number_index(self, n)
    type(number_index_t), intent(out) :: self
    !> Largest number of labels that will be added.
    integer, intent(in) :: n

    integer :: room

    room = 16
    do while (room < 2*n)
      room = 2*room
    end do
    allocate (self%label(room), self%position(room), source=0)
  end subroutine new_number_index

  !> Add a label; if it is there already, return its position, else 0.
  pure subroutine add(self, label, position, earlier)
    class(number_index_t), intent(inout) :: self
    !> Positive.
    integer, intent(in) :: label
    integer, intent(in) :: position
    integer, intent(out) :: earlier

    integer :: k

    k = self%place(label)
    earlier = self%position(k)
    if (earlier > 0) return
    self%label(k) = label
    self%position(k) = position
  end subroutine add

  !> Return the position of a label; 0 if it is not there.
  pure integer function find(self, label)
    class(number_index_t), intent(in) :: self
    !> Positive.
    integer, intent(in) :: label

    find = self%position(self%place(label))
  end function find

  !> Return the place of a label, or the free place where it belongs.
  pure integer function place(self, label) result(k)
    class(number_index_t), intent(in) :: self
    integer, intent(in) :: label

    integer(i8), parameter :: factor = 2654435769_i8

    k = int(modulo(ishft(iand(int(label, i8)*factor, 4294967295_i8), -4), &
        int(size(self%label), i8))) + 1
    do while (self%label(k) /= 0 .and. self%label(k) /= label)
      k = modulo(k, size(self%label)) + 1
    end do
  end function place

end module dd3_base_number_index
