!> *GAP LAW -> one side of the conductance of a surface interaction.
module deck_builder_gap_laws
   use card_parameters, only: need_choice, take_parameter
   use card_values, only: check_extra, need_field, take_field
   use cards, only: data_card_type, keyword_card_type
   use conductance_laws, only: conductance_law_type, law_clearance, law_gas, law_none, law_power
   use deck_builder_gap_conductance, only: gap_table_type, note_ends, read_table
   use deck_context, only: deck_type
   use kinds, only: dp
   use model, only: physical_constants_type
   use text, only: largest_magnitude, to_text
   implicit none
   private
   public :: build_gap_law

   real(dp), parameter :: cmy_factor = 1.25_dp     !! of Cooper, Mikic and Yovanovich
   real(dp), parameter :: cmy_exponent = 0.95_dp   !! of pressure over hardness

   !> Largest n of C0 + C1 p^n: laws that are measured have 1/2 to 2, and p^10 stays within the
   !> range of numbers for every pressure that a material bears.
   real(dp), parameter :: largest_exponent = 10.0_dp

   !> Parameters of TYPE=GAS only.
   character(*), parameter :: of_gas(3) = [character(10) :: 'JUMP', 'ROUGHNESS', 'EMISSIVITY']

contains

   !> Reads one *GAP LAW.
   subroutine build_gap_law(card, name, constants, deck, law)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(physical_constants_type), intent(in) :: constants
      type(deck_type), intent(inout) :: deck   !! receives notes and errors
      type(conductance_law_type), intent(inout) :: law     !! receives one side
      type(gap_table_type) :: table
      character(:), allocatable :: kind
      integer :: i

      call need_choice(card, 'TYPE', 'GAS/POWER/CLEARANCE/CMY/ROSS-STOUTE', deck, kind)
      if (kind == '') return
      if (any(kind == ['GAS      ', 'CLEARANCE'])) then
         if (law%open_kind /= law_none) call deck%error(card%place, 'a second open law in one '// &
            'surface interaction')
      else if (law%closed_kind /= law_none) then
         call deck%error(card%place, 'a second closed law in one surface interaction')
      end if
      if (kind == 'GAS') then
         law%open_kind = law_gas
         call build_gas_law(card, name, constants, deck, law)
         return
      end if
      do i = 1, size(of_gas)
         if (card%has(trim(of_gas(i)))) call deck%error(card%place_of(trim(of_gas(i))), &
            trim(of_gas(i))//'= belongs to *GAP LAW, TYPE=GAS')
      end do
      if (kind == 'CLEARANCE') then
         law%open_kind = law_clearance
         call read_table(card, 'gap', spread(0.0_dp, 1, size(card%data)), deck, table)
         call move_alloc(table%abscissa, law%table_gap)
         call move_alloc(table%omega, law%open_omega)
         call note_ends('*GAP LAW, TYPE=CLEARANCE', name, 'gaps', law%table_gap, deck)
         return
      end if
      if (size(card%data) > 1) call deck%error(card%data(2)%place(1), 'extra data card; *GAP '// &
         'LAW, TYPE='//kind//' has one')
      law%closed_kind = law_power
      if (kind == 'POWER') then
         call build_power_law(card%data(1), deck, law)
      else
         call build_solid_spots(card%data(1), kind, deck, law)
      end if
   end subroutine build_gap_law

   !> omega = C0 + C1 p^n.
   subroutine build_power_law(data, deck, law)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law
      logical :: valid(3)

      valid = .true.
      call need_field(data, 1, 'C0', deck, law%power_c0, valid(1))
      call need_field(data, 2, 'C1', deck, law%power_c1, valid(2))
      call need_field(data, 3, 'n', deck, law%power_n, valid(3))
      call check_extra(data, 3, 'C0, C1, n of C0 + C1 pressure^n', deck)
      if (valid(1) .and. law%power_c0 < 0.0_dp) then
         call deck%error(data%place(1), 'C0 must not be negative')
      end if
      if (valid(2) .and. law%power_c1 < 0.0_dp) then
         call deck%error(data%place(2), 'C1 must not be negative')
      end if
      if (valid(3) .and. law%power_n <= 0.0_dp) then
         call deck%error(data%place(3), 'n must be positive')
         law%power_n = 1.0_dp
      else if (valid(3) .and. law%power_n > largest_exponent) then
         call deck%error(data%place(3), 'n must not exceed '//to_text(largest_exponent)// &
            '; for rough faces it is about 0.95')
         law%power_n = 1.0_dp
      end if
   end subroutine build_power_law

   !> Reads one data card. With ks = 2 k1 k2/(k1 + k2), CMY is 1.25 ks (m/sigma) (p/H)^0.95 and
   !> ROSS-STOUTE ks p/(a0 sqrt(R) H).
   subroutine build_solid_spots(data, kind, deck, law)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: kind                     !! CMY or ROSS-STOUTE
      type(deck_type), intent(inout) :: deck   !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the closed side
      character(12), parameter :: cmy(5) = [character(12) :: 'conductivity', 'conductivity', &
         'slope', 'roughness', 'hardness']
      character(12), parameter :: ross_stoute(5) = [character(12) :: 'conductivity', &
         'conductivity', 'roughness', 'hardness', 'a0']
      character(12) :: names(5)
      real(dp) :: value(5), magnitude
      logical :: valid(5)
      integer :: i

      names = cmy
      if (kind == 'ROSS-STOUTE') names = ross_stoute
      valid = .true.
      value = 1.0_dp
      do i = 1, 5
         call need_field(data, i, trim(names(i)), deck, value(i), valid(i))
         if (.not. valid(i) .or. value(i) > 0.0_dp) cycle
         call deck%error(data%place(i), trim(names(i))//' must be positive')
         valid(i) = .false.
      end do
      if (kind == 'CMY') then
         call check_extra(data, 5, 'two conductivities, slope, roughness, hardness', deck)
      else
         call check_extra(data, 5, 'two conductivities, roughness, hardness, a0', deck)
      end if
      law%closed_adds = .true.
      if (.not. all(valid)) return
      if (kind == 'CMY') then
         law%power_n = cmy_exponent
         magnitude = log(cmy_factor*harmonic_mean(value(1), value(2))) + log(value(3)) - &
            log(value(4)) - cmy_exponent*log(value(5))
      else
         law%power_n = 1.0_dp
         magnitude = log(harmonic_mean(value(1), value(2))) - 0.5_dp*log(value(3)) - &
            log(value(4)) - log(value(5))
      end if
      if (magnitude > log(largest_magnitude)) then
         call deck%error(data%place(1), 'the conductance at a pressure of 1 exceeds '// &
            to_text(largest_magnitude))
      else if (kind == 'CMY') then
         law%power_c1 = cmy_factor*harmonic_mean(value(1), value(2))*(value(3)/value(4))/ &
            value(5)**cmy_exponent
      else
         law%power_c1 = harmonic_mean(value(1), value(2))/(sqrt(value(3))*value(4)*value(5))
      end if
   end subroutine build_solid_spots

   pure real(dp) function harmonic_mean(one, other)
      real(dp), intent(in) :: one, other    ! > 0

      harmonic_mean = 2/(1/one + 1/other)
   end function harmonic_mean

   !> omega = A/(B + JUMP + ROUGHNESS + gamma) + radiation; A and B of one row, or of a row for each
   !> mean temperature of the faces.
   subroutine build_gas_law(card, name, constants, deck, law)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(physical_constants_type), intent(in) :: constants
      type(deck_type), intent(inout) :: deck   !! receives notes and errors
      type(conductance_law_type), intent(inout) :: law     !! receives the open side
      real(dp), allocatable :: a(:), b(:), temperature(:)
      integer :: i, n

      law%added_length = length_of(card, 'JUMP', deck) + length_of(card, 'ROUGHNESS', deck)
      call take_emissivity(card, constants, deck, law)
      n = size(card%data)
      allocate (a(n), b(n), temperature(n))
      do i = 1, n
         call read_row(i, a(i), b(i), temperature(i))
      end do
      law%gas_a = a(1)
      law%gas_b = b(1)
      if (n == 1) return
      if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
      law%by_temperature%gas_temperature = temperature
      law%by_temperature%gas_a = a
      law%by_temperature%gas_b = b
      call note_ends('*GAP LAW, TYPE=GAS', name, 'mean temperatures', temperature, deck)
   contains
      !> One row, with values that are sound where those of the deck are not.
      subroutine read_row(i, a, b, at)
         integer, intent(in) :: i
         real(dp), intent(out) :: a, b, at
         logical :: valid(3)

         a = 0.0_dp
         b = 0.0_dp
         at = 0.0_dp
         valid = .true.
         associate (data => card%data(i))
            call need_field(data, 1, 'A', deck, a, valid(1))
            if (law%added_length > 0.0_dp) then
               call take_field(data, 2, 'B', deck, b, valid(2))
            else
               call need_field(data, 2, 'B', deck, b, valid(2))
            end if
            if (n > 1) call need_field(data, 3, 'temperature', deck, at, valid(3))
            if (n == 1) call take_field(data, 3, 'temperature', deck, at, valid(3))
            call check_extra(data, 3, 'A, B of A/(B + gap), temperature', deck)
            call check_values(data, a, b, law%added_length, card%has('EMISSIVITY'), valid(:2), deck)
            if (.not. all(valid(2:)) .or. b + law%added_length <= 0.0_dp) b = 1.0_dp
            if (i == 1 .or. .not. valid(3)) return
            if (at <= temperature(i - 1)) call deck%error(data%place(3), 'temperatures must ascend')
         end associate
      end subroutine read_row
   end subroutine build_gas_law

   !> A is positive, or 0 where faces radiate; B with the lengths that add to it is positive.
   subroutine check_values(data, a, b, added, radiates, valid, deck)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: a, b
      real(dp), intent(in) :: added       ! to B [length]
      logical, intent(in) :: radiates
      logical, intent(in) :: valid(2)     ! whether A and B were read
      type(deck_type), intent(inout) :: deck

      if (valid(1) .and. a < 0.0_dp .and. radiates) then
         call deck%error(data%place(1), 'A must not be negative')
      else if (valid(1) .and. a <= 0.0_dp .and. .not. radiates) then
         call deck%error(data%place(1), 'A must be positive')
      end if
      if (valid(2) .and. b < 0.0_dp) then
         call deck%error(data%place(2), 'B must not be negative')
      else if (valid(2) .and. b + added <= 0.0_dp) then
         call deck%error(data%place(2), 'B must be positive')
      else if (all(valid) .and. a > largest_magnitude*(b + added)) then
         call deck%error(data%place(1), 'the conductance A/B at gap 0 exceeds '// &
            to_text(largest_magnitude))
      end if
   end subroutine check_values

   !> A length that adds to B.
   function length_of(card, name, deck) result(length)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      type(deck_type), intent(inout) :: deck
      real(dp) :: length

      length = 0.0_dp
      call take_parameter(card, name, deck, length)
      if (length >= 0.0_dp) return
      call deck%error(card%place_of(name), name//'= must not be negative')
      length = 0.0_dp
   end function length_of

   !> sigma eps of the radiation between the faces.
   subroutine take_emissivity(card, constants, deck, law)
      type(keyword_card_type), intent(in) :: card
      type(physical_constants_type), intent(in) :: constants
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law
      real(dp) :: emissivity

      if (.not. card%has('EMISSIVITY')) return
      emissivity = 1.0_dp
      call take_parameter(card, 'EMISSIVITY', deck, emissivity)
      if (emissivity <= 0.0_dp .or. emissivity > 1.0_dp) call deck%error( &
         card%place_of('EMISSIVITY'), 'EMISSIVITY= must be above 0 and at most 1')
      if (.not. constants%has_radiation) call deck%error(card%place_of('EMISSIVITY'), &
         'EMISSIVITY= needs *PHYSICAL CONSTANTS, ABSOLUTE ZERO=, STEFAN BOLTZMANN=')
      if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
      law%by_temperature%radiance = max(emissivity, 0.0_dp)*constants%stefan_boltzmann
      law%by_temperature%absolute_zero = constants%absolute_zero
   end subroutine take_emissivity

end module deck_builder_gap_laws
