!> Values of the fields of a data card, with an error at their place where they are not what they
!> should be.
module card_values
   use cards, only: data_card_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use kinds, only: dp
   use text, only: integer_fault, is_whole, read_integer, read_real, real_fault
   implicit none
   private

   !> Freezing point of water in kelvin. A whole number below it behind a property may well be
   !> decimals; one above it is rather the temperature that the property was measured at.
   real(dp), parameter :: least_plausible = 273.0_dp

   public :: has_field, is_undefined, field_text, field_place, need_field, take_field, check_extra
   public :: may_be_decimals, check_unneeded, check_unneeded_temperature

   !> Value of a field; an error where it is missing.
   interface need_field
      module procedure need_text_field
      module procedure need_integer_field
      module procedure need_real_field
   end interface need_field

   !> Value of a field where the card has it; else it stays as it is.
   interface take_field
      module procedure take_integer_field
      module procedure take_real_field
   end interface take_field

contains

   !> Whether a data card has a field that is not empty.
   pure logical function has_field(data, i)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1

      has_field = i <= size(data%fields)
      if (has_field) has_field = len(data%fields(i)%text) > 0
   end function has_field

   !> A field as written; empty where the card does not have it.
   pure function field_text(data, i) result(string)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1
      character(:), allocatable :: string        !! the field

      string = ''
      if (i <= size(data%fields)) string = data%fields(i)%text
   end function field_text

   !> Whether the text of a field is not known, which is reported already.
   pure logical function is_undefined(data, i)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1

      is_undefined = i <= size(data%fields)
      if (is_undefined) is_undefined = data%fields(i)%undefined
   end function is_undefined

   !> Place of a field; the end of the card where it does not have it.
   pure function field_place(data, i) result(place)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                   !! position, from 1
      type(place_type) :: place                  !! where it stands

      place = data%end
      if (i <= size(data%fields)) place = data%fields(i)%place
   end function field_place

   !> Reports the first field that a card has too many.
   subroutine check_extra(data, most, layout, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: most                         !! most fields
      character(*), intent(in) :: layout                  !! what a card of its keyword holds
      type(deck_report_type), intent(inout) :: report     !! receives the error

      if (size(data%fields) <= most) return
      call report%error(field_place(data, most + 1), 'extra field; the card is '//layout)
   end subroutine check_extra

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
      decimals = field_text(data, i)
      if (.not. is_whole(field_text(data, i - 1)) .or. verify(decimals, '0') == 0) return
      if (scan(decimals(1:1), '0123456789') == 0 .or. index(decimals, '.') > 0) return
      call read_real(decimals, number, may_be_decimals)
   end function may_be_decimals

   !> Warns of a field that is read and means nothing where it may be the decimals of the field
   !> before it.
   subroutine check_unneeded(data, i, what, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                            !! position of the field, from 2
      character(*), intent(in) :: what                    !! what the field is, with its article
      type(deck_report_type), intent(inout) :: report     !! receives the warning

      if (.not. may_be_decimals(data, i)) return
      associate (whole => data%fields(i - 1)%text, decimals => data%fields(i)%text)
         call report%warning(field_place(data, i - 1), 'decimal comma? '//whole//','//decimals// &
            ' is two fields: '//whole//', and '//what//', which is not needed; write '//whole// &
            '.'//decimals//', or '//whole//'. if that is meant')
      end associate
   end subroutine check_unneeded

   !> As check_unneeded for the temperature behind a property: a plausible one is no decimals,
   !> unless it stands directly behind the comma of `0,`.
   subroutine check_unneeded_temperature(data, i, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                            !! position of the field, from 2
      type(deck_report_type), intent(inout) :: report     !! receives the warning
      real(dp) :: temperature
      logical :: is_number

      if (.not. may_be_decimals(data, i)) return
      call read_real(field_text(data, i), temperature, is_number)
      associate (before => data%fields(i - 1), field => data%fields(i))
         if (temperature >= least_plausible .and. (verify(before%text, '+-0') > 0 .or. &
            field%place%column > before%place%column + len(before%text) + 1)) return
      end associate
      call check_unneeded(data, i, 'a temperature', report)
   end subroutine check_unneeded_temperature

   subroutine need_text_field(data, i, what, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable, intent(inout) :: value
      logical, intent(inout) :: valid

      value = field_text(data, i)
      if (len(value) == 0) call report_missing(data, i, what, report, valid)
   end subroutine need_text_field

   subroutine need_integer_field(data, i, what, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      type(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: value
      logical, intent(inout) :: valid

      call take_field(data, i, what, report, value, valid)
      if (.not. has_field(data, i)) call report_missing(data, i, what, report, valid)
   end subroutine need_integer_field

   subroutine need_real_field(data, i, what, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid

      call take_field(data, i, what, report, value, valid)
      if (.not. has_field(data, i)) call report_missing(data, i, what, report, valid)
   end subroutine need_real_field

   subroutine report_missing(data, i, what, report, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid

      valid = .false.
      if (.not. is_undefined(data, i)) call report%error(field_place(data, i), &
         'missing field: '//what)
   end subroutine report_missing

   subroutine take_integer_field(data, i, what, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      type(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: value
      logical, intent(inout) :: valid
      integer :: number
      logical :: is_number

      if (is_undefined(data, i)) valid = .false.
      if (.not. has_field(data, i)) return
      call read_integer(data%fields(i)%text, number, is_number)
      if (is_number) then
         value = number
      else
         call report%error(field_place(data, i), ''''//data%fields(i)%text//''' '// &
            integer_fault(data%fields(i)%text)//'; expected: '//what)
         valid = .false.
      end if
   end subroutine take_integer_field

   subroutine take_real_field(data, i, what, report, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid
      real(dp) :: number
      logical :: is_number

      if (is_undefined(data, i)) valid = .false.
      if (.not. has_field(data, i)) return
      call read_real(data%fields(i)%text, number, is_number)
      if (is_number) then
         value = number
      else
         call report%error(field_place(data, i), ''''//data%fields(i)%text//''' '// &
            real_fault(data%fields(i)%text)//'; expected: '//what)
         valid = .false.
      end if
   end subroutine take_real_field

end module card_values
