!> Whether the cards of a deck are where they may be, and those that every deck needs are there;
!> *CYCLE -> the steps before it, as often again as it says.
module deck_structure
   use card_values, only: chosen
   use cards, only: cards_type, keyword_card_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use keywords, only: in_model, in_step, keyword_type, known_keywords
   use text, only: counted, read_integer, to_text
   implicit none
   private
   public :: check_structure, check_data_counts, cards_of, data_count, has_stand_in, is_keyword, &
      repeat_steps

   integer, parameter :: most_repeats = 100000

   !> Cards of a step that are there once: what they define or ask for holds for all cycles.
   character(*), parameter :: not_repeated(7) = [character(11) :: 'VERIFY', 'AMPLITUDE', 'NSET', &
      'ELSET', 'TIME POINTS', 'RESTART', 'NO ANALYSIS']

contains

   !> The keyword cards of a name, as indexes into the keyword cards.
   pure function cards_of(cards, name) result(places)
      type(cards_type), intent(in) :: cards
      character(*), intent(in) :: name        !! name as in the table of keywords
      integer, allocatable :: places(:)
      integer :: k

      places = pack([(k, k=1, size(cards%keywords))], &
         [(cards%keywords(k)%name == name, k=1, size(cards%keywords))])
   end function cards_of

   !> Number of data cards of some keyword cards.
   pure integer function data_count(cards, keywords)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: keywords(:)      !! indexes into the keyword cards
      integer :: i

      data_count = sum([(size(cards%keywords(keywords(i))%data), i=1, size(keywords))])
   end function data_count

   !> Whether there is a keyword card k, and it has this name.
   pure logical function is_keyword(cards, k, name)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: k                !! index of the card, or one that no card has
      character(*), intent(in) :: name        !! name as in the table of keywords

      is_keyword = .false.
      if (k >= 1 .and. k <= size(cards%keywords)) is_keyword = cards%keywords(k)%name == name
   end function is_keyword

   !> Whether a misspelt or refused keyword stands for another one.
   pure logical function has_stand_in(cards, name)
      type(cards_type), intent(in) :: cards
      character(*), intent(in) :: name        !! name as in the table of keywords
      integer :: k

      has_stand_in = any([(cards%keywords(k)%meant == name, k=1, size(cards%keywords))])
   end function has_stand_in

   !> Checks the order of the cards, and what must not be missing.
   subroutine check_structure(cards, report)
      type(cards_type), intent(in) :: cards
      class(deck_report_type), intent(inout) :: report    !! receives errors
      type(place_type) :: place
      logical :: step_open, after_step
      integer :: k, section, step

      do k = 1, size(cards%keywords)
         call lose_definitions(cards%keywords(k), report)
      end do
      if (report%has_lost()) return
      place = cards%last
      do k = size(cards%keywords), 1, -1
         associate (card => cards%keywords(k))
            if (card%known == 0 .or. len(card%meant) > 0) cycle
            if (known_keywords(card%known)%section == in_step) place = card%place
         end associate
      end do
      call need_card(cards, 'STEP', place, report)
      step_open = .false.
      after_step = .false.
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name == 'STEP') then
               if (step_open) call report%error(card%place, 'the step before has no *END STEP')
               step_open = .true.
               step = k
            else if (card%name == 'END STEP') then
               if (.not. step_open) call report%missing(card%place, 'this *END STEP has no '// &
                  '*STEP', '*STEP')
               step_open = .false.
            end if
            after_step = after_step .or. step_open
            if (card%known == 0 .or. len(card%meant) > 0) cycle
            section = known_keywords(card%known)%section
            if (section == in_model .and. after_step) call report%error(card%place, '*'// &
               card%name//' must come before the first *STEP', 'late cards of the model')
            if (section == in_step .and. .not. step_open .and. card%name /= 'END STEP') call &
               report%missing(card%place, '*'//card%name//' must be between *STEP and *END '// &
               'STEP', '*STEP')
            if (card%name == 'BOUNDARY' .and. after_step .and. .not. step_open) call &
               report%error(card%place, '*BOUNDARY must be in a step or before the first')
         end associate
      end do
      if (step_open) call report%error(cards%keywords(step)%place, 'this step has no *END STEP')
      call need_card(cards, 'NODE', cards%last, report)
      call need_card(cards, 'ELEMENT', cards%last, report)
      place = cards%last
      do k = size(cards%keywords), 1, -1
         if (cards%keywords(k)%name == 'ELEMENT') place = cards%keywords(k)%place
      end do
      call need_card(cards, 'SOLID SECTION', place, report)
   end subroutine check_structure

   !> Definitions of a card with an error in it may be missing elsewhere.
   subroutine lose_definitions(card, report)
      type(keyword_card_type), intent(in) :: card
      class(deck_report_type), intent(inout) :: report

      if (.not. (card%flawed .or. card%data_lost)) return
      select case (card%name)
      case ('NODE', 'NSET')
         if (card%data_lost) call report%lose('node')
         call report%lose('node set', card%text('NSET'))
      case ('ELEMENT', 'ELSET')
         if (card%data_lost) call report%lose('element')
         call report%lose('element set', card%text('ELSET'))
      case ('SURFACE', 'MATERIAL', 'ORIENTATION', 'AMPLITUDE', 'SURFACE INTERACTION', &
         'CONTACT PAIR')
         call report%lose(card%name, card%text('NAME'))
      case ('ELASTIC', 'CONDUCTIVITY', 'DENSITY', 'SPECIFIC HEAT')
         call report%lose('*'//card%name)
      case ('EQUATION', 'COUPLING', 'KINEMATIC', 'RIGID BODY', 'PRE-TENSION SECTION')
         call report%lose('equation')
      case default
         return
      end select
   end subroutine lose_definitions

   !> Checks the number of data cards of all keyword cards.
   subroutine check_data_counts(cards, report)
      type(cards_type), intent(in) :: cards
      class(deck_report_type), intent(inout) :: report    !! receives errors
      type(keyword_type) :: known
      character(:), allocatable :: most
      integer :: k
      logical :: says_all

      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k), n => size(cards%keywords(k)%data))
            if (card%known == 0) cycle
            known = known_keywords(card%known)
            ! OP=NEW, ROUGH, or an element set or surface of which an *NSET takes the nodes.
            says_all = chosen(card, 'OP', 'MOD/NEW') == 'NEW' .or. card%has('ROUGH') .or. &
               (card%name == 'NSET' .and. (card%has('ELSET') .or. card%has('SURFACE')))
            if (n < known%least_data .and. .not. (says_all .or. card%data_lost)) then
               call report%error(card%place, '*'//card%name//' needs a data card')
            else if (n > known%most_data) then
               most = 'none'
               if (known%most_data > 0) most = 'at most '//to_text(known%most_data)
               call report%error(card%data(known%most_data + 1)%place(1), 'extra data card; *'// &
                  card%name//' has '//most)
            end if
         end associate
      end do
   end subroutine check_data_counts

   !> Reports a card that no deck can do without, unless a refused one is in its place.
   subroutine need_card(cards, name, place, report)
      type(cards_type), intent(in) :: cards
      character(*), intent(in) :: name
      type(place_type), intent(in) :: place              ! where it is missed
      class(deck_report_type), intent(inout) :: report

      if (size(cards_of(cards, name)) > 0 .or. has_stand_in(cards, name)) return
      if (size(cards%keywords) > 0) call report%error(place, 'the deck has no *'//name)
      call report%lose('*'//name)
   end subroutine need_card

   !> Inserts the steps that each *CYCLE repeats behind it.
   subroutine repeat_steps(cards, report)
      type(cards_type), intent(inout) :: cards
      type(deck_report_type), intent(inout) :: report
      type(keyword_card_type), allocatable :: longer(:), repeated(:)
      integer :: first, i, k, repeats, steps

      k = 1
      do while (k <= size(cards%keywords))
         if (cards%keywords(k)%name == 'CYCLE') then
            associate (card => cards%keywords(k))
               steps = number_of(card, 'STEPS')
               repeats = number_of(card, 'REPEAT')
               first = first_card(cards, k, steps)
               if (first == 0) call report%error(card%place_of('STEPS'), '*CYCLE stands behind '// &
                  'the *END STEP of the last of '//counted(steps, 'step')// &
                  ', none of which is in a *CYCLE before')
               if (repeats > most_repeats) call report%error(card%place_of('REPEAT'), &
                  'REPEAT is at most '//to_text(most_repeats))
            end associate
            if (first == 0 .or. repeats > most_repeats) return
            repeated = pack(cards%keywords(first:k - 1), [(all(not_repeated /= &
               cards%keywords(i)%name), i=first, k - 1)])
            associate (n => size(repeated), all => size(cards%keywords))
               allocate (longer(all + repeats*n))
               longer(:k) = cards%keywords(:k)
               do i = 1, repeats
                  longer(k + 1 + (i - 1)*n:k + i*n) = repeated
               end do
               longer(k + repeats*n + 1:) = cards%keywords(k + 1:)
            end associate
            call move_alloc(longer, cards%keywords)
            k = k + repeats*size(repeated)
         end if
         k = k + 1
      end do
   end subroutine repeat_steps

   !> The card that begins the first of some steps before a card, or 0.
   integer function first_card(cards, k, steps)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: k, steps
      integer :: found
      logical :: is_closed

      found = 0
      is_closed = .false.
      do first_card = k - 1, 1, -1
         select case (cards%keywords(first_card)%name)
         case ('CYCLE')
            exit
         case ('END STEP')
            is_closed = .true.
         case ('STEP')
            if (.not. is_closed) exit
            found = found + 1
            if (found == steps) return
         case default
            cycle
         end select
      end do
      first_card = 0
   end function first_card

   !> A parameter, 1 where it is not given or wrong, which the builder reports.
   pure integer function number_of(card, name) result(number)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      logical :: is_number

      call read_integer(card%text(name), number, is_number)
      if (.not. is_number .or. number < 1) number = 1
   end function number_of

end module deck_structure
