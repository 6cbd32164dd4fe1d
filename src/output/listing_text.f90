!> Text of the listing: titles, wrapped lines, the echo of the deck.
module listing_text
   use text, only: string_type
   implicit none
   private
   public :: page_width, print_title, print_wrapped, print_list, print_deck

   integer, parameter :: page_width = 132   !! columns of the line printer

contains

   !> Prints a title, underlined.
   subroutine print_title(unit, title)
      integer, intent(in) :: unit         !! unit of the listing
      character(*), intent(in) :: title   !! the title

      write (unit, '(/, a, /, a)') title, repeat('-', len(title))
   end subroutine print_title

   !> Prints text under a mark, broken at blanks.
   subroutine print_wrapped(unit, mark, string)
      integer, intent(in) :: unit          !! unit of the listing
      character(*), intent(in) :: mark     !! what stands before the first line
      character(*), intent(in) :: string   !! the text
      integer :: first, last, room

      room = page_width - len(mark)
      first = 1
      do
         last = len_trim(string)
         if (last - first + 1 > room) then
            last = first - 1 + index(string(first:first + room), ' ', back=.true.)
            if (last < first) last = first + room - 1
         end if
         if (first == 1) then
            write (unit, '(2a)') mark, trim(string(first:last))
         else
            write (unit, '(2a)') repeat(' ', len(mark)), trim(string(first:last))
         end if
         first = last + 1
         if (first > len_trim(string)) exit
      end do
   end subroutine print_wrapped

   !> Prints a list of texts under a title; nothing for an empty list.
   subroutine print_list(unit, title, list)
      integer, intent(in) :: unit                            !! unit of the listing
      character(*), intent(in) :: title                      !! the title
      type(string_type), allocatable, intent(in) :: list(:)  !! the texts, or unallocated
      integer :: i

      if (.not. allocated(list)) return
      if (size(list) == 0) return
      call print_title(unit, title)
      do i = 1, size(list)
         call print_wrapped(unit, '   - ', list(i)%value)
      end do
   end subroutine print_list

   !> Prints the card images with their numbers; a card that is wider than the page goes on below.
   subroutine print_deck(unit, cards)
      integer, intent(in) :: unit                   !! unit of the listing
      type(string_type), intent(in) :: cards(:)     !! card images as read
      integer, parameter :: room = page_width - 10
      integer :: i, first

      call print_title(unit, 'DECK')
      do i = 1, size(cards)
         associate (card => cards(i)%value)
            write (unit, '(i8, 2x, a)') i, card(:min(len(card), room))
            do first = room + 1, len(card), room
               write (unit, '(10x, a)') card(first:min(len(card), first + room - 1))
            end do
         end associate
      end do
   end subroutine print_deck

end module listing_text
