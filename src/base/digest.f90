! SPDX-License-Identifier: GPL-3.0-or-later
!> Check sum of data, to compare two sets of data.
!> Source: CRC-32 of ISO 3309, reflected polynomial EDB88320.
module dd3_base_digest
  use, intrinsic :: iso_fortran_env, only : int8
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: digest_t

  !> Running check sum.
  type :: digest_t
    integer, private :: remainder = -1
  contains
    procedure, private :: add_text, add_integers, add_reals, add_logicals
    generic :: add => add_text, add_integers, add_reals, add_logicals
    procedure :: value => digest_value
  end type digest_t

contains

  !> Add a text to the check sum.
  subroutine add_text(self, text)
    class(digest_t), intent(inout) :: self
    character(len=*), intent(in) :: text

    call add_bytes(self, transfer(text, [0_int8]))
  end subroutine add_text

  !> Add integers to the check sum.
  subroutine add_integers(self, values)
    class(digest_t), intent(inout) :: self
    integer, intent(in) :: values(:)

    call add_bytes(self, transfer(values, [0_int8]))
  end subroutine add_integers

  !> Add real numbers to the check sum.
  subroutine add_reals(self, values)
    class(digest_t), intent(inout) :: self
    real(wp), intent(in) :: values(:)

    call add_bytes(self, transfer(values, [0_int8]))
  end subroutine add_reals

  !> Add logical values to the check sum.
  subroutine add_logicals(self, values)
    class(digest_t), intent(inout) :: self
    logical, intent(in) :: values(:)

    call self%add(merge(1, 0, values))
  end subroutine add_logicals

  !> Add bytes to the check sum.
  subroutine add_bytes(self, bytes)
    type(digest_t), intent(inout) :: self
    integer(int8), intent(in) :: bytes(:)

    integer, parameter :: polynomial = int(z'6DB88320') - huge(1) - 1
    integer :: i, k

    do i = 1, size(bytes)
      self%remainder = ieor(self%remainder, iand(int(bytes(i)), 255))
      do k = 1, 8
        if (btest(self%remainder, 0)) then
          self%remainder = ieor(shiftr(self%remainder, 1), polynomial)
        else
          self%remainder = shiftr(self%remainder, 1)
        end if
      end do
    end do
  end subroutine add_bytes

  !> Return the check sum of all that was added.
  pure integer function digest_value(self)
    class(digest_t), intent(in) :: self

    digest_value = not(self%remainder)
  end function digest_value

end module dd3_base_digest
