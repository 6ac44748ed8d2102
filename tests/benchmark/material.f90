!> Nanoseconds per stress update with its tangent, for combinations of the registered laws. With an
!> argument only the combinations whose names hold it ("hill48 swift").
program benchmark_material
  use dd3_base_clock, only : wall_time
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_material_check, only : describe_laws, law_backstress, law_hardening, law_yield
  use dd3_material_description, only : description_t, law_choice_t
  use dd3_material_material, only : material_t, new_material
  use parameter_sets, only : set_t, published_sets
  implicit none

  !> States prepared; best of so many rounds over them.
  integer, parameter :: states = 1000, rounds = 20
  !> Sizes of the strain increments timed.
  real(wp), parameter :: sizes(4) = [1.0e-5_wp, 1.0e-4_wp, 1.0e-3_wp, 1.0e-2_wp]
  type(description_t), allocatable :: criteria(:), hardenings(:), backstresses(:)
  type(law_choice_t), allocatable :: back(:)
  type(set_t), allocatable :: sets(:)
  character(len=60) :: wanted
  integer :: i, j, k

  call get_command_argument(1, wanted)
  sets = published_sets()
  call describe_laws(law_yield, criteria)
  call describe_laws(law_hardening, hardenings)
  call describe_laws(law_backstress, backstresses)
  print '(a)', "ns per update with tangent; strain increments 1e-5 1e-4 1e-3 1e-2; "// &
    "mean Newton iterations"
  do k = 0, size(backstresses)
    do i = 1, size(criteria)
      do j = 1, size(hardenings)
        if (k == 0) then
          allocate (back(0))
        else
          allocate (back(1))
          back(1) = law_choice_t(backstresses(k)%name, backstresses(k)%example)
        end if
        call measure(choice_of(criteria(i)), choice_of(hardenings(j)), back)
        deallocate (back)
      end do
    end do
  end do

contains

  !> A law with its example; criteria with a published set of parameters in place of the isotropic
  !> one.
  type(law_choice_t) function choice_of(description) result(choice)
    !> The law.
    type(description_t), intent(in) :: description

    integer :: n

    choice = law_choice_t(description%name, description%example)
    do n = size(sets), 1, -1
      if (sets(n)%law%name == description%name) choice = sets(n)%law
    end do
  end function choice_of

  !> Times one combination and prints a line.
  subroutine measure(criterion, hardening, back)
    !> The laws.
    type(law_choice_t), intent(in) :: criterion, hardening, back(:)

    type(material_t) :: material
    real(wp) :: plastic_time(size(sizes)), iterations(size(sizes)), elastic_time
    character(len=60) :: name
    integer :: n

    name = trim(criterion%name)//" "//trim(hardening%name)
    if (size(back) > 0) name = trim(name)//" "//trim(back(1)%name)
    if (index(name, trim(wanted)) == 0) return
    call new_material(material, 2.1e5_wp, 0.3_wp, criterion, hardening, back)
    do n = 1, size(sizes)
      call time_updates(material, sizes(n), .true., plastic_time(n), iterations(n))
    end do
    call time_updates(material, 1.0e-5_wp, .false., elastic_time, iterations(1))
    call time_updates(material, sizes(1), .true., plastic_time(1), iterations(1))
    print '(a40, 2(a, f7.1), 3f8.1, a, 4f5.1)', name, " elastic ", elastic_time, &
      "  plastic ", plastic_time, "  iterations ", iterations
  end subroutine measure

  !> Random number between -1 and 1 in each component.
  function random_vector() result(v)
    real(wp) :: v(6)

    call random_number(v)
    v = 2*v - 1
  end function random_vector

  !> Time of one update from states on the yield surface, loaded or unloaded.
  subroutine time_updates(material, length, load, time, iterations)
    !> The material.
    type(material_t), intent(in) :: material
    !> Size of the strain increment.
    real(wp), intent(in) :: length
    !> Whether the increments load.
    logical, intent(in) :: load
    !> Nanoseconds; mean number of iterations.
    real(wp), intent(out) :: time, iterations

    real(wp) :: stress(6, states), internal(material%n_internal, states), strain(6, states)
    real(wp) :: zero(6), zeros(material%n_internal), end_stress(6)
    real(wp) :: end_internal(material%n_internal)
    real(wp) :: tangent(6, 6), start
    type(verdict_t) :: verdict
    logical :: plastic
    integer :: n, r, total

    zero = 0.0_wp
    zeros = 0.0_wp
    do n = 1, states
      strain(:, n) = 0.02_wp*random_vector()
      call material%update(zero, zeros, strain(:, n), stress(:, n), internal(:, n), tangent, &
                           plastic, verdict)
      strain(:, n) = length*random_vector()
      strain(:, n) = strain(:, n) - (strain(1, n) + strain(2, n) + strain(3, n)) &
                     /3*[1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      if (dot_product(strain(:, n), material%plastic_direction(stress(:, n), internal(:, n))) &
          > 0.0_wp .neqv. load) strain(:, n) = -strain(:, n)
    end do
    time = huge(1.0_wp)
    do r = 1, rounds
      total = 0
      start = wall_time()
      do n = 1, states
        call material%update(stress(:, n), internal(:, n), strain(:, n), end_stress, end_internal, &
                             tangent, plastic, verdict)
        total = total + verdict%iterations
      end do
      time = min(time, 1.0e9_wp*(wall_time() - start)/states)
    end do
    iterations = real(total, wp)/states
  end subroutine time_updates

end program benchmark_material
