!> Strings of any length, and numbers as text and back.
module text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_null_char, c_null_ptr, c_ptr
   use kinds, only: dp, long
   implicit none
   private
   public :: named_type, string_type, others, counted, listed, to_text, all_digits, few_digits, &
      rounded, digits_above, with_decimals, or_blank, percent, share_words, quoted, to_upper, &
      without_blanks, is_same_name, read_integer, read_real, append, is_whole, integer_fault, &
      real_fault, smallest_magnitude, largest_magnitude, split_words

   integer, parameter :: largest_exponent = 300   !! beyond it reading could overflow
   !> Magnitudes of numbers that are not 0: products of three of them stay finite.
   real(dp), parameter :: smallest_magnitude = 1.0e-100_dp, largest_magnitude = 1.0e100_dp

   integer, parameter :: most_digits = 15   !! of a real that are its own

   !> A string in a list.
   type :: string_type
      character(:), allocatable :: value   !! the text
   end type string_type

   !> Ancestor of all that a deck defines by a name: sets, surfaces, materials, contact pairs, ...
   type :: named_type
      !> in upper case; that of a contact pair as the deck writes it
      character(:), allocatable :: name
   end type named_type

   interface
      !> Takes a fifth of the instructions of a read statement, which calls it, too.
      pure real(c_double) function c_strtod(string, end) bind(c, name='strtod')
         import :: c_char, c_double, c_ptr
         character(kind=c_char), intent(in) :: string(*)
         type(c_ptr), value, intent(in) :: end
      end function c_strtod
   end interface

   !> A number as text without blanks around it.
   interface to_text
      module procedure integer_to_text
      module procedure long_to_text
      module procedure real_to_text
   end interface to_text

contains

   !> An integer without blanks.
   pure function integer_to_text(number) result(string)
      integer, intent(in) :: number          !! the number
      character(:), allocatable :: string    !! its decimal digits

      string = long_to_text(int(number, long))
   end function integer_to_text

   !> A long integer without blanks.
   pure function long_to_text(number) result(string)
      integer(long), intent(in) :: number    !! the number
      character(:), allocatable :: string    !! its decimal digits
      character(20) :: buffer
      integer(long) :: rest
      integer :: first

      rest = number
      first = len(buffer) + 1
      do
         first = first - 1
         buffer(first:first) = achar(iachar('0') + int(abs(mod(rest, 10_long))))
         rest = rest/10
         if (rest == 0) exit
      end do
      string = buffer(first:)
      if (number < 0) string = '-'//string
   end function long_to_text

   !> A real with six significant digits, plain where that is short, else with an exponent.
   pure function real_to_text(number) result(string)
      real(dp), intent(in) :: number         !! the number
      character(:), allocatable :: string    !! such as 540 or 0.155 or 1.2E-5
      character(24) :: buffer

      write (buffer, '(1p,g0.6)') number
      string = without_end_zeros(adjustl(buffer))
      if (string == '-0') string = '0'
   end function real_to_text

   !> A number with all the digits that it takes to read the same number again.
   pure function all_digits(number) result(string)
      real(dp), intent(in) :: number         !! finite
      character(:), allocatable :: string    !! such as 540, 0.155 or 3.3333333333333331E-001
      character(26) :: buffer
      real(dp) :: back
      integer :: status

      string = '0'
      if (abs(number) <= 0.0_dp) return
      string = few_digits(abs(number), most_digits)
      read (string, *, iostat=status) back
      if (status /= 0 .or. abs(back - abs(number)) > 0.0_dp) then
         write (buffer, '(es25.16e3)') abs(number)
         string = trim(adjustl(buffer))
      end if
      if (number < 0.0_dp) string = '-'//string
   end function all_digits

   !> A number >= 0 with two significant digits, or as many as given, plain where that is short.
   pure function few_digits(number, digits) result(string)
      real(dp), intent(in) :: number
      integer, intent(in), optional :: digits   !! up to most_digits
      character(:), allocatable :: string       !! such as 0.044 or 3.5E-10
      real(dp), parameter :: plain(2) = [9.5e-5_dp, 9.95e5_dp]
      character(24) :: buffer
      integer :: behind_first

      behind_first = 1
      if (present(digits)) behind_first = digits - 1
      if (number >= plain(1) .and. number < plain(2)) then
         string = with_decimals(number, max(0, behind_first - floor(log10(number))))
         string = without_end_zeros(string)
         return
      end if
      write (buffer, '(1p,g0.'//to_text(behind_first)//')') number
      string = without_end_zeros(adjustl(buffer))
   end function few_digits

   !> A number with two decimal digits: the same double for the same digits, as text is read.
   elemental real(dp) function rounded(number)
      real(dp), intent(in) :: number   !! >= 0
      character(16) :: digits

      write (digits, '(es16.1e3)') number
      read (digits, *) rounded
   end function rounded

   !> Significant digits that show a number above a limit as such: two, where these do, or where it
   !> is not above it.
   pure integer function digits_above(number, limit) result(digits)
      real(dp), intent(in) :: number, limit     !! >= 0

      digits = 2
      if (number <= limit) return
      do digits = 2, most_digits - 1
         if (few_digits(number, digits) /= few_digits(limit, digits)) exit
      end do
   end function digits_above

   !> A part of 1 in percent with two significant digits, or as many as given.
   pure function percent(part, digits) result(string)
      real(dp), intent(in) :: part              !! >= 0
      integer, intent(in), optional :: digits
      character(:), allocatable :: string       !! such as 0.13 %

      string = few_digits(100.0_dp*part, digits)//' %'
   end function percent

   !> How large a part of a value its uncertainty is; empty where the value is small beside it.
   pure function share_words(uncertainty, value) result(words)
      real(dp), intent(in) :: uncertainty, value
      character(:), allocatable :: words        !! such as (5 %)

      words = ''
      if (uncertainty < 10.0_dp*abs(value)) words = '('//percent(uncertainty/abs(value))//')'
   end function share_words

   !> A number with a fixed number of decimals.
   pure function with_decimals(number, decimals) result(string)
      real(dp), intent(in) :: number
      integer, intent(in) :: decimals
      character(:), allocatable :: string       !! such as 12.30
      character(24) :: buffer

      write (buffer, '(f24.'//to_text(decimals)//')') number
      string = trim(adjustl(buffer))
   end function with_decimals

   !> A number without zeros behind its point that say nothing.
   pure function without_end_zeros(number) result(string)
      character(*), intent(in) :: number        !! with or without an exponent
      character(:), allocatable :: string
      integer :: exponent, last

      exponent = index(number, 'E')
      if (exponent == 0) exponent = len_trim(number) + 1
      last = exponent - 1
      if (index(number(:last), '.') > 0) then
         last = verify(number(:last), '0', back=.true.)
         if (number(last:last) == '.') last = last - 1
      end if
      string = number(:last)//trim(number(exponent:))
   end function without_end_zeros

   !> A string with its letters a-z in upper case.
   pure function to_upper(string) result(upper)
      character(*), intent(in) :: string    !! any text
      character(len(string)) :: upper       !! the same, a-z as A-Z
      integer :: i

      upper = string
      do i = 1, len(string)
         if (string(i:i) >= 'a' .and. string(i:i) <= 'z') upper(i:i) = achar(iachar(string(i:i)) - &
            32)
      end do
   end function to_upper

   !> Whether two names are the same but for blanks, tabs and the case of letters.
   pure logical function is_same_name(one, other)
      character(*), intent(in) :: one, other   !! the names
      integer :: i, k

      is_same_name = .false.
      i = next_mark(one, 1)
      k = next_mark(other, 1)
      do while (i <= len(one) .and. k <= len(other))
         if (to_upper(one(i:i)) /= to_upper(other(k:k))) return
         i = next_mark(one, i + 1)
         k = next_mark(other, k + 1)
      end do
      is_same_name = i > len(one) .and. k > len(other)
   end function is_same_name

   !> The first character from a place on that is neither blank nor tab; beyond the end for none.
   pure integer function next_mark(string, first)
      character(*), intent(in) :: string
      integer, intent(in) :: first

      do next_mark = first, len(string)
         if (string(next_mark:next_mark) /= ' ' .and. string(next_mark:next_mark) /= achar(9)) exit
      end do
   end function next_mark

   !> The words of a list that slashes separate.
   pure function split_words(list) result(words)
      character(*), intent(in) :: list                  !! without blanks at its end
      type(string_type), allocatable :: words(:)        !! none of an empty list
      integer :: first, last

      allocate(words(0))
      last = -1
      do while (last + 1 < len(list))
         first = last + 2
         last = first - 2 + index(list(first:)//'/', '/')
         call append(words, list(first:last))
      end do
   end function split_words

   !> A string without any of its blanks and tabs.
   pure function without_blanks(string) result(squeezed)
      character(*), intent(in) :: string         !! any text
      character(:), allocatable :: squeezed      !! the same without blanks
      character(len(string)) :: buffer
      integer :: i, n

      n = 0
      do i = 1, len(string)
         if (string(i:i) == ' ' .or. string(i:i) == achar(9)) cycle
         n = n + 1
         buffer(n:n) = string(i:i)
      end do
      squeezed = buffer(:n)
   end function without_blanks

   !> Reads a whole number: an optional sign and digits, nothing else.
   pure subroutine read_integer(string, number, valid)
      character(*), intent(in) :: string   !! text without blanks around it
      integer, intent(out) :: number       !! its value, 0 when not valid
      logical, intent(out) :: valid        !! whether it is a number that a default integer holds
      integer(long) :: magnitude
      integer :: i, first

      number = 0
      magnitude = 0
      valid = .false.
      first = 1
      if (len(string) > 1) then
         if (scan(string(1:1), '+-') == 1) first = 2
      end if
      if (len(string) < first) return
      do i = first, len(string)
         if (string(i:i) < '0' .or. string(i:i) > '9') return
         magnitude = 10*magnitude + (iachar(string(i:i)) - iachar('0'))
         if (magnitude > huge(number)) return
      end do
      number = int(magnitude)
      if (string(1:1) == '-') number = -number
      valid = .true.
   end subroutine read_integer

   !> Reads a real number: sign, digits with at most one point, exponent with E or D. Its magnitude
   !> is 0 or from 1E-100 to 1E100.
   pure subroutine read_real(string, number, valid)
      character(*), intent(in) :: string   !! text without blanks around it
      real(dp), intent(out) :: number      !! its value, 0 when not valid
      logical, intent(out) :: valid        !! whether it is a number in that range
      character(len(string) + 1, kind=c_char) :: copy
      integer :: mark, exponent

      number = 0.0_dp
      valid = has_form_of_real(string)
      if (.not. valid) return
      mark = scan(string, 'eEdD')
      if (mark > 0) then
         call read_integer(string(mark + 1:), exponent, valid)
         if (valid) valid = abs(exponent) <= largest_exponent
         if (.not. valid) return
      end if
      copy = string//c_null_char
      if (mark > 0) copy(mark:mark) = 'e'
      number = c_strtod(copy, c_null_ptr)
      valid = ieee_is_finite(number)
      if (valid) valid = abs(number) <= largest_magnitude .and. &
         (abs(number) <= 0.0_dp .or. abs(number) >= smallest_magnitude)
      if (.not. valid) number = 0.0_dp
   end subroutine read_real

   !> The part of a message that says why a text is not read as a whole number.
   pure function integer_fault(string) result(fault)
      character(*), intent(in) :: string      !! text that read_integer does not take
      character(:), allocatable :: fault      !! such as "is not a whole number"

      fault = 'is not a whole number'
      if (is_whole(string)) fault = 'is out of range'
   end function integer_fault

   !> The part of a message that says why a text is not read as a real.
   pure function real_fault(string) result(fault)
      character(*), intent(in) :: string      !! text that read_real does not take
      character(:), allocatable :: fault      !! such as "is not a number"

      fault = 'is not a number'
      if (has_form_of_real(string)) fault = 'is out of range'
   end function real_fault

   !> Whether a text is written as a real; list-directed input alone would also accept "1*2", "5/3"
   !> or "1-5".
   pure logical function has_form_of_real(string) result(valid)
      character(*), intent(in) :: string
      integer :: mark, point

      mark = scan(string//'E', 'eEdD')
      point = scan(string(:mark - 1)//'.', '.')
      valid = is_whole(string(:point - 1)//string(point + 1:mark - 1)) .and. &
         verify(string(point + 1:mark - 1), '0123456789') == 0
      if (mark <= len(string)) valid = valid .and. is_whole(string(mark + 1:))
   end function has_form_of_real

   !> Whether a text is an optional sign and at least one digit.
   pure function is_whole(string) result(valid)
      character(*), intent(in) :: string   !! text without blanks around it
      logical :: valid                     !! of any length, so that it need not be an integer
      integer :: first

      valid = .false.
      if (len(string) == 0) return
      first = 1
      if (scan(string(1:1), '+-') == 1) first = 2
      if (len(string) < first) return
      valid = verify(string(first:), '0123456789') == 0
   end function is_whole

   !> Adds a string at the end of a short list; lists that grow card by card keep a capacity of
   !> their own.
   pure subroutine append(list, string)
      type(string_type), allocatable, intent(inout) :: list(:)   !! the list; unallocated for none
      character(*), intent(in) :: string                         !! what is added
      type(string_type), allocatable :: longer(:)
      integer :: i, n

      n = 0
      if (allocated(list)) n = size(list)
      allocate(longer(n + 1))
      do i = 1, n
         call move_alloc(list(i)%value, longer(i)%value)
      end do
      longer(n + 1)%value = string
      call move_alloc(longer, list)
   end subroutine append

   !> A text between double quotes, those inside it doubled; nothing for an empty text. An
   !> apostrophe precedes text that a spreadsheet would read as a formula.
   pure function quoted(words) result(field)
      character(*), intent(in) :: words     !! the text
      character(:), allocatable :: field    !! as RFC 4180 has it
      character(*), parameter :: formula_begins = '=+-@'//achar(9)//achar(13)
      integer :: i

      field = ''
      if (len(words) == 0) return
      if (scan(words(:1), formula_begins) > 0) field = "'"
      do i = 1, len(words)
         field = field//words(i:i)
         if (words(i:i) == '"') field = field//'"'
      end do
      field = '"'//field//'"'
   end function quoted

   !> A number with its noun, such as 1 row or 3 rows.
   pure function counted(n, noun) result(words)
      integer, intent(in) :: n                 !! how many
      character(*), intent(in) :: noun         !! in the singular, with a plural in -s
      character(:), allocatable :: words

      words = to_text(n)//' '//noun//trim(merge(' ', 's', n == 1))
   end function counted

   !> The first ones of some names, separated by commas, and how many more there are.
   pure function listed(names, most) result(words)
      type(string_type), intent(in) :: names(:)
      integer, intent(in) :: most              !! names that are listed
      character(:), allocatable :: words       !! such as A, B and 3 more
      integer :: i

      words = ''
      do i = 1, min(size(names), most)
         if (i > 1) words = words//', '
         words = words//names(i)%value
      end do
      if (size(names) > most) words = words//' and '//to_text(size(names) - most)//' more'
   end function listed

   !> Text that may not have been given.
   pure function or_blank(text) result(string)
      character(:), allocatable, intent(in) :: text   !! the text, or unallocated
      character(:), allocatable :: string             !! the text, or nothing

      string = ''
      if (allocated(text)) string = text
   end function or_blank

   !> The ending of a message that names one of several: their number, if it is more than one.
   pure function others(n, words) result(ending)
      integer, intent(in) :: n                 !! how many there are
      character(*), intent(in) :: words        !! what is before the number
      character(:), allocatable :: ending      !! empty for one

      ending = ''
      if (n > 1) ending = words//to_text(n)
   end function others

end module text
