!> Misspellings: names that are likely meant where an unknown one is written, and characters
!> that word processors put in place of quotes, blanks and minus signs.
module spelling
   use text, only: listed, string_type, to_upper, without_blanks
   implicit none
   private
   public :: nearest_name, nearest_known, known_choices, edit_distance, full_word, is_slip, &
      find_look_alike

   integer, parameter :: most_listed = 16         !! choices that a message lists
   integer, parameter :: most_slips = 2           !! letters that differ in a misspelt name,
   integer, parameter :: letters_per_slip = 3     !! and letters for each of them

   !> A character that looks like one of the dialect.
   type :: look_alike_type
      character(3) :: bytes       !! its bytes in UTF-8, blank behind the last
      character(6) :: code        !! its number in Unicode
      character(26) :: name       !! its name there
      character(14) :: plain      !! what to type
   end type look_alike_type

   character(*), parameter :: quote = 'a plain "', single = 'a plain '' or "'
   character(*), parameter :: minus = 'a plain -', blank = 'a blank'
   character, parameter :: c2 = char(194), e2 = char(226), x80 = char(128)

   type(look_alike_type), parameter :: look_alikes(17) = [ &
      look_alike_type(e2//x80//char(152), 'U+2018', 'left single quote', single), &
      look_alike_type(e2//x80//char(153), 'U+2019', 'right single quote', single), &
      look_alike_type(e2//x80//char(154), 'U+201A', 'low single quote', single), &
      look_alike_type(e2//x80//char(156), 'U+201C', 'left double quote', quote), &
      look_alike_type(e2//x80//char(157), 'U+201D', 'right double quote', quote), &
      look_alike_type(e2//x80//char(158), 'U+201E', 'low double quote', quote), &
      look_alike_type(c2//char(171), 'U+00AB', 'left guillemet', quote), &
      look_alike_type(c2//char(187), 'U+00BB', 'right guillemet', quote), &
      look_alike_type(c2//char(160), 'U+00A0', 'no-break space', blank), &
      look_alike_type(e2//x80//char(137), 'U+2009', 'thin space', blank), &
      look_alike_type(e2//x80//char(175), 'U+202F', 'narrow no-break space', blank), &
      look_alike_type(e2//x80//char(139), 'U+200B', 'zero-width space', 'nothing'), &
      look_alike_type(e2//char(136)//char(146), 'U+2212', 'minus sign', minus), &
      look_alike_type(e2//x80//char(144), 'U+2010', 'hyphen', minus), &
      look_alike_type(e2//x80//char(145), 'U+2011', 'no-break hyphen', minus), &
      look_alike_type(e2//x80//char(147), 'U+2013', 'en dash', minus), &
      look_alike_type(e2//x80//char(148), 'U+2014', 'em dash', minus)]

contains

   !> Index of the name in a list that is nearest to a given one, whatever their cases; empty names
   !> do not count. 0 where there is none.
   pure function nearest_name(name, names) result(nearest)
      character(*), intent(in) :: name            !! what was written
      type(string_type), intent(in) :: names(:)   !! what is known
      integer :: nearest                          !! index of the first with the smallest distance
      integer :: i, distance, smallest

      nearest = 0
      smallest = huge(smallest)
      do i = 1, size(names)
         if (len(names(i)%value) == 0) cycle
         distance = edit_distance(to_upper(name), to_upper(names(i)%value))
         if (distance >= smallest) cycle
         smallest = distance
         nearest = i
      end do
   end function nearest_name

   !> The end of a message on an unknown name; empty where no known one is like it.
   pure function nearest_known(name, names) result(hint)
      character(*), intent(in) :: name             !! what was written
      type(string_type), intent(in) :: names(:)    !! what is known
      character(:), allocatable :: hint            !! such as "; the nearest known is TOP"

      integer :: nearest

      hint = ''
      nearest = nearest_name(name, names)
      if (nearest == 0) return
      if (is_slip(name, names(nearest)%value)) hint = '; the nearest known is '// &
         names(nearest)%value
   end function nearest_known

   !> The end of a message on a word that is none of a fixed list: the one it is like, or the list
   !> itself where that is short.
   pure function known_choices(name, names) result(hint)
      character(*), intent(in) :: name             !! what was written
      type(string_type), intent(in) :: names(:)    !! the list
      character(:), allocatable :: hint            !! such as "; known: MOD, NEW"

      hint = nearest_known(name, names)
      if (len(hint) > 0 .or. size(names) == 0 .or. size(names) > most_listed) return
      hint = '; known: '//listed(names, most_listed)
   end function known_choices

   !> The one of several words that a word is, or begins as in Abaqus, whatever the blanks; empty
   !> where none of them does, or several do.
   pure function full_word(short, words) result(word)
      character(*), intent(in) :: short            !! in upper case
      type(string_type), intent(in) :: words(:)
      character(:), allocatable :: word            !! as in words
      character(:), allocatable :: wanted
      integer :: i

      word = ''
      wanted = without_blanks(short)
      if (len(wanted) == 0) return
      do i = 1, size(words)
         word = words(i)%value
         if (without_blanks(word) == wanted) return
      end do
      word = ''
      do i = 1, size(words)
         if (index(without_blanks(words(i)%value), wanted) /= 1) cycle
         ! ISO is ISOTROPIC, which begins with it.
         if (len(word) > 0 .and. index(words(i)%value, word//'') /= 1) then
            word = ''
            return
         end if
         if (len(word) == 0) word = words(i)%value
      end do
   end function full_word

   !> Whether a name is likely a misspelling of another one, whatever their cases: in a short one
   !> fewer letters may differ.
   pure logical function is_slip(name, known)
      character(*), intent(in) :: name     !! what was written
      character(*), intent(in) :: known    !! what may be meant

      is_slip = len(known) > 0 .and. edit_distance(to_upper(name), to_upper(known)) <= &
         min(most_slips, max(len(name), len(known))/letters_per_slip)
   end function is_slip

   !> Number of letters to insert, delete, replace or swap with their neighbour that make one word
   !> of another: the restricted Damerau-Levenshtein distance.
   pure function edit_distance(a, b) result(distance)
      character(*), intent(in) :: a    !! one word
      character(*), intent(in) :: b    !! another
      integer :: distance              !! steps from one to the other
      integer :: row(0:len(b), 0:len(a))
      integer :: i, j, change

      row(:, 0) = [(j, j=0, len(b))]
      do i = 1, len(a)
         row(0, i) = i
         do j = 1, len(b)
            change = merge(0, 1, a(i:i) == b(j:j))
            row(j, i) = min(row(j, i - 1) + 1, row(j - 1, i) + 1, row(j - 1, i - 1) + change)
            if (i < 2 .or. j < 2) cycle
            if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) then
               row(j, i) = min(row(j, i), row(max(j - 2, 0), max(i - 2, 0)) + 1)
            end if
         end do
      end do
      distance = row(len(b), len(a))
   end function edit_distance

   !> Finds the first look-alike in a text.
   pure subroutine find_look_alike(string, position, words)
      character(*), intent(in) :: string                   !! UTF-8
      integer, intent(out) :: position                     !! of its first byte; 0 where none is
      character(:), allocatable, intent(out) :: words      !! what it is and what to type
      integer :: i, k

      words = ''
      do position = 1, len(string)
         if (iachar(string(position:position)) < 128) cycle
         do i = 1, size(look_alikes)
            k = len_trim(look_alikes(i)%bytes)
            if (index(string(position:), look_alikes(i)%bytes(:k)) /= 1) cycle
            words = look_alikes(i)%code//' ('//trim(look_alikes(i)%name)//'); type '// &
               trim(look_alikes(i)%plain)
            return
         end do
      end do
      position = 0
   end subroutine find_look_alike

end module spelling
