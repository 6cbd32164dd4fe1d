!> Fields of a data card that blanks, tabs or semicolons separate in place of commas.
module field_separators
   use cards, only: cards_type, field_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use kinds, only: dp
   use text, only: read_real, to_text, to_upper
   implicit none
   private
   public :: cut_at_blanks, is_defined

   character(*), parameter :: signs = achar(9)//';'     !! what no name and no number has
   character(*), parameter :: blanks = ' '//signs       !! what separates words

contains

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
      if (scan(string, blanks) == 0 .or. index(string, '"') > 0) return
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

   pure logical function is_number(string)
      character(*), intent(in) :: string
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
         last = first + scan(field%text(first:)//' ', blanks) - 2
         if (last >= first) then
            n = n + 1
            buffer(n)%text = field%text(first:last)
            buffer(n)%place = place_type(field%place%image, field%place%column + first - 1)
         end if
         first = last + 2
      end do
      words = buffer(:n)
   end function words_of

end module field_separators
