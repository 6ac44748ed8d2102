!> history.csv: travel, tools' displacements and forces, and the quantities of the followed node
!> sets. One row for the initial state and one for every n-th accepted increment; the last state of
!> a phase and of the run is always there.
module dd3_output_history
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t
  use dd3_base_text, only : newline
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t, status_gap
  use dd3_output_csv, only : table_t
  implicit none
  private
  public :: history_record_t

  !> Endings of the columns along the axes.
  character(len=1), parameter :: axis(3) = ["x", "y", "z"]

  !> The history of a run.
  type :: history_record_t
    !> The table.
    type(table_t), private :: table
    !> A row that has not been written, because it is not its turn.
    character(len=:), allocatable, private :: waiting
    !> Phase of the last state.
    integer, private :: phase = 0
  contains
    procedure :: open => history_open
    procedure :: write => history_write
    procedure :: close => history_close
  end type history_record_t

contains

  !> Makes the file with its two lines of heading.
  subroutine history_open(self, model, directory, error)
    !> The record.
    class(history_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The directory.
    character(len=*), intent(in) :: directory
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: names, units

    self%waiting = ""
    self%phase = 0
    call self%table%open(directory//"/history.csv", error)
    if (allocated(error)) return
    call heading(model, names, units)
    call self%table%file%put("# units: "//units//newline//names//newline, error)
    if (.not. allocated(error)) call self%table%file%flush(error)
  end subroutine history_open

  !> Names and units of the columns.
  subroutine heading(model, names, units)
    !> The model.
    type(model_t), intent(in) :: model
    !> The names, and the units, with commas between them.
    character(len=:), allocatable, intent(out) :: names, units
    integer :: i

    names = "increment,phase,travel,progress"
    units = "-,-,mm,-"
    do i = 1, model%n_tool
      call add_vector(names, units, trim(model%tool(i)%name)//"_u", "mm")
      call add_vector(names, units, trim(model%tool(i)%name)//"_f", "N")
      names = names//","//trim(model%tool(i)%name)//"_contacts"
      units = units//",-"
    end do
    if (.not. allocated(model%history)) return
    do i = 1, size(model%history)
      if (model%history(i)%displacement) then
        call add_vector(names, units, model%history(i)%name//"_u", "mm")
      end if
      if (model%history(i)%reaction) call add_vector(names, units, model%history(i)%name//"_r", "N")
      if (model%history(i)%position) call add_vector(names, units, model%history(i)%name//"_", "mm")
    end do
  end subroutine heading

  !> Adds the columns of a vector to the heading.
  subroutine add_vector(names, units, prefix, unit)
    !> The names and the units so far.
    character(len=:), allocatable, intent(inout) :: names, units
    !> What stands before the axis, and the unit.
    character(len=*), intent(in) :: prefix, unit
    integer :: i

    do i = 1, 3
      names = names//","//prefix//axis(i)
      units = units//","//unit
    end do
  end subroutine add_vector

  !> Adds the row of a state, or keeps it until its phase ends or the next one takes its place.
  subroutine history_write(self, model, state, error)
    !> The record.
    class(history_record_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The state, accepted.
    type(state_t), intent(in) :: state
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error
    logical :: due

    if (state%phase /= self%phase) call put_waiting(self, error)
    if (allocated(error)) return
    due = mod(state%increment, max(1, model%output%history_every)) == 0 &
          .or. state%progress >= 1.0_wp
    self%phase = state%phase
    self%waiting = ""
    call fill_row(self%table, model, state)
    if (due) then
      call self%table%end_row(error)
    else
      call self%table%take_row(self%waiting)
    end if
  end subroutine history_write

  !> Fills the row of a state.
  subroutine fill_row(table, model, state)
    !> The table.
    type(table_t), intent(inout) :: table
    !> The model.
    type(model_t), intent(in) :: model
    !> The state.
    type(state_t), intent(in) :: state
    integer :: i

    call table%add_integer(state%increment)
    call table%add_text(model%phase(state%phase)%name)
    call table%add_real(state%travel)
    call table%add_real(state%progress)
    do i = 1, model%n_tool
      call table%add_reals(state%tool_displacement(:, i))
      call table%add_reals(state%tool_force(:, i))
      call table%add_integer(count(state%contact_tool == i .and. state%status /= status_gap))
    end do
    if (.not. allocated(model%history)) return
    do i = 1, size(model%history)
      if (model%history(i)%displacement) then
        call table%add_reals(mean(state%x, model%history(i)%node) &
                             - mean(model%x0, model%history(i)%node))
      end if
      if (model%history(i)%reaction) then
        call table%add_reals(reaction(model, state, model%history(i)%node))
      end if
      if (model%history(i)%position) call table%add_reals(mean(state%x, model%history(i)%node))
    end do
  end subroutine fill_row

  !> Mean of the vectors of some nodes.
  pure function mean(vector, node)
    !> The vectors of all nodes.
    real(wp), intent(in) :: vector(:, :)
    !> The nodes.
    integer, intent(in) :: node(:)
    real(wp) :: mean(3)
    integer :: i

    mean = 0.0_wp
    do i = 1, size(node)
      mean = mean + vector(:, node(i))
    end do
    mean = mean/real(max(1, size(node)), wp)
  end function mean

  !> Sum of the supports' forces on some nodes: what the internal forces leave when loads and tools
  !> have done their part.
  pure function reaction(model, state, node)
    !> The model.
    type(model_t), intent(in) :: model
    !> The state.
    type(state_t), intent(in) :: state
    !> The nodes.
    integer, intent(in) :: node(:)
    real(wp) :: reaction(3)
    integer :: i

    reaction = 0.0_wp
    do i = 1, size(node)
      reaction = reaction + state%internal_force(:, node(i)) - state%external_force(:, node(i))
    end do
    do i = 1, model%n_contact
      if (any(node == model%contact_node(i))) reaction = reaction + state%lambda(:, i)
    end do
  end function reaction

  !> Writes the row that waits.
  subroutine put_waiting(self, error)
    !> The record.
    class(history_record_t), intent(inout) :: self
    !> Says why it cannot be written.
    type(error_t), allocatable, intent(out) :: error

    if (.not. allocated(self%waiting)) return
    if (len(self%waiting) > 0) call self%table%file%put(self%waiting//newline, error)
    self%waiting = ""
  end subroutine put_waiting

  !> Writes what waits and closes the file.
  subroutine history_close(self, error)
    !> The record.
    class(history_record_t), intent(inout) :: self
    !> Says why the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: second

    call put_waiting(self, error)
    call self%table%close(second)
    if (.not. allocated(error) .and. allocated(second)) call move_alloc(second, error)
  end subroutine history_close

end module dd3_output_history
