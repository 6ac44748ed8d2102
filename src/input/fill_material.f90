! SPDX-License-Identifier: GPL-3.0-or-later
!> Fills the materials of the case and their laws.
module dd3_input_fill_material
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : pair_name
  use dd3_input_block, only : block_t, entry_t
  use dd3_input_case, only : law_parameter_t, law_spec_t, material_spec_t
  use dd3_input_law_outline, only : is_pair
  use dd3_input_number, only : parse_pair, parse_real
  implicit none
  private
  public :: add_law, fill_material, frame_of

contains

  subroutine fill_material(material, block)
    type(material_spec_t), intent(inout) :: material
    type(block_t), intent(in) :: block

    real(wp) :: normal(3)
    integer :: i

    material%name = block%name
    material%source = block
    material%young = block%number("young")
    material%poisson = block%number("poisson")
    if (block%has("density")) material%density = block%number("density")
    material%yield%name = ""
    material%hardening%name = ""
    if (block%has("yield")) then
      call fill_law(material%yield, block%entry(block%find("yield")), block%folder)
    end if
    if (block%has("hardening")) then
      call fill_law(material%hardening, block%entry(block%find("hardening")), block%folder)
    end if
    material%modulus%name = ""
    if (block%has("modulus")) then
      call fill_law(material%modulus, block%entry(block%find("modulus")), block%folder)
    end if
    material%rate%name = ""
    if (block%has("rate")) then
      call fill_law(material%rate, block%entry(block%find("rate")), block%folder)
    end if
    material%temperature%name = ""
    if (block%has("temperature")) then
      call fill_law(material%temperature, block%entry(block%find("temperature")), block%folder)
    end if
    material%fracture%name = ""
    if (block%has("fracture")) then
      call fill_law(material%fracture, block%entry(block%find("fracture")), block%folder)
    end if
    if (block%has("forming_limit")) material%forming_limit = block%numbers("forming_limit")
    if (block%has("initial_temperature")) material%initial_temperature = &
        block%number("initial_temperature")
    if (block%has("heat_capacity")) material%heat_capacity = block%number("heat_capacity")
    if (block%has("heat_fraction")) material%heat_fraction = block%number("heat_fraction")
    allocate (material%backstress(0))
    do i = 1, block%n_entry
      if (block%entry(i)%key /= "backstress" .or. .not. block%entry(i)%valid) cycle
      if (block%entry(i)%value(1)%text == "none" .and. size(block%entry(i)%value) == 1) cycle
      call add_law(material%backstress, block%entry(i), block%folder)
    end do
    if (block%has("rolling_direction")) then
      normal = [0.0_wp, 0.0_wp, 1.0_wp]
      if (block%has("normal_direction")) normal = block%numbers("normal_direction")
      material%frame = frame_of(block%numbers("rolling_direction"), normal)
    end if
  end subroutine fill_material

  !> Append a law to a list.
  subroutine add_law(law, entry, folder)
    type(law_spec_t), allocatable, intent(inout) :: law(:)
    type(entry_t), intent(in) :: entry
    !> Folder of the file the entry is written in.
    character(len=*), intent(in) :: folder

    type(law_spec_t), allocatable :: larger(:)

    allocate (larger(size(law) + 1))
    larger(:size(law)) = law
    call fill_law(larger(size(larger)), entry, folder)
    call move_alloc(larger, law)
  end subroutine add_law

  !> Fill a law from its words: the name, then pairs `p:Y` or triples key, equals sign, value.
  subroutine fill_law(law, entry, folder)
    type(law_spec_t), intent(inout) :: law
    type(entry_t), intent(in) :: entry
    !> Folder of the file the entry is written in.
    character(len=*), intent(in) :: folder

    integer :: i, k, pairs

    law%name = entry%value(1)%text
    law%at = entry%value(1)%at
    law%folder = folder
    pairs = count([(is_pair(entry%value(k)), k=2, size(entry%value))])
    allocate (law%parameter(pairs + (size(entry%value) - 1 - pairs)/3))
    k = 2
    do i = 1, size(law%parameter)
      call fill_law_parameter(law%parameter(i), entry, k)
    end do
  end subroutine fill_law

  subroutine fill_law_parameter(parameter, entry, k)
    type(law_parameter_t), intent(inout) :: parameter
    type(entry_t), intent(in) :: entry
    !> Position of the parameter's first word; on return, of the next parameter's.
    integer, intent(inout) :: k

    parameter%key_at = entry%value(k)%at

    if (is_pair(entry%value(k))) then
      parameter%key = pair_name
      parameter%text = entry%value(k)%text
      parameter%at = entry%value(k)%at
      call parse_pair(parameter%text, parameter%abscissa, parameter%value, parameter%numeric)
      k = k + 1
    else
      parameter%key = entry%value(k)%text
      parameter%text = entry%value(k + 2)%text
      parameter%at = entry%value(k + 2)%at
      call parse_real(parameter%text, parameter%value, parameter%numeric)
      k = k + 3
    end if
  end subroutine fill_law_parameter

  !> Return the rolling, transverse and normal direction as columns: the normal as given, the
  !> rolling direction orthogonalised against it. Zero if the two are parallel or zero.
  pure function frame_of(rolling, normal) result(frame)
    real(wp), intent(in) :: rolling(3), normal(3)
    real(wp) :: frame(3, 3)

    real(wp) :: n(3), r(3)

    frame = 0.0_wp
    if (norm2(normal) < tiny(1.0_wp) .or. norm2(rolling) < tiny(1.0_wp)) return
    n = normal/norm2(normal)
    r = rolling/norm2(rolling)
    r = r - dot_product(r, n)*n
    if (norm2(r) < 1.0e-6_wp) return
    r = r/norm2(r)
    frame(:, 1) = r
    frame(:, 2) = [n(2)*r(3) - n(3)*r(2), n(3)*r(1) - n(1)*r(3), n(1)*r(2) - n(2)*r(1)]
    frame(:, 3) = n
  end function frame_of

end module dd3_input_fill_material
