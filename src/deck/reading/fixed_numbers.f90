!> Numbers in fields of fixed columns as Fortran reads them.
module fixed_numbers
   implicit none
   private
   public :: number_fault, plain_number

   character(*), parameter :: digits = '0123456789'

contains

   !> What is wrong with the place of a number in its field. In Fortran before 1977 blanks behind a
   !> number were zeros, later they count for nothing: such a number is taken only where its point
   !> makes both the same.
   pure subroutine number_fault(text, whole, bad, fault)
      character(*), intent(in) :: text                     !! all columns of the field
      logical, intent(in) :: whole                         !! whether the format is I
      integer, intent(out) :: bad                          !! where the fault is in text
      character(:), allocatable, intent(out) :: fault      !! what is wrong, or empty
      character(:), allocatable :: number
      integer :: first, last, inner

      fault = ''
      bad = 1
      first = verify(text, ' ')
      if (first == 0) return
      last = len_trim(text)
      number = with_signed_exponent(text(first:last))
      inner = index(number, ' ')
      if (inner > 0) then
         bad = first + inner - 1
         fault = 'there is a blank inside this field: are the columns shifted?'
      else if (last < len(text) .and. (whole .or. .not. ends_safely(number))) then
         bad = last + 1
         fault = 'the number must end in the last column of its field, because blanks after it '// &
            'may count as zeros: are the columns shifted?'
      end if
   end subroutine number_fault

   !> Whether zeros behind a number would not change it: it has a point and no exponent.
   pure logical function ends_safely(number)
      character(*), intent(in) :: number

      ends_safely = index(number, '.') > 0 .and. scan(number, 'EeDd') == 0 .and. &
         scan(number(2:), '+-') == 0
   end function ends_safely

   !> A number as it is on a card of fields between commas: with the point that the format
   !> implies and an E before the exponent. What is no number stays as it is.
   pure function plain_number(text, decimals, real) result(number)
      character(*), intent(in) :: text            !! all columns of the field
      integer, intent(in) :: decimals             !! digits behind a point that is not written
      logical, intent(in) :: real                 !! whether the number has decimals
      character(:), allocatable :: number         !! without blanks around it
      character(:), allocatable :: mantissa, sign, exponent
      integer :: mark, point

      number = with_signed_exponent(trim(adjustl(text)))
      if (.not. real .or. len(number) == 0) return
      mark = scan(number, 'EeDd')
      if (mark == 0) then
         mark = scan(number(2:), '+-') + 1
         if (mark == 1) mark = len(number) + 1
         exponent = number(mark:)
         if (len(exponent) > 0 .and. index(number, '.') == 0) return
         if (len(exponent) > 0) exponent = 'E'//exponent
      else
         exponent = number(mark:)
      end if
      mantissa = number(:mark - 1)
      sign = ''
      if (len(mantissa) > 0) then
         if (scan(mantissa(1:1), '+-') == 1) sign = mantissa(1:1)
      end if
      mantissa = mantissa(len(sign) + 1:)
      if (verify(mantissa, digits) == 0 .and. len(mantissa) > 0 .and. decimals > 0) then
         mantissa = repeat('0', max(decimals + 1 - len(mantissa), 0))//mantissa
         point = len(mantissa) - decimals
         mantissa = mantissa(:point)//'.'//mantissa(point + 1:)
      end if
      number = sign//mantissa//exponent
   end function plain_number

   !> Old machines print 1.5E 03: the blank is the sign of the exponent.
   pure function with_signed_exponent(number) result(signed)
      character(*), intent(in) :: number
      character(:), allocatable :: signed
      integer :: mark

      signed = number
      mark = scan(number, 'EeDd')
      if (mark == 0 .or. mark + 1 >= len(number)) return
      if (number(mark + 1:mark + 1) == ' ' .and. scan(number(mark + 2:mark + 2), digits) == 1) then
         signed(mark + 1:mark + 1) = '+'
      end if
   end function with_signed_exponent

end module fixed_numbers
