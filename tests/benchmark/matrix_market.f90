! SPDX-License-Identifier: GPL-3.0-or-later
!> Linear systems as text files in the coordinate and array formats of Matrix Market (Boisvert, Pozo
!> and Remington 1996).
module matrix_market
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t, fatal_error
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern_from_rows, position_of
  implicit none
  private
  public :: write_matrix_market, read_matrix_market

  !> First lines of the two files.
  character(len=*), parameter :: &
      coordinate_header = "%%MatrixMarket matrix coordinate real general", &
      array_header = "%%MatrixMarket matrix array real general"

contains

  !> Write a matrix to `file` and a right-hand side to `file` with `.rhs` appended.
  subroutine write_matrix_market(matrix, b, file, error)
    type(block_matrix_t), intent(in) :: matrix
    !> Right-hand side, `(3n)`.
    real(wp), intent(in) :: b(:)
    character(len=*), intent(in) :: file
    !> Set if a file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    integer :: unit, status, i, k, r, c

    open (newunit=unit, file=file, status="replace", action="write", iostat=status)
    if (status == 0) write (unit, '(a)', iostat=status) coordinate_header
    if (status == 0) write (unit, '(i0,2(1x,i0))', iostat=status) 3*matrix%n, 3*matrix%n, &
        size(matrix%value)
    rows: do i = 1, matrix%n
      do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
        do r = 1, 3
          do c = 1, 3
            if (status /= 0) exit rows
            write (unit, '(i0,1x,i0,es25.16e3)', iostat=status) 3*(i - 1) + r, &
                3*(matrix%column(k) - 1) + c, matrix%value(r, c, k)
          end do
        end do
      end do
    end do rows
    if (status == 0) close (unit, iostat=status)
    if (status == 0) open (newunit=unit, file=file//".rhs", status="replace", action="write", &
        iostat=status)
    if (status == 0) write (unit, '(a)', iostat=status) array_header
    if (status == 0) write (unit, '(i0,a)', iostat=status) size(b), " 1"
    if (status == 0) write (unit, '(es24.16e3)', iostat=status) b
    if (status == 0) close (unit, iostat=status)
    if (status /= 0) call fatal_error(error, "cannot write the linear system to "//file)
  end subroutine write_matrix_market

  !> Read a square matrix, whose size must be a multiple of three, and its right-hand side.
  subroutine read_matrix_market(matrix, b, file, error)
    type(block_matrix_t), intent(out) :: matrix
    !> Right-hand side, `(3n)`.
    real(wp), allocatable, intent(out) :: b(:)
    !> File of the matrix; the right-hand side is in `file` with `.rhs` appended.
    character(len=*), intent(in) :: file
    !> Set if a file cannot be read.
    type(error_t), allocatable, intent(out) :: error

    integer, allocatable :: row(:), column(:)
    real(wp), allocatable :: entry(:)
    integer :: k, n, at

    call read_entries(file, n, row, column, entry, error)
    if (allocated(error)) return
    call pattern_of_entries(matrix, n/3, (row + 2)/3, (column + 2)/3)
    do k = 1, size(entry)
      at = position_of(matrix, (row(k) + 2)/3, (column(k) + 2)/3)
      matrix%value(modulo(row(k) - 1, 3) + 1, modulo(column(k) - 1, 3) + 1, at) = entry(k)
    end do
    call read_vector(file//".rhs", n, b, error)
  end subroutine read_matrix_market

  !> Read the entries of a matrix in coordinate format.
  subroutine read_entries(file, n, row, column, entry, error)
    character(len=*), intent(in) :: file
    !> Number of rows and columns.
    integer, intent(out) :: n
    !> Row and column of each entry.
    integer, allocatable, intent(out) :: row(:), column(:)
    real(wp), allocatable, intent(out) :: entry(:)
    type(error_t), allocatable, intent(out) :: error

    character(len=80) :: line
    integer :: unit, status, k, n_column, n_entry

    n = 0
    open (newunit=unit, file=file, status="old", action="read", iostat=status)
    if (status /= 0) then
      call fatal_error(error, "cannot open the matrix file "//file)
      return
    end if
    call first_line(unit, line, status)
    if (status == 0) read (line, *, iostat=status) n, n_column, n_entry
    if (status == 0) then
      if (n <= 0 .or. n /= n_column .or. modulo(n, 3) /= 0 .or. n_entry < 0) status = 1
    end if
    if (status == 0) then
      allocate (row(n_entry), column(n_entry), entry(n_entry))
      do k = 1, n_entry
        read (unit, *, iostat=status) row(k), column(k), entry(k)
        if (status /= 0) exit
        if (min(row(k), column(k)) < 1 .or. max(row(k), column(k)) > n) status = 1
        if (status /= 0) exit
      end do
    end if
    close (unit)
    if (status /= 0) then
      call fatal_error(error, file//": expected a square matrix of 3x3 blocks in coordinate format")
    end if
  end subroutine read_entries

  !> Read a vector in array format.
  subroutine read_vector(file, n, b, error)
    character(len=*), intent(in) :: file
    !> Expected size.
    integer, intent(in) :: n
    real(wp), allocatable, intent(out) :: b(:)
    type(error_t), allocatable, intent(out) :: error

    character(len=80) :: line
    integer :: unit, status, rows

    allocate (b(n))
    open (newunit=unit, file=file, status="old", action="read", iostat=status)
    if (status /= 0) then
      call fatal_error(error, "cannot open the right-hand side "//file)
      return
    end if
    call first_line(unit, line, status)
    if (status == 0) read (line, *, iostat=status) rows
    if (status == 0 .and. rows /= n) status = 1
    if (status == 0) read (unit, *, iostat=status) b
    close (unit)
    if (status /= 0) then
      call fatal_error(error, file//": expected a vector of the matrix's size in array format")
    end if
  end subroutine read_vector

  !> Read the first line after the comments, which holds the sizes.
  subroutine first_line(unit, line, status)
    integer, intent(in) :: unit
    character(len=*), intent(out) :: line
    !> Zero on success.
    integer, intent(out) :: status

    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) return
      if (line(1:1) /= "%") return
    end do
  end subroutine first_line

  !> Create a zero matrix with the pattern of the blocks that hold at least one entry.
  subroutine pattern_of_entries(matrix, n, row, column)
    type(block_matrix_t), intent(out) :: matrix
    !> Number of block rows.
    integer, intent(in) :: n
    !> Block row and column of each entry.
    integer, intent(in) :: row(:), column(:)

    integer, allocatable :: start(:), order(:), marker(:), row_start(:), packed(:)
    integer :: k, i, count

    ! Sorted by column, then stably by row: the columns of each row are in ascending order.
    call stable_order(n, column, [(k, k=1, size(row))], order, start)
    call stable_order(n, row, order, packed, start)
    deallocate (order)
    allocate (marker(n), row_start(n + 1), order(size(row)))
    marker = 0
    count = 0
    row_start(1) = 1
    do i = 1, n
      do k = start(i), start(i + 1) - 1
        if (marker(column(packed(k))) == i) cycle
        marker(column(packed(k))) = i
        count = count + 1
        order(count) = column(packed(k))
      end do
      row_start(i + 1) = count + 1
    end do
    call new_pattern_from_rows(matrix, row_start, order(:count))
  end subroutine pattern_of_entries

  !> Sort items by a key from 1 to n; items of equal key keep their order (counting sort).
  subroutine stable_order(n, key, items, sorted, start)
    !> Largest key.
    integer, intent(in) :: n
    integer, intent(in) :: key(:), items(:)
    integer, allocatable, intent(out) :: sorted(:)
    !> Where the items of each key begin, `(n + 1)`.
    integer, allocatable, intent(out) :: start(:)

    integer, allocatable :: next(:)
    integer :: k

    allocate (start(n + 1), sorted(size(items)))
    start = 0
    do k = 1, size(items)
      start(key(items(k)) + 1) = start(key(items(k)) + 1) + 1
    end do
    start(1) = 1
    do k = 1, n
      start(k + 1) = start(k + 1) + start(k)
    end do
    next = start
    do k = 1, size(items)
      sorted(next(key(items(k)))) = items(k)
      next(key(items(k))) = next(key(items(k))) + 1
    end do
  end subroutine stable_order

end module matrix_market
