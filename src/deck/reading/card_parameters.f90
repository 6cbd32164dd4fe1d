!> Values of the parameters of a keyword card, with an error at their place where they are wrong.
module card_parameters
   use cards, only: keyword_card_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use spelling, only: full_word, known_choices
   use text, only: integer_fault, read_integer, read_real, real_fault, split_words, to_upper, &
      without_blanks
   implicit none
   private
   public :: surface_kinds
   public :: need_parameter, take_parameter, choice, chosen, needed_choice, is_on, read_number

   !> TYPE= of *SURFACE.
   character(*), parameter :: surface_kinds = 'ELEMENT/NODE/SEGMENTS'

   !> Value of a parameter within a limit, as read_number has it; it stays as it is where the card
   !> does not have it, and after an error.
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
      if (card%lacks(name)) call report%error(card%place, '*'//card%name//' needs '//name//'=')
   end subroutine need_parameter

   subroutine take_integer_parameter(card, name, report, value, limit)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      class(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: value
      character(*), intent(in), optional :: limit
      real(dp) :: number

      number = value
      call take_number(card, name, .true., report, number, limit)
      value = nint(number)
   end subroutine take_integer_parameter

   subroutine take_real_parameter(card, name, report, value, limit)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      class(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: value
      character(*), intent(in), optional :: limit

      call take_number(card, name, .false., report, value, limit)
   end subroutine take_real_parameter

   subroutine take_number(card, name, is_whole, report, value, limit)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      logical, intent(in) :: is_whole
      class(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: value
      character(*), intent(in), optional :: limit
      character(:), allocatable :: fault, range

      if (.not. card%has(name)) return
      range = ''
      if (present(limit)) range = limit
      call read_number(card%text(name), 'value of '//name//'=', is_whole, range, value, fault)
      if (allocated(fault)) call report%error(card%place_of(name), fault)
   end subroutine take_number

   !> Reads a number within a limit; after an error it stays as it is.
   subroutine read_number(string, what, is_whole, limit, value, fault)
      character(*), intent(in) :: string           !! as written
      character(*), intent(in) :: what             !! what it is, such as value of TOL=
      logical, intent(in) :: is_whole              !! whether it must be a whole number
      character(*), intent(in) :: limit            !! >0, >=0, >=n, >0 <=1, >=0 <=1 or empty
      real(dp), intent(inout) :: value
      character(:), allocatable, intent(out) :: fault   !! what is wrong with it; else unallocated
      real(dp) :: number
      integer :: least, whole
      logical :: valid

      if (is_whole) then
         call read_integer(string, whole, valid)
         number = whole
         if (.not. valid) fault = integer_fault(string)
      else
         call read_real(string, number, valid)
         if (.not. valid) fault = real_fault(string)
      end if
      if (.not. valid) then
         fault = ''''//string//''' '//fault//'; expected: '//what
         return
      end if
      select case (limit)
      case ('>0')
         if (number <= 0.0_dp) fault = ' must be positive'
      case ('>=0')
         if (number < 0.0_dp) fault = ' must not be negative'
      case ('>=1', '>=2', '>=80')
         read (limit(3:), *) least
         if (number < least) fault = ' must be at least '//limit(3:)
      case ('>0 <=1')
         if (number <= 0.0_dp .or. number > 1.0_dp) fault = ' must be above 0 and at most 1'
      case ('>=0 <=1')
         if (number < 0.0_dp .or. number > 1.0_dp) fault = ' must be between 0 and 1'
      case default
         continue
      end select
      if (allocated(fault)) then
         fault = what//fault
      else
         value = number
      end if
   end subroutine read_number

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
