!> Slips in a card that do not hide its meaning: a comma that is missing behind the keyword, between
!> two parameters or between fields, where blanks, tabs or semicolons separate them; an equals sign,
!> the asterisk. Each is reported where it is, and mended.
module card_slips
   use card_fields, only: first_text, last_text
   use cards, only: cards_type, field_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use keywords, only: advice_type, find_advice, find_keyword, find_parameter, &
      known_parameter_type, no_advice
   use kinds, only: dp
   use text, only: read_real, to_text, to_upper
   implicit none
   private
   public :: lacks_star, mend_commas, cut_at_blanks, is_number

   character(*), parameter :: blanks = ' '//achar(9)    !! they separate words
   character(*), parameter :: signs = achar(9)//';'     !! no name and no number has them

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
      type(advice_type) :: advice
      character(:), allocatable :: rest
      integer :: i, known

      end_of_keyword = 0
      advice = find_advice(string(2:))
      if (find_keyword(string(2:)) > 0 .or. advice%kind /= no_advice) return
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
      type(field_type) :: first, second

      first%place = fields(i)%place
      first%text = trim(fields(i)%text(:cut - 1))
      second%place = second_place(fields(i), cut)
      second%text = fields(i)%text(second%place%column - first%place%column + 1:)
      fields = [fields(:i - 1), first, second, fields(i + 1:)]
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

   !> Cuts the fields of a data line where something else stands for a comma, and reports it once a
   !> keyword card.
   subroutine cut_at_blanks(cards, report, fields)
      type(cards_type), intent(in) :: cards                       !! the cards so far
      type(deck_report_type), intent(inout) :: report             !! receives the error
      type(field_type), allocatable, intent(inout) :: fields(:)   !! fields of the line
      type(field_type), allocatable :: all(:), words(:)
      integer :: i, k, n
      logical :: found

      found = .false.
      do i = 1, size(fields)
         found = found .or. lacks_comma(fields(i)%text, cards)
      end do
      if (.not. found) return
      allocate(all(sum([(len(fields(i)%text) + 1, i=1, size(fields))])))
      n = 0
      do i = 1, size(fields)
         if (lacks_comma(fields(i)%text, cards)) then
            words = words_of(fields(i))
            if (found) call report%error(words(2)%place, 'a comma is missing between '''// &
               words(1)%text//''' and '''//words(2)%text// &
               ''': only commas separate fields', 'commas of '//to_text(cards%keyword_count))
            found = .false.
         else
            words = fields(i:i)
         end if
         do k = 1, size(words)
            n = n + 1
            all(n) = words(k)
         end do
      end do
      fields = all(:n)
   end subroutine cut_at_blanks

   !> Whether a field is several: words with a tab or a semicolon between them, or with blanks where
   !> they are numbers, or a known name and numbers. Names may have blanks.
   pure logical function lacks_comma(string, cards)
      character(*), intent(in) :: string
      type(cards_type), intent(in) :: cards
      type(field_type), allocatable :: words(:)
      type(field_type) :: field
      integer :: i

      lacks_comma = .false.
      if (scan(string, blanks//signs) == 0 .or. index(string, '"') > 0) return
      if (is_defined(cards, string)) return
      field%text = string
      words = words_of(field)
      if (size(words) < 2) return
      lacks_comma = scan(string, signs) > 0
      if (lacks_comma) return
      lacks_comma = is_number(words(1)%text) .or. is_defined(cards, words(1)%text)
      do i = 2, size(words)
         lacks_comma = lacks_comma .and. (is_number(words(i)%text) .or. &
            is_label(words(i)%text) .or. is_defined(cards, words(i)%text))
      end do
   end function lacks_comma

   !> Whether a field is a number.
   pure logical function is_number(string)
      character(*), intent(in) :: string   !! without blanks around it
      real(dp) :: number

      call read_real(string, number, is_number)
   end function is_number

   !> Whether a word is the label of a face, such as S1.
   pure logical function is_label(string)
      character(*), intent(in) :: string

      is_label = .false.
      if (len(string) == 2) is_label = scan(to_upper(string(1:1)), 'FPS') == 1 .and. &
         scan(string(2:2), '1234') == 1
   end function is_label

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

   !> The words of a field, as fields.
   pure function words_of(field) result(words)
      type(field_type), intent(in) :: field
      type(field_type), allocatable :: words(:)
      integer :: first, last, n
      type(field_type) :: buffer(len(field%text))

      n = 0
      first = 1
      do while (first <= len(field%text))
         last = first + scan(field%text(first:)//' ', blanks//signs) - 2
         if (last >= first) then
            n = n + 1
            buffer(n)%text = field%text(first:last)
            buffer(n)%place = place_type(field%place%image, field%place%column + first - 1)
         end if
         first = last + 2
      end do
      words = buffer(:n)
   end function words_of

end module card_slips
