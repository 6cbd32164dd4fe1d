!> Slips that steps with heat show: contact without a law for its conductance, films on faces in
!> contact, and coefficients of expansion in another unit than the temperatures.
module heat_checks
   use amplitudes, only: amplitude_value
   use conductance_laws, only: law_none
   use contact_definitions, only: is_removed
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use equations, only: facing_nodes
   use facing_faces, only: lie_on
   use kinds, only: dp
   use load_requests, only: request_type
   use materials, only: follows_temperature, of_expansion
   use model, only: model_type
   use steps, only: dof_temperature, load_film_coefficient, load_film_sink, load_temperature, &
      solves_heat, solves_mechanics
   use text, only: counted, to_text
   implicit none
   private
   public :: check_heat_paths, check_starts, temperature_range

   real(dp), parameter :: small_strain = 0.1_dp   !! largest for which small strains hold
   real(dp), parameter :: far = 0.25_dp   !! of a table's span, from ZERO= to where bodies start

contains

   !> Warns of contact pairs that no heat crosses, of films on their faces, and of materials
   !> whose expansion over the range of the temperatures of the deck is no small strain.
   subroutine check_heat_paths(deck)
      type(deck_type), intent(inout) :: deck
      integer :: i

      call check_expansion(deck)
      if (.not. any(solves_heat(deck%model%steps%analysis))) return
      call check_films(deck)
      call check_jump(deck)
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

   !> Warns of the first temperature that an amplitude takes from the initial one to 0 at once.
   subroutine check_jump(deck)
      type(deck_type), intent(inout) :: deck
      real(dp) :: time
      integer :: b, s

      s = findloc(solves_heat(deck%model%steps%analysis), .true., dim=1)
      do b = 1, size(deck%model%steps(s)%boundaries)
         associate (given => deck%model%steps(s)%boundaries(b), requests => &
            deck%boundaries%items(:deck%boundaries%count))
            if (given%dof /= dof_temperature .or. given%amplitude == 0 .or. &
               abs(given%value) <= 0.0_dp) cycle
            associate (curve => deck%model%amplitudes(given%amplitude), &
               initial => deck%model%initial_temperature(given%node))
               time = merge(sum(deck%model%steps(:s - 1)%period), 0.0_dp, curve%total_time)
               if (abs(amplitude_value(curve, time)) > 0.0_dp .or. abs(initial) <= 0.0_dp) cycle
               call deck%warning(requests(findloc(requests%card, given%card, dim=1))%place, &
                  'the temperature jumps from '//to_text(initial)//' to 0 as step '//to_text(s)// &
                  ' begins: factors of an amplitude multiply the value, and '//curve%name// &
                  ' begins with 0; '//to_text(initial/given%value)//' is the factor for '// &
                  to_text(initial))
               return
            end associate
         end associate
      end do
   end subroutine check_jump

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

end module heat_checks
