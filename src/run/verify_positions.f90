!> Positions of *VERIFY cards that only the contact points of the refined mesh can tell.
module verify_positions
   use contact_points, only: contact_points_type
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
   subroutine check_arc_lengths(model, interfaces, report)
      type(model_type), intent(in) :: model                !! its checks name known interfaces
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
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
            do k = 1, size(interfaces)
               if (to_upper(interfaces(k)%name) /= to_upper(trim(check%where(:at - 1)))) cycle
               if (is_on_interface(s, interfaces(k))) cycle
               call report%error(place_type(check%line, check%columns(2)), &
                  'the arc length of contact pair '//interfaces(k)%name//' ends at '// &
                  to_text(interfaces(k)%arc_length(size(interfaces(k)%arc_length))))
            end do
         end associate
      end do
   end subroutine check_arc_lengths

end module verify_positions
