!> Slips that steps with heat show: contact without a law for its conductance, films on faces in
!> contact, coefficients of expansion in another unit than the temperatures; and constants in other
!> units than *OPTIONS, UNITS= says.
module heat_checks
   use conductance_laws, only: law_none
   use contact_definitions, only: is_removed
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use equations, only: facing_nodes
   use facing_faces, only: lie_on
   use kinds, only: dp
   use load_requests, only: request_type
   use materials, only: follows_temperature, heat_capacity, of_expansion, property_keywords
   use model, only: model_type
   use steps, only: dof_temperature, load_film_coefficient, load_film_sink, load_temperature, &
      solves_heat, solves_mechanics
   use text, only: counted, to_text, to_upper
   implicit none
   private
   public :: check_heat_paths, check_starts, check_units

   real(dp), parameter :: small_strain = 0.1_dp   !! largest for which small strains hold
   real(dp), parameter :: far = 0.25_dp   !! of a table's span, from ZERO= to where bodies start

   !> Stefan-Boltzmann constant, CODATA 2018 [W/(m^2 K^4)].
   real(dp), parameter :: stefan_boltzmann = 5.670374419e-8_dp

   !> A unit by its labels, which blanks separate.
   type :: unit_type
      character(25) :: labels
      real(dp) :: size                !! [K], [m], [W], [Pa]
      real(dp) :: zero = 0.0_dp       !! absolute zero of a scale of temperature
   end type unit_type

   type(unit_type), parameter :: temperatures(4) = [ &
      unit_type('C CELSIUS', 1.0_dp, -273.15_dp), unit_type('K KELVIN', 1.0_dp), &
      unit_type('F FAHRENHEIT', 5.0_dp/9, -459.67_dp), unit_type('R RANKINE', 5.0_dp/9)]

   type(unit_type), parameter :: lengths(7) = [ &
      unit_type('M', 1.0_dp), unit_type('DM', 1.0e-1_dp), unit_type('CM', 1.0e-2_dp), &
      unit_type('MM', 1.0e-3_dp), unit_type('UM', 1.0e-6_dp), unit_type('FT', 0.3048_dp), &
      unit_type('IN INCH', 0.0254_dp)]

   !> Labels of power are as written: m is milli and M mega.
   type(unit_type), parameter :: powers(7) = [ &
      unit_type('W w J/s', 1.0_dp), unit_type('mW mJ/s Nmm/s N*mm/s', 1.0e-3_dp), &
      unit_type('kW KW kJ/s', 1.0e3_dp), unit_type('MW MJ/s', 1.0e6_dp), &
      unit_type('erg/s', 1.0e-7_dp), unit_type('BTU/s Btu/s', 1055.05585_dp), &
      unit_type('BTU/h Btu/h BTU/hr Btu/hr', 0.29307107_dp)]

   type(unit_type), parameter :: stresses(7) = [ &
      unit_type('PA N/M2 N/M^2', 1.0_dp), unit_type('KPA', 1.0e3_dp), &
      unit_type('MPA N/MM2 N/MM^2', 1.0e6_dp), unit_type('GPA', 1.0e9_dp), &
      unit_type('BAR', 1.0e5_dp), unit_type('PSI', 6894.757_dp), unit_type('KSI', 6.894757e6_dp)]

   ! Least and largest of solids: gels, and a thousand times diamond, because stiff bodies stand for
   ! rigid ones; aerogels and pure copper at 20 K.
   real(dp), parameter :: moduli(2) = [1.0e3_dp, 1.2e15_dp]         !! [Pa]
   real(dp), parameter :: conductivities(2) = [1.0e-2_dp, 1.0e4_dp] !! [W/(m K)]
   ! Of latent over specific heat: white phosphorus has 27, carbon 14,000.
   real(dp), parameter :: latent_ratios(2) = [5.0_dp, 2.0e4_dp]   !! [K]

   real(dp), parameter :: other_digits = 0.01_dp   !! relative difference of a constant
   real(dp), parameter :: other_scale = 0.5_dp     !! difference of absolute zero [K]

contains

   !> Warns of contact pairs that no heat crosses, of films on their faces, and of materials
   !> whose expansion over the range of the temperatures of the deck is no small strain.
   subroutine check_heat_paths(deck)
      type(deck_type), intent(inout) :: deck
      integer :: i

      call check_expansion(deck)
      if (.not. any(solves_heat(deck%model%steps%analysis))) return
      call check_films(deck)
      do i = 1, size(deck%model%contacts)
         associate (contact => deck%model%contacts(i), interaction => &
            deck%model%interactions(deck%model%contacts(i)%interaction))
            if (interaction%law%open_kind /= law_none) cycle
            if (interaction%law%closed_kind /= law_none) cycle
            call deck%warning(place_type(image=contact%card), 'no heat crosses '//contact%name// &
               ': its interaction '//interaction%name//' has no conductance law; give it *GAP '// &
               'CONDUCTANCE or *GAP LAW')
         end associate
      end do
   end subroutine check_heat_paths

   !> Warns of films on faces that touch the other surface of a contact pair; heat fluxes there may
   !> stand for friction. The mesh is not refined yet.
   subroutine check_films(deck)
      type(deck_type), intent(inout) :: deck
      integer :: film(4, size(deck%mesh%element_number))   ! the last one of each side, or 0
      integer :: i, on_master, on_slave

      if (deck%loads%count == 0) return
      associate (loads => deck%loads%items(:deck%loads%count))
         if (all(loads%kind /= load_film_coefficient)) return
         film = 0
         do i = 1, size(loads)
            if (loads(i)%kind == load_film_coefficient) film(loads(i)%component, &
               loads(i)%members(deck%mesh%element_sets)) = i
         end do
         do i = 1, size(deck%model%contacts)
            associate (contact => deck%model%contacts(i), surfaces => deck%mesh%surfaces)
               if (allocated(surfaces(contact%master)%drawing)) cycle
               on_slave = film_between(surfaces(contact%slave)%faces, &
                  surfaces(contact%master)%faces)
               on_master = film_between(surfaces(contact%master)%faces, &
                  surfaces(contact%slave)%faces)
               if (max(on_slave, on_master) > 0) call deck%warning( &
                  loads(max(on_slave, on_master))%place, 'the film acts on faces of '// &
                  contact%title()//' that touch the other surface; leave these faces out')
            end associate
         end do
      end associate
   contains
      !> The last film on faces that touch others while the contact pair is not removed, or 0.
      integer function film_between(faces, opposite) result(last)
         integer, intent(in) :: faces(:, :), opposite(:, :)   ! (2, n) as in a surface
         integer :: films(size(faces, 2)), k

         films = [(film(faces(2, k), faces(1, k)), k=1, size(films))]
         do k = 1, size(films)
            if (films(k) == 0) cycle
            associate (step => deck%loads%items(films(k))%step)
               if (is_removed(deck%model%steps(:step)%changes, i)) films(k) = 0
            end associate
         end do
         last = 0
         if (any(films > 0)) last = maxval(merge(films, 0, lie_on(deck%mesh, faces, opposite)))
      end function film_between
   end subroutine check_films

   !> Warns of nodes of bodies without an initial temperature where others have one that is not 0.
   !> The mesh is not refined yet.
   subroutine check_starts(deck)
      type(deck_type), intent(inout) :: deck
      logical :: starts_at_0(0:size(deck%mesh%node_number))
      integer :: i

      associate (given => deck%temperatures, mesh => deck%mesh)
         if (given%count == 0) then
            call check_no_start(deck)
            return
         end if
         if (.not. any(abs(given%items(:given%count)%value) > 0.0_dp)) return
         if (.not. (any(solves_heat(deck%model%steps%analysis)) .or. &
            any(deck%model%materials%has(of_expansion)))) return
         starts_at_0 = .false.
         starts_at_0([mesh%element_nodes]) = .true.
         starts_at_0(0) = .false.
         where (deck%dropped) starts_at_0(1:) = .false.
         do i = 1, given%count
            starts_at_0(given%items(i)%members(mesh%node_sets)) = .false.
         end do
         do i = 1, size(deck%model%couplings)
            if (.not. deck%model%couplings(i)%is_section()) cycle
            associate (pairs => facing_nodes(deck%model%couplings(i), mesh))
               starts_at_0(pairs(2, :)) = .false.
            end associate
         end do
         if (.not. any(starts_at_0)) return
         call deck%warning(given%items(1)%place, 'these cards give no initial temperature to '// &
            counted(count(starts_at_0), 'node')//' of the bodies, such as '// &
            to_text(mesh%node_number(findloc(starts_at_0(1:), .true., dim=1)))//': they start at 0')
      end associate
   end subroutine check_starts

   !> Warns where bodies that expand are heated and no initial temperature is given, unless a
   !> temperature of 0 or on either side of it shows that they count from 0.
   subroutine check_no_start(deck)
      type(deck_type), intent(inout) :: deck
      type(request_type), allocatable :: given(:)
      integer :: i

      if (.not. any(solves_mechanics(deck%model%steps%analysis))) return
      if (.not. any([(maxval(abs(deck%model%materials(deck%model%sections(i)%material)%expansion)) &
         > 0.0_dp, i=1, size(deck%model%sections))])) return
      associate (boundaries => deck%boundaries, loads => deck%loads)
         allocate (given(0))
         if (boundaries%count > 0) given = pack(boundaries%items(:boundaries%count), &
            boundaries%items(:boundaries%count)%component == dof_temperature)
         if (loads%count > 0) given = [given, pack(loads%items(:loads%count), &
            loads%items(:loads%count)%kind == load_temperature .or. &
            loads%items(:loads%count)%kind == load_film_sink)]
      end associate
      if (size(given) == 0) return
      if (minval(given%value) <= 0.0_dp .and. maxval(given%value) >= 0.0_dp) return
      call deck%warning(given(1)%place, 'temperatures are prescribed, but no initial one is '// &
         'given: bodies expand from 0; give *INITIAL CONDITIONS, TYPE=TEMPERATURE, with the '// &
         'value 0 where temperatures are rises')
   end subroutine check_no_start

   !> Warns of the first *EXPANSION that is too large for small strains, and of tables whose secants
   !> begin far from the initial temperature: farther than a quarter of what the table spans.
   subroutine check_expansion(deck)
      type(deck_type), intent(inout) :: deck
      real(dp) :: ends(2), initial, range, strain
      integer :: e, i, k, m
      logical :: is_told

      ends = temperature_range(deck%model)
      range = ends(2) - ends(1)
      is_told = .false.
      m = 0
      do k = 1, size(deck%cards%keywords)
         if (deck%cards%keywords(k)%name == 'MATERIAL') m = m + 1
         if (deck%cards%keywords(k)%name /= 'EXPANSION' .or. m == 0) cycle
         e = findloc(deck%model%sections(deck%mesh%element_section)%material, m, dim=1)
         associate (material => deck%model%materials(m), place => deck%cards%keywords(k)%place)
            strain = maxval(abs(material%expansion))*range
            if (strain > small_strain .and. .not. is_told .and. &
               any(deck%model%sections%material == m)) then
               call deck%warning(place, 'the expansion of '//material%name//' over the range '// &
                  'of the temperatures, '//to_text(range)//', is a strain of '//to_text(strain)// &
                  ', but the theory assumes small strains; check the unit of *EXPANSION, '// &
                  '1/temperature')
               is_told = .true.
            end if
            if (e == 0 .or. .not. follows_temperature(material, of_expansion)) cycle
            ! Strains of a solid count from where it forms.
            if (material%law%annealing > 0 .and. material%no_strain <= &
               material%law%anneal_temperature) cycle
            i = findloc(material%given%kind, of_expansion, dim=1)
            initial = deck%model%initial_temperature(deck%mesh%element_nodes(1, e))
            associate (rows => material%given(i)%temperature)
               if (abs(initial - material%no_strain) <= far*(rows(size(rows)) - rows(1))) cycle
            end associate
            call deck%warning(place, 'the coefficients of '//material%name//' are secants from '// &
               'ZERO='//to_text(material%no_strain)//' on, far from the initial temperature '// &
               to_text(initial)//'; give the ZERO= that they were measured from')
         end associate
      end do
   end subroutine check_expansion

   !> Least and largest of the temperatures that the deck gives: initial ones, prescribed ones and
   !> sinks of films, with the extreme factors of their amplitudes.
   pure function temperature_range(model) result(ends)
      type(model_type), intent(in) :: model      !! with its loads and supports
      real(dp) :: ends(2)                        !! [temperature]
      integer :: i, s

      associate (start => model%initial_temperature, used => model%mesh%node_body > 0)
         ends = [minval(start, mask=used), maxval(start, mask=used)]
      end associate
      do s = 1, size(model%steps)
         associate (boundaries => model%steps(s)%boundaries, loads => model%steps(s)%loads)
            do i = 1, size(boundaries)
               if (boundaries(i)%dof == dof_temperature) call widen(model, &
                  boundaries(i)%value, boundaries(i)%amplitude, ends)
            end do
            do i = 1, size(loads)
               if (any(loads(i)%kind == [load_temperature, load_film_sink])) call widen(model, &
                  loads(i)%value, loads(i)%amplitude, ends)
            end do
         end associate
      end do
   end function temperature_range

   !> Widens a range to a value; where it follows an amplitude, to all values that this gives it.
   pure subroutine widen(model, value, amplitude, ends)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: value
      integer, intent(in) :: amplitude   ! index into model%amplitudes, or 0
      real(dp), intent(inout) :: ends(2)

      if (amplitude == 0) then
         ends = [min(ends(1), value), max(ends(2), value)]
      else
         associate (factors => model%amplitudes(amplitude)%values)
            ends = [min(ends(1), minval(value*factors)), max(ends(2), maxval(value*factors))]
         end associate
      end if
   end subroutine widen

   !> Warns of constants in other units than the deck says, and of temperatures below absolute zero:
   !> of what was read, where the deck has errors.
   subroutine check_units(deck)
      type(deck_type), intent(inout) :: deck
      type(unit_type) :: degree, metre, pascal, watt
      real(dp) :: constant, ratio
      integer :: k, m

      degree = unit_of(scale_label(deck%model%units%temperature), temperatures)
      metre = unit_of(to_upper(deck%model%units%length), lengths)
      watt = unit_of(deck%model%units%power, powers)
      pascal = unit_of(to_upper(deck%model%units%stress), stresses)
      m = 0
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         select case (deck%card%name)
         case ('PHYSICAL CONSTANTS')
            if (deck%has_errors()) cycle   ! it may have one, or temperatures
            call check_zero(degree, deck)
            if (min(degree%size, metre%size, watt%size) <= 0.0_dp .or. .not. deck%card%has( &
               'STEFAN BOLTZMANN')) cycle
            constant = stefan_boltzmann*metre%size**2*degree%size**4/watt%size
            associate (given => deck%model%constants%stefan_boltzmann, units => deck%model%units)
               if (abs(given - constant) <= other_digits*constant) cycle
               call deck%warning(deck%card%place_of('STEFAN BOLTZMANN'), 'the constant of '// &
                  'Stefan and Boltzmann is '//to_text(given)//', but '//to_text(constant)// &
                  ' in the units of *OPTIONS, UNITS=, '//units%power//'/('//units%length//'^2 '// &
                  units%temperature//'^4); give that, or correct UNITS=')
            end associate
         case ('MATERIAL')
            m = m + 1
         case ('ELASTIC')
            if (any(solves_mechanics(deck%model%steps%analysis))) call check_property(m, &
               pascal%size, deck)
         case ('CONDUCTIVITY')
            if (min(degree%size, metre%size) > 0.0_dp .and. &
               any(solves_heat(deck%model%steps%analysis))) call check_property(m, &
               watt%size/(metre%size*degree%size), deck)
         case ('LATENT HEAT')
            if (m == 0 .or. degree%size <= 0.0_dp) cycle
            associate (material => deck%model%materials(m))
               if (.not. allocated(material%melting) .or. heat_capacity(material) <= 0.0_dp) cycle
               ratio = degree%size*sum(material%melting%content)/heat_capacity(material)
               if (ratio < latent_ratios(1) .or. ratio > latent_ratios(2)) call deck%warning( &
                  deck%card%place, 'the latent heat of '//material%name//' is '//to_text(ratio)// &
                  ' K times its specific heat, beyond the '//to_text(latent_ratios(1))//' to '// &
                  to_text(latent_ratios(2))//' K of solids; give it in the units of *SPECIFIC '// &
                  'HEAT, such as J/kg, not kJ/kg')
            end associate
         case default
            cycle
         end select
      end do
   end subroutine check_units

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

   !> Finds a unit; its size is 0 where the label is not known.
   pure type(unit_type) function unit_of(label, units)
      character(*), intent(in) :: label
      type(unit_type), intent(in) :: units(:)
      integer :: i

      unit_of = unit_type('', 0.0_dp)
      do i = 1, size(units)
         if (index(' '//trim(units(i)%labels)//' ', ' '//label//' ') > 0) unit_of = units(i)
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

end module heat_checks
