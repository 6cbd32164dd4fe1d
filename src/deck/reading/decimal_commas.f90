!> Numbers written with a decimal comma, which the dialect reads as two fields.
module decimal_commas
   use card_values, only: field_place, may_be_decimals
   use cards, only: data_card_type
   use deck_report, only: deck_report_type
   use text, only: is_whole
   implicit none
   private
   public :: decimal_comma, report_decimal_comma

contains

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
      type(deck_report_type), intent(inout) :: report     !! receives the error

      associate (whole => data%fields(i)%text, part => data%fields(i + 1)%text)
         call report%error(field_place(data, i), 'a decimal comma? A comma separates fields; '// &
            'write '//whole//'.'//part//' for '//whole//','//part)
      end associate
   end subroutine report_decimal_comma

end module decimal_commas
