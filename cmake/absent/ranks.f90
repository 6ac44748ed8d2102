! SPDX-License-Identifier: GPL-3.0-or-later
!> In place of `src/parallel/ranks.f90` in a build without MPI: a single rank.
submodule (dd3_base_ranks) dd3_absent_ranks
  implicit none

contains

  module procedure ranks_present
    ranks_present = .false.
  end procedure ranks_present

  module procedure start_ranks
  end procedure start_ranks

  module procedure end_ranks
  end procedure end_ranks

  module procedure this_rank
    this_rank = 0
  end procedure this_rank

  module procedure n_ranks
    n_ranks = 1
  end procedure n_ranks

  module procedure sum_over_ranks
  end procedure sum_over_ranks

  module procedure largest_integers
  end procedure largest_integers

  module procedure largest_reals
  end procedure largest_reals

  module procedure broadcast_integers
  end procedure broadcast_integers

  module procedure broadcast_reals
  end procedure broadcast_reals

  module procedure broadcast_text
  end procedure broadcast_text

  module procedure exchange_reals
    receive(:n_receive(1)) = send(:n_send(1))
  end procedure exchange_reals

  module procedure gather_reals
    all(:n(1)) = own(:n(1))
  end procedure gather_reals

end submodule dd3_absent_ranks
