!> *SURFACE INTERACTION with *FRICTION and *SURFACE BEHAVIOR, and the laws of its conductance.
module deck_builder_interactions
   use card_values, only: choice, take_parameter, check_ascending, check_unneeded, read_row, &
      read_rows
   use conductance_laws, only: conductance, conductance_law_type, law_jump, law_none, &
      table_jump, varies_with_temperature
   use contact_definitions, only: interaction_type
   use deck_builder_gap_laws, only: build_gap_conductance, is_of_clearance, build_friction_heat, &
      build_gap_radiation, build_gap_law
   use deck_context, only: deck_type
   use deck_report, only: frictionless
   use deck_source, only: place_type
   use deck_structure, only: cards_of
   use friction_laws, only: friction_law_type, rough_coefficient
   use kinds, only: dp
   use overlap_laws, only: overlap_law_type
   use temperature_laws, only: face_temperatures_type, largest_jump, law_at, radiation_ends
   use text, only: to_text, to_upper
   use wear_laws, only: wear_law_type
   implicit none
   private
   public :: build_interactions, build_friction

   real(dp), parameter :: continuous = 1.0e-6_dp   !! a smaller jump is none, relative
   real(dp), parameter :: largest_usual = 5.0_dp   !! coefficient, of rubber and of rough joints

contains

   !> Builds all surface interactions; a law belongs to the last *SURFACE INTERACTION before it.
   subroutine build_interactions(deck)
      type(deck_type), intent(inout) :: deck
      type(interaction_type) :: interaction
      type(place_type) :: law_place
      real(dp) :: thickness(1)
      integer :: k, n, errors
      logical :: valid

      allocate(deck%model%interactions(size(cards_of(deck%cards, 'SURFACE INTERACTION'))))
      n = 0
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         if (deck%card%name == 'STEP') exit
         select case (deck%card%name)
         case ('SURFACE INTERACTION')
            errors = deck%error_count()
            n = n + 1
            call deck%take_name('surface interaction', deck%model%interactions(n)%name)
            law_place = deck%card%place
            if (size(deck%card%data) > 0) then
               ! Out of the plane; Abaqus needs it for surfaces of nodes alone.
               call read_row(deck%card%data(1), 'thickness? >0 =1', deck, thickness, valid)
               call deck%note('*SURFACE INTERACTION: the thickness is ignored: that of *SOLID '// &
                  'SECTION is taken')
            end if
            interaction = deck%model%interactions(n)
            call build_laws(k, deck, interaction, law_place)
            call deck%open_card(k)
            deck%model%interactions(n) = interaction
            if (deck%error_count() > errors .or. deck%card%flawed) cycle
            call check_law(law_place, deck%model%interactions(n), deck)
         case ('FRICTION', 'GAP LAW', 'GAP CONDUCTANCE', 'GAP HEAT GENERATION', 'GAP RADIATION', &
            'SURFACE BEHAVIOR', 'WEAR')
            if (n == 0 .and. len(deck%card%meant) == 0) call deck%missing(deck%card%place, '*'// &
               deck%card%name//' has no *SURFACE INTERACTION before it')
         case default
            cycle
         end select
      end do
   end subroutine build_interactions

   !> Reads the laws behind one *SURFACE INTERACTION.
   subroutine build_laws(place, deck, interaction, law_place)
      integer, intent(in) :: place
      type(deck_type), intent(inout) :: deck
      type(interaction_type), intent(inout) :: interaction
      type(place_type), intent(inout) :: law_place   ! becomes that of the data of the last law
      character(*), parameter :: once(5) = [character(19) :: 'FRICTION', 'SURFACE BEHAVIOR', &
         'GAP HEAT GENERATION', 'GAP RADIATION', 'WEAR']
      character(*), parameter :: ends(2) = ['SURFACE INTERACTION', 'STEP               ']
      integer :: i, k, table, taken(0:size(once))
      logical :: says_pressure

      taken = 0
      table = 0
      says_pressure = .false.
      do k = place + 1, size(deck%cards%keywords)
         if (any(deck%cards%keywords(k)%name == ends)) exit
         says_pressure = says_pressure .or. deck%cards%keywords(k)%has('PRESSURE')
      end do
      do k = place + 1, size(deck%cards%keywords)
         call deck%open_card(k)
         if (any(deck%card%name == ends)) exit
         if (size(deck%card%data) == 0 .and. all(deck%card%name /= [character(19) :: 'FRICTION', &
            'GAP HEAT GENERATION', 'SURFACE BEHAVIOR', 'WEAR'])) cycle
         if (any(deck%card%name == ['GAP LAW        ', 'GAP CONDUCTANCE', &
            'GAP RADIATION  '])) law_place = deck%card%data(1)%place(1)
         i = findloc(once == deck%card%name, .true., dim=1)
         if (i > 0 .and. taken(i) > 0) call deck%error(deck%card%place, 'a second *'// &
            deck%card%name//' in one surface interaction; the first is on '//deck%source%words_of( &
            deck%cards%keywords(taken(i))%place)//': leave one of them out')
         taken(i) = k
         select case (deck%card%name)
         case ('FRICTION')
            call build_friction(deck, interaction%friction)
         case ('SURFACE BEHAVIOR')
            call build_behavior(deck, interaction%overlap)
         case ('WEAR')
            call build_wear(deck, interaction%wear)
         case ('GAP HEAT GENERATION')
            call build_friction_heat(deck, interaction%heat)
         case ('GAP LAW')
            call build_gap_law(interaction%name, deck, interaction%law)
         case ('GAP CONDUCTANCE')
            if (is_of_clearance(deck%card, says_pressure)) then
               call build_gap_conductance(interaction%name, .true., deck, interaction%law)
            else
               if (table > 0) then
                  call deck%error(deck%card%place, 'a second *GAP CONDUCTANCE in one surface '// &
                     'interaction')
                  call deck%open_card(table)
                  call build_gap_conductance(interaction%name, .false., deck, interaction%law)
               end if
               table = k
            end if
         case default
            cycle
         end select
      end do
      if (table > 0) then
         call deck%open_card(table)
         call build_gap_conductance(interaction%name, .false., deck, interaction%law)
      end if
      if (interaction%overlap%is_soft() .and. interaction%wear%wears()) call deck%error( &
         deck%cards%keywords(taken(5))%place, '*WEAR is refused beside a *SURFACE BEHAVIOR '// &
         'whose faces overlap: worn faces are hard ones; leave one of them out')
      if (taken(4) == 0) return
      call deck%open_card(taken(4))
      call build_gap_radiation(deck, interaction%law)
   end subroutine build_laws

   subroutine build_wear(deck, wear)
      type(deck_type), intent(inout) :: deck
      type(wear_law_type), intent(out) :: wear
      real(dp) :: values(3, size(deck%card%data))
      integer :: k
      logical :: valid

      if (deck%card%has('CYCLES')) call deck%error(deck%card%place_of('CYCLES'), 'CYCLES= '// &
         'belongs to *WEAR in a step; leave it out here')
      if (size(deck%card%data) == 0) then
         call deck%missing(deck%card%place, '*WEAR needs a data card: K, share of the slave, '// &
            'temperature', 'data')
         return
      end if
      call read_rows(deck%card%data, 'K (depth per pressure and slip) >=0/share of the slave? '// &
         '>=0 <=1 =1/temperature? =0', deck, values, valid)
      if (.not. valid) return
      call check_ascending(deck%card%data, 3, 'temperatures', values(3, :), deck)
      do k = 2, size(deck%card%data)
         if (abs(values(2, k) - values(2, 1)) > 0.0_dp) call deck%error( &
            deck%card%data(k)%place(2), 'the share of the slave is one number for all '// &
            'temperatures; repeat that of the first row')
      end do
      wear%rate = values(1, :)
      wear%temperature = values(3, :)
      wear%slave_share = values(2, 1)
   end subroutine build_wear

   !> Reads one *FRICTION: coefficient of friction, or ROUGH; TAUMAX= bounds the shear.
   subroutine build_friction(deck, friction)
      type(deck_type), intent(inout) :: deck
      type(friction_law_type), intent(out) :: friction
      real(dp) :: values(2)
      logical :: valid

      call take_parameter(deck%card, 'TAUMAX', deck, friction%largest_shear, '>0')
      if (deck%card%has('ROUGH')) then
         friction%coefficient = rough_coefficient
         if (deck%card%has('TAUMAX')) call deck%error(deck%card%place_of('ROUGH'), 'TAUMAX= '// &
            'and ROUGH exclude each other: rough faces do not slip')
         if (size(deck%card%data) > 0) call deck%error(deck%card%data(1)%place(1), '*FRICTION, '// &
            'ROUGH has no data')
      else if (size(deck%card%data) > 0) then
         associate (data => deck%card%data(1), coefficient => friction%coefficient)
            call read_row(data, 'coefficient of friction >=0/stick slope?', deck, values, valid)
            coefficient = values(1)
            ! With a larger one a pressure is lost in the last places of mu times it.
            if (coefficient > rough_coefficient) then
               call deck%error(data%place(1), 'the coefficient of friction must not exceed '// &
                  to_text(rough_coefficient)//'; use ROUGH for faces that never slip while closed')
            else if (coefficient > largest_usual .and. coefficient < rough_coefficient) then
               call deck%warning(data%place(1), 'a coefficient of friction of '// &
                  to_text(coefficient)//' is unusual: is it in per cent? Use ROUGH for faces '// &
                  'that never slip while closed')
            end if
            if (size(data%fields) == 1) return
            call deck%note('*FRICTION: the stick slope is ignored')
            call check_unneeded(data, 2, 'a stick slope', deck, frictionless)
         end associate
      end if
   end subroutine build_friction

   !> Warns of a law that jumps, where the gap closes or where its table of clearances ends.
   subroutine check_law(law_place, interaction, deck)
      type(place_type), intent(in) :: law_place      ! where the last of its laws is
      type(interaction_type), intent(in) :: interaction
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type) :: law
      type(face_temperatures_type) :: faces
      real(dp) :: open, closed
      character(:), allocatable :: advice, there

      if (table_jump(interaction%law) > 0.0_dp) call deck%warning(deck%card%place, 'the '// &
         'conductance of '//interaction%name//' falls from '//to_text(table_jump( &
         interaction%law))//' to 0 where the gap exceeds that of the last row, '//to_text(maxval( &
         interaction%law%open_table%abscissa))//'; an increment in which a gap would stay '// &
         'there has no solution: end the table with a row of conductance 0')
      if (radiation_ends(interaction%law)) call deck%warning(law_place, 'faces of '// &
         interaction%name//' radiate where they are open and not where they are closed: the '// &
         'conductance jumps by that of radiation where the gap closes; TYPE=CMY and '// &
         'TYPE=ROSS-STOUTE add to it')
      faces = largest_jump(interaction%law)
      law = law_at(interaction%law, faces)
      law%radiation = 0.0_dp
      there = ''
      if (varies_with_temperature(interaction%law)) there = ' at a mean temperature of '// &
         to_text(faces%mean)
      closed = conductance(law, .true., 0.0_dp, 0.0_dp)
      open = conductance(law, .false., 0.0_dp, 0.0_dp)
      if (abs(law_jump(law)) <= continuous*max(open, closed)) return
      advice = '; at gap 0 and pressure 0 both laws should give the same'
      if (law%open_kind == law_none) advice = ', for there is no open law; give the gas in '// &
         'gaps by *GAP LAW, TYPE=GAS'
      call deck%warning(law_place, 'the conductance of '//interaction%name//' jumps by '// &
         to_text(law_jump(law))//' where the gap closes without pressure'//there//': from '// &
         to_text(open)//' open to '//to_text(closed)//' closed'//advice)
   end subroutine check_law

   !> Reads one *SURFACE BEHAVIOR: a law of faces that overlap; parameters of a penalty are ignored.
   subroutine build_behavior(deck, law)
      type(deck_type), intent(inout) :: deck
      type(overlap_law_type), intent(out) :: law           !! of hard faces, or of soft ones
      character(:), allocatable :: kind
      real(dp) :: rows(2, size(deck%card%data)), values(2)
      logical :: valid

      kind = to_upper(deck%card%text('PRESSURE-OVERCLOSURE'))
      if (kind == 'TIED') then
         call deck%error(deck%card%place_of('PRESSURE-OVERCLOSURE'), 'PRESSURE-OVERCLOSURE='// &
            kind//' is refused: tied faces do not open; take *TIE')
         return
      end if
      kind = choice(deck%card, 'PRESSURE-OVERCLOSURE', 'LINEAR/HARD/EXPONENTIAL/TABULAR', deck, '')
      select case (kind)
      case ('EXPONENTIAL', 'TABULAR')
         if (size(deck%card%data) == 0) then
            call deck%error(deck%card%place, '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE='//kind// &
               ' needs data: one card c0, p0, or rows of pressure, overlap')
         else if (kind == 'EXPONENTIAL') then
            ! The pressure at the clearance c0 is a hundredth of p0.
            call read_row(deck%card%data(1), 'clearance c0 >0/pressure p0 >0', deck, values, valid)
            law%clearance = values(1)
            law%touching_pressure = values(2)
            if (size(deck%card%data) > 1) call deck%error(deck%card%data(2)%place(1), 'an '// &
               'exponential law has one card: c0, p0')
         else
            ! Rows of pressure, from 0 on, and overlap.
            call read_rows(deck%card%data, 'pressure/overlap', deck, rows, valid)
            law%pressure = rows(1, :)
            law%overlap = rows(2, :)
            if (.not. valid) return
            if (abs(law%pressure(1)) > 0.0_dp) call deck%error(deck%card%data(1)%place(1), &
               'the first row must have pressure 0, and the overlap from which faces press')
            if (size(deck%card%data) == 1) call deck%error(deck%card%data(1)%place(1), 'a '// &
               'table of pressure and overlap needs two rows or more')
            call check_ascending(deck%card%data, 1, 'pressures', law%pressure, deck)
            call check_ascending(deck%card%data, 2, 'overlaps', law%overlap, deck)
         end if
      case default
         call deck%note('*SURFACE BEHAVIOR is ignored: contact is exact')
      end select
   end subroutine build_behavior

end module deck_builder_interactions
