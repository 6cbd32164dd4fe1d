!> The global quantities of an interface whose errors are estimated.
module interface_quantities
   use axis_limits, only: tractions
   use contact_pairs, only: contact_pairs_type
   use kinds, only: dp
   use records, only: edges_kept, estimated_quantities
   use zone_edges, only: contact_edges, stick_edges
   implicit none
   private
   public :: quantities_of

contains

   !> Normal force, shear force, heat rate, peak pressure, edge of contact, edge of stick, in the
   !> order of estimated_names; NaN for an edge where there is none.
   pure function quantities_of(pairs, friction, status, gap, force, shear_force, heat) &
      result(values)
      type(contact_pairs_type), intent(in) :: pairs   !! the pairs of the interface
      real(dp), intent(in) :: friction                !! mu [-]
      integer, intent(in) :: status(:)                !! (m) open, slip or stick
      real(dp), intent(in) :: gap(:)                  !! (m) [length]
      real(dp), intent(in) :: force(:)                !! (m) nodal, positive in compression [force]
      real(dp), intent(in) :: shear_force(:)          !! (m) on the slave [force]
      real(dp), intent(in) :: heat(:)                 !! (m) from slave to master [power]
      real(dp) :: values(estimated_quantities)
      real(dp) :: edges(edges_kept), pressure(size(force)), shear(size(force))

      pressure = tractions(force, pairs%weight, pairs%position(1, :), even=.true.)
      shear = tractions(shear_force, pairs%weight, pairs%position(1, :), even=.false.)
      values(1) = sum(force)
      values(2) = sum(shear_force)
      values(3) = sum(heat)
      values(4) = maxval(pressure)
      call contact_edges(pairs%arc_length, status, pressure, gap, edges, values(5))
      call stick_edges(pairs%arc_length, pairs%weight, status, pressure, shear, gap, friction, &
         edges, values(6))
   end function quantities_of

end module interface_quantities
