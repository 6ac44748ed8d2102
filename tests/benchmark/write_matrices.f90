! SPDX-License-Identifier: GPL-3.0-or-later
!> Write linear systems of a run in Matrix Market format.
!>
!>     benchmark_write_matrices <file> <travel, ...> <input file> [name=value ...]
!>
!> Runs the job and writes the systems of the predictor and of the corrector's last iteration of the
!> first increment beyond each travel, mm, to `<file>_<travel>_predictor.mtx` and `_corrector.mtx`,
!> the right-hand sides with `.rhs` appended. The job ends after the last.
program benchmark_write_matrices
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use matrix_market, only : write_matrix_market
  use run_samples, only : argument, collect, read_model, sample_t
  implicit none

  character(len=*), parameter :: part(0:1) = [character(len=9) :: "corrector", "predictor"]
  type(model_t) :: model
  type(sample_t), allocatable :: sample(:)
  type(error_t), allocatable :: error
  character(len=:), allocatable :: list
  character(len=16), allocatable :: word(:)
  real(wp), allocatable :: travel(:)
  integer :: i

  if (command_argument_count() < 3) then
    error stop "benchmark_write_matrices <file> <travel, ...> <input file> [name=value ...]"
  end if
  list = argument(2)
  allocate (word(1 + count([(list(i:i) == ",", i=1, len(list))])))
  allocate (travel(size(word)))
  read (list, *) word
  read (word, *) travel
  call read_model(model, 3)
  call collect(model, sample, travel)
  do i = 1, size(sample)
    print '(a)', trim(sample(i)%origin)
    call write_matrix_market(sample(i)%matrix, sample(i)%b, argument(1)//"_"// &
        trim(word((i + 1)/2))//"_"//part(modulo(i, 2))//".mtx", error)
    if (allocated(error)) then
      print '(a)', error%message
      error stop 1
    end if
  end do
end program benchmark_write_matrices
