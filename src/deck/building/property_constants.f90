!> Constants of a property of a material, as they are on its data cards.
module property_constants
   use card_parameters, only: choose
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, has_field, keyword_card_type
   use decimal_commas, only: check_unneeded_temperature
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   implicit none
   private
   public :: choose_symmetry, read_constants, refuse_not_positive

   character(*), parameter :: varies = 'properties that vary with temperature are refused: '// &
      'bodies are linear, and reduced once to their contact unknowns'

   integer, parameter :: per_card = 8   !! constants of a property on a card

contains

   !> Takes TYPE= of a property: how many constants it has. CalculiX reads the first letters only,
   !> so longer words are in decks for it.
   subroutine choose_symmetry(card, choices, report, symmetry)
      type(keyword_card_type), intent(in) :: card              !! the property
      character(*), intent(in) :: choices                      !! words, separated by slashes
      type(deck_report_type), intent(inout) :: report          !! receives the error
      character(:), allocatable, intent(inout) :: symmetry     !! the word as in choices

      call choose(card, 'TYPE', choices//'/ISOTROPIC/ORTHOTROPIC', report, symmetry)
      if (symmetry == 'ISOTROPIC') symmetry = 'ISO'
      if (symmetry == 'ORTHOTROPIC') symmetry = 'ORTHO'
   end subroutine choose_symmetry

   !> Reads the constants of a property, eight on a card, and the temperature behind the last.
   subroutine read_constants(cards, card, names, context, report, constants, valid)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card         !! the property, with a data card
      character(*), intent(in) :: names(:)                !! (constants) what they are called
      type(deck_context_type), intent(inout) :: context   !! receives a note
      type(deck_report_type), intent(inout) :: report     !! receives errors
      real(dp), intent(out) :: constants(:)               !! (constants) in the order of the cards
      logical, intent(out) :: valid                       !! false after an error
      integer :: i, last, place

      valid = .true.
      constants = 0.0_dp
      last = card%first_data + (size(constants) - 1)/per_card
      do i = 1, size(constants)
         place = card%first_data + (i - 1)/per_card
         if (place > card%last_data) then
            call report%error(cards%data(card%last_data)%end, 'a card is missing after '// &
               'this one: '// &
               trim(names(i)))
            valid = .false.
            return
         end if
         call need_field(cards%data(place), mod(i - 1, per_card) + 1, trim(names(i)), report, &
            constants(i), valid)
         if (.not. has_field(cards%data(place), mod(i - 1, per_card) + 1)) return
         if (place == last) cycle
         if (mod(i, per_card) == 0) call check_extra(cards%data(place), per_card, &
            'eight constants', report)
      end do
      call read_temperature(cards%data(last), mod(size(constants) - 1, per_card) + 2, &
         joined(names(per_card*(last - card%first_data) + 1:)), context, report)
      if (card%last_data > last) call report%error(field_place(cards%data(last + 1), 1), varies)
   end subroutine read_constants

   pure function joined(names) result(list)
      character(*), intent(in) :: names(:)
      character(:), allocatable :: list
      integer :: i

      list = trim(names(1))
      do i = 2, size(names)
         list = list//', '//trim(names(i))
      end do
   end function joined

   !> Reports constants that must be positive and are not.
   subroutine refuse_not_positive(cards, card, names, constants, which, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card         !! the property
      character(*), intent(in) :: names(:)                !! (constants) what they are called
      real(dp), intent(in) :: constants(:)                !! (constants) as read
      integer, intent(in) :: which(:)                     !! indexes of those that must be positive
      type(deck_report_type), intent(inout) :: report     !! receives errors
      integer :: i

      do i = 1, size(which)
         if (constants(which(i)) > 0.0_dp) cycle
         call report%error(field_place(cards%data(card%first_data + (which(i) - 1)/per_card), &
            mod(which(i) - 1, per_card) + 1), trim(names(which(i)))//' must be positive')
      end do
   end subroutine refuse_not_positive

   !> Reads the temperature behind a property: one row of it means nothing.
   subroutine read_temperature(data, position, layout, context, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position
      character(*), intent(in) :: layout
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp) :: temperature
      logical :: valid

      valid = .true.
      call take_field(data, position, 'temperature', report, temperature, valid)
      call check_extra(data, position, layout//', temperature', report)
      if (has_field(data, position)) then
         call context%note('the temperature field of a single property row is ignored')
         if (valid) call check_unneeded_temperature(data, position, report)
      end if
   end subroutine read_temperature

end module property_constants
