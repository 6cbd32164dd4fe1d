!> Values of the parameters of a keyword card, with an error at their place where they are not what
!> they should be.
module card_parameters
   use cards, only: keyword_card_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use spelling, only: full_word, known_choices
   use text, only: integer_fault, read_integer, read_real, real_fault, split_words, to_text, &
      to_upper, without_blanks
   implicit none
   private
   public :: surface_kinds
   public :: need_parameter, take_parameter, choice, chosen, needed_choice, is_on, take_within, &
      take_from, limit_fault

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

   !> Value of a parameter within a limit; else, and after an error, it stays as it is.
   subroutine take_within(limit, card, name, report, value)
      character(*), intent(in) :: limit                        !! as limit_fault has it
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      class(deck_report_type), intent(inout) :: report         !! receives the error
      real(dp), intent(inout) :: value
      real(dp) :: given
      character(:), allocatable :: fault
      integer :: errors

      given = value
      errors = report%error_count()
      call take_parameter(card, name, report, given)
      if (report%error_count() > errors) return
      fault = limit_fault(given, limit)
      if (len(fault) == 0) then
         value = given
      else if (card%has(name)) then
         call report%error(card%place_of(name), name//'= '//fault)
      end if
   end subroutine take_within

   !> What is wrong with a number outside of a limit; empty within it.
   pure function limit_fault(value, limit) result(fault)
      real(dp), intent(in) :: value
      character(*), intent(in) :: limit            !! >0, >=0, >0 <=1, >=0 <=1 or empty
      character(:), allocatable :: fault           !! such as 'must be positive'
      logical :: above, below

      fault = ''
      above = value >= 0.0_dp
      if (index(limit, '>0') > 0) above = value > 0.0_dp
      below = value <= 1.0_dp .or. index(limit, '<=1') == 0
      if ((above .and. below) .or. len(limit) == 0) return
      select case (limit)
      case ('>0')
         fault = 'must be positive'
      case ('>=0')
         fault = 'must not be negative'
      case ('>0 <=1')
         fault = 'must be above 0 and at most 1'
      case default
         fault = 'must be between 0 and 1'
      end select
   end function limit_fault

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

      word = full_word(to_upper(card%text(name)), split_words(choices))
   end function chosen

   !> The one of several words that the value of a parameter is; the default where the card does not
   !> have it, and after an error.
   function choice(card, name, choices, report, default) result(word)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      character(*), intent(in) :: choices                      !! words, separated by slashes
      class(deck_report_type), intent(inout) :: report         !! receives the error
      character(*), intent(in) :: default
      character(:), allocatable :: word                        !! as in choices
      character(:), allocatable :: wanted

      word = default
      if (.not. card%has(name)) return
      word = chosen(card, name, choices)
      if (len(word) > 0) return
      word = default
      wanted = to_upper(without_blanks(card%text(name)))
      call report%error(card%place_of(name), 'unknown '//name//'='//wanted//' of *'//card%name// &
         known_choices(wanted, split_words(choices)))
   end function choice

   !> The one of several words that a parameter is which the card must have; empty after an error.
   function needed_choice(card, name, choices, report) result(word)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      character(*), intent(in) :: choices                      !! words, separated by slashes
      class(deck_report_type), intent(inout) :: report         !! receives the error
      character(:), allocatable :: word                        !! as in choices

      call need_parameter(card, name, report, word)
      word = choice(card, name, choices, report, '')
   end function needed_choice

   !> Whether a card has a parameter that needs no value, or YES; not after an error.
   logical function is_on(card, name, report)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                         !! parameter
      class(deck_report_type), intent(inout) :: report         !! receives the error

      is_on = card%has(name)
      if (len(card%text(name)) > 0) is_on = choice(card, name, 'YES/NO', report, 'NO') == 'YES'
   end function is_on

end module card_parameters
