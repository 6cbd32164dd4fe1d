!> *CHANGE FRICTION, *MODEL CHANGE and *CONTACT INTERFERENCE -> what a step changes of contact.
module deck_builder_contact_changes
   use card_parameters, only: choose, has_parameter, need_parameter, parameter_place
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use contact_definitions, only: contact_changes_type, contact_definition_type, &
      friction_change_type, interference_type, pair_change_type
   use deck_builder_contact, only: find_contact
   use deck_builder_interactions, only: build_friction
   use deck_context, only: deck_context_type, need_named, read_surface, take_named
   use deck_report, only: deck_report_type
   use deck_structure, only: is_keyword
   use kinds, only: dp
   use model, only: model_type
   use text, only: to_text
   implicit none
   private
   public :: build_contact_change

contains

   !> Reads one card of a step.
   subroutine build_contact_change(cards, k, step, model, context, report)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: k                             !! the keyword card
      integer, intent(in) :: step                          !! index of the step, 0 before the first
      type(model_type), intent(inout) :: model             !! receives the change
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(contact_changes_type) :: changes

      if (step == 0) return
      changes = model%steps(step)%changes
      select case (cards%keywords(k)%name)
      case ('CHANGE FRICTION')
         if (is_keyword(cards, k + 1, 'FRICTION')) return
         call report%error(cards%keywords(k)%place, '*CHANGE FRICTION needs a *FRICTION after it')
      case ('FRICTION')
         if (is_keyword(cards, k - 1, 'CHANGE FRICTION')) then
            call change_friction(cards, k, model, context, report, changes)
         else
            call report%error(cards%keywords(k)%place, &
               '*FRICTION in a step needs *CHANGE FRICTION, INTERACTION= before it')
         end if
      case ('MODEL CHANGE')
         call change_pairs(cards, cards%keywords(k), model, report, changes)
      case default
         call change_interferences(cards, cards%keywords(k), step, model, context, report, changes)
      end select
      model%steps(step)%changes = changes
   end subroutine build_contact_change

   !> The friction of the interaction that the card before names.
   subroutine change_friction(cards, k, model, context, report, changes)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: k
      type(model_type), intent(in) :: model
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(contact_changes_type), intent(inout) :: changes
      type(friction_change_type) :: change

      call build_friction(cards, cards%keywords(k), context, report, change%friction)
      call need_named(cards%keywords(k - 1), 'INTERACTION', 'surface interaction', &
         model%interactions, report, change%interaction)
      if (change%interaction == 0) return
      if (.not. allocated(changes%frictions)) allocate (changes%frictions(0))
      changes%frictions = [changes%frictions, change]
   end subroutine change_friction

   !> The interfaces that *MODEL CHANGE removes or adds.
   subroutine change_pairs(cards, card, model, report, changes)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(contact_changes_type), intent(inout) :: changes
      type(pair_change_type) :: change
      character(:), allocatable :: kind
      integer :: j

      call need_parameter(card, 'TYPE', report, kind)
      if (kind == 'ELEMENT') then
         call report%error(parameter_place(card, 'TYPE'), 'TYPE=ELEMENT is refused: '// &
            'elements are the same in all steps')
         return
      end if
      call choose(card, 'TYPE', 'CONTACT PAIR', report, kind)
      change%removes = has_parameter(card, 'REMOVE')
      if ((change%removes .eqv. has_parameter(card, 'ADD')) .and. .not. card%flawed) then
         call report%error(card%place, '*MODEL CHANGE needs either ADD or REMOVE')
      end if
      if (.not. allocated(changes%pairs)) allocate (changes%pairs(0))
      do j = card%first_data, card%last_data
         call read_contact(cards%data(j), 2, 'slave surface, master surface', model, report, &
            change%contact)
         if (change%contact > 0) changes%pairs = [changes%pairs, change]
      end do
   end subroutine change_pairs

   !> The interferences of some interfaces.
   subroutine change_interferences(cards, card, step, model, context, report, changes)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: step
      type(model_type), intent(in) :: model
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(contact_changes_type), intent(inout) :: changes
      type(interference_type) :: given
      character(:), allocatable :: kind, operation
      integer :: j
      logical :: valid

      call choose(card, 'TYPE', 'CONTACT PAIR', report, kind)
      operation = 'MOD'
      call choose(card, 'OP', 'MOD/NEW', report, operation)
      if (operation == 'NEW') changes%ends_interferences = .true.
      given%shrinks = has_parameter(card, 'SHRINK')
      if (given%shrinks .and. step > 1) call report%error(parameter_place(card, 'SHRINK'), &
         'SHRINK is allowed in the first step only: it removes the initial overlaps')
      if (given%shrinks .and. has_parameter(card, 'AMPLITUDE')) then
         call context%note('*CONTACT INTERFERENCE, SHRINK: AMPLITUDE= is ignored')
      else
         call take_named(card, 'AMPLITUDE', 'amplitude', model%amplitudes, report, given%amplitude)
      end if
      if (.not. allocated(changes%interferences)) allocate (changes%interferences(0))
      do j = card%first_data, card%last_data
         valid = .true.
         given%value = 1.0_dp
         if (given%shrinks) then
            call read_contact(cards%data(j), 2, 'slave surface, master surface', model, report, &
               given%contact)
         else
            call read_contact(cards%data(j), 3, 'slave surface, master surface, interference', &
               model, report, given%contact)
            call need_field(cards%data(j), 3, 'interference', report, given%value, valid)
         end if
         if (given%contact == 0 .or. .not. valid) cycle
         changes%interferences = [changes%interferences, given]
         if (.not. given%shrinks) call check_clearance(cards%data(j), model%contacts( &
            given%contact), given%value, report)
      end do
   end subroutine change_interferences

   !> Warns of an interference against a clearance, but not where it allows a part of an overlap.
   subroutine check_clearance(data, contact, interference, report)
      type(data_card_type), intent(in) :: data
      type(contact_definition_type), intent(in) :: contact
      real(dp), intent(in) :: interference
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: meaning

      if (contact%clearance*interference >= 0.0_dp) return
      associate (gap => contact%clearance + interference)
         if (contact%clearance < 0.0_dp .and. gap <= 0.0_dp) return
         meaning = 'the faces touch'
         if (gap < 0.0_dp) meaning = 'the faces overlap by '//to_text(-gap)
         if (gap > 0.0_dp) meaning = 'the faces are '//to_text(gap)//' apart'
         call report%warning(field_place(data, 3), contact%title()//': the interference '// &
            to_text(interference)//' and the *CLEARANCE '//to_text(contact%clearance)// &
            ' work against each other: with the sum, '//to_text(gap)//', '//meaning// &
            '; give the gap that is meant by one of them')
      end associate
   end subroutine check_clearance

   !> The interface of the two surfaces that a data card names; 0 after an error.
   subroutine read_contact(data, most, layout, model, report, contact)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: most                 ! most fields
      character(*), intent(in) :: layout
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer, intent(out) :: contact
      integer :: master, slave

      call read_surface(data, 1, 'slave surface', model%mesh%surfaces, report, slave)
      call read_surface(data, 2, 'master surface', model%mesh%surfaces, report, master)
      call check_extra(data, most, layout, report)
      call find_contact(slave, master, model%contacts, model%mesh, field_place(data, 1), report, &
         contact)
   end subroutine read_contact

end module deck_builder_contact_changes
