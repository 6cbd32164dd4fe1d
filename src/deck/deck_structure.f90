!> Whether the cards of a deck stand where they may stand, and whether those that every deck needs
!> are there.
module deck_structure
   use card_parameters, only: has_parameter, parameter_text
   use card_values, only: field_place
   use cards, only: cards_type, keyword_card_type
   use deck_report, only: deck_report_type
   use keywords, only: built, in_model, in_step, known_keyword_type, known_keywords, not_needed
   use text, only: to_text, to_upper
   implicit none
   private
   public :: check_structure, card_count, is_misspelt

contains

   !> Number of keyword cards of a name.
   pure integer function card_count(cards, name)
      type(cards_type), intent(in) :: cards   !! the cards
      character(*), intent(in) :: name        !! name as in the table of keywords
      integer :: k

      card_count = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name == name) card_count = card_count + 1
      end do
   end function card_count

   !> Whether a keyword that is likely a slip of the pen stands for a name.
   pure logical function is_misspelt(cards, name)
      type(cards_type), intent(in) :: cards   !! the cards
      character(*), intent(in) :: name        !! name as in the table of keywords
      integer :: k

      is_misspelt = .false.
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%meant == name) is_misspelt = .true.
      end do
   end function is_misspelt

   !> Checks the order of the cards, the number of data cards, and what must not be missing.
   subroutine check_structure(cards, report)
      type(cards_type), intent(in) :: cards               !! the cards
      type(deck_report_type), intent(inout) :: report     !! receives errors
      logical :: step_open, after_step
      integer :: k

      step_open = .false.
      after_step = .false.
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            call check_step_card(card, report, step_open)
            after_step = after_step .or. step_open
            if (card%known == 0) cycle
            if (.not. any(known_keywords(card%known)%status == [built, not_needed])) cycle
            call check_section(card, step_open, after_step, report)
            call check_data_count(cards, card, report)
         end associate
      end do
      if (step_open) call report%error(cards%last, 'the last step has no *END STEP')
      call need_card(cards, 'NODE', report)
      call need_card(cards, 'ELEMENT', report)
      call need_card(cards, 'SOLID SECTION', report)
      call need_card(cards, 'STEP', report)
   end subroutine check_structure

   !> Follows *STEP and *END STEP; a slip of the pen in one of them is reported already, and stands
   !> for it.
   subroutine check_step_card(card, report, step_open)
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: step_open
      character(:), allocatable :: name

      name = card%name//card%meant
      if (name == 'STEP') then
         if (step_open) call report%error(card%place, 'the step before has no *END STEP')
         step_open = .true.
      else if (name == 'END STEP') then
         if (.not. step_open) call report%error(card%place, 'this *END STEP has no *STEP')
         step_open = .false.
      end if
   end subroutine check_step_card

   subroutine check_section(card, step_open, after_step, report)
      type(keyword_card_type), intent(in) :: card
      logical, intent(in) :: step_open, after_step
      type(deck_report_type), intent(inout) :: report

      select case (known_keywords(card%known)%section)
      case (in_model)
         if (after_step) call report%error(card%place, '*'//card%name// &
            ' must stand before the first *STEP')
      case (in_step)
         if (.not. step_open .and. card%name /= 'END STEP') call report%error(card%place, &
            '*'//card%name//' must stand between *STEP and *END STEP')
      case default
         if (card%name == 'BOUNDARY' .and. after_step .and. .not. step_open) then
            call report%error(card%place, '*BOUNDARY must stand in a step or before the first')
         end if
      end select
   end subroutine check_section

   subroutine check_data_count(cards, card, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report
      type(known_keyword_type) :: known
      integer :: n

      known = known_keywords(card%known)
      n = card%last_data - card%first_data + 1
      if (known%status == built .and. n < known%least_data .and. .not. &
         (says_all(card) .or. card%data_lost)) then
         call report%error(card%place, '*'//card%name//' needs a data card')
      else if (n > known%most_data) then
         call report%error(field_place(cards%data(card%first_data + known%most_data), 1), &
            'extra data card; *'//card%name//' has '//most_cards(known%most_data))
      end if
   end subroutine check_data_count

   !> Whether a card needs no data because its parameters say all that it has to say: OP=NEW, or an
   !> element set or surface of which an *NSET takes the nodes.
   pure logical function says_all(card)
      type(keyword_card_type), intent(in) :: card

      says_all = to_upper(parameter_text(card, 'OP')) == 'NEW' .or. (card%name == 'NSET' .and. &
         (has_parameter(card, 'ELSET') .or. has_parameter(card, 'SURFACE')))
   end function says_all

   pure function most_cards(most) result(words)
      integer, intent(in) :: most
      character(:), allocatable :: words

      words = 'none'
      if (most > 0) words = 'at most '//to_text(most)
   end function most_cards

   !> Reports a card that no deck can do without, unless a misspelt one stands for it.
   subroutine need_card(cards, name, report)
      type(cards_type), intent(in) :: cards
      character(*), intent(in) :: name
      type(deck_report_type), intent(inout) :: report

      if (card_count(cards, name) > 0 .or. is_misspelt(cards, name)) return
      if (size(cards%keywords) > 0) call report%error(cards%last, 'the deck has no *'//name)
   end subroutine need_card

end module deck_structure
