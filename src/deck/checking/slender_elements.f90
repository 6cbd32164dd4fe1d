!> Elements with nodes that nearly coincide. The forces of such nodes, made of stiffnesses that
!> grow as the side shrinks, are known to rounding times the square of the ratio of the sides, in
!> parts of an even load: nothing is left of the pressure at a contact point of such a side at 1e-8.
module slender_elements
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use element_kinds, only: element_corner_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use text, only: to_text
   implicit none
   private
   public :: check_slenderness

   real(dp), parameter :: hopeless = 1.0e-7_dp   !! shortest side over the longest, to be refused
   real(dp), parameter :: doubtful = 1.0e-5_dp   !! the same, to be warned of

contains

   !> No side of an element is far shorter than the others. Corners in one place are left to the
   !> Jacobian.
   subroutine check_slenderness(context, mesh, report)
      type(deck_context_type), intent(in) :: context       !! places for messages
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report      !! receives errors and a warning
      real(dp) :: least, ratio
      integer :: e, worst, count_doubtful

      worst = 0
      count_doubtful = 0
      least = doubtful
      do e = 1, size(mesh%element_number)
         if (.not. context%element_valid(e)) cycle
         ratio = side_ratio(mesh, e)
         if (ratio < hopeless) call report%error(context%element_place(e), said(mesh, e, ratio)// &
            ', and rounding would spoil the result')
         if (ratio < hopeless .or. ratio >= doubtful) cycle
         count_doubtful = count_doubtful + 1
         if (ratio < least) worst = e
         least = min(least, ratio)
      end do
      if (worst > 0) call report%warning(context%element_place(worst), &
         said(mesh, worst, least)//', and pressures there are accurate to '// &
         to_text(epsilon(1.0_dp)/least**2)//' only (number of such elements: '// &
         to_text(count_doubtful)//')')
   end subroutine check_slenderness

   !> The shortest side that has a length, over the longest; of corners alone.
   pure real(dp) function side_ratio(mesh, e)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(dp) :: lengths(4)
      integer :: i, n

      n = element_corner_count(mesh%element_kind(e))
      do i = 1, n
         lengths(i) = norm2(mesh%coordinates(:, mesh%element_nodes(1 + mod(i, n), e)) - &
            mesh%coordinates(:, mesh%element_nodes(i, e)))
      end do
      side_ratio = 1.0_dp
      if (any(lengths(:n) > 0.0_dp)) side_ratio = minval(lengths(:n), mask=lengths(:n) > 0.0_dp)/ &
         maxval(lengths(:n))
   end function side_ratio

   !> The part of a message that names an element and the ratio of its sides.
   pure function said(mesh, e, ratio) result(words)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(dp), intent(in) :: ratio
      character(:), allocatable :: words

      words = 'nodes of element '//to_text(mesh%element_number(e))// &
         ' nearly coincide: its shortest side is '//to_text(ratio)//' of its longest'
   end function said

end module slender_elements
