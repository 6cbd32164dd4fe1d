!> Messages as they are printed: the card with a caret under the place that is meant, and what
!> messages have in common that tell one mistake again and again.
module card_echo
   use messages, only: print_line
   use utf8, only: character_count, first_byte, printable
   implicit none
   private
   public :: print_card, column_of, without_numbers

   integer, parameter :: longest_echo = 200     !! characters of a card that are printed
   integer, parameter :: echo_before = 100      !! of these, before the place that is meant
   character(*), parameter :: gap = '...'       !! where characters are left out

contains

   !> Prints a card, or the part of a long one about a byte, and below it a caret under this byte.
   !> Each tab is shown as one blank.
   subroutine print_card(unit, image, column)
      integer, intent(in) :: unit          !! open for formatted output
      character(*), intent(in) :: image    !! the card
      integer, intent(in) :: column        !! the byte, which may be the one behind the card
      character(:), allocatable :: before, behind
      integer :: room

      before = shown(image(:column - 1))
      behind = shown(image(column:))
      room = longest_echo
      if (character_count(before) + character_count(behind) > longest_echo) then
         if (character_count(before) > echo_before) before = gap//before(first_byte(before, &
            character_count(before) - echo_before + len(gap) + 1):)
         room = longest_echo - character_count(before)
         if (character_count(behind) > room) behind = behind(:first_byte(behind, &
            room - len(gap) + 1) - 1)//gap
      end if
      call print_line(unit, before//behind)
      call print_line(unit, repeat(' ', character_count(before))//'^')
   end subroutine print_card

   pure function shown(part) result(string)
      character(*), intent(in) :: part
      character(:), allocatable :: string
      character(len(part)) :: untabbed
      integer :: i

      untabbed = part
      do i = 1, len(part)
         if (part(i:i) == achar(9)) untabbed(i:i) = ' '
      end do
      string = printable(untabbed)
   end function shown

   !> Column of a byte, which may be behind the line: a character of several bytes is one column.
   pure integer function column_of(image, byte)
      character(*), intent(in) :: image
      integer, intent(in) :: byte

      column_of = character_count(image(:min(byte - 1, len(image)))) + 1 + &
         max(0, byte - 1 - len(image))
   end function column_of

   !> A message with one mark for each run of digits.
   pure function without_numbers(message) result(kind)
      character(*), intent(in) :: message   !! any
      character(:), allocatable :: kind
      character(*), parameter :: digits = '0123456789'
      character(len(message)) :: buffer
      integer :: i, n
      logical :: is_digit, was_digit

      n = 0
      was_digit = .false.
      do i = 1, len(message)
         is_digit = index(digits, message(i:i)) > 0
         if (.not. (is_digit .and. was_digit)) then
            n = n + 1
            buffer(n:n) = message(i:i)
            if (is_digit) buffer(n:n) = '0'
         end if
         was_digit = is_digit
      end do
      kind = buffer(:n)
   end function without_numbers

end module card_echo
