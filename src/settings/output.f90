! SPDX-License-Identifier: GPL-3.0-or-later
!> Settings of the output: what is written, and when.
module dd3_settings_output
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: output_spec_t, history_quantities_t, fields_ends, fields_every, fields_at, &
      fields_increments

  !> When fields are written: first and last state only, at intervals of the travel, at given
  !> travels, at intervals in increments.
  integer, parameter :: fields_ends = 0, fields_every = 1, fields_at = 2, fields_increments = 3

  !> What is written, and when.
  type :: output_spec_t
    !> Interval of the rows of the history table, in increments.
    integer :: history = 0
    !> One of the `fields_*` values.
    integer :: fields = fields_ends
    !> Interval (mm, or increments), or the travels at which fields are written, mm.
    real(wp), allocatable :: fields_value(:)
    !> Whether a restart file is written at the end of each phase and when a run stops.
    logical :: restart = .true.
    !> Interval of the restart file in increments; 0 for none in between.
    integer :: restart_every = 0
    !> Folder of the results; empty for the default beside the input file.
    character(len=:), allocatable :: directory
  end type output_spec_t

  !> Quantities of a node set in history.csv.
  type :: history_quantities_t
    logical :: displacement = .false., reaction = .false., position = .false., moment = .false.
    logical :: draw_in = .false.
  end type history_quantities_t

end module dd3_settings_output
