!> The cards of a deck: what is in its lines, before anything is known of its meaning.
module cards
   use deck_source, only: place_type
   use text, only: append, string_type
   implicit none
   private
   public :: cards_type, keyword_card_type, data_card_type, parameter_type, field_type
   public :: add_keyword, add_data, add_note, trim_cards, replace_cards

   !> One field of a card.
   type :: field_type
      character(:), allocatable :: text   !! without blanks around it, quotes and <names>
      type(place_type) :: place           !! where it begins
      logical :: undefined = .false.      !! whether its text is not known, which is reported
   end type field_type

   !> One parameter of a keyword card.
   type :: parameter_type
      character(:), allocatable :: name   !! as in the table of keywords
      character(:), allocatable :: text   !! its value without quotes, empty where it has none
      type(place_type) :: place           !! where its name begins
      type(place_type) :: value_place     !! where its value begins
   end type parameter_type

   !> One data card, continuations included.
   type :: data_card_type
      type(field_type), allocatable :: fields(:)   !! its fields, empty ones at its end left out
      type(place_type) :: end                      !! where a missing field would be
   contains
      procedure :: has => has_field
      procedure :: is_undefined
      procedure :: text => field_text
      procedure :: place => field_place
   end type data_card_type

   !> One keyword card with its data cards.
   type :: keyword_card_type
      character(:), allocatable :: name                    !! as in the table; empty when unknown
      character(:), allocatable :: meant   !! keyword that a misspelt or refused one stands for
      integer :: known = 0                                 !! index into known_keywords, or 0
      character(:), allocatable :: refusal_of_data         !! the error if data cards follow
      type(place_type) :: place                            !! where it begins
      type(parameter_type), allocatable :: parameters(:)   !! those that are known
      logical :: data_lost = .false.   !! whether data cards were left out after an error in them
      logical :: flawed = .false.      !! whether a parameter was left out after an error in it
      integer :: data_count = 0                            !! data cards, while reading
      type(data_card_type), allocatable :: data(:)         !! data cards
   contains
      procedure :: has => has_parameter
      procedure :: lacks => lacks_parameter
      procedure :: text => parameter_text
      procedure :: place_of => parameter_place
   end type keyword_card_type

   !> All cards of a deck.
   type :: cards_type
      character(:), allocatable :: path                      !! the deck as given
      type(string_type), allocatable :: files(:)             !! it and what it includes, as found
      type(string_type), allocatable :: images(:)            !! lines, those of included files too
      type(keyword_card_type), allocatable :: keywords(:)    !! keyword cards
      type(place_type) :: last                               !! last line of the deck
      type(string_type), allocatable :: notes(:)             !! parameters that are not needed
      integer :: keyword_count = 0                           !! keyword cards, while reading
   end type cards_type

contains

   !> Whether a data card has a field that is not empty.
   pure logical function has_field(data, i)
      class(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1

      has_field = i <= size(data%fields)
      if (has_field) has_field = len(data%fields(i)%text) > 0
   end function has_field

   !> A field as written; empty where the card does not have it.
   pure function field_text(data, i) result(string)
      class(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1
      character(:), allocatable :: string        !! the field

      string = ''
      if (i <= size(data%fields)) string = data%fields(i)%text
   end function field_text

   !> Whether the text of a field is not known, which is reported already.
   pure logical function is_undefined(data, i)
      class(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1

      is_undefined = i <= size(data%fields)
      if (is_undefined) is_undefined = data%fields(i)%undefined
   end function is_undefined

   !> Place of a field; the end of the card where it does not have it.
   pure function field_place(data, i) result(place)
      class(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1
      type(place_type) :: place                  !! where it is

      place = data%end
      if (i <= size(data%fields)) place = data%fields(i)%place
   end function field_place

   pure integer function position(card, name)
      class(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name

      do position = size(card%parameters), 1, -1
         if (card%parameters(position)%name == name) return
      end do
   end function position

   !> Whether a card has a parameter.
   pure logical function has_parameter(card, name)
      class(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name              !! name as in the table of keywords

      has_parameter = position(card, name) > 0
   end function has_parameter

   !> Whether a card is without a parameter, and not because of an error that is reported already.
   pure logical function lacks_parameter(card, name)
      class(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name              !! name as in the table of keywords

      lacks_parameter = .not. (card%has(name) .or. card%flawed)
   end function lacks_parameter

   !> Value of a parameter as written; empty where the card does not have it.
   pure function parameter_text(card, name) result(value)
      class(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name              !! name as in the table of keywords
      character(:), allocatable :: value            !! value without quotes

      value = ''
      if (card%has(name)) value = card%parameters(position(card, name))%text
   end function parameter_text

   !> Place of the value of a parameter; that of the card where it does not have it.
   pure function parameter_place(card, name) result(place)
      class(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name              !! name as in the table of keywords
      type(place_type) :: place                     !! where the value is

      place = card%place
      if (card%has(name)) place = card%parameters(position(card, name))%value_place
   end function parameter_place

   !> Adds a keyword card, whose data cards are still to come.
   subroutine add_keyword(cards, card)
      class(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(in) :: card    !! what is added, but for its data

      if (.not. allocated(cards%keywords)) allocate(cards%keywords(64))
      if (cards%keyword_count == size(cards%keywords)) call resize_keywords(cards%keywords, &
         cards%keyword_count, 2*cards%keyword_count)
      cards%keyword_count = cards%keyword_count + 1
      associate (added => cards%keywords(cards%keyword_count))
         added = card
         added%data_count = 0
         if (allocated(added%data)) deallocate (added%data)
         allocate (added%data(0))
      end associate
   end subroutine add_keyword

   !> Adds a data card to the last keyword card.
   subroutine add_data(cards, fields, end)
      class(cards_type), intent(inout) :: cards
      type(field_type), allocatable, intent(inout) :: fields(:)   !! fields, handed over
      type(place_type), intent(in) :: end                         !! where a missing field would be

      associate (card => cards%keywords(cards%keyword_count))
         if (card%data_count == size(card%data)) call resize_data(card%data, card%data_count, &
            2*card%data_count + 4)
         card%data_count = card%data_count + 1
         call move_alloc(fields, card%data(card%data_count)%fields)
         card%data(card%data_count)%end = end
      end associate
   end subroutine add_data

   !> Adds a note for the listing.
   subroutine add_note(notes, line)
      type(string_type), allocatable, intent(inout) :: notes(:)
      character(*), intent(in) :: line                            !! what is added, once
      integer :: i

      if (allocated(notes)) then
         if (any([(notes(i)%value == line, i=1, size(notes))])) return
      end if
      call append(notes, line)
   end subroutine add_note

   !> Cuts the lists to what they hold, once reading has ended.
   subroutine trim_cards(cards)
      type(cards_type), intent(inout) :: cards
      integer :: k

      if (.not. allocated(cards%keywords)) allocate(cards%keywords(0))
      call resize_keywords(cards%keywords, cards%keyword_count, cards%keyword_count)
      do k = 1, cards%keyword_count
         associate (card => cards%keywords(k))
            call resize_data(card%data, card%data_count, card%data_count)
         end associate
      end do
   end subroutine trim_cards

   !> Puts the cards of another list in place of those read; the notes stay.
   subroutine replace_cards(cards, others)
      type(cards_type), intent(inout) :: cards
      class(cards_type), intent(inout) :: others      !! its cards move, and are not trimmed yet

      call move_alloc(others%keywords, cards%keywords)
      cards%keyword_count = others%keyword_count
      call trim_cards(cards)
   end subroutine replace_cards

   subroutine resize_keywords(list, kept, length)
      type(keyword_card_type), allocatable, intent(inout) :: list(:)
      integer, intent(in) :: kept, length
      type(keyword_card_type), allocatable :: other(:)
      type(data_card_type), allocatable :: data(:)
      integer :: i

      allocate(other(length))
      do i = 1, kept
         call move_alloc(list(i)%data, data)
         other(i) = list(i)
         call move_alloc(data, other(i)%data)
      end do
      call move_alloc(other, list)
   end subroutine resize_keywords

   subroutine resize_data(list, kept, length)
      type(data_card_type), allocatable, intent(inout) :: list(:)
      integer, intent(in) :: kept, length
      type(data_card_type), allocatable :: other(:)
      integer :: i

      allocate(other(length))
      do i = 1, kept
         call move_alloc(list(i)%fields, other(i)%fields)
         other(i)%end = list(i)%end
      end do
      call move_alloc(other, list)
   end subroutine resize_data

end module cards
