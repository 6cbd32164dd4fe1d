!> Values of the parameters of a keyword card, with an error at their place where they are not what
!> they should be.
module card_parameters
   use cards, only: keyword_card_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use spelling, only: known_choices
   use text, only: integer_fault, read_integer, read_real, real_fault, split_words, string_type, &
      to_text, to_upper, without_blanks
   implicit none
   private
   public :: surface_kinds
   public :: need_parameter, take_parameter, choose, chosen, need_choice, is_on, take_positive, &
      take_from

   !> TYPE= of *SURFACE.
   character(*), parameter :: surface_kinds = 'ELEMENT/NODE/SEGMENTS'

   !> Value of a parameter where the card has it; else it stays as it is.
   interface take_parameter
      module procedure take_integer_parameter
      module procedure take_real_parameter
   end interface take_parameter

contains

   !> Value of a parameter that the card must have.
   subroutine need_parameter(card, name, report, value)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                        !! name as in the table of keywords
      class(deck_report_type), intent(inout) :: report        !! receives the error
      character(:), allocatable, intent(out) :: value   !! value in upper case; empty after an error

      value = to_upper(card%text(name))
      if (card%lacks(name)) then
         call report%error(card%place, '*'//card%name//' needs '//name//'=')
      end if
   end subroutine need_parameter

   subroutine take_integer_parameter(card, name, report, value)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      class(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: value
      integer :: number
      logical :: valid

      if (.not. card%has(name)) return
      call read_integer(card%text(name), number, valid)
      if (valid) then
         value = number
      else
         call report%error(card%place_of(name), ''''//card%text(name)//''' '// &
            integer_fault(card%text(name))//'; expected: value of '//name//'=')
      end if
   end subroutine take_integer_parameter

   subroutine take_real_parameter(card, name, report, value)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      class(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: value
      real(dp) :: number
      logical :: valid

      if (.not. card%has(name)) return
      call read_real(card%text(name), number, valid)
      if (valid) then
         value = number
      else
         call report%error(card%place_of(name), ''''//card%text(name)//''' '// &
            real_fault(card%text(name))//'; expected: value of '//name//'=')
      end if
   end subroutine take_real_parameter

   !> Value of a parameter that must be positive; else, and after an error, it stays as it is.
   subroutine take_positive(card, name, report, value)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      class(deck_report_type), intent(inout) :: report         !! receives the error
      real(dp), intent(inout) :: value                         !! > 0
      real(dp) :: given

      given = value
      call take_parameter(card, name, report, given)
      if (given > 0.0_dp) then
         value = given
      else
         call report%error(card%place_of(name), name//'= must be positive')
      end if
   end subroutine take_positive

   !> Value of a parameter that must not be below the least one; else, and after an error, it stays
   !> as it is.
   subroutine take_from(least, card, name, report, value)
      integer, intent(in) :: least
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      class(deck_report_type), intent(inout) :: report         !! receives the error
      integer, intent(inout) :: value                          !! >= least
      integer :: given

      given = value
      call take_parameter(card, name, report, given)
      if (given >= least) then
         value = given
      else if (least == 0) then
         call report%error(card%place_of(name), name//'= must not be negative')
      else
         call report%error(card%place_of(name), name//'= must be at least '//to_text(least))
      end if
   end subroutine take_from

   !> The one of several words that the value of a parameter is, or begins as in Abaqus; empty where
   !> none of them does, or several do.
   pure function chosen(card, name, choices) result(word)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      character(*), intent(in) :: choices                      !! words, separated by slashes
      character(:), allocatable :: word                        !! as in choices
      type(string_type), allocatable :: words(:)
      character(:), allocatable :: short
      integer :: i

      word = ''
      short = to_upper(without_blanks(card%text(name)))
      if (len(short) == 0) return
      words = split_words(choices)
      do i = 1, size(words)
         word = words(i)%value
         if (without_blanks(word) == short) return
      end do
      word = ''
      do i = 1, size(words)
         if (index(without_blanks(words(i)%value), short) /= 1) cycle
         ! ISO is ISOTROPIC, which begins with it.
         if (len(word) > 0 .and. index(words(i)%value, word//'') /= 1) then
            word = ''
            return
         end if
         if (len(word) == 0) word = words(i)%value
      end do
   end function chosen

   !> Takes one of several words.
   subroutine choose(card, name, choices, report, choice)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      character(*), intent(in) :: choices                      !! words, separated by slashes
      class(deck_report_type), intent(inout) :: report         !! receives the error
      character(:), allocatable, intent(inout) :: choice   !! the word as in choices; else as it was
      character(:), allocatable :: wanted, word

      if (.not. card%has(name)) return
      word = chosen(card, name, choices)
      if (len(word) > 0) then
         choice = word
         return
      end if
      wanted = to_upper(without_blanks(card%text(name)))
      call report%error(card%place_of(name), 'unknown '//name//'='//wanted//' of *'//card%name// &
         known_choices(wanted, split_words(choices)))
   end subroutine choose

   !> Takes one of several words of a parameter that the card must have; empty after an error.
   subroutine need_choice(card, name, choices, report, choice)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      character(*), intent(in) :: choices                      !! words, separated by slashes
      class(deck_report_type), intent(inout) :: report         !! receives the error
      character(:), allocatable, intent(out) :: choice         !! the word as in choices

      call need_parameter(card, name, report, choice)
      choice = ''
      call choose(card, name, choices, report, choice)
   end subroutine need_choice

   !> Whether a card has a parameter that needs no value, or YES; not after an error.
   logical function is_on(card, name, report)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      class(deck_report_type), intent(inout) :: report         !! receives the error
      character(:), allocatable :: choice

      choice = 'NO'
      if (card%has(name)) choice = 'YES'
      if (len(card%text(name)) > 0) call choose(card, name, 'YES/NO', report, choice)
      is_on = choice == 'YES'
   end function is_on

end module card_parameters
