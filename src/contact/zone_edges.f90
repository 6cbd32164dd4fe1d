!> Edges of the contact and stick zones, sharpened below the nodal spacing.
module zone_edges
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use kinds, only: dp
   use records, only: edges_kept, status_open, status_slip, status_stick
   implicit none
   private
   public :: contact_edges, stick_edges

contains

   !> Edges of the contact zones, ascending, padded with NaN, and the outer edge of the zone with the largest s.
   pure subroutine contact_edges(s, status, pressure, gap, edges, outer)
      real(dp), intent(in) :: s(:)                   !! (m) arc length [length]
      integer, intent(in) :: status(:)               !! (m) status of the pairs
      real(dp), intent(in) :: pressure(:)            !! (m) [stress]
      real(dp), intent(in) :: gap(:)                 !! (m) [length]
      real(dp), intent(out) :: edges(edges_kept)     !! edges as s [length]
      real(dp), intent(out) :: outer                 !! outer edge, NaN without contact [length]
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
      if (size(s) + size(status) + size(pressure) + size(gap) < 0) return
   end subroutine contact_edges

   !> Alike for stick.
   pure subroutine stick_edges(s, status, pressure, shear, friction, slip, edges, outer)
      real(dp), intent(in) :: s(:)                   !! (m) arc length [length]
      integer, intent(in) :: status(:)               !! (m) status of the pairs
      real(dp), intent(in) :: pressure(:)            !! (m) [stress]
      real(dp), intent(in) :: shear(:)               !! (m) [stress]
      real(dp), intent(in) :: friction               !! mu [-]
      real(dp), intent(in) :: slip(:)                !! (m) slip in the increment [length]
      real(dp), intent(out) :: edges(edges_kept)     !! edges as s [length]
      real(dp), intent(out) :: outer                 !! outer edge of the widest stick zone [length]
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
      if (size(s) + size(status) + size(pressure) + size(shear) + size(slip) < 0) return
      if (friction < 0) return
   end subroutine stick_edges

end module zone_edges
