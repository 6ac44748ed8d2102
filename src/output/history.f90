! SPDX-License-Identifier: GPL-3.0-or-later
!> history.csv: travel, displacements and forces of the tools, the quantities of the node sets of
!> *HISTORY, energies and the number of elements. One row for the initial state and for every n-th
!> accepted increment; the last state of a phase and of the run always has a row. All ranks evaluate
!> the rows, the first writes them.
module dd3_output_history
  use dd3_base_kinds, only : pi, wp
  use dd3_base_error, only : error_t, share_error
  use dd3_base_ranks, only : broadcast_integers, count_over_ranks, this_rank
  use dd3_base_text, only : axis => axis_name, newline
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_tensor, only : cross
  use dd3_model_bound_nodes, only : give_to_parents
  use dd3_model_contact_results, only : tool_deflections
  use dd3_model_model, only : model_t
  use dd3_model_reactions, only : reactions
  use dd3_model_rim, only : mean_draw_in
  use dd3_model_state, only : state_t
  use dd3_model_terms_released, only : released_tool, remaining_force
  use dd3_model_pressed_tools, only : tilt_of
  use dd3_model_tool_supports, only : cushion_force, has_cushion, has_spacer, spacer_force
  use dd3_model_turning, only : torque, turned_angle
  use dd3_output_csv, only : table_t
  use dd3_output_forming_columns, only : add_forming_heading, add_forming_values
  implicit none
  private
  public :: history_record_t

  !> Name of the file in the folder of the results.
  character(len=*), parameter :: file_name = "history.csv"

  !> History of a run.
  type :: history_record_t
    type(table_t), private :: table
    !> Row of a state that is not due; it is written if it becomes the last one of its phase.
    character(len=:), allocatable, private :: waiting
    !> Increment and phase of the last state.
    integer, private :: increment = 0, phase = 0
  contains
    procedure :: open => history_open
    procedure :: resume => history_resume
    procedure :: write => history_write
    procedure :: flush => history_flush
    procedure :: close => history_close
  end type history_record_t

contains

  !> Make the file with its two lines of heading.
  subroutine history_open(self, model, directory, error)
    class(history_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Folder of the results.
    character(len=*), intent(in) :: directory
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    self%waiting = ""
    self%phase = 0
    if (this_rank() > 0) return
    call self%table%open(directory//"/"//file_name, error)
    if (allocated(error)) return
    call self%table%file%put(heading(model), error)
    if (.not. allocated(error)) call self%table%file%flush(error)
  end subroutine history_open

  !> Make the file with the rows of an earlier run up to a restart.
  subroutine history_resume(self, model, state, source, directory, found, error)
    class(history_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> State of the restart.
    type(state_t), intent(in) :: state
    !> Folders of the earlier results, and of the results.
    character(len=*), intent(in) :: source, directory
    !> The earlier rows are in the file; otherwise it begins with the heading alone.
    logical, intent(out) :: found
    !> Set if the file cannot be written, on all ranks.
    type(error_t), allocatable, intent(out) :: error

    integer :: resumed(1)

    self%waiting = ""
    self%increment = state%increment
    self%phase = state%phase
    found = .false.
    if (this_rank() == 0) call self%table%resume(source//"/"//file_name, &
        directory//"/"//file_name, heading(model), state%history_increment, found, error)
    call share_error(error)
    resumed = merge(1, 0, found)
    call broadcast_integers(0, 1, resumed)
    found = resumed(1) > 0
    if (allocated(error) .or. .not. found) return
    if (state%history_increment >= state%increment) return
    call fill_row(self%table, model, state)
    call self%table%take_row(self%waiting)
  end subroutine history_resume

  !> Return the lines of the heading: units and names of the columns.
  function heading(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    character(len=:), allocatable :: names, units
    integer :: i

    names = "increment,phase,travel,progress"
    units = "-,-,mm,-"
    if (has_time(model)) names = names//",time"
    if (has_time(model)) units = units//",s"
    do i = 1, model%n_tool
      call add_vector(names, units, trim(model%tool(i)%name)//"_u", "mm")
      call add_vector(names, units, trim(model%tool(i)%name)//"_f", "N")
      names = names//","//trim(model%tool(i)%name)//"_contacts,"//trim(model%tool(i)%name)//"_depth"
      units = units//",-,mm"
      if (model%tool(i)%compliance > 0.0_wp) then
        names = names//","//trim(model%tool(i)%name)//"_deflection"
        units = units//",mm"
      end if
      if (model%tilts(i)) call add_vector(names, units, trim(model%tool(i)%name)//"_tilt_", &
          "degrees")
      if (has_cushion(model, i)) names = names//","//trim(model%tool(i)%name)//"_cushion"
      if (has_cushion(model, i)) units = units//",N"
      if (has_spacer(model, i)) names = names//","//trim(model%tool(i)%name)//"_spacer"
      if (has_spacer(model, i)) units = units//",N"
      if (.not. model%turns(i)) cycle
      names = names//","//trim(model%tool(i)%name)//"_angle,"//trim(model%tool(i)%name)//"_torque"
      units = units//",degrees,N.mm"
    end do
    if (allocated(model%history)) then
      do i = 1, size(model%history)
        associate (set => model%history(i))
          if (set%displacement) call add_vector(names, units, set%name//"_u", "mm")
          if (set%reaction) call add_vector(names, units, set%name//"_r", "N")
          if (set%position) call add_vector(names, units, set%name//"_", "mm")
          if (set%moment) call add_vector(names, units, set%name//"_m", "N.mm")
          if (set%draw_in) then
            names = names//","//set%name//"_draw_in"
            units = units//",mm"
          end if
        end associate
      end do
    end if
    call add_forming_heading(model, names, units)
    names = names//",elements"
    units = units//",-"
    text = "# units: "//units//newline//names//newline
  end function heading

  !> Whether a phase has a duration.
  pure logical function has_time(model)
    type(model_t), intent(in) :: model

    has_time = any(model%phase%duration > 0.0_wp)
  end function has_time

  !> Add the columns of a vector.
  subroutine add_vector(names, units, prefix, unit)
    character(len=:), allocatable, intent(inout) :: names, units
    character(len=*), intent(in) :: prefix, unit
    integer :: i

    do i = 1, 3
      names = names//","//prefix//axis(i)
      units = units//","//unit
    end do
  end subroutine add_vector

  !> Write the row of a committed state if it is due; keep it otherwise, until the phase ends or the
  !> next row replaces it.
  subroutine history_write(self, model, state, error)
    class(history_record_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Gets the increment of the last row written.
    type(state_t), intent(inout) :: state
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    logical :: due, writes

    writes = this_rank() == 0
    if (state%phase /= self%phase .and. len(self%waiting) > 0) then
      call put_waiting(self, error)
      if (allocated(error)) return
      state%history_increment = self%increment
    end if
    due = mod(state%increment, model%output%history) == 0 &
          .or. state%progress >= 1.0_wp
    self%increment = state%increment
    self%phase = state%phase
    self%waiting = ""
    call fill_row(self%table, model, state)
    if (due .and. writes) then
      call self%table%end_row(error)
    else
      call self%table%take_row(self%waiting)
    end if
    if (due) state%history_increment = state%increment
    if (.not. writes) self%waiting = ""
  end subroutine history_write

  !> Fill the row of a state.
  subroutine fill_row(table, model, state)
    type(table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: deflection(model%n_tool)
    integer :: i

    deflection = tool_deflections(model, state)
    call table%add_integer(state%increment)
    call table%add_text(model%phase(state%phase)%name)
    call table%add_real(state%travel)
    call table%add_real(state%progress)
    if (has_time(model)) call table%add_real(state%time)
    do i = 1, model%n_tool
      call table%add_reals(state%tools%displacement(:, i))
      call table%add_reals(state%tools%force(:, i))
      call table%add_integer(count_over_ranks(count(state%contact%tool == i &
          .and. state%contact%status /= status_gap)))
      call table%add_real(state%observed%depth(i))
      if (model%tool(i)%compliance > 0.0_wp) call table%add_real(deflection(i))
      if (model%tilts(i)) call table%add_reals(180.0_wp/pi*tilt_of(state%tools, i))
      associate (phase => model%phase(state%phase))
        if (has_cushion(model, i)) call table%add_real(cushion_force(phase, state%tools, i))
        if (has_spacer(model, i)) call table%add_real(spacer_force(phase, state%tools, i))
      end associate
      if (.not. model%turns(i)) cycle
      call table%add_real(turned_angle(state, i))
      call table%add_real(torque(model, state, i))
    end do
    if (allocated(model%history)) call add_set_values(table, model, state)
    call add_forming_values(table, model, state)
    call table%add_integer(model%n_element)
  end subroutine fill_row

  !> Add the quantities of the node sets to a row.
  subroutine add_set_values(table, model, state)
    type(table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp), allocatable :: reaction(:, :)
    integer, allocatable :: first(:)
    integer :: i

    if (any(model%history%reaction .or. model%history%moment)) then
      reaction = support_reactions(model, state)
    end if
    do i = 1, size(model%history)
      first = model%first_nodes(model%history(i)%node)
      if (model%history(i)%displacement) then
        call table%add_reals(mean(state%x, first) - mean(model%x0, first))
      end if
      if (model%history(i)%reaction) then
        call table%add_reals(sum(reaction(:, model%history(i)%node), dim=2))
      end if
      if (model%history(i)%position) call table%add_reals(mean(state%x, first))
      if (model%history(i)%moment) then
        call table%add_reals(moment(state%x, reaction, model%history(i)%node, mean(state%x, first)))
      end if
      if (model%history(i)%draw_in) then
        call table%add_real(mean_draw_in(model, state%x, first))
      end if
    end do
  end subroutine add_set_values

  !> Return the mean of the vectors of some nodes.
  pure function mean(vector, node)
    real(wp), intent(in) :: vector(:, :)
    integer, intent(in) :: node(:)
    real(wp) :: mean(3)
    integer :: i

    mean = 0.0_wp
    do i = 1, size(node)
      mean = mean + vector(:, node(i))
    end do
    mean = mean/real(max(1, size(node)), wp)
  end function mean

  !> Return the support reactions of the nodes, `(3, n_node)`, N: internal forces less those of
  !> loads and tools. Fading reactions of freed directions are included.
  function support_reactions(model, state) result(reaction)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: reaction(3, model%n_node)

    real(wp) :: fading(3, model%n_node)

    fading = remaining_force(state%term)
    where (spread(released_tool(state%term) /= 0, 1, 3)) fading = 0.0_wp
    call give_to_parents(model, state%x, fading)
    reaction = reactions(model, state) - fading
  end function support_reactions

  !> Return the moment of the support reactions of some nodes about a point, N.mm.
  pure function moment(x, reaction, node, centre)
    !> Positions, mm, and reactions, N, of all nodes, `(3, n_node)`.
    real(wp), intent(in) :: x(:, :), reaction(:, :)
    integer, intent(in) :: node(:)
    !> mm.
    real(wp), intent(in) :: centre(3)
    real(wp) :: moment(3)

    integer :: i

    moment = 0.0_wp
    do i = 1, size(node)
      moment = moment + cross(x(:, node(i)) - centre, reaction(:, node(i)))
    end do
  end function moment

  !> Write the row that is kept.
  subroutine put_waiting(self, error)
    class(history_record_t), intent(inout) :: self
    !> Set if the file cannot be written.
    type(error_t), allocatable, intent(out) :: error

    if (.not. allocated(self%waiting)) return
    if (len(self%waiting) > 0) call self%table%file%put(self%waiting//newline, error)
    self%waiting = ""
  end subroutine put_waiting

  !> Write what is kept and buffered, and close the file.
  subroutine history_close(self, error)
    class(history_record_t), intent(inout) :: self
    !> Set if the rest cannot be written.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: second

    call put_waiting(self, error)
    call self%table%close(second)
    if (.not. allocated(error) .and. allocated(second)) call move_alloc(second, error)
  end subroutine history_close

  !> Write what is buffered.
  subroutine history_flush(self, error)
    class(history_record_t), intent(inout) :: self
    !> Set if the rows cannot be written.
    type(error_t), allocatable, intent(out) :: error

    call self%table%file%flush(error)
  end subroutine history_flush

end module dd3_output_history
