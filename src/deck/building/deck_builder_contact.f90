!> *CONTACT PAIR, *CLEARANCE and *TIE -> contact between surfaces, and surfaces that are tied;
!> *CHANGE FRICTION, *MODEL CHANGE and *CONTACT INTERFERENCE -> what a step changes of contact.
module deck_builder_contact
   use card_parameters, only: choice, need_parameter, needed_choice, take_parameter
   use card_values, only: check_extra, read_field
   use cards, only: data_card_type, keyword_card_type
   use contact_definitions, only: contact_changes_type, contact_definition_type, &
      friction_change_type, interference_type, pair_change_type, pairing_nodes, pairing_surfaces
   use deck_builder_interactions, only: build_friction
   use deck_builder_rigid, only: need_faces
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of, data_count, is_keyword
   use kinds, only: dp
   use text, only: read_real, to_text, to_upper
   implicit none
   private
   public :: build_contacts, build_ties, find_contact, build_contact_change

contains

   !> Builds all interfaces, one for each data card, and their clearances.
   subroutine build_contacts(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      type(contact_definition_type) :: common
      character(:), allocatable :: text
      real(dp) :: value
      integer :: i, k, master, n, slave

      places = cards_of(deck%cards, 'CONTACT PAIR')
      allocate (deck%model%contacts(data_count(deck%cards, places)))
      n = 0
      do k = 1, size(places)
         associate (card => deck%cards%keywords(places(k)))
            call read_parameters(card, deck, common)
            do i = 1, size(card%data)
               n = n + 1
               deck%model%contacts(n) = common
               call read_faces(card, card%data(i), deck, deck%model%contacts(n))
               call check_name(card, deck, deck%model%contacts(:n))
            end do
         end associate
      end do
      places = cards_of(deck%cards, 'CLEARANCE')
      do n = 1, size(places)
         associate (card => deck%cards%keywords(places(n)))
            call deck%need_named(card, 'MASTER', 'surface', master)
            call deck%need_named(card, 'SLAVE', 'surface', slave)
            call need_parameter(card, 'VALUE', deck, text)
            value = 0.0_dp
            call take_parameter(card, 'VALUE', deck, value)
            call find_contact(slave, master, card%place, deck, i)
            if (i == 0) cycle
            associate (contact => deck%model%contacts(i))
               if (contact%has_clearance) call deck%error(card%place, 'the clearance of '// &
                  'contact pair '//contact%name//' is given twice')
               contact%has_clearance = .true.
               contact%clearance = value
            end associate
         end associate
      end do
   end subroutine build_contacts

   !> The interface of two surfaces; 0 after an error, and where a surface is 0.
   subroutine find_contact(slave, master, place, deck, contact)
      integer, intent(in) :: slave, master                   !! surfaces
      type(place_type), intent(in) :: place                  !! where they are named
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: contact

      contact = 0
      if (slave == 0 .or. master == 0) return
      contact = findloc(deck%model%contacts%slave == slave .and. deck%model%contacts%master == &
         master, .true., dim=1)
      if (contact == 0) call deck%missing(place, 'no *CONTACT PAIR has the slave surface '// &
         deck%mesh%surfaces(slave)%name//' and the master surface '// &
         deck%mesh%surfaces(master)%name, 'surface')
   end subroutine find_contact

   !> Reads what all data cards of a card have in common.
   subroutine read_parameters(card, deck, contact)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(contact_definition_type), intent(out) :: contact
      character(:), allocatable :: pairing
      logical :: is_number

      call deck%need_named(card, 'INTERACTION', 'surface interaction', contact%interaction)
      pairing = choice(card, 'PAIRING', 'NODES/SURFACES', deck, '')
      if (pairing /= '') contact%pairing = merge(pairing_nodes, pairing_surfaces, &
         pairing == 'NODES')
      contact%adjusts = card%has('ADJUST')
      if (contact%adjusts) then   ! a distance, or a node set
         call read_real(card%text('ADJUST'), contact%adjusted, is_number)
         if (.not. is_number) then
            call deck%need_named(card, 'ADJUST', 'node set', contact%adjusted_set)
         else if (contact%adjusted < 0.0_dp) then
            call deck%error(card%place_of('ADJUST'), 'the distance of ADJUST= must not be negative')
         end if
      end if
      contact%card = card%place%image
      contact%name = card%text('NAME')
   end subroutine read_parameters

   !> Reads the two surfaces; the slave's name is that of a card without NAME=.
   subroutine read_faces(card, data, deck, faces)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(contact_definition_type), intent(inout) :: faces
      character(*), parameter :: held = 'let it be the master, and the face of the body the slave'
      character(*), parameter :: tied = 'nodes that it holds are TIE NSET= of *RIGID BODY        '

      call deck%need_item(data, 1, 'surface', 'slave surface', faces%slave)
      call deck%need_item(data, 2, 'surface', 'master surface', faces%master)
      call check_extra(data, 2, 'slave surface, master surface', deck)
      if (faces%slave > 0 .and. faces%slave == faces%master) call deck%error(data%place(2), &
         'a surface cannot be '// &
         trim(merge('tied to itself           ', 'in contact with itself   ', faces%is_tied)))
      call need_faces(data%place(1), trim(merge(tied, held, faces%is_tied)), deck, faces%slave)
      if (faces%is_tied) call need_faces(data%place(2), trim(tied), deck, faces%master)
      if (card%has('NAME')) return
      if (size(data%fields) > 0) faces%name = data%fields(1)%text
      if (faces%is_tied) call deck%note('*'//card%name//' without NAME=: '//faces%name//', the '// &
         'slave surface')
   end subroutine read_faces

   !> A name stands for a group of the result file: it is used once, and is one that HDF5
   !> allows for a group. The last pair has the name of its slave surface only if no other has it;
   !> it follows the name of a card with several pairs.
   subroutine check_name(card, deck, contacts)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(contact_definition_type), intent(inout) :: contacts(:)
      integer :: n
      logical :: is_taken, several

      n = size(contacts)
      several = card%has('NAME') .and. size(card%data) > 1
      if (several .and. contacts(n)%slave > 0) contacts(n)%name = contacts(n)%name//'-'// &
         deck%mesh%surfaces(contacts(n)%slave)%name
      if ((several .or. .not. card%has('NAME')) .and. contacts(n)%master > 0) then
         is_taken = deck%index_of('contact pair', contacts(n)%name) > 0
         if (is_taken) contacts(n)%name = contacts(n)%name//'-'// &
            deck%mesh%surfaces(contacts(n)%master)%name
         call deck%note('*CONTACT PAIR '// &
            trim(merge('of several pairs:', 'without NAME=:   ', several))//' '// &
            contacts(n)%name//', '//trim(merge('its surfaces     ', 'the slave surface', is_taken)))
      end if
      associate (place => card%place_of('NAME'), name => contacts(n)%name)
         if (deck%index_of('contact pair', name) > 0) call deck%error(place, 'contact pair '// &
            name//' is defined twice')
         call deck%add_name('contact pair', name)
         if (scan(name, '/@') > 0) call deck%error(place, 'the name of a contact pair must not '// &
            'contain / or @')
         if (name == '.' .or. name == '..') call deck%error(place, 'a contact pair must not be '// &
            'named . or ..: its name is a group of the result file')
      end associate
   end subroutine check_name

   !> Builds all ties, one for each data card.
   subroutine build_ties(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      integer :: i, k, n

      places = cards_of(deck%cards, 'TIE')
      allocate(deck%model%ties(data_count(deck%cards, places)))
      n = 0
      do k = 1, size(places)
         associate (card => deck%cards%keywords(places(k)))
            if (choice(card, 'ADJUST', 'YES/NO', deck, 'NO') == 'YES') call deck%note('*TIE, '// &
               'ADJUST=YES: nodes are not moved, an initial gap is not closed')
            do i = 1, n
               if (card%has('NAME') .and. to_upper(deck%model%ties(i)%faces%name) == to_upper( &
                  card%text('NAME'))) call deck%error(card%place_of('NAME'), &
                  deck%model%ties(i)%faces%title()//' is defined twice')
            end do
            do i = 1, size(card%data)
               n = n + 1
               associate (tie => deck%model%ties(n))
                  tie%faces%is_tied = .true.
                  tie%faces%card = card%place%image
                  tie%faces%name = card%text('NAME')
                  tie%has_tolerance = card%has('POSITION TOLERANCE')
                  tie%faces%either_side = tie%has_tolerance
                  call take_parameter(card, 'POSITION TOLERANCE', deck, tie%tolerance, '>=0')
                  call read_faces(card, card%data(i), deck, tie%faces)
               end associate
            end do
         end associate
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
      integer :: j

      if (step == 0) return
      changes = deck%model%steps(step)%changes
      associate (card => deck%cards%keywords(k))
         select case (card%name)
         case ('CHANGE FRICTION')
            if (.not. is_keyword(deck%cards, k + 1, 'FRICTION')) call deck%error(card%place, &
               '*CHANGE FRICTION needs a *FRICTION after it')
         case ('FRICTION')
            if (is_keyword(deck%cards, k - 1, 'CHANGE FRICTION')) then
               call build_friction(card, deck, change%friction)
               call deck%need_named(deck%cards%keywords(k - 1), 'INTERACTION', 'surface '// &
                  'interaction', change%interaction)
               if (change%interaction == 0) return
               if (.not. allocated(changes%frictions)) allocate (changes%frictions(0))
               changes%frictions = [changes%frictions, change]
            else
               call deck%error(card%place, '*FRICTION in a step needs *CHANGE FRICTION, '// &
                  'INTERACTION= before it')
            end if
         case ('MODEL CHANGE')
            if (needed_choice(card, 'TYPE', 'CONTACT PAIR', deck) == '') return
            pair%removes = card%has('REMOVE')
            if ((pair%removes .eqv. card%has('ADD')) .and. .not. card%flawed) call deck%error( &
               card%place, '*MODEL CHANGE needs either ADD or REMOVE')
            if (.not. allocated(changes%pairs)) allocate (changes%pairs(0))
            do j = 1, size(card%data)
               call read_contact(card%data(j), 2, 'slave surface, master surface', deck, &
                  pair%contact)
               if (pair%contact > 0) changes%pairs = [changes%pairs, pair]
            end do
         case default
            call change_interferences(card, step, deck, changes)
         end select
      end associate
      deck%model%steps(step)%changes = changes
   end subroutine build_contact_change

   !> The interferences of some interfaces.
   subroutine change_interferences(card, step, deck, changes)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: step
      type(deck_type), intent(inout) :: deck
      type(contact_changes_type), intent(inout) :: changes
      type(interference_type) :: given
      character(:), allocatable :: kind
      integer :: j
      logical :: valid

      kind = choice(card, 'TYPE', 'CONTACT PAIR', deck, '')
      if (choice(card, 'OP', 'MOD/NEW', deck, 'MOD') == 'NEW') changes%ends_interferences = .true.
      given%shrinks = card%has('SHRINK')
      if (given%shrinks .and. step > 1) call deck%error(card%place_of('SHRINK'), 'SHRINK is '// &
         'allowed in the first step only: it removes the initial overlaps')
      if (given%shrinks .and. card%has('AMPLITUDE')) then
         call deck%note('*CONTACT INTERFERENCE, SHRINK: AMPLITUDE= is ignored')
      else
         call deck%take_named(card, 'AMPLITUDE', 'amplitude', given%amplitude)
      end if
      if (.not. allocated(changes%interferences)) allocate (changes%interferences(0))
      do j = 1, size(card%data)
         valid = .true.
         given%value = 1.0_dp
         if (given%shrinks) then
            call read_contact(card%data(j), 2, 'slave surface, master surface', deck, given%contact)
         else
            call read_contact(card%data(j), 3, 'slave surface, master surface, interference', &
               deck, given%contact)
            call read_field(card%data(j), 3, 'interference', deck, given%value, valid)
         end if
         if (given%contact == 0 .or. .not. valid) cycle
         changes%interferences = [changes%interferences, given]
         if (.not. given%shrinks) call check_clearance(card%data(j), &
            deck%model%contacts(given%contact), given%value, deck)
      end do
   end subroutine change_interferences

   !> Warns of an interference against a clearance, but not where it allows a part of an overlap;
   !> and of one that is given twice.
   subroutine check_clearance(data, contact, interference, deck)
      type(data_card_type), intent(in) :: data
      type(contact_definition_type), intent(in) :: contact
      real(dp), intent(in) :: interference
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: meaning

      associate (gap => contact%clearance + interference)
         if (abs(contact%clearance - interference) <= 0.0_dp .and. &
            abs(gap) > 0.0_dp) call deck%warning(data%place(3), contact%title()//': the '// &
            'interference and the *CLEARANCE are both '//to_text(interference)//', and the '// &
            'faces begin with the sum, '//to_text(gap)//'; give a gap that stays by *CLEARANCE '// &
            'alone, one that the step takes away by *CONTACT INTERFERENCE alone')
         if (contact%clearance*interference >= 0.0_dp) return
         if (contact%clearance < 0.0_dp .and. gap <= 0.0_dp) return
         meaning = 'the faces touch'
         if (gap < 0.0_dp) meaning = 'the faces overlap by '//to_text(-gap)
         if (gap > 0.0_dp) meaning = 'the faces are '//to_text(gap)//' apart'
         call deck%warning(data%place(3), contact%title()//': the interference '// &
            to_text(interference)//' and the *CLEARANCE '//to_text(contact%clearance)//' work '// &
            'against each other: with the sum, '//to_text(gap)//', '//meaning//'; give the gap '// &
            'that is meant by one of them')
      end associate
   end subroutine check_clearance

   !> The interface of the two surfaces that a data card names; 0 after an error.
   subroutine read_contact(data, most, layout, deck, contact)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: most                 ! most fields
      character(*), intent(in) :: layout
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: contact
      integer :: master, slave

      call deck%need_item(data, 1, 'surface', 'slave surface', slave)
      call deck%need_item(data, 2, 'surface', 'master surface', master)
      call check_extra(data, most, layout, deck)
      call find_contact(slave, master, data%place(1), deck, contact)
   end subroutine read_contact

end module deck_builder_contact
