!> *CONTACT PAIR, *CLEARANCE and *TIE -> contact between surfaces, and surfaces that are tied;
!> *CHANGE FRICTION, *MODEL CHANGE and *CONTACT INTERFERENCE -> what a step changes of contact.
module deck_builder_contact
   use card_values, only: choice, need_parameter, needed_choice, take_parameter, check_extra, &
      read_field
   use cards, only: data_card_type
   use contact_definitions, only: contact_changes_type, contact_definition_type, &
      friction_change_type, interference_type, pair_change_type, pairing_nodes, pairing_surfaces
   use deck_builder_interactions, only: build_friction
   use deck_builder_rigid, only: need_faces
   use deck_context, only: deck_type, place_list_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of, data_count, is_keyword
   use facing_faces, only: find_facing
   use kinds, only: dp
   use mesh, only: surface_type
   use name_index, only: is_pattern, matches
   use text, only: append, counted, listed, read_real, string_type, to_text, to_upper
   implicit none
   private
   public :: build_contacts, build_ties, build_contact_change

contains

   !> Builds all interfaces, one for each data card, and their clearances.
   subroutine build_contacts(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:), contacts(:)
      type(contact_definition_type) :: contact
      character(:), allocatable :: master, slave, text
      real(dp) :: value
      integer :: i, k, n

      places = cards_of(deck%cards, 'CONTACT PAIR')
      allocate (deck%model%contacts(0))
      do k = 1, size(places)
         call deck%open_card(places(k))
         call read_parameters(deck, contact)
         do i = 1, size(deck%card%data)
            if (is_pattern(deck%card%data(i)%text(1)) .or. is_pattern( &
               deck%card%data(i)%text(2))) then
               call add_matching(deck%card%data(i), contact, deck)
            else
               call read_faces(deck%card%data(i), deck, contact)
               call add_contact(.false., contact, deck)
            end if
         end do
      end do
      places = cards_of(deck%cards, 'CLEARANCE')
      do n = 1, size(places)
         call deck%open_card(places(n))
         call need_parameter(deck%card, 'MASTER', deck, master)
         call need_parameter(deck%card, 'SLAVE', deck, slave)
         call need_parameter(deck%card, 'VALUE', deck, text)
         value = 0.0_dp
         call find_contacts([deck%card%place_of('SLAVE'), deck%card%place_of('MASTER')], slave, &
            master, deck, contacts)
         call take_parameter(deck%card, 'VALUE', deck, value)
         do i = 1, size(contacts)
            associate (contact => deck%model%contacts(contacts(i)))
               if (contact%has_clearance) call deck%error(deck%card%place, 'the clearance of '// &
                  'contact pair '//contact%name//' is given twice')
               contact%has_clearance = .true.
               contact%clearance = value
            end associate
         end do
      end do
   end subroutine build_contacts

   !> Adds an interface for each slave surface that is opposite some master, where names of a data
   !> card are patterns. Its master are those faces that are opposite, or all faces where it slides.
   subroutine add_matching(data, common, deck)
      type(data_card_type), intent(in) :: data
      type(contact_definition_type), intent(in) :: common
      type(deck_type), intent(inout) :: deck
      type(contact_definition_type) :: contact
      type(surface_type) :: part
      type(place_list_type) :: places
      type(string_type), allocatable :: left_out(:)
      integer, allocatable :: masters(:), slaves(:)
      integer, parameter :: most_named = 5
      integer :: chosen, i

      call deck%need_items(data, 1, 'surface', 'slave surface', slaves)
      call deck%need_items(data, 2, 'surface', 'master surface', masters)
      call check_extra(data, 2, 'slave surface, master surface', deck)
      if (size(slaves) == 0 .or. size(masters) == 0) return
      do i = 1, size(slaves) + size(masters)
         chosen = merge(slaves(min(i, size(slaves))), masters(max(i - size(slaves), 1)), &
            i <= size(slaves))
         if (count([slaves, masters] == chosen) > 1) then
            call deck%error(data%place(2), 'surface '//deck%mesh%surfaces(chosen)%name// &
               ' is meant by both names; a surface cannot be in contact with itself')
            return
         end if
         call need_faces(data%place(merge(1, 2, i <= size(slaves))), deck, chosen)
         if (chosen == 0) return
      end do
      allocate (left_out(0))
      do i = 1, size(slaves)
         contact = common
         call find_facing(deck%mesh, slaves(i), masters, chosen, part%faces)
         if (chosen == 0) then
            call append(left_out, deck%mesh%surfaces(slaves(i))%name)
            cycle
         end if
         contact%slave = slaves(i)
         contact%master = chosen
         if (size(part%faces, 2) < size(deck%mesh%surfaces(chosen)%faces, 2) .and. &
            .not. contact%follows_sliding) then
            part%name = deck%mesh%surfaces(chosen)%name
            part%card = deck%mesh%surfaces(chosen)%card
            deck%mesh%surfaces = [deck%mesh%surfaces, part]
            places = place_list_type(spread(data%place(2), 1, size(part%faces, 2)))
            deck%face_places = [deck%face_places, places]
            contact%master = size(deck%mesh%surfaces)
         end if
         if (.not. deck%card%has('NAME')) contact%name = deck%mesh%surfaces(slaves(i))%name
         call add_contact(.true., contact, deck)
      end do
      if (size(left_out) == size(slaves)) then
         call deck%error(data%place(1), 'none of '//listed(left_out, most_named)// &
            ' is opposite a face of '//to_upper(data%text(2))//'; name surfaces that look at '// &
            'each other, slaves first')
         return
      end if
      associate (names => '*CONTACT PAIR '//to_upper(data%text(1))//', '//to_upper(data%text(2)))
         call deck%note(names//': '//counted(size(slaves) - size(left_out), 'pair')//', named '// &
            'after the slave surfaces')
         if (size(left_out) > 0) call deck%note(names//': opposite no face of the master, and '// &
            'in no pair: '//listed(left_out, most_named))
      end associate
   end subroutine add_matching

   !> The interfaces of two surfaces, or of those that patterns mean; none after an error.
   subroutine find_contacts(places, slave, master, deck, contacts)
      type(place_type), intent(in) :: places(2)              !! where they are named
      character(*), intent(in) :: slave, master              !! names
      type(deck_type), intent(inout) :: deck
      integer, allocatable, intent(out) :: contacts(:)
      integer :: i, k

      allocate (contacts(0))
      if (len(slave) == 0 .or. len(master) == 0) return
      k = 1
      if (.not. is_pattern(slave)) call deck%look_up('surface', to_upper(slave), places(1), k)
      i = 1
      if (.not. is_pattern(master)) call deck%look_up('surface', to_upper(master), places(2), i)
      if (i == 0 .or. k == 0) return
      associate (pairs => deck%model%contacts, surfaces => deck%mesh%surfaces)
         do i = 1, size(pairs)
            if (pairs(i)%slave == 0 .or. pairs(i)%master == 0) cycle
            if (matches(to_upper(slave), to_upper(surfaces(pairs(i)%slave)%name)) .and. &
               matches(to_upper(master), to_upper(surfaces(pairs(i)%master)%name))) contacts = &
               [contacts, i]
         end do
      end associate
      if (size(contacts) == 0) call deck%missing(places(1), 'no *CONTACT PAIR has the slave '// &
         'surface '//to_upper(slave)//' and the master surface '//to_upper(master), 'surface')
   end subroutine find_contacts

   subroutine read_parameters(deck, contact)
      type(deck_type), intent(inout) :: deck
      type(contact_definition_type), intent(out) :: contact
      character(:), allocatable :: pairing
      logical :: is_number

      call deck%need_named('INTERACTION', 'surface interaction', contact%interaction)
      pairing = choice(deck%card, 'PAIRING', 'NODES/SURFACES', deck, '')
      if (pairing /= '') contact%pairing = merge(pairing_nodes, pairing_surfaces, &
         pairing == 'NODES')
      contact%follows_sliding = choice(deck%card, 'SLIDING', 'SMALL/FINITE', deck, 'SMALL') == &
         'FINITE'
      contact%adjusts = deck%card%has('ADJUST')
      if (contact%adjusts) then   ! a distance, or a node set
         call read_real(deck%card%text('ADJUST'), contact%adjusted, is_number)
         if (.not. is_number) then
            call deck%need_named('ADJUST', 'node set', contact%adjusted_set)
         else if (contact%adjusted < 0.0_dp) then
            call deck%error(deck%card%place_of('ADJUST'), 'the distance of ADJUST= must not be '// &
               'negative')
         end if
      end if
      contact%card = deck%card%place%image
      contact%name = deck%card%text('NAME')
   end subroutine read_parameters

   !> Reads the two surfaces; the slave's name is that of a card without NAME=.
   subroutine read_faces(data, deck, faces)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(contact_definition_type), intent(inout) :: faces

      call deck%need_item(data, 1, 'surface', 'slave surface', faces%slave)
      call deck%need_item(data, 2, 'surface', 'master surface', faces%master)
      call check_extra(data, 2, 'slave surface, master surface', deck)
      if (faces%slave > 0 .and. faces%slave == faces%master) call deck%error(data%place(2), &
         'a surface cannot be in contact with itself')
      call need_faces(data%place(1), deck, faces%slave)
      if (faces%is_tied) call need_faces(data%place(2), deck, faces%master)
      if (deck%card%has('NAME')) return
      if (size(data%fields) > 0) faces%name = data%fields(1)%text
      if (faces%is_tied) call deck%note('*'//deck%card%name//' without NAME=: '//faces%name// &
         ', the slave surface')
   end subroutine read_faces

   !> Adds a pair. Its name stands for a group of the result file: it is used once, and is one
   !> that HDF5 allows for a group. The pair has the name of its slave surface only if no other has
   !> it; it follows the name of a card with several pairs.
   subroutine add_contact(by_pattern, contact, deck)
      logical, intent(in) :: by_pattern         ! whether it is one of several of a data card
      type(contact_definition_type), intent(in) :: contact
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: name
      logical :: is_taken, several

      several = deck%card%has('NAME') .and. (by_pattern .or. size(deck%card%data) > 1)
      name = contact%name
      if (several .and. contact%slave > 0) name = name//'-'//deck%mesh%surfaces(contact%slave)%name
      if ((several .or. .not. deck%card%has('NAME')) .and. contact%master > 0) then
         is_taken = deck%index_of('contact pair', name) > 0
         if (is_taken) name = name//'-'//deck%mesh%surfaces(contact%master)%name
         if (.not. by_pattern) call deck%note('*CONTACT PAIR '// &
            trim(merge('of several pairs:', 'without NAME=:   ', several))//' '// &
            name//', '//trim(merge('its surfaces     ', 'the slave surface', is_taken)))
      end if
      deck%model%contacts = [deck%model%contacts, contact]
      deck%model%contacts(size(deck%model%contacts))%name = name
      associate (place => deck%card%place_of('NAME'))
         if (deck%index_of('contact pair', name) > 0) call deck%error(place, 'contact pair '// &
            name//' is defined twice')
         call deck%add_name('contact pair', name)
         if (scan(name, '/@') > 0 .or. name == '.' .or. name == '..') call deck%error(place, &
            'the name of a contact pair must not be . or .. or contain / or @: it is a group '// &
            'of the result file')
      end associate
   end subroutine add_contact

   !> Builds all ties, one for each data card.
   subroutine build_ties(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      integer :: i, k, n

      places = cards_of(deck%cards, 'TIE')
      allocate(deck%model%ties(data_count(deck%cards, places)))
      n = 0
      do k = 1, size(places)
         call deck%open_card(places(k))
         if (choice(deck%card, 'ADJUST', 'YES/NO', deck, 'NO') == 'YES') call deck%note('*TIE, '// &
            'ADJUST=YES: nodes are not moved, an initial gap is not closed')
         do i = 1, n
            if (deck%card%has('NAME') .and. to_upper(deck%model%ties(i)%faces%name) == to_upper( &
               deck%card%text('NAME'))) call deck%error(deck%card%place_of('NAME'), &
               deck%model%ties(i)%faces%title()//' is defined twice')
         end do
         do i = 1, size(deck%card%data)
            n = n + 1
            associate (tie => deck%model%ties(n))
               tie%faces%is_tied = .true.
               tie%faces%card = deck%card%place%image
               tie%faces%name = deck%card%text('NAME')
               tie%has_tolerance = deck%card%has('POSITION TOLERANCE')
               tie%faces%either_side = tie%has_tolerance
               call take_parameter(deck%card, 'POSITION TOLERANCE', deck, tie%tolerance, '>=0')
               call read_faces(deck%card%data(i), deck, tie%faces)
            end associate
         end do
      end do
   end subroutine build_ties

   !> Reads one card of a step.
   subroutine build_contact_change(k, step, deck)
      integer, intent(in) :: k                             !! the keyword card
      integer, intent(in) :: step                          !! index of the step, 0 before the first
      type(deck_type), intent(inout) :: deck
      type(contact_changes_type) :: changes
      type(friction_change_type) :: change
      type(pair_change_type) :: pair
      integer, allocatable :: contacts(:)
      integer :: i, j

      if (step == 0) return
      changes = deck%model%steps(step)%changes
      call deck%open_card(k)
      select case (deck%card%name)
      case ('CHANGE FRICTION')
         if (.not. is_keyword(deck%cards, k + 1, 'FRICTION')) call deck%error(deck%card%place, &
            '*CHANGE FRICTION needs a *FRICTION after it')
      case ('FRICTION')
         if (is_keyword(deck%cards, k - 1, 'CHANGE FRICTION')) then
            call build_friction(deck, change%friction)
            call deck%open_card(k - 1)
            call deck%need_named('INTERACTION', 'surface interaction', change%interaction)
            if (change%interaction == 0) return
            if (.not. allocated(changes%frictions)) allocate (changes%frictions(0))
            changes%frictions = [changes%frictions, change]
         else
            call deck%error(deck%card%place, '*FRICTION in a step needs *CHANGE FRICTION, '// &
               'INTERACTION= before it')
         end if
      case ('MODEL CHANGE')
         if (needed_choice(deck%card, 'TYPE', 'CONTACT PAIR', deck) == '') return
         pair%removes = deck%card%has('REMOVE')
         if ((pair%removes .eqv. deck%card%has('ADD')) .and. &
            .not. deck%card%flawed) call deck%error(deck%card%place, '*MODEL CHANGE needs '// &
            'either ADD or REMOVE')
         if (.not. allocated(changes%pairs)) allocate (changes%pairs(0))
         do j = 1, size(deck%card%data)
            call read_contacts(deck%card%data(j), 2, deck, contacts)
            do i = 1, size(contacts)
               pair%contact = contacts(i)
               changes%pairs = [changes%pairs, pair]
            end do
         end do
      case default
         call change_interferences(step, deck, changes)
      end select
      deck%model%steps(step)%changes = changes
   end subroutine build_contact_change

   subroutine change_interferences(step, deck, changes)
      integer, intent(in) :: step
      type(deck_type), intent(inout) :: deck
      type(contact_changes_type), intent(inout) :: changes
      type(interference_type) :: given
      character(:), allocatable :: kind
      integer, allocatable :: contacts(:)
      integer :: i, j
      logical :: valid

      kind = choice(deck%card, 'TYPE', 'CONTACT PAIR', deck, '')
      if (choice(deck%card, 'OP', 'MOD/NEW', deck, 'MOD') == 'NEW') changes%ends_interferences = &
         .true.
      given%shrinks = deck%card%has('SHRINK')
      if (given%shrinks .and. step > 1) call deck%error(deck%card%place_of('SHRINK'), 'SHRINK '// &
         'is allowed in the first step only: it removes the initial overlaps')
      if (given%shrinks .and. deck%card%has('AMPLITUDE')) then
         call deck%note('*CONTACT INTERFERENCE, SHRINK: AMPLITUDE= is ignored')
      else
         call deck%take_named('AMPLITUDE', 'amplitude', given%amplitude)
      end if
      if (.not. allocated(changes%interferences)) allocate (changes%interferences(0))
      do j = 1, size(deck%card%data)
         valid = .true.
         given%value = 1.0_dp
         call read_contacts(deck%card%data(j), merge(2, 3, given%shrinks), deck, contacts)
         if (.not. given%shrinks) call read_field(deck%card%data(j), 3, 'interference', deck, &
            given%value, valid)
         if (.not. valid) cycle
         do i = 1, size(contacts)
            given%contact = contacts(i)
            changes%interferences = [changes%interferences, given]
            if (.not. given%shrinks) call check_clearance(deck%card%data(j), deck%model%contacts( &
               given%contact), given%value, deck)
         end do
      end do
   end subroutine change_interferences

   !> Warns of an interference that is given twice, or works against a clearance, but not where it
   !> allows a part of an overlap.
   subroutine check_clearance(data, contact, interference, deck)
      type(data_card_type), intent(in) :: data
      type(contact_definition_type), intent(in) :: contact
      real(dp), intent(in) :: interference
      type(deck_type), intent(inout) :: deck
      logical :: is_twice

      associate (clearance => contact%clearance, gap => contact%clearance + interference)
         is_twice = abs(clearance - interference) <= 0.0_dp .and. abs(gap) > 0.0_dp
         if (.not. is_twice .and. clearance*interference >= 0.0_dp) return
         if (.not. is_twice .and. clearance < 0.0_dp .and. gap <= 0.0_dp) return
         call deck%warning(data%place(3), contact%title()//': the interference '// &
            to_text(interference)//' and the *CLEARANCE '//to_text(clearance)//' add up to '// &
            to_text(gap)//'; give the gap that is meant by one of them')
      end associate
   end subroutine check_clearance

   !> The interfaces of the two surfaces that a data card names; none after an error.
   subroutine read_contacts(data, most, deck, contacts)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: most                 ! most fields: 3 with an interference
      type(deck_type), intent(inout) :: deck
      integer, allocatable, intent(out) :: contacts(:)
      character(:), allocatable :: master, slave
      logical :: valid

      valid = .true.
      call read_field(data, 1, 'slave surface', deck, slave, valid)
      call read_field(data, 2, 'master surface', deck, master, valid)
      call check_extra(data, most, 'slave surface, master surface'//trim(merge( &
         ', interference', '              ', most == 3)), deck)
      call find_contacts([data%place(1), data%place(2)], slave, master, deck, contacts)
   end subroutine read_contacts

end module deck_builder_contact
