!> The global quantities of an interface whose errors are estimated.
module interface_quantities
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_pairs, only: contact_pairs_type
   use contact_states, only: status_open
   use controls, only: thermal_scheme_type
   use interface_operators, only: interface_operators_type
   use kinds, only: dp
   use pair_tractions, only: pressures, shears
   use records, only: at_edge_contact, at_edge_stick, at_heat_rate, at_normal_force, &
      at_peak_pressure, at_shear_force, estimated_quantities
   use solution_state, only: carrying_conductance, solution_state_type
   use zone_edges, only: contact_edges, edges_kept, stick_edges
   implicit none
   private
   public :: quantities_of, quantities_of_state, edge_resolution

   !> How far edges of zones are known on a mesh, in spacings of the pairs about them: of those of
   !> the published cylinder nine tenths are no further from the converged ones (docs/accuracy.md).
   real(dp), parameter :: known_contact_edge = 0.1_dp
   real(dp), parameter :: known_stick_edge = 0.6_dp

contains

   !> The quantities at their places; NaN for an edge where there is none.
   pure function quantities_of(pairs, friction, status, gap, force, shear_force, heat) &
      result(values)
      type(contact_pairs_type), intent(in) :: pairs   !! the pairs of the interface
      real(dp), intent(in) :: friction                !! mu [-]
      integer, intent(in) :: status(:)                !! (m) open, slip or stick
      real(dp), intent(in) :: gap(:)                  !! (m) [length]
      real(dp), intent(in) :: force(:)                !! (m) nodal, positive in compression [force]
      real(dp), intent(in) :: shear_force(:)          !! (m) on the slave [force]
      real(dp), intent(in) :: heat(:)                 !! (m) from slave to master [power]
      real(dp) :: values(estimated_quantities)        !! [force], [power], [stress], [length]
      real(dp) :: edges(edges_kept), pressure(size(force)), shear(size(force))

      pressure = pressures(pairs, force, status /= status_open)
      shear = shears(pairs, shear_force, status /= status_open, friction, pressure)
      values(at_normal_force) = sum(force)
      values(at_shear_force) = sum(shear_force)
      values(at_heat_rate) = sum(heat)
      values(at_peak_pressure) = maxval(pressure)
      call contact_edges(pairs%arc_length, status, pressure, gap, edges, values(at_edge_contact))
      call stick_edges(pairs%arc_length, pairs%weight, status, pressure, shear, gap, friction, &
         edges, values(at_edge_stick))
   end function quantities_of

   !> The quantities of all interfaces in a state.
   subroutine quantities_of_state(operators, state, scheme, values)
      type(interface_operators_type), intent(in) :: operators   !! the bodies
      type(solution_state_type), intent(in) :: state            !! the state
      type(thermal_scheme_type), intent(in) :: scheme           !! by which it was found
      real(dp), intent(out) :: values(:, :)                     !! (quantities, interfaces)
      real(dp) :: omega(size(state%omega))
      integer :: first, i, last

      omega = carrying_conductance(state, scheme)
      associate (pairs => operators%pairs, contact => state%contact)
         do i = 1, size(values, 2)
            first = pairs%interface_start(i)
            last = pairs%interface_start(i + 1) - 1
            values(:, i) = quantities_of(operators%interfaces(i), pairs%friction(first), &
               contact%status(first:last), contact%gap(first:last), contact%force(first:last), &
               contact%shear_force(first:last), pairs%weight(first:last)*omega(first:last)* &
               state%jump(first:last))
         end do
      end associate
   end subroutine quantities_of_state

   !> How far the edges among the quantities are known from the spacing of the pairs; 0 for the
   !> others and for zones that end with the interface.
   pure function edge_resolution(pairs, values) result(resolution)
      type(contact_pairs_type), intent(in) :: pairs   !! the pairs of the interface
      real(dp), intent(in) :: values(:)               !! as quantities_of gave them
      real(dp) :: resolution(size(values))            !! to either side [length]

      resolution = 0.0_dp
      resolution(at_edge_contact) = known_contact_edge*spacing_at(pairs%arc_length, &
         values(at_edge_contact))
      resolution(at_edge_stick) = known_stick_edge*spacing_at(pairs%arc_length, &
         values(at_edge_stick))
   end function edge_resolution

   !> Distance of the pairs on both sides of a place; 0 at or beyond the last pair.
   pure function spacing_at(s, place) result(spacing)
      real(dp), intent(in) :: s(:), place
      real(dp) :: spacing
      integer :: k

      spacing = 0.0_dp
      if (ieee_is_nan(place)) return
      do k = 1, size(s) - 1
         if (place >= s(k) .and. place < s(k + 1)) spacing = s(k + 1) - s(k)
      end do
   end function spacing_at

end module interface_quantities
