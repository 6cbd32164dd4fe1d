!> *CONTACT PAIR, *CLEARANCE and *TIE -> contact between surfaces, and surfaces that are tied.
module deck_builder_contact
   use card_parameters, only: choose, has_parameter, need_parameter, parameter_place, &
      parameter_text, take_parameter
   use card_values, only: check_extra
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use contact_definitions, only: contact_definition_type, pairing_nodes, pairing_surfaces, &
      tie_definition_type
   use deck_context, only: deck_context_type, need_named, read_surface
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of, data_cards_of
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type
   use named_items, only: find_named
   use text, only: read_real, to_upper
   implicit none
   private
   public :: build_contacts, build_ties, find_contact

contains

   !> Builds all interfaces and their clearances.
   subroutine build_contacts(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(model_type), intent(inout) :: model             !! receives the interfaces
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, allocatable :: places(:)
      integer :: n

      places = cards_of(cards, 'CONTACT PAIR')
      allocate(model%contacts(size(places)))
      do n = 1, size(places)
         call build_contact(cards, cards%keywords(places(n)), context, model, report, &
            model%contacts(n))
         call check_name(cards%keywords(places(n)), model%contacts(:n), report)
      end do
      places = cards_of(cards, 'CLEARANCE')
      do n = 1, size(places)
         call build_clearance(cards%keywords(places(n)), model%mesh, report, model%contacts)
      end do
   end subroutine build_contacts

   !> Reads a clearance, for the interface of the two surfaces that it names.
   subroutine build_clearance(card, mesh, report, contacts)
      type(keyword_card_type), intent(in) :: card
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(contact_definition_type), intent(inout) :: contacts(:)
      character(:), allocatable :: text
      real(dp) :: value
      integer :: i, master, slave

      call need_named(card, 'MASTER', 'surface', mesh%surfaces, report, master)
      call need_named(card, 'SLAVE', 'surface', mesh%surfaces, report, slave)
      call need_parameter(card, 'VALUE', report, text)
      value = 0.0_dp
      call take_parameter(card, 'VALUE', report, value)
      call find_contact(slave, master, contacts, mesh, card%place, report, i)
      if (i == 0) return
      if (contacts(i)%has_clearance) call report%error(card%place, &
         'the clearance of contact pair '//contacts(i)%name//' is given twice')
      if (contacts(i)%has_clearance) return
      contacts(i)%has_clearance = .true.
      contacts(i)%clearance = value
   end subroutine build_clearance

   !> The interface of two surfaces; 0 after an error, and where a surface is 0.
   subroutine find_contact(slave, master, contacts, mesh, place, report, contact)
      integer, intent(in) :: slave, master                   !! surfaces
      type(contact_definition_type), intent(in) :: contacts(:)
      type(mesh_type), intent(in) :: mesh
      type(place_type), intent(in) :: place                  !! where they are named
      type(deck_report_type), intent(inout) :: report        !! receives the error
      integer, intent(out) :: contact

      contact = 0
      if (slave == 0 .or. master == 0) return
      contact = findloc(contacts%slave == slave .and. contacts%master == master, .true., dim=1)
      if (contact == 0) call report%missing(place, 'no *CONTACT PAIR has the slave surface '// &
         mesh%surfaces(slave)%name//' and the master surface '//mesh%surfaces(master)%name, &
         'surface')
   end subroutine find_contact

   subroutine build_contact(cards, card, context, model, report, contact)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(contact_definition_type), intent(out) :: contact
      character(:), allocatable :: pairing

      call need_named(card, 'INTERACTION', 'surface interaction', model%interactions, report, &
         contact%interaction)
      call choose(card, 'PAIRING', 'NODES/SURFACES', report, pairing)
      if (allocated(pairing)) contact%pairing = merge(pairing_nodes, pairing_surfaces, &
         pairing == 'NODES')
      if (has_parameter(card, 'ADJUST')) call read_adjustment(card, model%mesh, report, contact)
      contact%card = card%place%image
      contact%name = parameter_text(card, 'NAME')
      if (card%last_data >= card%first_data) call read_faces(card, cards%data(card%first_data), &
         context, model%mesh, report, contact)
   end subroutine build_contact

   !> Reads the two surfaces; the slave's name is that of a card without NAME=.
   subroutine read_faces(card, data, context, mesh, report, faces)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(contact_definition_type), intent(inout) :: faces

      call read_surface(data, 1, 'slave surface', mesh%surfaces, report, faces%slave)
      call read_surface(data, 2, 'master surface', mesh%surfaces, report, faces%master)
      call check_extra(data, 2, 'slave surface, master surface', report)
      if (faces%slave > 0 .and. faces%slave == faces%master) call report%error( &
         field_place(data, 2), 'a surface cannot be '//trim(merge('tied to itself           ', &
         'in contact with itself   ', faces%is_tied)))
      if (has_parameter(card, 'NAME')) return
      if (size(data%fields) > 0) faces%name = data%fields(1)%text
      call context%note('*'//card%name//' without NAME=: '//faces%name//', the slave surface')
   end subroutine read_faces

   !> A distance, or a node set.
   subroutine read_adjustment(card, mesh, report, contact)
      type(keyword_card_type), intent(in) :: card
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(contact_definition_type), intent(inout) :: contact
      logical :: is_number

      contact%adjusts = .true.
      call read_real(parameter_text(card, 'ADJUST'), contact%adjusted, is_number)
      if (.not. is_number) then
         call need_named(card, 'ADJUST', 'node set', mesh%node_sets, report, contact%adjusted_set)
      else if (contact%adjusted < 0.0_dp) then
         call report%error(parameter_place(card, 'ADJUST'), &
            'the distance of ADJUST= must not be negative')
      end if
   end subroutine read_adjustment

   !> A name stands for a group of the result file: it is used once, and is one that HDF5
   !> allows for a group.
   subroutine check_name(card, contacts, report)
      type(keyword_card_type), intent(in) :: card
      type(contact_definition_type), intent(in) :: contacts(:)
      type(deck_report_type), intent(inout) :: report

      associate (place => parameter_place(card, 'NAME'), name => contacts(size(contacts))%name)
         if (find_named(contacts(:size(contacts) - 1), name) > 0) call report%error(place, &
            'contact pair '//name//' is defined twice')
         if (scan(name, '/@') > 0) call report%error(place, &
            'the name of a contact pair must not contain / or @')
         if (name == '.' .or. name == '..') call report%error(place, 'a contact pair must not '// &
            'be named . or ..: its name is a group of the result file')
      end associate
   end subroutine check_name

   !> Builds all ties, one for each data card.
   subroutine build_ties(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(model_type), intent(inout) :: model             !! receives the ties
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, allocatable :: places(:)
      integer :: i, k, n

      allocate(model%ties(size(data_cards_of(cards, 'TIE'))))
      n = 0
      places = cards_of(cards, 'TIE')
      do k = 1, size(places)
         associate (card => cards%keywords(places(k)))
            call check_tie_card(card, model%ties(:n), context, report)
            do i = card%first_data, card%last_data
               n = n + 1
               associate (tie => model%ties(n))
                  tie%faces%is_tied = .true.
                  tie%faces%card = card%place%image
                  tie%faces%name = parameter_text(card, 'NAME')
                  tie%has_tolerance = has_parameter(card, 'POSITION TOLERANCE')
                  call take_parameter(card, 'POSITION TOLERANCE', report, tie%tolerance)
                  if (tie%tolerance < 0.0_dp) call report%error(parameter_place(card, &
                     'POSITION TOLERANCE'), 'POSITION TOLERANCE is a distance, 0 or more')
                  call read_faces(card, cards%data(i), context, model%mesh, report, tie%faces)
               end associate
            end do
         end associate
      end do
   end subroutine build_ties

   !> Checks that a card has a name of its own; no node is moved.
   subroutine check_tie_card(card, ties, context, report)
      type(keyword_card_type), intent(in) :: card
      type(tie_definition_type), intent(in) :: ties(:)     ! those of the cards before
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: adjust
      integer :: i

      adjust = 'NO'
      call choose(card, 'ADJUST', 'YES/NO', report, adjust)
      if (adjust == 'YES') call context%note('*TIE, ADJUST=YES: nodes are not moved, an '// &
         'initial gap is not closed')
      if (.not. has_parameter(card, 'NAME')) return
      do i = 1, size(ties)
         if (to_upper(ties(i)%faces%name) /= to_upper(parameter_text(card, 'NAME'))) cycle
         call report%error(parameter_place(card, 'NAME'), ties(i)%faces%title()// &
            ' is defined twice')
         return
      end do
   end subroutine check_tie_card

end module deck_builder_contact
