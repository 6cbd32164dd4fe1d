!> Messages as they are printed: the card with a caret under the place that is meant, and messages
!> that tell one mistake again and again, on lines of one card, alike but for numbers.
module card_echo
   use messages, only: print_line
   use text, only: string_type
   use utf8, only: character_count, first_byte, printable
   implicit none
   private
   public :: print_card, column_of, first_alike

   integer, parameter :: longest_echo = 200     !! characters of a card that are printed
   integer, parameter :: echo_before = 100      !! of these, before the place that is meant
   character(*), parameter :: gap = '...'       !! where characters are left out

   integer, parameter :: most_kinds = 16   !! kinds of a card that are looked for again

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

   !> Part of a card as it is printed.
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

   !> The first message of the same kind and card, which is its own index where there is none
   !> before. Of a card with many kinds only the last ones are compared.
   pure function first_alike(card, messages) result(first)
      integer, intent(in) :: card(:)              !! (messages) of each, in order; 0 for none
      type(string_type), intent(in) :: messages(:)
      integer :: first(size(card))
      type(string_type) :: kinds(most_kinds)
      character(:), allocatable :: kind
      integer :: index_of(most_kinds), i, k, found, last_card

      found = 0
      last_card = 0
      do i = 1, size(card)
         first(i) = i
         if (card(i) == 0) cycle
         if (card(i) /= last_card) found = 0
         last_card = card(i)
         kind = without_numbers(messages(i)%value)
         do k = 1, min(found, most_kinds)
            if (kinds(k)%value == kind) first(i) = index_of(k)
         end do
         if (first(i) < i) cycle
         k = modulo(found, most_kinds) + 1
         kinds(k)%value = kind
         index_of(k) = i
         found = found + 1
      end do
   end function first_alike

   !> A message with one mark for each run of digits.
   pure function without_numbers(message) result(kind)
      character(*), intent(in) :: message
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
