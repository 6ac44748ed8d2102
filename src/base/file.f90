! SPDX-License-Identifier: GPL-3.0-or-later
!> Text files with checked writes. The flush of the Fortran library does not report a full disk, so
!> these files use the POSIX calls creat, write, ftruncate and close. After a failed write the file
!> is truncated to its last complete line. A file may reserve disk space for its buffer: a full disk
!> is then detected while all lines can still be written.
!>
!> Text is written in the pieces in which it is put, so that a program that is killed leaves whole
!> lines if whole lines are put, unless the system cuts a write at the end of a page. Each flush
!> checks that the file still has its name: a file that was removed or replaced, as with its folder,
!> is an error.
module dd3_base_file
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_size_t, c_long, c_null_char
  use dd3_base_kinds, only : wp, i8
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_clock, only : wall_time
  use dd3_base_identity, only : is_at, is_same_file
  use dd3_base_lock, only : open_locked
  use dd3_base_posix, only : linux_fallocate, posix_close, posix_creat, posix_ftruncate, &
      posix_getrlimit, posix_lseek, posix_mkdir, posix_readlink, posix_unlink, posix_write
  use dd3_base_system_error, only : errno, system_message
  use dd3_base_text, only : newline
  implicit none
  private
  public :: file_t, make_directory, remove_file, folder_of, standard_output

  !> Descriptor of the standard output.
  integer, parameter :: standard_output = 1
  !> Size of the buffer in characters; it grows for longer pieces of text.
  integer(i8), parameter :: buffer_size = 16384
  !> Reserved disk space: a full buffer, and the lines written while a run stops.
  integer(i8), parameter :: room_kept = 2*buffer_size
  !> Maximum age of the buffer when text is added, and maximum time between two pieces of text that
  !> share a write, s: what comes slowly is written at once.
  real(wp), parameter :: longest_wait = 1.0_wp, longest_pause = 0.05_wp
  !> Error numbers of Linux: interrupted call, file exists, file too large, disk full, over quota.
  integer(c_int), parameter :: eintr = 4, eexist = 17, efbig = 27, enospc = 28, edquot = 122
  !> Message on a file or folder that is gone.
  character(len=*), parameter :: lost = " was removed or replaced while the program was "// &
      "writing it; what was written to it is lost"
  !> Resource number of the file size limit (Linux).
  integer(c_int), parameter :: rlimit_fsize = 1
  !> Mode of fallocate that keeps the file size (Linux).
  integer(c_int), parameter :: keep_size = 1

  !> A text file open for writing.
  type :: file_t
    character(len=:), allocatable :: path
    !> Negative if closed.
    integer(c_int) :: descriptor = -1
    !> Text not yet written, `buffer(1:used)`.
    character(len=:), allocatable :: buffer
    integer(i8) :: used = 0
    !> Length of the file: up to the last complete line, and in total.
    integer(i8) :: whole = 0, length = 0
    !> Times of the last flush and of the last text added, s.
    real(wp) :: flushed = 0.0_wp, added = 0.0_wp
    !> Whether `path` is the name of the file, to be checked by each flush.
    logical :: named = .false.
    !> Whether a write failed.
    logical :: failed = .false.
    !> Whether disk space is reserved for the buffer; whether a lack of it was reported.
    logical :: keeps_room = .false., full = .false.
  contains
    procedure :: create => file_create
    procedure :: attach => file_attach
    procedure :: put => file_put
    procedure :: flush => file_flush
    procedure :: check_name => file_check_name
    procedure :: refuse => file_refuse
    procedure :: keep_room => file_keep_room
    procedure :: reserve => file_reserve
    procedure :: release => file_release
    procedure :: close => file_close
  end type file_t

contains

  !> Create an empty file, or truncate an existing one. Its folder was there before: if it is not
  !> any more, it was removed.
  subroutine file_create(self, path, error, locked)
    class(file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error
    !> Lock the file until it is closed; it is an error if another program has locked it.
    logical, intent(in), optional :: locked

    integer(c_int), parameter :: mode = int(o'666', c_int)
    integer(c_int) :: descriptor, cause
    logical :: lock, busy

    lock = .false.
    busy = .false.
    if (present(locked)) lock = locked
    if (lock) then
      call open_locked(path, descriptor, busy)
    else
      descriptor = posix_creat(path//c_null_char, mode)
    end if
    cause = errno()
    call self%attach(descriptor, path)
    self%named = .true.
    if (descriptor >= 0) return
    self%failed = .true.
    if (busy) then
      call fatal_error(error, "'"//path//"' is being written by another run", "E203")
    else if (.not. is_folder(folder_of(path))) then
      call fatal_error(error, "'"//folder_of(path)//"'"//lost, "E203")
    else
      call fatal_error(error, "cannot write '"//path//"': "//system_message(cause), "E203")
    end if
  end subroutine file_create

  !> Use an open descriptor.
  subroutine file_attach(self, descriptor, path)
    class(file_t), intent(inout) :: self
    integer(c_int), intent(in) :: descriptor
    !> Name for messages.
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
    self%named = .false.
    self%flushed = wall_time()
    self%added = self%flushed
  end subroutine file_attach

  !> Add text to the buffer, which is written when it is full or too old, and at once if the text
  !> before it is old.
  subroutine file_put(self, text, error)
    class(file_t), intent(inout) :: self
    !> With line ends.
    character(len=*), intent(in) :: text
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    type(error_t), allocatable :: late
    integer(i8) :: n
    real(wp) :: now, quiet

    if (self%failed) return
    n = len(text, i8)
    if (self%used + n > len(self%buffer, i8)) then
      call self%flush(error)
      if (self%failed) return
      if (n > len(self%buffer, i8)) self%buffer = repeat(" ", n)
    end if
    self%buffer(self%used + 1:self%used + n) = text
    self%used = self%used + n
    now = wall_time()
    quiet = now - self%added
    self%added = now
    if (quiet <= longest_pause .and. now - self%flushed <= longest_wait) return
    call self%flush(late)
    if (allocated(late)) call move_alloc(late, error)
  end subroutine file_put

  !> Write the buffer, into reserved space if there is any; report if no more space can be reserved.
  subroutine file_flush(self, error)
    class(file_t), intent(inout) :: self
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    integer(i8) :: first
    integer(c_size_t) :: n
    integer(c_int) :: status, cause

    self%flushed = wall_time()
    if (self%failed .or. self%descriptor < 0) return
    if (self%named) call self%check_name(error)
    if (self%failed) return
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
        call fatal_error(error, "cannot write '"//self%path//"': "//system_message(errno()), "E203")
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
    call fatal_error(error, "cannot write '"//self%path//"': "//system_message(cause), "E203")
  end subroutine file_flush

  !> Check that the file still has its name.
  subroutine file_check_name(self, error)
    class(file_t), intent(inout) :: self
    !> Set if it was removed or replaced; nothing more is written to it.
    type(error_t), allocatable, intent(out) :: error

    if (self%failed .or. self%descriptor < 0) return
    if (is_at(self%descriptor, self%path)) return
    self%failed = .true.
    call fatal_error(error, "'"//self%path//"'"//lost, "E203")
  end subroutine file_check_name

  !> Report why an operation on the name of the file failed. A check before the operation is not
  !> sufficient: the file can be removed or replaced between the two.
  subroutine file_refuse(self, message, error)
    class(file_t), intent(inout) :: self
    !> Cause if the file still has its name.
    character(len=*), intent(in) :: message
    type(error_t), allocatable, intent(out) :: error

    call self%check_name(error)
    if (.not. allocated(error)) call fatal_error(error, message, "E203")
  end subroutine file_refuse

  !> Reserve disk space for the buffer from now on.
  subroutine file_keep_room(self, error)
    class(file_t), intent(inout) :: self
    !> Set if there is no space.
    type(error_t), allocatable, intent(out) :: error

    self%keeps_room = .true.
    call self%flush(error)
  end subroutine file_keep_room

  !> Update the length of the file and of its complete lines.
  subroutine count_written(self, text)
    class(file_t), intent(inout) :: self
    !> Text written.
    character(len=*), intent(in) :: text

    integer(i8) :: end_of_line

    end_of_line = index(text, newline, back=.true., kind=i8)
    if (end_of_line > 0) self%whole = self%length + end_of_line
    self%length = self%length + len(text, i8)
  end subroutine count_written

  !> Reserve disk space at the end of the file for another library. File systems that cannot reserve
  !> report no error here, but in the write.
  subroutine file_reserve(self, size, more, error)
    class(file_t), intent(inout) :: self
    !> Current size, and additional space.
    integer(i8), intent(in) :: size, more
    !> Set if there is no space.
    type(error_t), allocatable, intent(out) :: error

    integer(c_int) :: cause

    if (self%named) call self%check_name(error)
    if (allocated(error)) return
    call try_to_reserve(self, size, more, cause)
    if (cause == 0) return
    call self%release()
    call fatal_error(error, "cannot write '"//self%path//"': "//system_message(cause), "E203")
  end subroutine file_reserve

  !> Reserve disk space at the end of the file.
  subroutine try_to_reserve(self, size, more, cause)
    class(file_t), intent(in) :: self
    !> Current size, and additional space.
    integer(i8), intent(in) :: size, more
    !> Error number; 0 if the space is reserved or the file system cannot reserve.
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

  !> Release reserved space that is not used.
  subroutine file_release(self)
    class(file_t), intent(inout) :: self

    integer(c_int), parameter :: from_end = 2
    integer(c_long) :: size
    integer(c_int) :: ignored

    size = posix_lseek(self%descriptor, 0_c_long, from_end)
    if (size >= 0) ignored = posix_ftruncate(self%descriptor, size)
  end subroutine file_release

  !> Write the buffer and close the file; no-op if it is closed.
  subroutine file_close(self, error)
    class(file_t), intent(inout) :: self
    !> Set if the buffer cannot be written.
    type(error_t), allocatable, intent(out) :: error

    integer(c_int) :: status

    if (self%descriptor < 0) return
    call self%flush(error)
    if (self%keeps_room) call self%release()
    status = posix_close(self%descriptor)
    self%descriptor = -1
    if (status /= 0 .and. .not. self%failed) then
      call fatal_error(error, "cannot write '"//self%path//"': "//system_message(errno()), "E203")
    end if
  end subroutine file_close

  !> Create a directory and its parents; it may exist.
  subroutine make_directory(path, error)
    character(len=*), intent(in) :: path
    !> Set if it cannot be created.
    type(error_t), allocatable, intent(out) :: error

    integer(c_int), parameter :: mode = int(o'777', c_int)
    integer(c_int) :: status, cause
    integer :: i

    do i = 2, len(path) - 1
      if (path(i:i) == "/") status = posix_mkdir(path(:i - 1)//c_null_char, mode)
    end do
    status = posix_mkdir(path//c_null_char, mode)
    if (status == 0) return
    cause = errno()
    if (cause == eexist) then
      if (is_folder(path)) return
    end if
    call fatal_error(error, "cannot create the directory '"//path//"': "//system_message(cause), &
        "E203")
  end subroutine make_directory

  !> Remove a file. A symbolic link is kept, as its target was chosen by the user.
  subroutine remove_file(path, removed)
    character(len=*), intent(in) :: path
    !> False if there was no file, or it could not be removed.
    logical, intent(out) :: removed

    character(kind=c_char) :: target(1)

    removed = .false.
    if (posix_readlink(path//c_null_char, target, 1_c_size_t) >= 0) return
    removed = posix_unlink(path//c_null_char) == 0
  end subroutine remove_file

  !> Return the folder of a path, without the last slash; `.` if it names none.
  pure function folder_of(path) result(folder)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: folder

    integer :: slash

    slash = index(path, "/", back=.true.)
    folder = "."
    if (slash == 1) folder = "/"
    if (slash > 1) folder = path(:slash - 1)
  end function folder_of

  !> Whether a path names a folder: only there is a file `.`.
  logical function is_folder(path)
    character(len=*), intent(in) :: path

    is_folder = is_same_file(path//"/.", path//"/.")
  end function is_folder

end module dd3_base_file
