!> Values of *PARAMETER that are arithmetic: numbers, earlier parameters, + - * / **, parentheses
!> and functions, with the precedence of Python.
module arithmetic
   use kinds, only: dp
   use name_index, only: name_index_type
   use spelling, only: known_choices, nearest_known
   use text, only: all_digits, largest_magnitude, read_real, smallest_magnitude, split_words, &
      string_type, to_upper
   implicit none
   private
   public :: is_arithmetic, evaluate, arithmetic_fault_type

   character(*), parameter :: digits = '0123456789'
   character(*), parameter :: letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_'
   character(*), parameter :: functions = 'SQRT/SIN/COS/TAN/ASIN/ACOS/ATAN/EXP/LOG/LOG10/ABS'
   integer, parameter :: deepest = 100   !! parentheses and signs within each other

   !> What is wrong with an expression.
   type :: arithmetic_fault_type
      character(:), allocatable :: message   !! in plain words; unallocated where nothing is wrong
      character(:), allocatable :: unknown   !! name of no parameter, if that is wrong
      integer :: at = 0                      !! byte of the expression
   end type arithmetic_fault_type

   !> An expression while it is read.
   type :: reader_type
      character(:), allocatable :: text
      type(name_index_type) :: parameters                 !! those before
      type(string_type), allocatable :: values(:)         !! (parameters)
      integer :: at = 1                      !! the byte that is read next
      integer :: depth = 0
      type(arithmetic_fault_type) :: fault   !! the first one; reading ends there
   end type reader_type

contains

   !> Whether a value is arithmetic, not text: it has an operator or a parenthesis, and it begins
   !> with a number, a sign, a parenthesis or an earlier parameter, or has ( or a factor behind *.
   pure logical function is_arithmetic(value, parameters)
      character(*), intent(in) :: value               !! without blanks around it
      type(name_index_type), intent(in) :: parameters !! the earlier ones
      real(dp) :: number
      logical :: is_number

      call read_real(value, number, is_number)
      is_arithmetic = .not. is_number .and. scan(value, '+-*/()') > 0 .and. value(1:1) /= '"'
      if (is_arithmetic) is_arithmetic = scan(value(:1), digits//'+-(') > 0 .or. &
         value(1:1) == '.' .and. scan(value(2:), digits) == 1 .or. index(value, '(') > 0 .or. &
         index(value(:len(value) - 1), '*') > 0 .or. parameters%find(name_at(value, 1)) > 0
   end function is_arithmetic

   !> Value of an expression. Every number, also an intermediate one, is 0 or from 1E-100 to 1E100.
   pure subroutine evaluate(expression, parameters, values, number, fault)
      character(*), intent(in) :: expression
      type(name_index_type), intent(in) :: parameters     !! the earlier ones
      type(string_type), intent(in) :: values(:)          !! (parameters) their values
      real(dp), intent(out) :: number                     !! 0 after an error
      type(arithmetic_fault_type), intent(out) :: fault
      type(reader_type) :: self

      self%text = expression
      self%parameters = parameters
      self%values = values
      call read_terms(self, '+-', number)
      if (next(self) /= '') call fail(self, self%at, 'an operator is expected here'// &
         '; put text between double quotes')
      fault = self%fault
      if (allocated(fault%message)) number = 0.0_dp
   end subroutine evaluate

   !> Terms of a sum, or factors of a product.
   pure recursive subroutine read_terms(self, operators, number)
      type(reader_type), intent(inout) :: self
      character(2), intent(in) :: operators       ! +- or */
      real(dp), intent(out) :: number
      character(:), allocatable :: operator
      real(dp) :: other
      integer :: place

      operator = '+'
      number = 0.0_dp
      if (operators == '*/') number = 1.0_dp
      if (operators == '*/') operator = '*'
      place = self%at
      do
         if (operators == '+-') then
            call read_terms(self, '*/', other)
         else
            call read_sign(self, other)
         end if
         select case (operator)
         case ('+')
            number = number + other
         case ('-')
            number = number - other
         case ('*')
            number = number*other
         case default
            if (abs(other) > 0.0_dp) number = number/other
            if (abs(other) <= 0.0_dp) call fail(self, place, 'division by zero')
         end select
         call check(self, place, number)
         operator = next(self)
         if (operator == '' .or. operator == '**' .or. scan(operator, operators) == 0) return
         place = self%at
         call move(self, 1)
      end do
   end subroutine read_terms

   !> A sign, which binds less than ** before it and more than ** behind it.
   pure recursive subroutine read_sign(self, number)
      type(reader_type), intent(inout) :: self
      real(dp), intent(out) :: number
      character(:), allocatable :: sign

      number = 0.0_dp
      sign = next(self)
      self%depth = self%depth + 1
      if (self%depth > deepest) then
         call fail(self, self%at, 'more than 100 parentheses and signs within each other')
      else if (sign == '+' .or. sign == '-') then
         call move(self, 1)
         call read_sign(self, number)
         if (sign == '-') number = -number
      else
         call read_power(self, number)
      end if
      self%depth = self%depth - 1
   end subroutine read_sign

   pure recursive subroutine read_power(self, number)
      type(reader_type), intent(inout) :: self
      real(dp), intent(out) :: number
      real(dp) :: exponent
      integer :: place
      logical :: is_whole

      call read_operand(self, number)
      if (next(self) /= '**') return
      place = self%at
      call move(self, 2)
      call read_sign(self, exponent)
      is_whole = abs(exponent - anint(exponent)) <= 0.0_dp
      if (abs(exponent) <= 0.0_dp) then
         number = 1.0_dp
      else if (abs(number) <= 0.0_dp .and. exponent < 0.0_dp) then
         call fail(self, place, 'division by zero')
      else if (number < 0.0_dp .and. .not. is_whole) then
         call fail(self, place, 'a power of a negative number must be whole')
      else if (abs(number) > 0.0_dp) then
         if (abs(log(abs(number)))*min(abs(exponent), largest_magnitude) > &
            2.0_dp*log(largest_magnitude)) then
            call fail(self, place, 'the result is not between 1E-100 and 1E100')
         else if (number < 0.0_dp .and. mod(exponent, 2.0_dp)**2 > 0.0_dp) then
            number = -abs(number)**exponent
         else
            number = abs(number)**exponent
         end if
      end if
      call check(self, place, number)
   end subroutine read_power

   !> A number, a parameter, a function, or what is between parentheses.
   pure recursive subroutine read_operand(self, number)
      type(reader_type), intent(inout) :: self
      real(dp), intent(out) :: number
      character(:), allocatable :: name
      integer :: k, place
      logical :: valid

      number = 0.0_dp
      if (next(self) == '(') then
         call read_parentheses(self, number)
         return
      end if
      place = self%at
      if (allocated(self%fault%message)) return
      name = name_at(self%text, place)
      call move(self, len(name))
      if (len(name) == 0) then
         call read_number(self, number)
      else if (next(self) == '(') then
         call read_parentheses(self, number)
         call apply(self, place, to_upper(name), number)
      else
         k = self%parameters%find(name)
         if (k == 0) then
            self%fault%unknown = to_upper(name)
            call fail(self, place, 'no *PARAMETER before this one defines '//to_upper(name)// &
               nearest_known(to_upper(name), self%parameters%known()))
            return
         end if
         call read_real(self%values(k)%value, number, valid)
         if (.not. valid) call fail(self, place, 'parameter '//to_upper(name)// &
            ' is not a number: '//self%values(k)%value)
      end if
   end subroutine read_operand

   pure recursive subroutine read_parentheses(self, number)
      type(reader_type), intent(inout) :: self
      real(dp), intent(out) :: number
      integer :: place

      place = self%at
      call move(self, 1)
      call read_terms(self, '+-', number)
      if (next(self) == ')') then
         call move(self, 1)
      else if (next(self) == '') then
         call fail(self, place, 'this parenthesis is not closed')
      else
         call fail(self, self%at, 'an operator or ) is expected here')
      end if
   end subroutine read_parentheses

   pure subroutine read_number(self, number)
      type(reader_type), intent(inout) :: self
      real(dp), intent(out) :: number
      integer :: first, last, mark
      logical :: valid

      number = 0.0_dp
      first = self%at
      last = first - 1 + span(self%text(first:), digits//'.')
      if (last < first) then
         call fail(self, first, 'a number, a parameter or ( is expected here')
         return
      end if
      mark = last + 1 + span(self%text(last + 1:min(last + 1, len(self%text))), 'eEdD')
      if (mark > last + 1) then
         mark = mark + span(self%text(mark:min(mark, len(self%text))), '+-')
         if (span(self%text(mark:), digits) > 0) last = mark - 1 + span(self%text(mark:), digits)
      end if
      call move(self, last + 1 - first)
      call read_real(self%text(first:last), number, valid)
      if (.not. valid) call fail(self, first, self%text(first:last)//' is not a number between '// &
         '1E-100 and 1E100')
   end subroutine read_number

   pure subroutine apply(self, place, name, number)
      type(reader_type), intent(inout) :: self
      integer, intent(in) :: place                ! of the name
      character(*), intent(in) :: name            ! in upper case
      real(dp), intent(inout) :: number           ! argument, then value
      logical :: valid

      if (allocated(self%fault%message)) return
      valid = .true.
      select case (name)
      case ('SQRT')
         valid = number >= 0.0_dp
         if (valid) number = sqrt(number)
      case ('SIN')
         number = sin(number)
      case ('COS')
         number = cos(number)
      case ('TAN')
         number = tan(number)
      case ('ASIN', 'ACOS')
         valid = abs(number) <= 1.0_dp
         if (valid .and. name == 'ASIN') then
            number = asin(number)
         else if (valid) then
            number = acos(number)
         end if
      case ('ATAN')
         number = atan(number)
      case ('EXP')
         ! Far enough beyond the limit for check, and finite.
         number = exp(max(-600.0_dp, min(600.0_dp, number)))
      case ('LOG', 'LOG10')
         valid = number > 0.0_dp
         if (valid .and. name == 'LOG') then
            number = log(number)
         else if (valid) then
            number = log10(number)
         end if
      case ('ABS')
         number = abs(number)
      case default
         call fail(self, place, 'unknown function '//name//known_choices(name, &
            split_words(functions)))
      end select
      if (.not. valid) call fail(self, place, name//' of '//all_digits(number)//' is not a number')
      call check(self, place, number)
   end subroutine apply

   !> Ends the reading where a number would leave the range of numbers of a deck.
   pure subroutine check(self, place, number)
      type(reader_type), intent(inout) :: self
      integer, intent(in) :: place                ! of the operator or function
      real(dp), intent(inout) :: number           ! 0 after an error

      if (abs(number) > largest_magnitude .or. abs(number) > 0.0_dp .and. abs(number) < &
         smallest_magnitude) call fail(self, place, 'the result is not between 1E-100 and 1E100')
      if (allocated(self%fault%message)) number = 0.0_dp
   end subroutine check

   !> Keeps the first error and goes to the end of the expression.
   pure subroutine fail(self, place, message)
      type(reader_type), intent(inout) :: self
      integer, intent(in) :: place
      character(*), intent(in) :: message

      if (.not. allocated(self%fault%message)) then
         self%fault%message = message
         self%fault%at = place
      end if
      self%at = len(self%text) + 1
   end subroutine fail

   !> Goes on by some characters and the blanks behind them.
   pure subroutine move(self, characters)
      type(reader_type), intent(inout) :: self
      integer, intent(in) :: characters

      self%at = self%at + characters
      self%at = self%at + span(self%text(self%at:), ' '//achar(9))
   end subroutine move

   !> The character that is read next, or ** as a whole; empty at the end.
   pure function next(self) result(token)
      type(reader_type), intent(in) :: self
      character(:), allocatable :: token

      token = self%text(self%at:min(self%at, len(self%text)))
      if (token == '*' .and. index(self%text(self%at:), '**') == 1) token = '**'
   end function next

   !> The name at a byte of a text; empty where there is none.
   pure function name_at(text, first) result(name)
      character(*), intent(in) :: text
      integer, intent(in) :: first
      character(:), allocatable :: name

      name = ''
      if (span(text(first:min(first, len(text))), letters) == 1) name = text(first:first - 1 + &
         span(text(first:), letters//digits))
   end function name_at

   !> How many characters of a set a text begins with.
   pure integer function span(text, set)
      character(*), intent(in) :: text, set

      span = verify(text, set) - 1
      if (span < 0) span = len(text)
   end function span

end module arithmetic
