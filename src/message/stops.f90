! SPDX-License-Identifier: GPL-3.0-or-later
!> What stops a run; docs/status.md has more on increments that fail.
module dd3_message_stops
  use dd3_message_row, only : message_row_t, row
  implicit none
  private
  public :: stops

  !> First remedy of an increment that fails in its elements, in the contact.
  character(len=*), parameter :: smaller = "Smaller increments (`strain`, `rotation` in "// &
      "`*LIMITS`), a finer mesh there, `cutback = on`."

contains

  !> Return the reasons of a run that stops before its end.
  function stops() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [surroundings(), in_material(), in_solver(), in_contact()]
  end function stops

  !> Return the reasons outside the computation.
  function surroundings() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E201", "interrupted", "By Ctrl-C, the system, the end of the session or a closed "// &
          "output.", &
          "`--restart` continues the run."), &
      row("E202", "not enough memory, or ended by a library", &
          "An array could not be allocated, or a library ended the program.", &
          "A mesh with fewer elements, `method = cgs` in `*SOLVER`, a higher limit of the "// &
          "system; with a limit of the address space `OPENBLAS_NUM_THREADS=1`."), &
      row("E203", "a file cannot be written or read", &
          "The disk is full, the folder was removed or replaced, another run writes into it, "// &
          "or the rights are missing.", "Free space, another folder; then `--restart`."), &
      row("E204", "restart file that cannot be used", &
          "It is missing, incomplete, of another version, or belongs to another model.", &
          "The restart file of this job; the message names what differs."), &
      row("E205", "call that does not fit the job", &
          "An option or the number of processes cannot be combined with this input.", &
          "What the message expects."), &
      row("E206", "tool that would return inside the sheet", &
          "A tool that was released is named again while it lies inside the sheet.", &
          "Give its path by `move` in the phase that releases it, or name it later.")]
  end function surroundings

  !> Return the failures of elements and of the stress update.
  function in_material() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E211", "element inside out", "The increment turns an element inside out.", smaller), &
      row("E212", "assumed strain inside out", &
          "The enhanced strain of a `solid_shell` turns the element inside out.", smaller), &
      row("E213", "values that are not finite", &
          "Stress, strain or internal variables have grown beyond all bounds.", &
          "Units and parameters of the material; smaller increments."), &
      row("E214", "strain increment too large", &
          "The stress update refuses an increment of this size.", smaller), &
      row("E215", "return mapping fails", "The stress update finds no stress on the yield "// &
          "surface.", &
          "Units and parameters of the material; smaller increments."), &
      row("E221", "strain out of reach", &
          "The target stress of a single point requires a strain beyond the bound: the flow "// &
          "stress of the material does not reach it.", &
          "A target stress below the flow stress at large strains."), &
      row("E222", "target stress out of reach", &
          "The tangent is singular: the flow stress does not increase any more.", &
          "A target strain in place of the target stress."), &
      row("E223", "no strain for the target stress", "The iteration does not converge.", &
          "More steps; a target strain in place of the target stress."), &
      row("E224", "deformation gradient without volume", "Its determinant is not positive.", &
          "A gradient with a positive determinant on the whole path.")]
  end function in_material

  !> Return the failures of the linear solver.
  function in_solver() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E231", "singular matrix", "The sheet, or a tool, is free to move without resistance.", &
          "Supports that stop rigid motion."), &
      row("E232", "too little memory for the linear solver", &
          "The factors need more memory than there is.", "`method = cgs` in `*SOLVER`."), &
      row("E233", "failure of the linear solver", &
          "The iteration does not reach the tolerance, most often because the sheet is hardly "// &
          "held.", "`method = umfpack` in `*SOLVER`; supports that stop rigid motion."), &
      row("E235", "factors that cannot be written", &
          "With `factors = disk` MUMPS keeps its factors in the folder of the results; its "// &
          "disk is full.", "A folder on a larger disk; `factors = memory` in `*SOLVER`.")]
  end function in_solver

  !> Return the failures of the contact and of the iteration.
  function in_contact() result(list)
    type(message_row_t), allocatable :: list(:)

    list = [ &
      row("E241", "pressed tool without resistance", "The tool has lost the sheet.", &
          "A tool that lies before the sheet along its force; a support of the sheet."), &
      row("E242", "nodes led into a tool", "A prescribed motion leads a node into a tool.", &
          "A motion that leads no node into a tool."), &
      row("E243", "node displaced too far in an iteration", &
          "In the first increments the sheet is not held; later the increments are too large.", &
          "Supports; `rotation` in `*LIMITS`, a finer mesh there."), &
      row("E244", "contact status that does not settle", &
          "Candidates change between gap, stick and slip from iteration to iteration.", &
          "`cutback = on`, `line_search = on` in `*NEWTON`; a larger `layer` in `*CONTACT`, "// &
          "or a smaller `penalty` in the mixed formulation."), &
      row("E245", "residual that does not vanish", &
          "The iterations do not converge within their number.", &
          "More `iterations` in `*NEWTON`; the remedies of E244."), &
      row("E246", "force of a pressed tool that is not reached", &
          "The tool's equilibrium does not converge.", &
          "`cutback = on` in `*NEWTON`; a larger `layer` in `*CONTACT`."), &
      row("E247", "no progress", "A limit makes the increments so small that the phase would "// &
          "not end.", &
          "A larger value of the limit that the message names.")]
  end function in_contact

end module dd3_message_stops
