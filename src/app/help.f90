! SPDX-License-Identifier: GPL-3.0-or-later
!> Answers to `--help` and `--version`.
module dd3_app_help
  use, intrinsic :: iso_fortran_env, only : output_unit, error_unit
  use dd3_app_command_line, only : usage_text
  use dd3_app_exit_codes, only : exit_end, exit_usage
  use dd3_app_registry_help, only : field_markdown, help_elements, help_registry, &
      solver_markdown
  use dd3_base_text, only : lower_case, newline, same_name
  use dd3_base_version, only : program_name, program_version
  use dd3_input_help, only : help_blocks, help_topic, reference_markdown
  use dd3_message_table, only : help_message, message_markdown
  use dd3_app_law_help, only : friction_markdown, help_friction, help_law, help_laws, &
      law_reference_markdown
  implicit none
  private
  public :: show_help, show_version

contains

  !> Shows help on a topic.
  subroutine show_help(topic, exit_code)
    !> A block, a key, a law, an element, the code of a message, `markdown` or `messages`; empty for
    !> the usage and the lists.
    character(len=*), intent(in) :: topic
    !> Whether there is such a topic.
    integer, intent(out) :: exit_code

    character(len=:), allocatable :: text

    exit_code = exit_end
    if (topic == "") then
      text = usage_text()//"blocks of the input:"//newline//help_blocks()// &
             "laws:"//newline//help_laws()//"elements:"//newline//help_elements()
    else if (same_name(topic, "markdown")) then
      text = reference_markdown()//solver_markdown()//field_markdown()//friction_markdown()// &
          law_reference_markdown()
    else if (same_name(topic, "messages")) then
      text = message_markdown()
    else
      text = help_topic(topic)//help_law(topic)//help_friction(topic)//help_registry(topic)// &
          help_message(topic)
    end if
    if (text == "") then
      write (error_unit, '(a)') "there is no help on '"//topic// &
          "'; dd3imp --help lists blocks, laws and elements"//lines_with(lower_case(topic))
      exit_code = exit_usage
    else
      write (output_unit, '(a)', advance="no") text
    end if
  end subroutine show_help

  !> The lines of the list of laws that hold a word, each on a line of its own.
  function lines_with(word) result(text)
    !> The word, in small letters.
    character(len=*), intent(in) :: word
    character(len=:), allocatable :: text

    character(len=:), allocatable :: all_lines
    integer :: start, last

    text = ""
    all_lines = help_laws()
    start = 1
    do while (start <= len(all_lines))
      last = index(all_lines(start:)//newline, newline) + start - 2
      if (index(lower_case(all_lines(start:last)), word) > 0) then
        text = text//newline//all_lines(start:last)
      end if
      start = last + 2
    end do
  end function lines_with

  !> Shows the version.
  subroutine show_version()
    write (output_unit, '(a)') program_name//" "//program_version
  end subroutine show_version

end module dd3_app_help
