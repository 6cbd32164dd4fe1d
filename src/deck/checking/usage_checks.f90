!> Definitions that a deck does not use, or uses for a part of a step only: they may be slips.
module usage_checks
   use amplitudes, only: amplitude_type, amplitude_value
   use card_parameters, only: parameter_text
   use cards, only: cards_type, field_text, keyword_card_type
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_list_type
   use model, only: model_type
   use text, only: to_text, to_upper
   implicit none
   private
   public :: check_usage

   integer, parameter :: most_names = 10   !! that one message lists

   !> An amplitude that ends before this part of its step is over ends long before it.
   real(dp), parameter :: long_before = 0.5_dp

contains

   !> Warns of definitions without use, and of amplitudes that end long before their step or begin
   !> after it. The deck has no errors, of which these may only be the consequence.
   subroutine check_usage(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(in) :: context      !! requests
      type(model_type), intent(in) :: model               !! amplitudes and steps
      type(deck_report_type), intent(inout) :: report     !! receives warnings
      logical :: told(size(model%amplitudes))

      call check_names(cards, 'MATERIAL', 'material', report)
      call check_names(cards, 'SURFACE INTERACTION', 'surface interaction', report)
      call check_names(cards, 'SURFACE', 'surface', report)
      call check_names(cards, 'AMPLITUDE', 'amplitude', report)
      told = .false.
      call check_amplitudes(cards, context%boundaries, model, told, report)
      call check_amplitudes(cards, context%loads, model, told, report)
   end subroutine check_usage

   !> Warns once of the cards of a keyword whose names no card refers to. A library that a deck
   !> includes may well have more materials, interactions and amplitudes than it needs; a surface
   !> without use may be a pair that was forgotten.
   subroutine check_names(cards, keyword, noun, report)
      type(cards_type), intent(in) :: cards
      character(*), intent(in) :: keyword, noun
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: name, names
      integer :: count, first, i, k
      logical :: from_library

      from_library = keyword /= 'SURFACE'
      names = ''
      count = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name /= keyword) cycle
         if (from_library .and. report%source%file(cards%keywords(k)%place%image) > 1) cycle
         name = to_upper(parameter_text(cards%keywords(k), 'NAME'))
         if (any([(refers(cards, cards%keywords(i), keyword, name), i=1, &
            size(cards%keywords))])) cycle
         count = count + 1
         if (count == 1) first = k
         if (count <= most_names) names = names//', '//name
      end do
      if (count == 0) return
      if (count > most_names) names = names//' and '//to_text(count - most_names)//' more'
      call report%warning(cards%keywords(first)%place, 'nothing uses the '//noun// &
         trim(merge(' ', 's', count == 1))//names(2:))
   end subroutine check_names

   !> Whether a card refers to a name that a keyword defines.
   pure logical function refers(cards, card, keyword, name)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: keyword, name

      select case (keyword)
      case ('MATERIAL')
         refers = has_value(card, 'MATERIAL', name)
      case ('SURFACE INTERACTION')
         refers = has_value(card, 'INTERACTION', name)
      case ('AMPLITUDE')
         refers = card%name /= 'STEP' .and. &
            (has_value(card, 'AMPLITUDE', name) .or. has_value(card, 'FILM AMPLITUDE', name))
      case default
         select case (card%name)
         case ('CONTACT PAIR', 'TIE')
            refers = has_field_value(cards, card, 2, name)
         case ('DLOAD', 'DSLOAD', 'DFLUX', 'DSFLUX', 'FILM', 'SFILM')
            refers = has_field_value(cards, card, 1, name)
         case default
            refers = has_value(card, 'SURFACE', name)
         end select
      end select
   end function refers

   pure logical function has_value(card, parameter, name)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: parameter, name

      has_value = to_upper(parameter_text(card, parameter)) == name
   end function has_value

   !> Whether one of the first fields of a data card is a name.
   pure logical function has_field_value(cards, card, fields, name)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: fields
      character(*), intent(in) :: name
      integer :: i, j

      has_field_value = .true.
      do j = card%first_data, card%last_data
         do i = 1, fields
            if (to_upper(field_text(cards%data(j), i)) == name) return
         end do
      end do
      has_field_value = .false.
   end function has_field_value

   !> Warns of amplitudes that end long before the step in which a request begins to follow them, or
   !> begin after it.
   subroutine check_amplitudes(cards, requests, model, told, report)
      type(cards_type), intent(in) :: cards
      type(request_list_type), intent(in) :: requests
      type(model_type), intent(in) :: model
      logical, intent(inout) :: told(:)
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: message
      real(dp) :: start, last
      integer :: a, i, s

      do i = 1, requests%count
         a = requests%items(i)%amplitude
         if (a == 0) cycle
         if (told(a)) cycle
         s = max(requests%items(i)%step, 1)
         start = 0.0_dp
         if (model%amplitudes(a)%total_time) start = sum(model%steps(:s - 1)%period)
         associate (curve => model%amplitudes(a), period => model%steps(s)%period)
            if (is_idle(curve, start, merge(sum(model%steps(s:)%period), period, &
               curve%total_time))) then
               told(a) = .true.
               message = 'amplitude '//curve%name//' is 0 throughout step '//to_text(s)// &
                  ', which begins to use it'
               if (.not. curve%total_time) message = message//'; without TIME=TOTAL TIME its '// &
                  'times count from the start of the step'
               call report%warning(cards%keywords(card_of(cards, a))%place, message)
               cycle
            end if
            last = curve%times(size(curve%times))
            if (last - start >= long_before*period .or. is_level(curve)) cycle
            told(a) = .true.
            call report%warning(cards%keywords(card_of(cards, a))%place, 'amplitude '// &
               curve%name//' ends at '//to_text(last)//', long before the end of step '// &
               to_text(s)//' at '//to_text(start + period)//': its last factor, '// &
               to_text(curve%values(size(curve%values)))//', is kept')
         end associate
      end do
   end subroutine check_amplitudes

   !> Whether an amplitude that is not always 0 is so over an interval.
   pure logical function is_idle(curve, start, length)
      type(amplitude_type), intent(in) :: curve
      real(dp), intent(in) :: start, length

      is_idle = .not. is_level(curve) .and. abs(amplitude_value(curve, start)) + &
         abs(amplitude_value(curve, start + length)) + sum(abs(curve%values), &
         mask=curve%times > start .and. curve%times < start + length) <= 0.0_dp
   end function is_idle

   !> Whether an amplitude is the same everywhere, so that it does not matter where it ends.
   pure logical function is_level(curve)
      type(amplitude_type), intent(in) :: curve

      is_level = all(abs(curve%values - curve%values(1)) <= 0.0_dp)
   end function is_level

   !> Index of the card that defines the n-th amplitude.
   pure integer function card_of(cards, n)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: n
      integer :: found

      found = 0
      do card_of = 1, size(cards%keywords)
         if (cards%keywords(card_of)%name == 'AMPLITUDE') found = found + 1
         if (found == n) return
      end do
   end function card_of

end module usage_checks
