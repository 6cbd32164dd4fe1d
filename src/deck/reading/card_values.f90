!> Values of the fields of a data card, with an error at their place where they are not what they
!> should be.
module card_values
   use cards, only: data_card_type, field_place, field_text, has_field, is_undefined
   use decimal_commas, only: decimal_comma_words, surplus_comma
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use text, only: integer_fault, read_integer, read_real, real_fault
   implicit none
   private
   public :: need_field, take_field, check_extra, need_vector, need_plane_vector

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

   !> Reports the first field that a card has too many, which a decimal comma may have made.
   subroutine check_extra(data, most, layout, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: most                         !! most fields
      character(*), intent(in) :: layout                  !! what a card of its keyword holds
      type(deck_report_type), intent(inout) :: report     !! receives the error
      integer :: comma

      if (size(data%fields) <= most) return
      comma = surplus_comma(data, most)
      if (comma == 0) then
         call report%error(field_place(data, most + 1), 'extra field; the card is '//layout)
      else
         call report%explain(field_place(data, comma), 'extra field; the card is '//layout// &
            '; or a '//decimal_comma_words(data%fields(comma)%text, data%fields(comma + 1)%text))
      end if
   end subroutine check_extra

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

   !> Takes three fields in a row; of fields that are missing the first is reported.
   subroutine need_vector(data, first, what, report, vector, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: first                         !! position of the first field
      character(*), intent(in) :: what                     !! what they are
      type(deck_report_type), intent(inout) :: report      !! receives the error
      real(dp), intent(out) :: vector(3)                   !! their values, zero after an error
      logical, intent(inout) :: valid   !! becomes false after an error; then nothing more is read
      integer :: i

      vector = 0.0_dp
      do i = 1, 3
         if (valid) call need_field(data, first + i - 1, what//' '//'xyz'(i:i), report, vector(i), &
            valid)
      end do
   end subroutine need_vector

   !> Reads a magnitude and the components of a direction, of which z may be left out and must be 0.
   subroutine need_plane_vector(data, first, report, vector, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: first                         !! position of the magnitude
      type(deck_report_type), intent(inout) :: report      !! receives errors
      real(dp), intent(out) :: vector(2)                   !! x and y, zero after an error
      logical, intent(inout) :: valid                      !! becomes false after an error
      real(dp) :: magnitude, direction(3)
      integer :: i

      vector = 0.0_dp
      direction = 0.0_dp
      call need_field(data, first, 'magnitude', report, magnitude, valid)
      do i = 1, 2
         if (valid) call need_field(data, first + i, 'direction '//'xy'(i:i), report, &
            direction(i), valid)
      end do
      if (valid) call take_field(data, first + 3, 'direction z', report, direction(3), valid)
      if (.not. valid) return
      if (abs(direction(3)) > 0.0_dp) then
         call report%error(field_place(data, first + 3), &
            'the direction lies in the plane: z must be 0')
         valid = .false.
      else if (norm2(direction) <= 0.0_dp) then
         call report%error(field_place(data, first + 1), 'the direction is zero')
         valid = .false.
      else
         vector = magnitude*direction(:2)/norm2(direction)
      end if
   end subroutine need_plane_vector

end module card_values
