!> Characters that look like those of the dialect and are not: what word processors make of quotes,
!> blanks and minus signs.
module look_alikes
   implicit none
   private
   public :: find_look_alike

   !> One of these characters.
   type :: look_alike_type
      character(3) :: bytes       !! its bytes in UTF-8, blank behind the last
      character(6) :: code        !! its number in Unicode
      character(26) :: name       !! its name there
      character(14) :: plain      !! what to type
   end type look_alike_type

   character(*), parameter :: quote = 'a plain "', single = 'a plain '' or "'
   character(*), parameter :: minus = 'a plain -', blank = 'a blank'
   character, parameter :: c2 = char(194), e2 = char(226), x80 = char(128)

   type(look_alike_type), parameter :: known(17) = [ &
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

   !> Finds the first of these characters in a text.
   pure subroutine find_look_alike(string, position, words)
      character(*), intent(in) :: string                   !! UTF-8
      integer, intent(out) :: position                     !! of its first byte; 0 where none is
      character(:), allocatable, intent(out) :: words      !! what it is and what to type
      integer :: i, k

      words = ''
      do position = 1, len(string)
         if (iachar(string(position:position)) < 128) cycle
         do i = 1, size(known)
            k = len_trim(known(i)%bytes)
            if (index(string(position:), known(i)%bytes(:k)) /= 1) cycle
            words = known(i)%code//' ('//trim(known(i)%name)//'); type '//trim(known(i)%plain)
            return
         end do
      end do
      position = 0
   end subroutine find_look_alike

end module look_alikes
