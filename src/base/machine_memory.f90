! SPDX-License-Identifier: GPL-3.0-or-later
!> Memory of the program and of the machine (Linux).
module dd3_base_machine_memory
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: resident_memory, available_memory

contains

  !> Return the memory that the program occupies, bytes; 0 if it is unknown.
  real(wp) function resident_memory()
    resident_memory = entry("/proc/self/status", "VmRSS:")
  end function resident_memory

  !> Return the memory of the machine that programs can still have, bytes; 0 if it is unknown.
  real(wp) function available_memory()
    available_memory = entry("/proc/meminfo", "MemAvailable:")
  end function available_memory

  !> Return an entry, given in kB, of a file of the kernel, bytes; 0 if there is none.
  real(wp) function entry(file, name) result(bytes)
    character(len=*), intent(in) :: file, name

    character(len=80) :: line
    integer :: unit, status

    bytes = 0.0_wp
    open (newunit=unit, file=file, action="read", status="old", iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, name) /= 1) cycle
      read (line(len(name) + 1:), *, iostat=status) bytes
      bytes = merge(1024.0_wp*bytes, 0.0_wp, status == 0)
      exit
    end do
    close (unit)
  end function entry

end module dd3_base_machine_memory
