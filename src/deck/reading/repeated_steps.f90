!> *CYCLE -> the steps before it, as often again as it says.
module repeated_steps
   use cards, only: cards_type, keyword_card_type
   use deck_report, only: deck_report_type
   use text, only: counted, read_integer, to_text
   implicit none
   private
   public :: repeat_steps

   integer, parameter :: most_repeats = 100000

   !> Cards of a step that are there once: what they define or ask for holds for all cycles.
   character(*), parameter :: not_repeated(7) = [character(11) :: 'VERIFY', 'AMPLITUDE', 'NSET', &
      'ELSET', 'TIME POINTS', 'RESTART', 'NO ANALYSIS']

contains

   !> Inserts the steps that each *CYCLE repeats behind it.
   subroutine repeat_steps(cards, report)
      type(cards_type), intent(inout) :: cards
      type(deck_report_type), intent(inout) :: report
      type(keyword_card_type), allocatable :: longer(:), repeated(:)
      integer :: first, i, k, repeats, steps

      k = 1
      do while (k <= size(cards%keywords))
         if (cards%keywords(k)%name == 'CYCLE') then
            associate (card => cards%keywords(k))
               steps = number_of(card, 'STEPS')
               repeats = number_of(card, 'REPEAT')
               first = first_card(cards, k, steps)
               if (first == 0) call report%error(card%place_of('STEPS'), '*CYCLE stands behind '// &
                  'the *END STEP of the last of '//counted(steps, 'step')// &
                  ', none of which is in a *CYCLE before')
               if (repeats > most_repeats) call report%error(card%place_of('REPEAT'), &
                  'REPEAT is at most '//to_text(most_repeats))
            end associate
            if (first == 0 .or. repeats > most_repeats) return
            repeated = pack(cards%keywords(first:k - 1), [(is_repeated(cards%keywords(i)%name), &
               i=first, k - 1)])
            associate (n => size(repeated), all => size(cards%keywords))
               allocate (longer(all + repeats*n))
               longer(:k) = cards%keywords(:k)
               do i = 1, repeats
                  longer(k + 1 + (i - 1)*n:k + i*n) = repeated
               end do
               longer(k + repeats*n + 1:) = cards%keywords(k + 1:)
            end associate
            call move_alloc(longer, cards%keywords)
            k = k + repeats*size(repeated)
         end if
         k = k + 1
      end do
   end subroutine repeat_steps

   !> The card that begins the first of some steps before a card, or 0.
   integer function first_card(cards, k, steps)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: k, steps
      integer :: found
      logical :: is_closed

      found = 0
      is_closed = .false.
      do first_card = k - 1, 1, -1
         select case (cards%keywords(first_card)%name)
         case ('CYCLE')
            exit
         case ('END STEP')
            is_closed = .true.
         case ('STEP')
            if (.not. is_closed) exit
            found = found + 1
            if (found == steps) return
         case default
            cycle
         end select
      end do
      first_card = 0
   end function first_card

   !> A parameter, 1 where it is not given or wrong, which the builder reports.
   pure integer function number_of(card, name) result(number)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      logical :: is_number

      call read_integer(card%text(name), number, is_number)
      if (.not. is_number .or. number < 1) number = 1
   end function number_of

   pure logical function is_repeated(name)
      character(*), intent(in) :: name

      is_repeated = all(not_repeated /= name)
   end function is_repeated

end module repeated_steps
