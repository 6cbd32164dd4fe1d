!> Fields of a keyword card -> the card with its parameters, each of them known; typing errors that
!> hide how a card is meant: a keyword without its asterisk, and commas that are missing.
module keyword_cards
   use card_fields, only: first_text, last_text, without_quotes
   use card_values, only: decimal_comma_words
   use cards, only: add_note, cards_type, field_type, keyword_card_type, parameter_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use keywords, only: advice_type, built, find_abbreviated, find_advice, find_keyword, &
      find_parameter, is_output, known_keywords, known_names, known_parameter_type, no_advice, &
      not_needed, not_printed, parameter_names, passed_over, refused, refused_with_data
   use kinds, only: dp
   use spelling, only: is_slip, nearest_name
   use text, only: is_whole, read_real, string_type, to_upper
   implicit none
   private
   public :: make_keyword_card, is_parameter, lacks_star, check_commas

   character(*), parameter :: blanks = ' '//achar(9)    !! they separate words
   character(*), parameter :: numerals = ' 0123456789+-.eEdD'
   character(*), parameter :: signs = achar(9)//';'     !! no name and no number has them

contains

   !> Makes a keyword card of its fields, and reports what is unknown or refused. A misspelt keyword
   !> is taken as the one that it likely is.
   subroutine make_keyword_card(fields, report, cards, card)
      type(field_type), intent(in) :: fields(:)         !! fields, the first with the star
      type(deck_report_type), intent(inout) :: report   !! receives errors
      type(cards_type), intent(inout) :: cards          !! receives notes on what is not needed
      type(keyword_card_type), intent(out) :: card      !! the card, without data
      card%name = ''
      card%meant = ''
      card%place = fields(1)%place
      card%known = find_keyword(fields(1)%text(2:))
      allocate(card%parameters(0))
      if (card%known == 0) call take_foreign_keyword(fields, report, cards, card)
      if (card%known == 0) return
      card%name = trim(known_keywords(card%known)%name)
      call take_parameters(fields(2:), report, cards, card)
   end subroutine make_keyword_card

   !> Whether the first field of a line behind a keyword card that ends in a comma is a parameter of
   !> it; else the line is data, as in CalculiX.
   pure logical function is_parameter(keyword, field)
      character(*), intent(in) :: keyword   !! the keyword with its star
      character(*), intent(in) :: field     !! the first field of the line
      type(known_parameter_type) :: parameter
      type(string_type), allocatable :: names(:)
      integer :: known

      known = find_keyword(keyword(2:))
      is_parameter = index(field, '=') > 0
      if (known == 0) return
      parameter = find_parameter(known, field)
      ! gfortran loses the strings of a function result that is an argument of size.
      names = parameter_names(known)
      is_parameter = size(names) > 0 .and. (is_parameter .or. len(parameter%name) > 0)
   end function is_parameter

   !> A keyword of CalculiX or Abaqus that is passed over or refused, or one that nobody knows.
   subroutine take_foreign_keyword(fields, report, cards, card)
      type(field_type), intent(in) :: fields(:)
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(inout) :: card
      type(advice_type) :: advice
      character(:), allocatable :: message, name
      integer :: blank

      name = trim(adjustl(fields(1)%text(2:)))
      advice = find_advice(name)
      message = '*'//trim(advice%names)//' is refused: '//trim(advice%words)
      select case (advice%kind)
      case (passed_over)
         call add_note(cards%notes, '*'//trim(advice%names)//' is ignored: '//trim(advice%words))
      case (not_printed)
         call report%warning(card%place, '*'//trim(advice%names)//' is not printed; '// &
            trim(advice%words))
      case (refused)
         card%meant = trim(advice%keyword)
         call report%error(card%place, message)
         if (len(card%meant) > 0) call report%lose('*'//card%meant)
         call lose_names(fields(2:), report)
      case (refused_with_data)
         card%refusal_of_data = message
         call add_note(cards%notes, '*'//trim(advice%names)//' without data is ignored')
      case default
         blank = end_of_keyword(fields(1)%text)
         if (blank > 0) then   ! the parameter behind it is lost
            call report%error(place_type(card%place%image, card%place%column + blank - 2 + &
               first_text(fields(1)%text(blank:))), 'a comma is missing after '// &
               to_upper(fields(1)%text(:blank - 1)))
            card%known = find_keyword(fields(1)%text(2:blank - 1))
            card%flawed = .true.
         end if
         if (card%known == 0) call report_unknown_keyword(name, index(fields(1)%text, '* ') == 1, &
            report, card)
         if (card%known == 0) call lose_names(fields(2:), report)
      end select
   end subroutine take_foreign_keyword

   !> The names that a refused card or one that nobody knows may define are missing elsewhere.
   subroutine lose_names(fields, report)
      type(field_type), intent(in) :: fields(:)    ! its parameters
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: value
      integer :: equals, i

      do i = 1, size(fields)
         equals = index(fields(i)%text, '=')
         value = without_quotes(trim(adjustl(fields(i)%text(equals + 1:))))
         if (equals == 0 .or. len(value) == 0) cycle
         select case (to_upper(trim(adjustl(fields(i)%text(:equals - 1)))))
         case ('NAME')
            call report%lose(name=value)
         case ('NSET')
            call report%lose('node set', value)
         case ('ELSET')
            call report%lose('element set', value)
         case default
            continue
         end select
      end do
   end subroutine lose_names

   !> Reports a keyword that nobody knows, with the known one that it likely is by its spelling. All
   !> its cards are one mistake.
   subroutine report_unknown_keyword(name, is_text, report, card)
      character(*), intent(in) :: name
      logical, intent(in) :: is_text   ! whether a blank follows the star
      type(deck_report_type), intent(inout) :: report
      type(keyword_card_type), intent(inout) :: card
      type(string_type), allocatable :: names(:)
      character(:), allocatable :: hint
      integer :: i

      names = known_names()
      i = nearest_name(name, names)
      hint = 'docs/deck.md lists those that are known'
      if (is_text) hint = 'a comment begins with **'
      if (is_slip(name, names(i)%value)) then
         hint = 'the nearest known is *'//names(i)%value
         if (i <= size(known_keywords)) then
            card%meant = names(i)%value
            card%known = i
         end if
      end if
      call report%error(card%place, 'unknown keyword *'//to_upper(name)//'; '//hint, &
         'keyword '//to_upper(name))
   end subroutine report_unknown_keyword

   !> Takes the parameters; LOAD= of *OPTIONS takes the field behind it as well.
   subroutine take_parameters(fields, report, cards, card)
      type(field_type), intent(in) :: fields(:)
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(inout) :: card
      type(parameter_type), allocatable :: found(:)
      type(parameter_type) :: parameter
      integer :: errors, i, k, n
      logical :: valid

      allocate(found(size(fields)))
      n = 0
      i = 1
      do while (i <= size(fields))
         if (is_number(fields(i)%text)) then
            call report_number(fields, i, report)
            card%flawed = .true.
            exit
         end if
         errors = report%error_count()
         call take_parameter(fields(i), report, cards, card, parameter, valid)
         if (card%name == 'OPTIONS' .and. parameter%name == 'LOAD' .and. i < size(fields)) then
            i = i + 1
            parameter%text = parameter%text//','//fields(i)%text
         end if
         i = i + 1
         if (.not. valid) cycle
         if (any([(found(k)%name == parameter%name, k=1, n)])) then
            if (report%error_count() == errors) call report%error(parameter%place, &
               parameter%name//' appears twice on this card')
            cycle
         end if
         n = n + 1
         found(n) = parameter
      end do
      card%parameters = found(:n)
   end subroutine take_parameters

   !> Reports a number among the parameters: decimals of a value, or data on the keyword card.
   subroutine report_number(fields, i, report)
      type(field_type), intent(in) :: fields(:)
      integer, intent(in) :: i
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: before, list
      integer :: k

      before = ''
      if (i > 1) before = fields(i - 1)%text
      if (is_whole(trim(adjustl(before(index(before, '=') + 1:)))) .and. is_whole( &
         fields(i)%text) .and. verify(fields(i)%text, '0123456789') == 0) then
         call report%root_cause(fields(i - 1)%place, 'a '//decimal_comma_words(before, &
            fields(i)%text))
         return
      end if
      list = fields(i)%text
      do k = i + 1, size(fields)
         list = list//', '//fields(k)%text
      end do
      call report%root_cause(fields(i)%place, 'a number is not a parameter; put data on a card '// &
         'of their own: write '//list//' below the keyword')
   end subroutine report_number

   !> Takes one parameter by the table; a misspelt one is taken as the one that it likely is.
   subroutine take_parameter(field, report, cards, card, parameter, valid)
      type(field_type), intent(in) :: field
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(inout) :: card
      type(parameter_type), intent(out) :: parameter
      logical, intent(out) :: valid
      type(known_parameter_type) :: known, other
      type(advice_type) :: advice
      character(:), allocatable :: fault, name, value
      type(place_type) :: place
      integer :: blank, equals, errors

      errors = report%error_count()
      place = field%place
      equals = index(field%text//'=', '=')
      name = field%text(:equals - 1)
      known = find_parameter(card%known, name)
      if (len(known%name) == 0) known = find_abbreviated(card%known, name)
      if (len(known%name) == 0 .and. len(field%text) > 0) call report_unknown_parameter(name, &
         place, report, cards, card, known)
      value = field%text(min(equals + 1, len(field%text) + 1):)
      parameter%name = known%name
      parameter%text = without_quotes(value(first_text(value):))
      parameter%place = place
      parameter%value_place = place
      if (len(value) > 0) parameter%value_place%column = place%column + equals + &
         first_text(value) - 1
      blank = scan(value(:index(value, '=')), ' ', back=.true.)
      other%name = ''
      if (blank > 0 .and. index(value, '"') == 0) other = find_parameter(card%known, &
         value(blank + 1:index(value, '=') - 1))
      fault = ''
      if (len(field%text) == 0 .and. .not. field%undefined) then
         fault = 'an empty parameter'
      else if (len(known%name) == 0) then
         continue
      else if (known%name == 'DEPENDENCIES' .and. parameter%text == '0') then
         known%status = not_needed
      else if (known%status == refused) then
         advice = find_advice(known%name, card%name)
         fault = known%name//' is refused on *'//card%name//': '//trim(advice%words)
      else if (known%needs_value .and. len(parameter%text) == 0) then
         fault = known%name//' needs a value'
      else if (.not. known%takes_value .and. equals <= len(field%text)) then
         fault = known%name//' takes no value'
      else if (len(other%name) > 0) then
         fault = 'a comma is missing before this parameter'
         place%column = place%column + equals + blank
      end if
      if (len(fault) > 0) call report%error(place, fault)
      valid = len(known%name) > 0 .and. len(fault) == 0 .and. known%status == built
      card%flawed = card%flawed .or. field%undefined .or. &
         (report%error_count() > errors .and. .not. valid)
      if (len(known%name) > 0 .and. known%status == not_needed .and. report%error_count() == &
         errors) call add_note(cards%notes, '*'//card%name//': '//known%name//' is ignored')
   end subroutine take_parameter

   !> Reports a parameter that the keyword does not have, and finds the one that it likely is. On
   !> all cards of the keyword it is one mistake; on cards of output it is none.
   subroutine report_unknown_parameter(name, place, report, cards, card, known)
      character(*), intent(in) :: name
      type(place_type), intent(in) :: place
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(in) :: card
      type(known_parameter_type), intent(inout) :: known
      type(string_type), allocatable :: names(:)
      type(known_parameter_type) :: other
      character(:), allocatable :: group, hint, list
      integer :: i

      group = 'parameter '//to_upper(trim(name))//' of *'//card%name
      names = parameter_names(card%known)
      list = ''
      do i = 1, size(names)
         other = find_parameter(card%known, names(i)%value)
         if (other%status == built) list = list//', '//other%name
      end do
      hint = 'it has none'
      if (len(list) > 0) hint = 'it takes '//list(3:)
      other = find_parameter(card%known, name(:index(name//' ', ' ') - 1))
      if (other%takes_value) hint = 'an equals sign is missing after '//other%name
      known%name = ''
      i = nearest_name(name, names)
      if (i > 0 .and. .not. other%takes_value) then
         if (is_slip(name, names(i)%value)) then
            known = find_parameter(card%known, names(i)%value)
            hint = 'the nearest known is '//known%name
         end if
      end if
      if (.not. is_output(card%name)) then
         call report%error(place, 'unknown '//group//'; '//hint, group)
      else if (len(known%name) > 0) then
         call report%warning(place, 'unknown '//group//'; '//known%name//' is taken', group)
      else
         call add_note(cards%notes, '*'//card%name//': '//to_upper(trim(name))//' is ignored')
      end if
   end subroutine report_unknown_parameter

   !> Position of the blank behind the known keyword with which a field begins that goes on with a
   !> parameter; 0 where it does not.
   pure integer function end_of_keyword(string)
      character(*), intent(in) :: string   !! with the star
      type(known_parameter_type) :: parameter
      integer :: known

      do end_of_keyword = len(string), 3, -1
         if (scan(string(end_of_keyword:end_of_keyword), blanks) == 0) cycle
         known = find_keyword(string(2:end_of_keyword - 1))
         if (known == 0) cycle
         parameter = find_parameter(known, adjustl(string(end_of_keyword + 1:)))
         if (len(parameter%name) > 0 .or. index(string, '=') > 0) return
      end do
      end_of_keyword = 0
   end function end_of_keyword

   !> Whether a data line is a keyword without its asterisk. A name that the deck uses may be that
   !> of a keyword, and a heading may begin with one.
   pure logical function lacks_star(line, title, cards)
      character(*), intent(in) :: line        !! card image
      logical, intent(in) :: title            !! whether it is part of the heading
      type(cards_type), intent(in) :: cards   !! the cards so far
      type(advice_type) :: advice
      type(known_parameter_type) :: parameter
      character(:), allocatable :: name, rest
      integer :: comma, known

      lacks_star = .false.
      if (verify(to_upper(line(first_text(line):first_text(line))), &
         'ABCDEFGHIJKLMNOPQRSTUVWXYZ') > 0) return
      name = line(first_text(line):index(line//',', ',') - 1)
      name = name(:last_text(name))
      if (title .and. index(line, '=') == 0) return
      known = find_keyword(name)
      comma = index(line//',', ',')
      lacks_star = .true.
      do while (comma < len(line) .and. lacks_star)   ! what is behind it are parameters
         rest = line(comma + 1:)
         rest = rest(:index(rest//',', ',') - 1)
         comma = comma + len(rest) + 1
         if (index(rest, '=') > 0 .or. verify(rest, blanks) == 0) cycle
         lacks_star = known > 0
         if (known == 0) return
         parameter = find_parameter(known, rest)
         lacks_star = len(parameter%name) > 0
      end do
      if (lacks_star) lacks_star = .not. is_defined(cards, name)
      if (known > 0 .or. .not. lacks_star) return
      advice = find_advice(name)   ! last, since this takes longest
      lacks_star = advice%kind /= no_advice
   end function lacks_star

   !> Whether a keyword card that is read defines or uses a name.
   pure logical function is_defined(cards, name)
      type(cards_type), intent(in) :: cards   !! the cards so far
      character(*), intent(in) :: name        !! the name, in any case
      integer :: i, k

      is_defined = .false.
      do k = 1, cards%keyword_count
         do i = 1, size(cards%keywords(k)%parameters)
            associate (string => cards%keywords(k)%parameters(i)%text)
               is_defined = is_defined .or. to_upper(string) == to_upper(name)
            end associate
         end do
      end do
   end function is_defined

   !> Reports the first field below a keyword in which a tab, a semicolon or a blank before a number
   !> stands for a comma. Names may have blanks.
   subroutine check_commas(cards, fields, report, valid)
      type(cards_type), intent(in) :: cards               !! the cards so far
      type(field_type), intent(in) :: fields(:)           !! fields of a line
      type(deck_report_type), intent(inout) :: report     !! receives the error
      logical, intent(out) :: valid                       !! false after it
      character(:), allocatable :: next
      integer :: blank, column, i

      valid = .true.
      do i = 1, size(fields)
         associate (string => fields(i)%text)
            blank = scan(string, blanks//signs)
            if (blank == 0 .or. index(string, '"') > 0) cycle
            if (is_defined(cards, string)) cycle
            if (scan(string, signs) == 0 .and. .not. (verify(string(blank:), numerals) == 0 .and. &
               (is_number(string(:blank - 1)) .or. is_defined(cards, string(:blank - 1))))) cycle
            column = blank - 1 + verify(string(blank:), blanks//signs)
            next = string(column:column - 2 + scan(string(column:)//' ', blanks//signs))
            call report%error(place_type(fields(i)%place%image, fields(i)%place%column + column - &
               1), 'a comma is missing between '''//string(:blank - 1)//''' and '''//next// &
               ''': only commas separate fields')
         end associate
         valid = .false.
         return
      end do
   end subroutine check_commas

   !> Whether a field is a number.
   pure logical function is_number(string)
      character(*), intent(in) :: string   !! without blanks around it
      real(dp) :: number

      call read_real(string, number, is_number)
   end function is_number

end module keyword_cards
