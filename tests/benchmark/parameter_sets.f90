! SPDX-License-Identifier: GPL-3.0-or-later
!> Yield criteria with published and with extreme parameters, for the benchmarks. The speed of a
!> criterion is measured with its first set.
module parameter_sets
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t
  use dd3_material_description, only : law_choice_t
  implicit none
  private
  public :: set_t, published_sets, law_of

  !> Criterion with its parameters.
  type :: set_t
    !> Material or special values.
    character(len=40) :: title
    type(law_choice_t) :: law
  end type set_t

contains

  !> Return all sets.
  function published_sets() result(sets)
    type(set_t), allocatable :: sets(:)

    character(len=*), parameter :: &
      yld91 = "yld91 a=1.0674 b=0.8559 c=1.1296 h=1.2970 m=", &
      karafillis = " scale=0.559 alpha1=1.103 alpha2=1.120 gamma3=1.460", &
      cazacu = "cazacu_barlat2001 a1=0.586 a2=1.05 a3=0.823 a4=0.96 b1=1.44 b2=0.061 "// &
               "b3=-1.302 b4=-0.281 b5=-0.375 b10=0.445 c=", &
      yld2004 = "yld2004 c12=-0.069888 c13=0.936408 c21=0.079143 c23=1.003060 c31=0.524741 "// &
                "c32=1.363180 c44=1.023770 c55=1.069060 c66=0.954322 d12=0.981171 "// &
                "d13=0.476741 d21=0.575316 d23=0.866827 d31=1.145010 d32=-0.079294 "// &
                "d44=1.051660 d55=1.147100 d66=1.404620 m=", &
      yld2000 = "yld2000 alpha1=0.4865 alpha2=1.3783 alpha3=0.7536 alpha4=1.0246 "// &
                "alpha5=1.0363 alpha6=0.9036 alpha7=1.2321 alpha8=1.4858 m=", &
      bbc2008 = "bbc2008 l1_1=0.130866 l2_1=0.621742 m1_1=0.783422 m2_1=0.660402 "// &
                "m3_1=0.000079 n1_1=0.110991 n2_1=0.048245 n3_1=0.307522 l1_2=1.033922 "// &
                "l2_2=-0.071963 m1_2=0.000113 m2_2=0.000077 m3_2=0.538047 n1_2=0.055764 "// &
                "n2_2=1.018603 n3_2=0.778150 k=", &
      titanium = "cpb06 C11=1 C12=0.2285 C13=0.0374 C22=1.2967 C23=0.2439 C33=0.3422 k=0.1556 m="

    sets = [ &
      set_t("", law_of("von_mises")), &
      set_t("mild steel", law_of("hill48 F=0.284 G=0.358 H=0.642 N=1.289")), &
      set_t("m = 8", law_of("hosford m=8")), &
      set_t("m = 100", law_of("hosford m=100")), &
      set_t("AA2090-T3, m = 8", law_of(yld91//"8")), &
      set_t("AA2090-T3, m = 100", law_of(yld91//"100")), &
      set_t("2008-T4, k = 15", law_of("karafillis_boyce k=15 c=0.81"//karafillis)), &
      set_t("2008-T4, k = 50, c = 0", law_of("karafillis_boyce k=50 c=0"//karafillis)), &
      set_t("2008-T4, k = 50, c = 1", law_of("karafillis_boyce k=50 c=1"//karafillis)), &
      set_t("mild steel", &
            law_of("drucker c=1.2129 C1=0.81324 C2=0.87964 C3=1.11288 C6=0.94426")), &
      set_t("c = 2.25, the upper bound", law_of("drucker c=2.25")), &
      set_t("c = -3.375, the lower bound", law_of("drucker c=-3.375")), &
      set_t("AA2090-T3 with c = 0.5", law_of(cazacu//"0.5")), &
      set_t("AA2090-T3, not convex", law_of(cazacu//"1.285 nonconvex=1")), &
      set_t("AA2090-T3, m = 8", law_of(yld2004//"8")), &
      set_t("AA2090-T3, m = 100", law_of(yld2004//"100")), &
      set_t("Ti-4Al, 0.2 %", law_of(titanium//"2")), &
      set_t("Ti-4Al, 0.2 %, with m = 100", law_of(titanium//"100")), &
      set_t("Ti-4Al, 1 %", law_of("cpb06 C11=1 C12=0.0431 C13=0.3369 C22=0.9562 "// &
                                  "C23=0.3139 C33=1.0861 k=-0.1868 m=2")), &
      set_t("Ti-4Al, 4 %", law_of("cpb06 C11=1 C12=0.2178 C13=0.3635 C22=1.0422 "// &
                                  "C23=0.3754 C33=0.8825 k=-0.2577 m=2")), &
      set_t("AA2090-T3, m = 8", law_of(yld2000//"8")), &
      set_t("AA2090-T3, m = 100", law_of(yld2000//"100")), &
      set_t("AA2090-T3, k = 4", law_of(bbc2008//"4")), &
      set_t("AA2090-T3, k = 50", law_of(bbc2008//"50")), &
      set_t("F = G = 0.001, H = 10, N = 100", law_of("hill48 F=1e-3 G=1e-3 H=10 N=100")), &
      set_t("r0 = 0.01, r45 = r90 = 20", law_of("hill48 r0=0.01 r45=20 r90=20")), &
      set_t("c = 2.25, C1 ... C6 = 0.01 ... 5", &
            law_of("drucker c=2.25 C1=3 C2=0.1 C3=1 C4=0.01 C5=5 C6=2")), &
      set_t("k = -1, m = 100", law_of("cpb06 C11=1 C12=0 C13=0 C22=1 C23=0 C33=1 k=-1 m=100"))]
  end function published_sets

  !> Return the law of a text such as "swift K=565 e0=0.007117 n=0.259".
  function law_of(text) result(law)
    character(len=*), intent(in) :: text
    type(law_choice_t) :: law

    character(len=:), allocatable :: rest, word
    real(wp) :: value
    integer :: blank, equals

    rest = trim(text)//" "
    blank = index(rest, " ")
    law%name = rest(:blank - 1)
    allocate (law%values(0))
    do
      rest = rest(blank + 1:)
      blank = index(rest, " ")
      if (blank == 0) return
      word = rest(:blank - 1)
      equals = index(word, "=")
      read (word(equals + 1:), *) value
      law%values = [law%values, law_value_t(word(:equals - 1), value)]
    end do
  end function law_of

end module parameter_sets
