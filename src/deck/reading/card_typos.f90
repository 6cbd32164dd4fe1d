!> Typing errors in a card that hide how it is meant: a keyword without its asterisk, and commas
!> that are missing behind the keyword, between parameters or between fields. Each is reported where
!> it is.
module card_typos
   use card_fields, only: first_text, last_text
   use cards, only: cards_type, field_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use keywords, only: advice_type, find_advice, find_keyword, find_parameter, &
      known_parameter_type, no_advice
   use kinds, only: dp
   use text, only: read_real, to_upper
   implicit none
   private
   public :: lacks_star, end_of_keyword, check_commas, is_number

   character(*), parameter :: blanks = ' '//achar(9)    !! they separate words
   character(*), parameter :: numerals = ' 0123456789+-.eEdD'
   character(*), parameter :: signs = achar(9)//';'     !! no name and no number has them

contains

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

end module card_typos
