!> Properties and constants in other units than *OPTIONS, UNITS= says.
module unit_checks
   use deck_context, only: deck_type
   use heat_checks, only: temperature_range
   use kinds, only: dp
   use materials, only: heat_capacity, of_density, of_specific_heat, property_keywords
   use model, only: unit_labels_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: string_type, to_text, to_upper
   implicit none
   private
   public :: check_units

   !> Stefan-Boltzmann constant, CODATA 2018 [W/(m^2 K^4)].
   real(dp), parameter :: stefan_boltzmann = 5.670374419e-8_dp

   !> A unit by its labels, which blanks separate; in capitals, but for those of power.
   type :: unit_type
      character(11) :: kind
      character(25) :: labels
      real(dp) :: size                !! [K], [m], [W], [Pa], [s]
      real(dp) :: zero = 0.0_dp       !! absolute zero of a scale of temperature
   end type unit_type

   !> Known units; of forces, which UNITS= does not have, only labels.
   type(unit_type), parameter :: known(31) = [ &
      unit_type('length', 'M', 1.0_dp), unit_type('length', 'DM', 1.0e-1_dp), &
      unit_type('length', 'CM', 1.0e-2_dp), unit_type('length', 'MM', 1.0e-3_dp), &
      unit_type('length', 'UM', 1.0e-6_dp), unit_type('length', 'FT', 0.3048_dp), &
      unit_type('length', 'IN INCH', 0.0254_dp), &
      unit_type('stress', 'PA N/M2 N/M^2', 1.0_dp), unit_type('stress', 'KPA', 1.0e3_dp), &
      unit_type('stress', 'MPA N/MM2 N/MM^2', 1.0e6_dp), unit_type('stress', 'GPA', 1.0e9_dp), &
      unit_type('stress', 'BAR', 1.0e5_dp), unit_type('stress', 'PSI', 6894.757_dp), &
      unit_type('stress', 'KSI', 6.894757e6_dp), &
      unit_type('power', 'W w J/s', 1.0_dp), &
      unit_type('power', 'mW mJ/s Nmm/s N*mm/s', 1.0e-3_dp), &   ! m is milli and M mega
      unit_type('power', 'kW KW kJ/s', 1.0e3_dp), unit_type('power', 'MW MJ/s', 1.0e6_dp), &
      unit_type('power', 'erg/s', 1.0e-7_dp), unit_type('power', 'BTU/s Btu/s', 1055.05585_dp), &
      unit_type('power', 'BTU/h Btu/h BTU/hr Btu/hr', 0.29307107_dp), &
      unit_type('temperature', 'C CELSIUS', 1.0_dp, -273.15_dp), &
      unit_type('temperature', 'K KELVIN', 1.0_dp), &
      unit_type('temperature', 'F FAHRENHEIT', 5.0_dp/9, -459.67_dp), &
      unit_type('temperature', 'R RANKINE', 5.0_dp/9), &
      unit_type('time', 'S SEC', 1.0_dp), unit_type('time', 'MS', 1.0e-3_dp), &
      unit_type('time', 'MIN', 60.0_dp), unit_type('time', 'H HR', 3600.0_dp), &
      unit_type('time', 'D DAY', 86400.0_dp), &
      unit_type('force', 'N KN MN KGF LBF', 1.0_dp)]

   !> Kinds in the order of UNITS=.
   character(*), parameter :: kinds(5) = [character(11) :: 'length', 'stress', 'power', &
      'temperature', 'time']

   ! Least and largest of solids: gels, and a thousand times diamond, because stiff bodies stand for
   ! rigid ones; aerogels and pure copper at 20 K.
   real(dp), parameter :: moduli(2) = [1.0e3_dp, 1.2e15_dp]         !! [Pa]
   real(dp), parameter :: conductivities(2) = [1.0e-2_dp, 1.0e4_dp] !! [W/(m K)]
   real(dp), parameter :: capacities(2) = [1.0e4_dp, 1.0e7_dp]      !! [J/(m^3 K)]: foams
   ! Of latent over specific heat: white phosphorus has 27, carbon 14,000.
   real(dp), parameter :: latent_ratios(2) = [5.0_dp, 2.0e4_dp]   !! [K]

   real(dp), parameter :: other_digits = 0.01_dp   !! relative difference of a constant
   real(dp), parameter :: other_scale = 0.5_dp     !! difference of absolute zero [K]

contains

   !> Warns of constants in other units than the deck says, and of temperatures below absolute zero:
   !> of what was read, where the deck has errors.
   subroutine check_units(deck)
      type(deck_type), intent(inout) :: deck
      type(unit_type) :: degree, metre, pascal, second, watt
      real(dp) :: heat, work   ! [J] of the units of heat and work, 0 where not known
      integer :: interaction, k, m

      associate (units => deck%model%units)
         degree = unit_of(units%temperature, 'temperature')
         metre = unit_of(units%length, 'length')
         watt = unit_of(units%power, 'power')
         pascal = unit_of(units%stress, 'stress')
         second = unit_of(time_label(units), 'time')
      end associate
      heat = watt%size*second%size
      work = pascal%size*metre%size**3
      m = 0
      interaction = 0
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         select case (deck%card%name)
         case ('OPTIONS')
            if (deck%card%has('UNITS')) call check_labels(deck)
         case ('PHYSICAL CONSTANTS')
            if (deck%has_errors()) cycle   ! it may have one, or temperatures
            call check_zero(degree, deck)
            if (min(degree%size, metre%size, watt%size) > 0.0_dp) call check_boltzmann( &
               stefan_boltzmann*metre%size**2*degree%size**4/watt%size, deck)
         case ('MATERIAL')
            m = m + 1
         case ('SURFACE INTERACTION')
            interaction = interaction + 1
         case ('ELASTIC')
            if (any(solves_mechanics(deck%model%steps%analysis))) call check_property(m, &
               pascal%size, deck)
         case ('CONDUCTIVITY')
            if (min(degree%size, metre%size) > 0.0_dp .and. &
               any(solves_heat(deck%model%steps%analysis))) call check_property(m, &
               watt%size/(metre%size*degree%size), deck)
         case ('SPECIFIC HEAT')
            if (min(degree%size, metre%size) > 0.0_dp) call check_capacity(m, heat/( &
               metre%size**3*degree%size), deck)
         case ('LATENT HEAT')
            if (degree%size > 0.0_dp) call check_latent_heat(m, degree%size, deck)
         case ('GAP HEAT GENERATION')
            if (deck%has_errors()) cycle
            call check_part(deck%model%interactions(interaction)%heat%efficiency, work, heat, deck)
         case ('INELASTIC HEAT FRACTION')
            if (deck%has_errors()) cycle
            call check_part(deck%model%materials(m)%law%heat_fraction, work, heat, deck)
         case default
            cycle
         end select
      end do
      k = findloc(deck%model%steps%dilates, .true., dim=1)
      if (k == 0 .or. min(work, heat) <= 0.0_dp) return
      if (abs(work - heat) > other_digits*heat) call deck%warning(deck%analysis_place(k), &
         'DILATATION counts the work of strains as heat, but '//rate_of_work(deck%model%units, &
         work/heat)//' in the units of *OPTIONS, UNITS=; give power in stress length^3/time, '// &
         'or correct UNITS=')
   end subroutine check_units

   !> Warns of a constant of radiation that is another one.
   subroutine check_boltzmann(constant, deck)
      real(dp), intent(in) :: constant                    ! in the units of the deck
      type(deck_type), intent(inout) :: deck

      if (.not. deck%card%has('STEFAN BOLTZMANN')) return
      associate (given => deck%model%constants%stefan_boltzmann, units => deck%model%units)
         if (abs(given - constant) > other_digits*constant) call deck%warning( &
            deck%card%place_of('STEFAN BOLTZMANN'), 'the constant of Stefan and Boltzmann is '// &
            to_text(given)//', but '//to_text(constant)//' in the units of *OPTIONS, UNITS=, '// &
            units%power//'/('//units%length//'^2 '//units%temperature//'^4); give that, or '// &
            'correct UNITS=')
      end associate
   end subroutine check_boltzmann

   !> Warns of the first label of UNITS= that is no known unit of its place but one of another.
   subroutine check_labels(deck)
      type(deck_type), intent(inout) :: deck
      type(string_type) :: labels(5)
      type(unit_type) :: unit
      integer :: place

      labels(1)%value = deck%model%units%length
      labels(2)%value = deck%model%units%stress
      labels(3)%value = deck%model%units%power
      labels(4)%value = deck%model%units%temperature
      labels(5)%value = deck%model%units%time
      do place = 1, size(labels)
         unit = unit_of(labels(place)%value, kinds(place))
         if (unit%size <= 0.0_dp) unit = unit_of(labels(place)%value)
         if (unit%size <= 0.0_dp .or. unit%kind == kinds(place)) cycle
         call deck%warning(deck%card%place_of('UNITS'), labels(place)%value//' is a '// &
            trim(unit%kind)//', but stands where the '//trim(kinds(place))//' is: UNITS= '// &
            'has length, stress, power, temperature, time')
         return
      end do
   end subroutine check_labels

   !> How much heat work is, in units of the deck.
   pure function rate_of_work(units, heat) result(words)
      type(unit_labels_type), intent(in) :: units
      real(dp), intent(in) :: heat               !! of a unit of work
      character(:), allocatable :: words

      words = '1 '//units%stress//' '//units%length//'^3/'//time_label(units)//' is '// &
         to_text(heat)//' '//units%power
   end function rate_of_work

   !> The unit of time: seconds where the deck says none.
   pure function time_label(units) result(label)
      type(unit_labels_type), intent(in) :: units
      character(:), allocatable :: label

      label = units%time
      if (label == '') label = 's'
   end function time_label

   !> Warns of a part of work that becomes more heat than it is, or next to none.
   subroutine check_part(part, work, heat, deck)
      real(dp), intent(in) :: part, work, heat            ! [heat/work], units [J] or 0
      type(deck_type), intent(inout) :: deck

      if (min(part, work, heat) <= 0.0_dp) return
      if (part*heat <= (1 + other_digits)*work .and. part*heat >= other_digits*work) return
      call deck%warning(deck%card%place, 'the heat per work is '//to_text(part)//', but '// &
         to_text(work/heat)//' turns all work into heat in the units of *OPTIONS, UNITS=, '// &
         'where '//rate_of_work(deck%model%units, work/heat)//'; give a part of that, or '// &
         'correct UNITS=')
   end subroutine check_part

   !> Warns of a heat of melting that is far from those of solids beside the specific heat.
   subroutine check_latent_heat(m, degree, deck)
      integer, intent(in) :: m                            ! index of its material, or 0
      real(dp), intent(in) :: degree                      ! [K]
      type(deck_type), intent(inout) :: deck
      real(dp) :: ratio

      if (m == 0) return
      associate (material => deck%model%materials(m))
         if (.not. allocated(material%melting) .or. heat_capacity(material) <= 0.0_dp) return
         ratio = degree*sum(material%melting%content)/heat_capacity(material)
         if (ratio < latent_ratios(1) .or. ratio > latent_ratios(2)) call deck%warning( &
            deck%card%place, 'the latent heat of '//material%name//' is '//to_text(ratio)// &
            ' K times its specific heat, beyond the '//to_text(latent_ratios(1))//' to '// &
            to_text(latent_ratios(2))//' K of solids; give it in the units of *SPECIFIC '// &
            'HEAT, such as J/kg, not kJ/kg')
      end associate
   end subroutine check_latent_heat

   !> Warns of a density times specific heat that at no temperature is one of a solid: a table may
   !> have the heat of a transition, or have little of it where it is cold.
   subroutine check_capacity(m, unit, deck)
      integer, intent(in) :: m                            ! index of its material, or 0
      real(dp), intent(in) :: unit                        ! [J/(m^3 K)], 0 where not known
      type(deck_type), intent(inout) :: deck
      real(dp) :: ends(2)
      integer :: i

      if (m == 0 .or. unit <= 0.0_dp .or. .not. any(deck%model%steps%is_transient)) return
      associate (material => deck%model%materials(m))
         if (heat_capacity(material) <= 0.0_dp) return
         ends = unit
         do i = 1, size(material%given)
            associate (rows => material%given(i)%values(1, :))
               if (any(material%given(i)%kind == [of_density, of_specific_heat])) ends = ends* &
                  [minval(rows), maxval(rows)]
            end associate
         end do
         if (ends(2) >= capacities(1) .and. ends(1) <= capacities(2)) return
         call deck%warning(deck%card%place, 'density times specific heat of '//material%name// &
            ' is '//to_text(merge(ends(1), ends(2), ends(1) > capacities(2)))//' J/(m^3 K) in '// &
            'the units of *OPTIONS, UNITS=, beyond the '//to_text(capacities(1))//' to '// &
            to_text(capacities(2))//' J/(m^3 K) of solids; give both in those units, '// &
            'or correct UNITS=')
      end associate
   end subroutine check_capacity

   !> Warns of a property whose first constant is none of a solid.
   subroutine check_property(m, unit, deck)
      integer, intent(in) :: m                            ! index of its material, or 0
      real(dp), intent(in) :: unit                        ! [Pa] or [W/(m K)], 0 where not known
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: si_unit
      real(dp) :: ends(2), value
      integer :: i

      if (m == 0 .or. unit <= 0.0_dp) return
      ends = merge(moduli, conductivities, deck%card%name == 'ELASTIC')
      si_unit = trim(merge('Pa     ', 'W/(m K)', deck%card%name == 'ELASTIC'))
      associate (material => deck%model%materials(m))
         if (.not. allocated(material%given)) return
         do i = 1, size(material%given)
            if (property_keywords(material%given(i)%kind) /= deck%card%name) cycle
            value = maxval(material%given(i)%values(1, :))
            if (value*unit <= ends(2)) value = minval(material%given(i)%values(1, :))
            if (value*unit >= ends(1) .and. value*unit <= ends(2)) cycle
            call deck%warning(deck%card%place, trim(material%given(i)%names(1))//' '// &
               to_text(value)//' of '//material%name//' is '//to_text(value*unit)//' '//si_unit// &
               ' in the units of *OPTIONS, UNITS=, beyond the '//to_text(ends(1))//' to '// &
               to_text(ends(2))//' '//si_unit//' of solids; give it in those units, or correct '// &
               'UNITS=')
         end do
      end associate
   end subroutine check_property

   subroutine check_zero(scale, deck)
      type(unit_type), intent(in) :: scale                ! of temperature
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: message
      real(dp) :: least(2)

      if (.not. deck%card%has('ABSOLUTE ZERO')) return
      least = temperature_range(deck%model)
      associate (given => deck%model%constants%absolute_zero, label => deck%model%units%temperature)
         message = 'absolute zero is '//to_text(given)
         if (abs(given - scale%zero)*scale%size > other_scale) then
            message = message//', but '//to_text(scale%zero)//' in '//label//', the unit of '// &
               '*OPTIONS, UNITS=; give that, or correct UNITS='
         else if (given > 0.0_dp) then
            message = message//', above 0: it is -273.15 in C, -459.67 in F and 0 in K'
         else if (least(1) < given) then
            message = message//', but the deck has a temperature of '//to_text(least(1))// &
               ', below it; give both in one unit: absolute zero is -273.15 in C, -459.67 in F '// &
               'and 0 in K'
         else
            return
         end if
      end associate
      call deck%warning(deck%card%place_of('ABSOLUTE ZERO'), message)
   end subroutine check_zero

   !> Finds a unit of a kind, or of any; its size is 0 where the label is not known.
   pure type(unit_type) function unit_of(label, kind)
      character(*), intent(in) :: label
      character(*), intent(in), optional :: kind
      character(:), allocatable :: sought
      integer :: i

      unit_of = unit_type('', '', 0.0_dp)
      do i = 1, size(known)
         if (present(kind)) then
            if (known(i)%kind /= kind) cycle
         end if
         sought = to_upper(label)
         if (known(i)%kind == 'power') sought = label
         if (known(i)%kind == 'temperature') sought = scale_label(label)
         if (index(' '//trim(known(i)%labels)//' ', ' '//sought//' ') == 0) cycle
         unit_of = known(i)
         return
      end do
   end function unit_of

   !> A label of a scale of temperature without the sign or the word for a degree.
   pure function scale_label(label) result(name)
      character(*), intent(in) :: label
      character(*), parameter :: degree_sign = char(194)//char(176)
      character(:), allocatable :: name

      name = to_upper(label)
      if (index(name, degree_sign) == 1) name = name(3:)
      if (index(name, 'DEG') == 1) name = name(4:)
   end function scale_label

end module unit_checks
