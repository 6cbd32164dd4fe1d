!> Fields of a keyword card -> the card with its parameters, each of them known.
module keyword_cards
   use card_fields, only: first_text, without_quotes
   use cards, only: add_note, cards_type, field_type, keyword_card_type, parameter_type
   use decimal_commas, only: decimal_comma_words
   use deck_report, only: deck_report_type
   use foreign_keywords, only: find_foreign, foreign_keyword_type, not_printed, &
      passed_over, refused_always, refused_with_data
   use kinds, only: dp
   use keywords, only: built, find_keyword, find_parameter, known_keywords, known_parameter_type, &
      not_needed, parameter_names, refusal, refused
   use text, only: is_whole, read_real, string_type, to_upper
   use unknown_keywords, only: report_unknown_keyword, report_unknown_parameter
   implicit none
   private
   public :: make_keyword_card, is_parameter

contains

   !> Makes a keyword card of its fields, and reports what is unknown or refused. A misspelt keyword
   !> is taken as the one that it likely is.
   subroutine make_keyword_card(fields, report, cards, card)
      type(field_type), intent(in) :: fields(:)         !! fields, the first with the star
      type(deck_report_type), intent(inout) :: report   !! receives errors
      type(cards_type), intent(inout) :: cards          !! receives notes on what is not needed
      type(keyword_card_type), intent(out) :: card      !! the card, without data
      character(:), allocatable :: name

      name = without_star(fields(1)%text)
      card%name = ''
      card%meant = ''
      card%place = fields(1)%place
      card%known = find_keyword(name)
      allocate(card%parameters(0))
      if (card%known == 0) call take_foreign_keyword(name, index(fields(1)%text, '* ') == 1, &
         report, cards, card)
      if (card%known == 0) then
         call lose_names(fields(2:), report)
         return
      end if
      card%name = trim(known_keywords(card%known)%name)
      select case (known_keywords(card%known)%status)
      case (refused)
         call report%error(card%place, '*'//card%name//' is refused: '//refusal(card%name, ''))
      case default
         call take_parameters(fields(2:), report, cards, card)
      end select
   end subroutine make_keyword_card

   !> What a card that is not taken names may be missing elsewhere.
   subroutine lose_names(fields, report)
      type(field_type), intent(in) :: fields(:)
      type(deck_report_type), intent(inout) :: report
      integer :: i

      do i = 1, size(fields)
         associate (string => fields(i)%text)
            if (index(string, '=') > 0) call report%lose(to_upper(without_quotes( &
               trim(adjustl(string(index(string, '=') + 1:))))))
         end associate
      end do
   end subroutine lose_names

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
   subroutine take_foreign_keyword(name, is_text, report, cards, card)
      character(*), intent(in) :: name
      logical, intent(in) :: is_text   ! whether a blank follows the star
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(inout) :: card
      type(foreign_keyword_type) :: foreign

      foreign = find_foreign(name)
      select case (foreign%status)
      case (passed_over)
         call add_note(cards%notes, '*'//trim(foreign%name)//' is ignored: '// &
            trim(foreign%reason))
      case (not_printed)
         call report%warning(card%place, '*'//trim(foreign%name)//' is not printed; '// &
            trim(foreign%reason))
      case (refused_always)
         card%meant = trim(foreign%stands_for)
         call report%error(card%place, refused_foreign(foreign))
      case (refused_with_data)
         card%refusal_of_data = refused_foreign(foreign)
         call add_note(cards%notes, '*'//trim(foreign%name)//' without data is ignored')
      case default
         call report_unknown_keyword(name, is_text, report, card)
      end select
   end subroutine take_foreign_keyword

   pure function refused_foreign(foreign) result(message)
      type(foreign_keyword_type), intent(in) :: foreign
      character(:), allocatable :: message

      message = '*'//trim(foreign%name)//' is refused: '//trim(foreign%reason)
   end function refused_foreign

   !> Blanks inside a keyword count once.
   pure function without_star(string) result(name)
      character(*), intent(in) :: string
      character(:), allocatable :: name
      integer :: double

      name = trim(adjustl(string(2:)))
      double = index(name, '  ')
      do while (double > 0)
         name = name(:double)//name(double + 2:)
         double = index(name, '  ')
      end do
   end function without_star

   !> Takes the parameters; LOAD= of *OPTIONS takes the field behind it as well.
   subroutine take_parameters(fields, report, cards, card)
      type(field_type), intent(in) :: fields(:)
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(inout) :: card
      type(parameter_type), allocatable :: found(:)
      type(parameter_type) :: parameter
      integer :: i, n, errors
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
         if (is_repeated(found(:n), parameter%name)) then
            if (report%error_count() == errors) call report%error(parameter%place, &
               parameter%name//' appears twice on this card')
            cycle
         end if
         n = n + 1
         found(n) = parameter
      end do
      deallocate(card%parameters)
      allocate(card%parameters(n))
      do i = 1, n
         card%parameters(i) = found(i)
      end do
   end subroutine take_parameters

   !> Reports a number among the parameters: the decimals of a value, or the first of data that
   !> are on the keyword card.
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
         call report%explain(fields(i - 1)%place, 'a '//decimal_comma_words(before, &
            fields(i)%text))
         return
      end if
      list = fields(i)%text
      do k = i + 1, size(fields)
         list = list//', '//fields(k)%text
      end do
      call report%explain(fields(i)%place, 'a number is not a parameter; put data on a card of '// &
         'their own: write '//list//' below the keyword')
   end subroutine report_number

   pure logical function is_number(string)
      character(*), intent(in) :: string
      real(dp) :: number

      call read_real(string, number, is_number)
   end function is_number

   pure logical function is_repeated(found, name)
      type(parameter_type), intent(in) :: found(:)
      character(*), intent(in) :: name
      integer :: i

      is_repeated = .false.
      do i = 1, size(found)
         if (found(i)%name == name) is_repeated = .true.
      end do
   end function is_repeated

   !> Takes one parameter and checks it against the table. A misspelt one is taken as the one that
   !> it likely is.
   subroutine take_parameter(field, report, cards, card, parameter, valid)
      type(field_type), intent(in) :: field
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: cards
      type(keyword_card_type), intent(inout) :: card
      type(parameter_type), intent(out) :: parameter
      logical, intent(out) :: valid
      type(known_parameter_type) :: known
      integer :: equals, errors

      errors = report%error_count()
      equals = index(field%text, '=')
      if (equals == 0) equals = len(field%text) + 1
      known = find_parameter(card%known, field%text(:equals - 1))
      if (len(known%name) == 0 .and. len(field%text) > 0) call report_unknown_parameter( &
         field%text(:equals - 1), field%place, report, card, known)
      parameter%name = known%name
      parameter%place = field%place
      parameter%value_place = field%place
      call take_value(field%text(min(equals + 1, len(field%text) + 1):), equals, parameter)
      if (len(field%text) == 0 .and. .not. field%undefined) then
         call report%error(field%place, 'an empty parameter')
      else if (len(known%name) == 0) then
         continue
      else if (known%status == refused) then
         call report%error(field%place, known%name//' is refused on *'//card%name//': '// &
            refusal(card%name, known%name))
      else if (known%needs_value .and. len(parameter%text) == 0) then
         call report%error(field%place, known%name//' needs a value')
      else if (.not. known%takes_value .and. equals <= len(field%text)) then
         call report%error(field%place, known%name//' takes no value')
      end if
      valid = len(known%name) > 0 .and. known%status == built
      if (valid) valid = len(parameter%text) > 0 .or. .not. known%needs_value
      if (valid .and. .not. known%takes_value) valid = equals > len(field%text)
      card%flawed = card%flawed .or. field%undefined .or. &
         (report%error_count() > errors .and. .not. valid)
      if (len(known%name) > 0 .and. known%status == not_needed .and. &
         report%error_count() == errors) call add_note(cards%notes, '*'//card%name//': '// &
         known%name//' is ignored')
   end subroutine take_parameter

   !> The value behind the equals sign.
   pure subroutine take_value(string, equals, parameter)
      character(*), intent(in) :: string
      integer, intent(in) :: equals
      type(parameter_type), intent(inout) :: parameter

      parameter%text = without_quotes(string(first_text(string):))
      if (len(string) == 0) return
      parameter%value_place%column = parameter%place%column + equals + first_text(string) - 1
   end subroutine take_value

end module keyword_cards
