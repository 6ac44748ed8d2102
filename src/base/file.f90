!> Text files whose every write is checked. The flush of the Fortran library does not report a full
!> disk, so these go through the POSIX calls creat, write, ftruncate and close. After a failed
!> write the file is cut back to its last whole line. A file may keep room on the disk for what its
!> buffer holds: a full disk is then found while all lines can still be written.
module dd3_base_file
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_size_t, c_long, c_ptr, c_null_char, &
      c_f_pointer, c_associated
  use dd3_base_kinds, only : wp, i8
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_clock, only : wall_time
  use dd3_base_text, only : newline
  implicit none
  private
  public :: file_t, make_directory, remove_file, standard_output

  !> Descriptor of the standard output.
  integer, parameter :: standard_output = 1
  !> Characters gathered before they are handed to the system.
  integer(i8), parameter :: buffer_size = 16384
  !> Room kept on the disk: for a full buffer, and for what is added while a run comes to its end.
  integer(i8), parameter :: room_kept = 2*buffer_size
  !> Longest time a line waits in the buffer while others follow, s.
  real(wp), parameter :: longest_wait = 1.0_wp
  !> Error numbers of Linux: interrupted call, file exists, too large, disk full, quota used up.
  integer(c_int), parameter :: eintr = 4, eexist = 17, efbig = 27, enospc = 28, edquot = 122
  !> Linux' limit on the size of a file, as `getrlimit` knows it.
  integer(c_int), parameter :: rlimit_fsize = 1
  !> Reserving room leaves the size of the file as it is (Linux).
  integer(c_int), parameter :: keep_size = 1

  !> A text file open for writing.
  type :: file_t
    character(len=:), allocatable :: path
    !> Descriptor; negative when closed.
    integer(c_int) :: descriptor = -1
    !> Text not written yet: `buffer(1:used)`.
    character(len=:), allocatable :: buffer
    !> Characters waiting in the buffer.
    integer(i8) :: used = 0
    !> Length of the file up to the end of its last whole line, and of all that is written.
    integer(i8) :: whole = 0, length = 0
    !> When the buffer was written last, s.
    real(wp) :: flushed = 0.0_wp
    !> Whether a write failed.
    logical :: failed = .false.
    !> Whether room is kept for what waits; whether it was said that there is none any more.
    logical :: keeps_room = .false., full = .false.
  contains
    procedure :: create => file_create
    procedure :: attach => file_attach
    procedure :: put => file_put
    procedure :: flush => file_flush
    procedure :: keep_room => file_keep_room
    procedure :: reserve => file_reserve
    procedure :: release => file_release
    procedure :: close => file_close
  end type file_t

  interface
    !> creat(2).
    integer(c_int) function posix_creat(path, mode) bind(c, name="creat")
      import :: c_char, c_int
      !> Name of the file, ended by a null.
      character(kind=c_char), intent(in) :: path(*)
      !> Permissions.
      integer(c_int), value :: mode
    end function posix_creat
    !> write(2).
    integer(c_size_t) function posix_write(descriptor, buffer, count) bind(c, name="write")
      import :: c_char, c_int, c_size_t
      !> Descriptor of the file.
      integer(c_int), value :: descriptor
      !> The characters.
      character(kind=c_char), intent(in) :: buffer(*)
      !> How many there are.
      integer(c_size_t), value :: count
    end function posix_write
    !> ftruncate(2).
    integer(c_int) function posix_ftruncate(descriptor, length) bind(c, name="ftruncate")
      import :: c_int, c_long
      !> Descriptor of the file.
      integer(c_int), value :: descriptor
      !> Its new length.
      integer(c_long), value :: length
    end function posix_ftruncate
    !> lseek(2).
    integer(c_long) function posix_lseek(descriptor, offset, whence) bind(c, name="lseek")
      import :: c_int, c_long
      !> Descriptor of the file; what the offset counts from.
      integer(c_int), value :: descriptor, whence
      !> The offset.
      integer(c_long), value :: offset
    end function posix_lseek
    !> close(2).
    integer(c_int) function posix_close(descriptor) bind(c, name="close")
      import :: c_int
      !> Descriptor of the file.
      integer(c_int), value :: descriptor
    end function posix_close
    !> fallocate(2).
    integer(c_int) function linux_fallocate(descriptor, mode, offset, length) &
      bind(c, name="fallocate")
      import :: c_int, c_long
      !> Descriptor of the file; how room is reserved.
      integer(c_int), value :: descriptor, mode
      !> Where the room begins, and its length.
      integer(c_long), value :: offset, length
    end function linux_fallocate
    !> getrlimit(2).
    integer(c_int) function posix_getrlimit(resource, limits) bind(c, name="getrlimit")
      import :: c_int, c_long
      !> What is limited.
      integer(c_int), value :: resource
      !> The limit that holds, and the largest it may be raised to.
      integer(c_long), intent(out) :: limits(2)
    end function posix_getrlimit
    !> mkdir(2).
    integer(c_int) function posix_mkdir(path, mode) bind(c, name="mkdir")
      import :: c_char, c_int
      !> Name of the directory, ended by a null.
      character(kind=c_char), intent(in) :: path(*)
      !> Permissions.
      integer(c_int), value :: mode
    end function posix_mkdir
    !> unlink(2).
    integer(c_int) function posix_unlink(path) bind(c, name="unlink")
      import :: c_char, c_int
      !> Name of the file, ended by a null.
      character(kind=c_char), intent(in) :: path(*)
    end function posix_unlink
    !> readlink(2).
    integer(c_size_t) function posix_readlink(path, buffer, size) bind(c, name="readlink")
      import :: c_char, c_int, c_size_t
      !> Name of the link, ended by a null.
      character(kind=c_char), intent(in) :: path(*)
      !> Receives what the link leads to.
      character(kind=c_char), intent(out) :: buffer(*)
      !> Room in the buffer.
      integer(c_size_t), value :: size
    end function posix_readlink
    !> Address of the last error number.
    type(c_ptr) function errno_location() bind(c, name="__errno_location")
      import :: c_ptr
    end function errno_location
    !> strerror(3).
    type(c_ptr) function c_strerror(number) bind(c, name="strerror")
      import :: c_int, c_ptr
      !> Number of the error.
      integer(c_int), value :: number
    end function c_strerror
    !> strlen(3).
    integer(c_size_t) function c_strlen(text) bind(c, name="strlen")
      import :: c_ptr, c_size_t
      !> Address of the text, ended by a null.
      type(c_ptr), value :: text
    end function c_strlen
  end interface

contains

  !> Open a new, empty file in place of any old one.
  subroutine file_create(self, path, error)
    class(file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error
    integer(c_int), parameter :: mode = int(o'666', c_int)

    call self%attach(posix_creat(path//c_null_char, mode), path)
    if (self%descriptor < 0) then
      self%failed = .true.
      call fatal_error(error, "cannot write '"//path//"': "//system_message(errno()))
    end if
  end subroutine file_create

  !> Make the file stand for a descriptor that is open.
  subroutine file_attach(self, descriptor, path)
    class(file_t), intent(inout) :: self
    integer(c_int), intent(in) :: descriptor
    !> The name it has in messages.
    character(len=*), intent(in) :: path

    self%path = path
    self%descriptor = descriptor
    if (.not. allocated(self%buffer)) allocate (character(len=buffer_size) :: self%buffer)
    self%used = 0
    self%whole = 0
    self%length = 0
    self%failed = .false.
    self%keeps_room = .false.
    self%full = .false.
    self%flushed = wall_time()
  end subroutine file_attach

  !> Add text; it is written when the buffer is full or has waited long enough.
  subroutine file_put(self, text, error)
    class(file_t), intent(inout) :: self
    !> The text, with its own ends of lines.
    character(len=*), intent(in) :: text
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: late
    integer(i8) :: first, n

    if (self%failed) return
    first = 1
    do while (first <= len(text, i8))
      if (self%used == buffer_size) then
        call self%flush(late)
        if (allocated(late)) call move_alloc(late, error)
        if (self%failed) return
      end if
      n = min(len(text, i8) - first + 1, buffer_size - self%used)
      self%buffer(self%used + 1:self%used + n) = text(first:first + n - 1)
      self%used = self%used + n
      first = first + n
    end do
    if (wall_time() - self%flushed <= longest_wait) return
    call self%flush(late)
    if (allocated(late)) call move_alloc(late, error)
  end subroutine file_put

  !> Write what waits to the system, into the room kept for it; an error says that no more can be
  !> kept.
  subroutine file_flush(self, error)
    class(file_t), intent(inout) :: self
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error
    integer(i8) :: first
    integer(c_size_t) :: n
    integer(c_int) :: status, cause

    self%flushed = wall_time()
    if (self%failed .or. self%descriptor < 0) return
    cause = 0
    if (self%keeps_room .and. .not. self%full) then
      call try_to_reserve(self, self%length, self%used + room_kept, cause)
      self%full = cause /= 0
    end if
    first = 1
    do while (first <= self%used)
      n = posix_write(self%descriptor, self%buffer(first:self%used), &
                      int(self%used - first + 1, c_size_t))
      if (n < 0) then
        if (errno() == eintr) cycle
      end if
      if (n <= 0) then
        self%failed = .true.
        call fatal_error(error, "cannot write '"//self%path//"': "//system_message(errno()))
        if (self%descriptor > standard_output) then
          status = posix_ftruncate(self%descriptor, int(self%whole, c_long))
        end if
        exit
      end if
      call count_written(self, self%buffer(first:first + n - 1))
      first = first + n
    end do
    self%used = 0
    if (self%failed .or. cause == 0) return
    call fatal_error(error, "cannot write '"//self%path//"': "//system_message(cause))
  end subroutine file_flush

  !> From now on room is kept on the disk for what waits in the buffer.
  subroutine file_keep_room(self, error)
    !> The file, open.
    class(file_t), intent(inout) :: self
    !> Says why there is no room.
    type(error_t), allocatable, intent(out) :: error

    self%keeps_room = .true.
    call self%flush(error)
  end subroutine file_keep_room

  !> Keep the book of the file's length and of its whole lines.
  subroutine count_written(self, text)
    class(file_t), intent(inout) :: self
    !> What was written.
    character(len=*), intent(in) :: text
    integer(i8) :: end_of_line

    end_of_line = index(text, newline, back=.true., kind=i8)
    if (end_of_line > 0) self%whole = self%length + end_of_line
    self%length = self%length + len(text, i8)
  end subroutine count_written

  !> Reserve room on the disk for what another library is about to write behind the file's end. On
  !> a file system that cannot reserve, the writes themselves tell.
  subroutine file_reserve(self, size, more, error)
    class(file_t), intent(inout) :: self
    !> Its size now, and how much it may grow.
    integer(i8), intent(in) :: size, more
    !> Says why there is no room.
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: cause

    call try_to_reserve(self, size, more, cause)
    if (cause == 0) return
    call self%release()
    call fatal_error(error, "cannot write '"//self%path//"': "//system_message(cause))
  end subroutine file_reserve

  !> Reserve room behind the file's end.
  subroutine try_to_reserve(self, size, more, cause)
    class(file_t), intent(in) :: self
    !> Its size now, and how much it may grow.
    integer(i8), intent(in) :: size, more
    !> Why there is no room; 0: there is, or the file system does not tell.
    integer(c_int), intent(out) :: cause
    integer(c_long) :: limits(2)

    cause = 0
    if (posix_getrlimit(rlimit_fsize, limits) == 0) then
      if (limits(1) >= 0 .and. limits(1) < size + more) cause = efbig
    end if
    if (cause == 0) then
      if (linux_fallocate(self%descriptor, keep_size, int(size, c_long), &
                          int(more, c_long)) /= 0) cause = errno()
    end if
    if (cause /= efbig .and. cause /= enospc .and. cause /= edquot) cause = 0
  end subroutine try_to_reserve

  !> Return back the room that is reserved and not used.
  subroutine file_release(self)
    class(file_t), intent(inout) :: self
    integer(c_int), parameter :: from_end = 2
    integer(c_long) :: size
    integer(c_int) :: ignored

    size = posix_lseek(self%descriptor, 0_c_long, from_end)
    if (size >= 0) ignored = posix_ftruncate(self%descriptor, size)
  end subroutine file_release

  !> Write what waits and closes the file; nothing happens where it is closed.
  subroutine file_close(self, error)
    class(file_t), intent(inout) :: self
    !> Says why the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    if (self%descriptor < 0) return
    call self%flush(error)
    if (self%keeps_room) call self%release()
    status = posix_close(self%descriptor)
    self%descriptor = -1
    if (status /= 0 .and. .not. self%failed) then
      call fatal_error(error, "cannot write '"//self%path//"': "//system_message(errno()))
    end if
  end subroutine file_close

  !> Make a directory and those above it; one that exists is fine.
  subroutine make_directory(path, error)
    character(len=*), intent(in) :: path
    !> Says why it cannot be made.
    type(error_t), allocatable, intent(out) :: error
    integer(c_int), parameter :: mode = int(o'777', c_int)
    integer(c_int) :: status
    integer :: i

    do i = 2, len(path) - 1
      if (path(i:i) == "/") status = posix_mkdir(path(:i - 1)//c_null_char, mode)
    end do
    status = posix_mkdir(path//c_null_char, mode)
    if (status /= 0) then
      if (errno() /= eexist) call fatal_error(error, "cannot make the directory '"//path//"': " &
                                              //system_message(errno()))
    end if
  end subroutine make_directory

  !> Remove a file. A symbolic link is left: what it leads to was chosen by the user.
  subroutine remove_file(path, removed)
    character(len=*), intent(in) :: path
    !> Whether it was there and is there no more.
    logical, intent(out) :: removed
    character(kind=c_char) :: target(1)

    removed = .false.
    if (posix_readlink(path//c_null_char, target, 1_c_size_t) >= 0) return
    removed = posix_unlink(path//c_null_char) == 0
  end subroutine remove_file

  !> The number of the last system error.
  integer(c_int) function errno()
    integer(c_int), pointer :: number

    call c_f_pointer(errno_location(), number)
    errno = number
  end function errno

  !> A system error in words.
  function system_message(number) result(message)
    !> Its number.
    integer(c_int), intent(in) :: number
    character(len=:), allocatable :: message
    character(kind=c_char), pointer :: letter(:)
    type(c_ptr) :: address
    integer :: i

    message = "unknown cause"
    address = c_strerror(number)
    if (.not. c_associated(address)) return
    call c_f_pointer(address, letter, [c_strlen(address)])
    message = repeat(" ", size(letter, kind=i8))
    do i = 1, size(letter)
      message(i:i) = letter(i)
    end do
  end function system_message

end module dd3_base_file
