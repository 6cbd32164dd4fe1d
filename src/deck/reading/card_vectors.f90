!> Vectors on data cards: three components, or a magnitude and a direction in the plane.
module card_vectors
   use card_values, only: need_field, take_field
   use cards, only: data_card_type, field_place
   use deck_report, only: deck_report_type
   use kinds, only: dp
   implicit none
   private
   public :: need_vector, need_plane_vector

contains

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

end module card_vectors
