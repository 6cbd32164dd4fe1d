!> Values of parameters and of the fields of a data card, with an error at their place where they
!> are wrong, such as numbers with a decimal comma, which the dialect reads as two fields.
module card_values
   use cards, only: data_card_type, keyword_card_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use spelling, only: full_word, known_choices
   use text, only: integer_fault, is_whole, read_integer, read_real, real_fault, split_words, &
      string_type, to_text, to_upper, without_blanks
   implicit none
   private
   public :: read_field, check_extra, read_row, read_rows, check_ascending, decimal_comma, &
      decimal_comma_words, report_decimal_comma, may_be_decimals, check_unneeded, surface_kinds, &
      need_parameter, take_parameter, choice, chosen, needed_choice, is_on

   !> Value of a field by its rule, as in a layout of read_row; it stays as it is where the card
   !> does not have it, and after an error. A text must be there.
   interface read_field
      module procedure read_text_field
      module procedure read_integer_field
      module procedure read_real_field
   end interface read_field

   !> A field of a layout.
   type :: field_rule_type
      integer :: name(2)       !! first and last character of what it holds
      integer :: limit(2)      !! those of its limit, as read_number has it
      real(dp) :: default      !! where it is not given, or wrong
      logical :: is_needed, is_whole, is_text
   end type field_rule_type

   !> Freezing point of water in kelvin. A whole number below it behind a property may well be
   !> decimals; one above it is rather the temperature that the property was measured at.
   real(dp), parameter :: least_plausible = 273.0_dp

   !> TYPE= of *SURFACE.
   character(*), parameter :: surface_kinds = 'ELEMENT/NODE/SEGMENTS'

   !> Value of a parameter within a limit, as read_number has it; it stays as it is where the card
   !> does not have it, and after an error.
   interface take_parameter
      module procedure take_integer_parameter
      module procedure take_real_parameter
   end interface take_parameter

contains

   !> Reports the first field that a card has too many, which a decimal comma may have made.
   subroutine check_extra(data, most, layout, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: most                         !! most fields
      character(*), intent(in) :: layout                  !! what a card of its keyword holds
      class(deck_report_type), intent(inout) :: report    !! receives the error
      integer :: comma

      if (size(data%fields) <= most) return
      comma = decimal_comma(data)
      if (may_be_decimals(data, most + 1)) then
         if (adjacent(data, most)) comma = most
      end if
      if (comma == 0) then
         call report%error(data%place(most + 1), 'extra field; the card is '//layout)
      else
         call report%root_cause(data%place(comma), 'extra field; the card is '//layout//'; or '// &
            'a '//decimal_comma_words(data%fields(comma)%text, data%fields(comma + 1)%text))
      end if
   end subroutine check_extra

   subroutine read_text_field(data, i, what, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      class(deck_report_type), intent(inout) :: report
      character(:), allocatable, intent(inout) :: value
      logical, intent(inout) :: valid

      value = data%text(i)
      if (len(value) == 0) call report_missing(data, i, what, report, valid)
   end subroutine read_text_field

   subroutine read_integer_field(data, i, rule, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: rule
      class(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: value
      logical, intent(inout) :: valid
      type(field_rule_type) :: whole
      real(dp) :: number

      whole = rule_of(rule)
      whole%is_whole = .true.
      number = value
      call read_by_rule(data, i, rule, whole, report, number, valid)
      value = nint(number)
   end subroutine read_integer_field

   subroutine read_real_field(data, i, rule, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: rule
      class(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid

      call read_by_rule(data, i, rule, rule_of(rule), report, value, valid)
   end subroutine read_real_field

   subroutine read_by_rule(data, i, field, rule, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: field
      type(field_rule_type), intent(in) :: rule           ! of this field
      class(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid                     ! becomes false after an error
      character(:), allocatable :: fault

      if (data%is_undefined(i)) then
         valid = .false.
      else if (data%has(i)) then
         call read_number(data%fields(i)%text, field(rule%name(1):rule%name(2)), rule%is_whole, &
            field(rule%limit(1):rule%limit(2)), value, fault)
         if (.not. allocated(fault)) return
         call report%error(data%place(i), fault)
         valid = .false.
      else if (rule%is_needed) then
         call report_missing(data, i, field(rule%name(1):rule%name(2)), report, valid)
      end if
   end subroutine read_by_rule

   subroutine report_missing(data, i, what, report, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      class(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid

      valid = .false.
      if (.not. data%is_undefined(i)) call report%error(data%place(i), 'missing field: '//what)
   end subroutine report_missing

   !> Reads the numbers of a data card by its layout: its fields, separated by slashes, such as
   !> `@node or set/#degree of freedom/force`. Before a field stands `#` where it is a whole number
   !> and `@` where it is none and is read elsewhere; behind it `?` where it may be missing, its
   !> limit, as read_number has it, and what is taken where it is not given, or wrong: `=1`, or 0.
   !> Of fields that are missing the first is reported, as is the first one too many.
   subroutine read_row(data, layout, report, values, valid)
      class(data_card_type), intent(in) :: data
      character(*), intent(in) :: layout
      class(deck_report_type), intent(inout) :: report    !! receives errors
      real(dp), intent(out) :: values(:)                  !! (fields) those that are numbers
      logical, intent(out) :: valid                       !! false after an error
      type(string_type), allocatable :: fields(:)
      type(field_rule_type) :: rule
      character(:), allocatable :: names
      integer :: i
      logical :: is_missing, lacks

      valid = .true.
      lacks = .false.
      names = ''
      values = 0.0_dp
      fields = split_words(layout)
      do i = 1, size(fields)
         rule = rule_of(fields(i)%value)
         if (size(data%fields) > size(fields)) names = names//', '// &
            fields(i)%value(rule%name(1):rule%name(2))
         if (rule%is_text) cycle
         values(i) = rule%default
         is_missing = rule%is_needed .and. .not. (data%has(i) .or. data%is_undefined(i))
         if (.not. (is_missing .and. lacks)) call read_by_rule(data, i, fields(i)%value, rule, &
            report, values(i), valid)
         lacks = lacks .or. is_missing
      end do
      if (len(names) > 0) call check_extra(data, size(fields), names(3:), report)
   end subroutine read_row

   !> Reads data cards of one layout.
   subroutine read_rows(rows, layout, report, values, valid)
      type(data_card_type), intent(in) :: rows(:)
      character(*), intent(in) :: layout                  !! as read_row
      class(deck_report_type), intent(inout) :: report    !! receives errors
      real(dp), intent(inout) :: values(:, :)             !! (fields, rows)
      logical, intent(out) :: valid                       !! false after an error
      integer :: i
      logical :: sound

      valid = .true.
      do i = 1, size(rows)
         call read_row(rows(i), layout, report, values(:, i), sound)
         valid = valid .and. sound
      end do
   end subroutine read_rows

   !> Reports the first row whose value is not above that of the row before.
   subroutine check_ascending(rows, i, what, values, report)
      type(data_card_type), intent(in) :: rows(:)
      integer, intent(in) :: i                            !! position of the field
      character(*), intent(in) :: what                    !! the values, such as gaps
      real(dp), intent(in) :: values(:)                   !! (rows)
      class(deck_report_type), intent(inout) :: report    !! receives the error
      integer :: row

      row = findloc(values(2:) <= values(:size(values) - 1), .true., dim=1)
      if (row > 0) call report%error(rows(row + 1)%place(i), what//' must ascend: '// &
         to_text(values(row + 1))//' follows '//to_text(values(row)))
   end subroutine check_ascending

   !> The rule of one field of a layout.
   pure type(field_rule_type) function rule_of(field) result(rule)
      character(*), intent(in) :: field
      integer :: behind, last
      logical :: is_given

      rule%default = 0.0_dp
      behind = index(field, ' =')
      if (behind > 0) call read_real(field(behind + 2:), rule%default, is_given)
      if (behind == 0) behind = len(field) + 1
      last = index(field(:behind - 1), ' >') - 1
      if (last < 0) last = behind - 1
      rule%limit = [last + 2, behind - 1]
      rule%is_needed = field(last:last) /= '?'
      if (.not. rule%is_needed) last = last - 1
      rule%is_whole = field(1:1) == '#'
      rule%is_text = field(1:1) == '@'
      rule%name = [merge(2, 1, rule%is_whole .or. rule%is_text), last]
   end function rule_of

   !> Position of the first field whose decimals, be they 0, the next one may be: the comma has no
   !> blank behind it, and other commas of the card have one, or no field of the card has a point. 0
   !> where there is none.
   pure integer function decimal_comma(data)
      type(data_card_type), intent(in) :: data
      integer :: i
      logical :: differs

      differs = .true.
      do i = 1, size(data%fields)
         differs = differs .and. scan(data%fields(i)%text, '.eEdD') == 0
      end do
      do i = 1, size(data%fields) - 1
         differs = differs .or. .not. adjacent(data, i)
      end do
      decimal_comma = 0
      if (.not. differs) return
      do i = 1, size(data%fields) - 1
         if (.not. adjacent(data, i)) cycle
         if (.not. may_be_decimals(data, i + 1) .and. .not. (is_whole(data%fields(i)%text) .and. &
            verify(data%fields(i + 1)%text, '0') == 0)) cycle
         decimal_comma = i
         return
      end do
   end function decimal_comma

   !> Whether the next field begins right behind the comma.
   pure logical function adjacent(data, i)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i

      associate (one => data%fields(i), other => data%fields(i + 1))
         adjacent = one%place%image == other%place%image .and. &
            other%place%column == one%place%column + len(one%text) + 1 .and. len(other%text) > 0
      end associate
   end function adjacent

   !> Reports a decimal comma.
   subroutine report_decimal_comma(data, i, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                            !! what decimal_comma found
      class(deck_report_type), intent(inout) :: report    !! receives the error

      call report%root_cause(data%place(i), 'a '// &
         decimal_comma_words(data%fields(i)%text, data%fields(i + 1)%text))
   end subroutine report_decimal_comma

   !> Message on a decimal comma.
   pure function decimal_comma_words(whole, decimals) result(words)
      character(*), intent(in) :: whole       !! before the comma
      character(*), intent(in) :: decimals    !! behind it
      character(:), allocatable :: words

      words = 'decimal comma? A comma separates fields; write '//whole//'.'//decimals//' for '// &
         whole//','//decimals
   end function decimal_comma_words

   !> Whether a field may be the decimals of the one before it, torn off by a decimal comma, as in
   !> 0,155 for 0.155: that one is written without a point and an exponent, this one is digits with
   !> or without an exponent. Zeros alone are no decimals that matter.
   pure logical function may_be_decimals(data, i)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position of the field, from 1
      character(:), allocatable :: decimals
      real(dp) :: number

      may_be_decimals = .false.
      if (i < 2) return
      decimals = data%text(i)
      if (.not. is_whole(data%text(i - 1)) .or. verify(decimals, '0') == 0) return
      if (scan(decimals(1:1), '0123456789') == 0 .or. index(decimals, '.') > 0) return
      call read_real(decimals, number, may_be_decimals)
   end function may_be_decimals

   !> Warns of a field that means nothing where it may be the decimals of the field before it.
   subroutine check_unneeded(data, i, what, report, group)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                            !! position of the field, from 2
      character(*), intent(in) :: what                    !! what the field is, with its article
      class(deck_report_type), intent(inout) :: report    !! receives the warning
      character(*), intent(in), optional :: group         !! by which it is is_told
      character(:), allocatable :: message
      real(dp) :: temperature
      logical :: is_number

      if (.not. may_be_decimals(data, i)) return
      if (what == 'a temperature') then
         call read_real(data%text(i), temperature, is_number)
         ! A plausible one is no decimals, unless it is directly behind the comma of `0,`.
         if (temperature >= least_plausible .and. (verify(data%text(i - 1), '+-0') > 0 .or. .not. &
            adjacent(data, i - 1))) return
      end if
      associate (whole => data%fields(i - 1)%text, decimals => data%fields(i)%text)
         message = 'decimal comma? '//whole//','//decimals//' is two fields: '//whole//', and '// &
            what//', which is ignored; write '//whole//'.'//decimals//', or '//whole// &
            '. if that is meant'
      end associate
      if (present(group)) then
         call report%warning(data%place(i - 1), message, group)
      else
         call report%possible_cause(data%place(i - 1), message)
      end if
   end subroutine check_unneeded

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

end module card_values
