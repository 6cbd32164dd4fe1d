!> Slips in a keyword card that do not hide what it means: a comma that is missing behind the
!> keyword or between two parameters, an equals sign, the asterisk. Each is reported where it is,
!> and mended.
module keyword_slips
   use card_fields, only: first_text, last_text
   use cards, only: cards_type, field_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use field_separators, only: is_defined
   use keywords, only: advice_type, find_advice, find_keyword, find_parameter, &
      known_parameter_type, no_advice
   use text, only: to_upper
   implicit none
   private
   public :: lacks_star, mend_commas

   character(*), parameter :: blanks = ' '//achar(9)   !! what separates words

contains

   !> Puts in the commas that are missing on a keyword card: behind a keyword that is known, and
   !> before a parameter of it that is in the value of another one.
   subroutine mend_commas(fields, report)
      type(field_type), allocatable, intent(inout) :: fields(:)   !! the first with the star
      type(deck_report_type), intent(inout) :: report             !! receives errors
      integer :: i, cut, known

      cut = end_of_keyword(fields(1)%text)
      if (cut > 0) then
         call report%error(second_place(fields(1), cut), 'a comma is missing after '// &
            to_upper(fields(1)%text(:cut - 1)))
         call split_field(1, cut, fields)
      end if
      known = find_keyword(fields(1)%text(2:))
      if (known == 0) return
      i = 2
      do while (i <= size(fields))
         call mend_equals(known, fields(i), report)
         cut = start_of_parameter(known, fields(i)%text)
         if (cut > 0) then
            call report%error(second_place(fields(i), cut), 'a comma is missing before this '// &
               'parameter')
            call split_field(i, cut, fields)
         end if
         i = i + 1
      end do
   end subroutine mend_commas

   !> Puts in the equals sign that is missing between a parameter and its value.
   subroutine mend_equals(known, field, report)
      integer, intent(in) :: known
      type(field_type), intent(inout) :: field
      type(deck_report_type), intent(inout) :: report
      type(known_parameter_type) :: parameter
      integer :: blank

      blank = scan(field%text, blanks)
      if (blank == 0 .or. index(field%text, '=') > 0) return
      parameter = find_parameter(known, field%text)
      if (len(parameter%name) > 0) return
      parameter = find_parameter(known, field%text(:blank - 1))
      if (len(parameter%name) == 0 .or. .not. parameter%takes_value) return
      call report%error(place_type(field%place%image, field%place%column + blank - 1), &
         'an equals sign is missing after '//parameter%name)
      field%text(blank:blank) = '='
   end subroutine mend_equals

   !> Position of the blank that ends a known keyword before a parameter of it; 0 where there is
   !> none.
   pure integer function end_of_keyword(string)
      character(*), intent(in) :: string
      type(known_parameter_type) :: parameter
      character(:), allocatable :: rest
      integer :: i, known

      end_of_keyword = 0
      if (find_keyword(string(2:)) > 0) return
      do i = len(string), 2, -1
         if (scan(string(i:i), blanks) == 0) cycle
         known = find_keyword(string(2:i - 1))
         if (known == 0) cycle
         rest = string(i + verify(string(i:), blanks) - 1:)
         parameter = find_parameter(known, rest(:index(rest//'=', '=') - 1))
         if (len(parameter%name) == 0 .and. index(rest, '=') == 0) cycle
         end_of_keyword = i
         return
      end do
   end function end_of_keyword

   !> Position of the blank before a parameter that is in the value of another; 0 where there is
   !> none. A value in quotes is left alone.
   pure integer function start_of_parameter(known, string)
      integer, intent(in) :: known
      character(*), intent(in) :: string
      type(known_parameter_type) :: parameter
      integer :: equals, first, i

      start_of_parameter = 0
      if (index(string, '"') > 0) return
      first = index(string, '=')
      equals = index(string(first + 1:), '=') + first
      if (equals == first) return
      do i = equals - 1, first + 2, -1
         if (scan(string(i:i), blanks) == 0) cycle
         parameter = find_parameter(known, string(i + 1:equals - 1))
         if (len(parameter%name) == 0) cycle
         start_of_parameter = i
         return
      end do
   end function start_of_parameter

   !> Where the second part of a field begins that is cut at a blank.
   pure type(place_type) function second_place(field, cut)
      type(field_type), intent(in) :: field
      integer, intent(in) :: cut

      second_place = place_type(field%place%image, field%place%column + cut - 2 + &
         verify(field%text(cut:), blanks))
   end function second_place

   !> Cuts a field in two at a blank.
   subroutine split_field(i, cut, fields)
      integer, intent(in) :: i, cut
      type(field_type), allocatable, intent(inout) :: fields(:)
      type(field_type), allocatable :: more(:)
      integer :: k

      allocate(more(size(fields) + 1))
      do k = 1, i
         more(k) = fields(k)
      end do
      do k = i + 1, size(fields)
         more(k + 1) = fields(k)
      end do
      more(i)%text = trim(fields(i)%text(:cut - 1))
      more(i + 1)%place = second_place(fields(i), cut)
      more(i + 1)%text = fields(i)%text(more(i + 1)%place%column - fields(i)%place%column + 1:)
      call move_alloc(more, fields)
   end subroutine split_field

   !> Whether a data line is a keyword without its asterisk. A name that the deck uses may be that
   !> of a keyword, and a heading may begin with one.
   pure logical function lacks_star(line, title, cards)
      character(*), intent(in) :: line        !! card image
      logical, intent(in) :: title            !! whether it is part of the heading
      type(cards_type), intent(in) :: cards   !! the cards so far
      type(advice_type) :: advice
      character(:), allocatable :: name

      lacks_star = .false.
      if (verify(to_upper(line(first_text(line):first_text(line))), &
         'ABCDEFGHIJKLMNOPQRSTUVWXYZ') > 0) return
      name = line(first_text(line):index(line//',', ',') - 1)
      name = name(:last_text(name))
      advice = find_advice(name)
      if (find_keyword(name) == 0 .and. advice%kind == no_advice) return
      if (title .and. index(line, '=') == 0) return
      lacks_star = names_keyword(line)
      if (lacks_star) lacks_star = .not. is_defined(cards, name)
   end function lacks_star

   !> Whether a line is a keyword, without its asterisk, and parameters of it.
   pure logical function names_keyword(line)
      character(*), intent(in) :: line
      type(known_parameter_type) :: parameter
      character(:), allocatable :: rest
      integer :: comma, known

      comma = index(line//',', ',')
      known = find_keyword(line(:comma - 1))
      names_keyword = .true.
      do while (comma < len(line) .and. names_keyword)
         rest = line(comma + 1:)
         rest = rest(:index(rest//',', ',') - 1)
         comma = comma + len(rest) + 1
         if (index(rest, '=') > 0 .or. verify(rest, blanks) == 0) cycle
         names_keyword = known > 0
         if (known == 0) return
         parameter = find_parameter(known, rest)
         names_keyword = len(parameter%name) > 0
      end do
   end function names_keyword

end module keyword_slips
