!> Messages that tell one mistake again and again: on lines of one card, alike but for numbers.
module alike_messages
   use text, only: string_type
   implicit none
   private
   public :: first_alike

   integer, parameter :: most_kinds = 16   !! kinds of a card that are looked for again

contains

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

end module alike_messages
