!> Places of *VERIFY cards that only the pairs of the refined mesh can tell.
module verify_places
   use contact_pairs, only: contact_pairs_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use kinds, only: dp
   use model, only: model_type
   use text, only: read_real, to_text, to_upper
   use verify_values, only: is_on_interface
   implicit none
   private
   public :: check_arc_lengths

contains

   !> Reports every check at an arc length beyond the end of its interface.
   subroutine check_arc_lengths(model, pairs, report)
      type(model_type), intent(in) :: model                !! its checks name known interfaces
      type(contact_pairs_type), intent(in) :: pairs(:)     !! pairs of every interface
      type(deck_report_type), intent(inout) :: report      !! receives errors
      real(dp) :: s
      integer :: at, i, k
      logical :: valid

      do i = 1, size(model%verifications)
         associate (check => model%verifications(i))
            at = index(check%where, '@')
            if (at == 0) cycle
            call read_real(trim(adjustl(check%where(at + 1:))), s, valid)
            if (.not. valid) cycle
            do k = 1, size(pairs)
               if (to_upper(pairs(k)%name) /= to_upper(trim(check%where(:at - 1)))) cycle
               if (is_on_interface(s, pairs(k))) cycle
               call report%error(place_type(check%line, check%columns(2)), &
                  'the arc length of contact pair '//pairs(k)%name//' ends at '// &
                  to_text(pairs(k)%arc_length(size(pairs(k)%arc_length))))
            end do
         end associate
      end do
   end subroutine check_arc_lengths

end module verify_places
