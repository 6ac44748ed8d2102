! SPDX-License-Identifier: GPL-3.0-or-later
!> Fracture and forming limit of the sheet: where they are reached first.
module dd3_report_limits_reached
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_ranks, only : largest_over_ranks
  use dd3_base_text, only : to_text
  use dd3_model_element_columns, only : element_columns_t, new_element_columns
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_closing, only : closing_t, reached_t
  use dd3_report_node_report, only : place_of_node
  implicit none
  private
  public :: has_limits, largest_limits, limit_warnings, limits_note, limits_t, measure_limits

  !> Largest damage of the points, and largest ratio to the forming limit of the quadrilaterals, of
  !> each the least through the thickness: a neck crosses the whole sheet. With the elements.
  type :: limits_t
    real(wp) :: damage = 0.0_wp, forming = 0.0_wp
    integer :: damaged = 0, necked = 0
  end type limits_t

contains

  !> Whether any material has a law of fracture or a forming limit curve.
  pure logical function has_limits(model)
    type(model_t), intent(in) :: model

    has_limits = any(model%material%laws%n_reported > 0)
  end function has_limits

  !> Find the largest damage and the largest ratio to the forming limit.
  function largest_limits(model, state) result(limits)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(limits_t) :: limits

    real(wp) :: least(model%n_element)

    if (.not. has_limits(model)) return
    call find_damage(model, state, limits, least)
    call find_neck(model, least, limits)
  end function largest_limits

  !> Find the largest damage, and the least ratio to the forming limit of the points of each
  !> element.
  subroutine find_damage(model, state, limits, least)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(limits_t), intent(inout) :: limits
    !> `(n_element)`; 0 without a forming limit curve.
    real(wp), intent(out) :: least(:)

    real(wp) :: damage(model%n_element)
    integer :: i, e

    damage = 0.0_wp
    least = 0.0_wp
    do i = 1, size(model%part%element)
      e = model%part%element(i)
      associate (laws => model%material(model%material_of(e))%laws, &
          variables => state%sheet%internal_variables(:, :, i))
        if (laws%at_damage > 0) damage(e) = maxval(variables(laws%at_damage, :))
        if (laws%at_forming_limit > 0) least(e) = minval(variables(laws%at_forming_limit, :))
      end associate
    end do
    call largest_over_ranks(size(damage), damage)
    call largest_over_ranks(size(least), least)
    limits%damaged = maxloc(damage, dim=1)
    limits%damage = damage(limits%damaged)
  end subroutine find_damage

  !> Find the quadrilateral with the largest of the least ratios through the thickness.
  subroutine find_neck(model, least, limits)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: least(:)
    type(limits_t), intent(inout) :: limits

    type(element_columns_t) :: columns
    real(wp), allocatable :: of_column(:)
    integer :: e

    if (.not. any(least > limits%forming)) return
    call new_element_columns(columns, model)
    allocate (of_column(columns%n), source=huge(1.0_wp))
    do e = 1, size(least)
      associate (ratio => of_column(columns%of_element(e)))
        ratio = min(ratio, least(e))
      end associate
    end do
    e = maxloc(of_column, dim=1)
    limits%forming = of_column(e)
    limits%necked = findloc(columns%of_element, e, dim=1)
  end subroutine find_neck

  !> Measure the largest damage and ratio to the forming limit at the end of a phase.
  subroutine measure_limits(model, state, closing)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Gets both; unchanged where no material has such a limit, or where it is zero everywhere.
    type(closing_t), intent(inout) :: closing

    type(limits_t) :: limits

    limits = largest_limits(model, state)
    if (limits%damage > 0.0_wp) closing%damage = reached(limits%damage, limits%damaged)
    if (limits%forming > 0.0_wp) closing%forming = reached(limits%forming, limits%necked)

  contains

    !> Return a value with its element.
    pure type(reached_t) function reached(value, element)
      real(wp), intent(in) :: value
      integer, intent(in) :: element

      associate (node => model%connectivity(:, element))
        reached = reached_t(value, element, sum(state%x(:, node), dim=2)/real(size(node), wp))
      end associate
    end function reached

  end subroutine measure_limits

  !> Return a note of the largest damage and ratio to the forming limit; empty without limits.
  function limits_note(model, state) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    type(limits_t) :: limits

    text = ""
    limits = largest_limits(model, state)
    if (any(model%material%laws%at_damage > 0)) text = "largest damage "// &
        to_text(limits%damage, 3)//" in element "//to_text(limits%damaged)
    if (.not. any(model%material%laws%at_forming_limit > 0)) return
    if (len(text) > 0) text = text//"; "
    text = text//"largest ratio to the forming limit "//to_text(limits%forming, 3)
    if (limits%necked > 0) text = text//" in element "//to_text(limits%necked)
  end function limits_note

  !> Return warnings of limits that are reached for the first time.
  subroutine limit_warnings(model, state, before, now, notes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Limits before the increment and behind it.
    type(limits_t), intent(in) :: before, now
    type(message_list_t), intent(out) :: notes

    if (before%damage < 1.0_wp .and. now%damage >= 1.0_wp) call notes%add_new("W126", &
        "fracture is reached first in element "//place(now%damaged)//": damage "// &
        to_text(now%damage, 4))
    if (before%forming < 1.0_wp .and. now%forming >= 1.0_wp) call notes%add_new("W127", &
        "the forming limit is reached first in element "//place(now%necked)//": ratio "// &
        to_text(now%forming, 4)//" through the whole thickness")

  contains

    !> Return element, place and time.
    function place(element) result(text)
      integer, intent(in) :: element
      character(len=:), allocatable :: text

      text = to_text(element)//", beside "//place_of_node(model, state, &
          model%connectivity(1, element))//", in increment "//to_text(state%increment)//" at "// &
          to_text(100*state%progress, 3)//" % of phase '"//model%phase(state%phase)%name//"'"
    end function place

  end subroutine limit_warnings

end module dd3_report_limits_reached
